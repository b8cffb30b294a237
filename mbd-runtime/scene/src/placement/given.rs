//! Joint coordinates at the start, as they are said: by joint and number, or by name.

use crate::Scene;

/// A joint coordinate at the start, and its rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointStart {
    /// The joint, by index.
    pub joint: usize,
    /// The coordinate, by number.
    pub coordinate: usize,
    /// Its value [m or rad]; `None`: as the others decide.
    pub value: Option<f64>,
    /// Its rate [m/s or rad/s]; `None`: as the others decide, zero where they do not.
    pub rate: Option<f64>,
    /// Whether the value gives way where loops do not close with it: the nearest that they close with is taken.
    pub about: bool,
}

impl JointStart {
    /// Values and rates by their names, brought together. The first name that is none is an error; a rate is what it is said to be about.
    ///
    /// # Errors
    /// That name.
    pub fn by_name<'a>(
        scene: &Scene,
        given: impl IntoIterator<Item = (&'a str, StartNumber)>,
    ) -> Result<Vec<Self>, &'a str> {
        let mut starts: Vec<JointStart> = Vec::new();
        for (name, said) in given {
            let (joint, coordinate, is_rate) = scene.joint_coordinate(name).ok_or(name)?;
            let same = |known: &JointStart| (known.joint, known.coordinate) == (joint, coordinate);
            let index = starts.iter().position(same).unwrap_or_else(|| {
                starts.push(JointStart {
                    joint,
                    coordinate,
                    value: None,
                    rate: None,
                    about: false,
                });
                starts.len() - 1
            });
            let start = &mut starts[index];
            if is_rate {
                start.rate = Some(said.number());
            } else {
                start.value = Some(said.number());
                start.about = matches!(said, StartNumber::About(_));
            }
        }
        Ok(starts)
    }
}

/// What is said of a coordinate or a rate at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StartNumber {
    /// It is this [SI].
    Exact(f64),
    /// It is this [SI] where loops close with it, and the nearest that they close with where not.
    About(f64),
}

impl StartNumber {
    /// The number that is said [SI].
    #[must_use]
    pub const fn number(self) -> f64 {
        match self {
            StartNumber::Exact(number) | StartNumber::About(number) => number,
        }
    }
}

impl From<f64> for StartNumber {
    fn from(number: f64) -> Self {
        StartNumber::Exact(number)
    }
}

impl Scene {
    /// The joint coordinate of a name, `pin.angle`, or of that of its rate, `pin.angle_rate`: joint, number, whether it is the rate. Of a joint with one
    /// coordinate its name is enough, as in a gear.
    #[must_use]
    pub fn joint_coordinate(&self, name: &str) -> Option<(usize, usize, bool)> {
        let named = |owner: &str| self.joints.iter().position(|joint| joint.name == owner);
        if let Some(joint) = named(name) {
            let only = self.joints.get(joint)?.law.measured().count() == 1;
            return only.then_some((joint, 0, false));
        }
        let (owner, word) = name.rsplit_once('.')?;
        let joint = named(owner)?;
        let mut measured = self.joints.get(joint)?.law.measured().enumerate();
        let (number, found) =
            measured.find(|(_, found)| found.name == word || found.rate == word)?;
        Some((joint, number, found.rate == word))
    }

    /// The name of a joint coordinate, `pin.angle`; empty of none.
    #[must_use]
    pub fn coordinate_name(&self, joint: usize, coordinate: usize) -> String {
        let found = self.coordinate(joint, coordinate);
        found.map_or_else(String::new, |(joint, it)| {
            format!("{}.{}", joint.name, it.name)
        })
    }

    /// The names of all joint coordinates, each followed by that of its rate.
    #[must_use]
    pub fn joint_coordinates(&self) -> Vec<String> {
        let joints = self.joints.iter();
        let names = joints.flat_map(|joint| {
            let words = joint
                .law
                .measured()
                .flat_map(|found| [found.name, found.rate]);
            words.map(move |word| format!("{}.{word}", joint.name))
        });
        names.collect()
    }
}
