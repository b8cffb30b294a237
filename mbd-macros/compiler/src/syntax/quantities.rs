//! What may be asked of the things of a scene, behind their names: `rope.tension`.

/// Where a quantity may stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// In loads, rates, forces along joints, outputs and events.
    Everywhere,
    /// In outputs and events alone: it follows from the accelerations.
    Results,
}

/// A quantity of one kind of thing.
#[derive(Clone, Copy, Debug)]
pub struct ThingQuantity {
    /// Its word.
    pub word: &'static str,
    /// Its SI unit; empty for a pure number.
    pub unit: &'static str,
    /// 1, or 3 for a vector.
    pub components: usize,
    /// What it is.
    pub what: &'static str,
    /// Where it may stand.
    pub reach: Reach,
}

use Reach::{Everywhere, Results};

const fn quantity(
    word: &'static str,
    unit: &'static str,
    components: usize,
    what: &'static str,
    reach: Reach,
) -> ThingQuantity {
    ThingQuantity {
        word,
        unit,
        components,
        what,
        reach,
    }
}

/// Of a point, of a frame and of a body: that of its centre of mass. A massless point has no acceleration.
pub const PLACE: [ThingQuantity; 3] = [
    quantity(
        "position",
        "m",
        3,
        "from the origin of the world",
        Everywhere,
    ),
    quantity("velocity", "m/s", 3, "world axes", Everywhere),
    quantity(
        "acceleration",
        "m/s^2",
        3,
        "rate of the velocity: g in free fall",
        Results,
    ),
];
/// Of a frame and of a body besides.
pub const AXES: [ThingQuantity; 3] = [
    quantity("x", "", 3, "its x axis, world axes", Everywhere),
    quantity("y", "", 3, "its y axis, world axes", Everywhere),
    quantity("z", "", 3, "its z axis, world axes", Everywhere),
];
/// Of a body besides.
pub const BODY: [ThingQuantity; 5] = [
    quantity(
        "orientation",
        "rad",
        3,
        "axis times angle of its rotation, up to half a turn",
        Everywhere,
    ),
    quantity(
        "omega_body",
        "rad/s",
        3,
        "angular velocity, own axes",
        Everywhere,
    ),
    quantity(
        "omega_world",
        "rad/s",
        3,
        "angular velocity, world axes",
        Everywhere,
    ),
    quantity(
        "angular_acceleration",
        "rad/s^2",
        3,
        "rate of the angular velocity, world axes",
        Results,
    ),
    quantity("mass", "kg", 1, "its mass", Everywhere),
];
/// Of a body in a planar scene besides.
pub const PLANAR_BODY: [ThingQuantity; 1] = [quantity(
    "angle",
    "rad",
    1,
    "about the normal of the plane, not periodic",
    Everywhere,
)];
/// Of the whole scene, behind [`ENERGY_WORD`].
pub const ENERGY: [ThingQuantity; 3] = [
    quantity("kinetic", "N*m", 1, "energy of motion", Results),
    quantity(
        "potential",
        "N*m",
        1,
        "energy of gravity, lines, springs and stops",
        Results,
    ),
    quantity("total", "N*m", 1, "kinetic and potential energy", Results),
];
/// The word before an energy of the scene: `energy.kinetic`.
pub const ENERGY_WORD: &str = "energy";
/// Of a line.
pub const LINE: [ThingQuantity; 4] = [
    quantity(
        "tension",
        "N",
        1,
        "its pull, of a line never below zero",
        Everywhere,
    ),
    quantity("length", "m", 1, "from end to end", Everywhere),
    quantity("stretch", "m", 1, "length less free length", Everywhere),
    quantity("stretch_rate", "m/s", 1, "rate of the stretch", Everywhere),
];
/// Of a joint besides its coordinates.
pub const JOINT: [ThingQuantity; 2] = [
    quantity(
        "force",
        "N",
        3,
        "of the joint on its child, what acts along its coordinates among it, world axes",
        Results,
    ),
    quantity(
        "torque",
        "N*m",
        3,
        "of the joint on its child, what acts along its coordinates among it, about the origin of its frame there",
        Results,
    ),
];

/// The words of some quantities, list behind list.
const fn words<const N: usize>(lists: &[&[ThingQuantity]]) -> [&'static str; N] {
    let mut all = [""; N];
    let (mut list, mut next) = (0, 0);
    while list < lists.len() {
        let mut item = 0;
        while item < lists[list].len() {
            all[next] = lists[list][item].word;
            (item, next) = (item + 1, next + 1);
        }
        list += 1;
    }
    all
}

/// What may be asked of a frame.
pub const FRAME_QUANTITIES: &[&str] = &words::<6>(&[&PLACE, &AXES]);
/// What may be asked of a body besides its frames.
pub const BODY_QUANTITIES: &[&str] = &words::<12>(&[&PLACE, &AXES, &BODY, &PLANAR_BODY]);
/// The energies of a scene.
pub const ENERGY_QUANTITIES: &[&str] = &words::<3>(&[&ENERGY]);
/// What may be asked of a point.
pub const POINT_QUANTITIES: &[&str] = &words::<3>(&[&PLACE]);
/// What may be asked of a line.
pub const LINE_QUANTITIES: &[&str] = &words::<4>(&[&LINE]);
/// What may be asked of every joint besides its coordinates.
pub const JOINT_QUANTITIES: &[&str] = &words::<2>(&[&JOINT]);

/// The axis that a letter means.
pub fn axis_of(word: &str) -> Option<usize> {
    ["x", "y", "z"].iter().position(|axis| *axis == word)
}

/// The quantity and the axis of a component that states and histories have under a name of its own: `vx` is `velocity.x`.
pub fn component_of(word: &str) -> Option<(&'static str, usize)> {
    let axis = axis_of(word.strip_prefix('v')?)?;
    Some(("velocity", axis))
}
