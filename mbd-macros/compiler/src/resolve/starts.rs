//! Starts of bodies and points: `start at [0.0, 0.0, 10.0] m rotated rpy(0.0, 30 deg, 0.0) velocity [1.0, 0.0, 0.0] m/s`.

use mbd_scene::{Formula, Part, PartStart, Place, Plane, Triple};

use super::{Instance, MayDependOn, Named, Resolver, fold};
use crate::describe;
use crate::lexeme::Region;
use crate::messages::{resolve as say, syntax as say_syntax};
use crate::syntax::{ValueSyntax, words};
use crate::units;

/// How far out of its plane a start may be said [m or 1]: rounding.
const IN_PLANE: f64 = 1e-9;

/// The rows of a rotation that turns nothing.
fn along_the_world() -> [Triple; 3] {
    let number = |i: usize, j: usize| Formula::Number(if i == j { 1.0 } else { 0.0 });
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| number(i, j)))
}

impl Resolver<'_> {
    /// Fills where bodies and points start.
    pub fn part_starts(&mut self) {
        for (word, body) in [("body", true), ("point", false)] {
            for instance in self.of(word) {
                let (part, named) = match body {
                    true => (Part::Body(instance.slot), Named::Body(instance.slot)),
                    false => (Part::Point(instance.slot), Named::Point(instance.slot)),
                };
                self.poison(named, |this| this.part_start(&instance, part));
            }
        }
    }

    fn part_start(&mut self, instance: &Instance<'_>, part: Part) -> Option<()> {
        let starts = instance
            .item
            .block
            .iter()
            .filter(|field| field.word.text == words::START.word);
        let starts: Vec<_> = starts.filter(|start| !start.broken).collect();
        let Some(first) = starts.first() else {
            return Some(());
        };
        let at = Region::from(first.word.at);
        let name = describe::part(&self.scene, part).to_owned();
        if let Some(field) = starts.iter().find(|start| start.clause(":").is_some()) {
            return self.fail(say::start_of_part(field.word.at.into(), &name));
        }
        let point = match part {
            Part::Point(index) if self.scene.is_node(Place::Point(index)) => {
                return self.fail(say::start_of_node(at, &name));
            }
            Part::Point(_) => true,
            _ => false,
        };
        let scope = instance.scope(MayDependOn::Fixed);
        let mut start = PartStart::of(part);
        let mut given: Vec<(&str, Region)> = Vec::new();
        for clause in starts.iter().flat_map(|start| &start.clauses) {
            let (sign, value) = (clause.sign, clause.value);
            if let Some((_, first)) = given.iter().find(|(known, _)| *known == sign) {
                return self.fail(say_syntax::repeated_clause(clause.at, sign, *first));
            }
            given.push((sign, clause.at));
            if point && ["rotated", "angular_velocity"].contains(&sign) {
                return self.fail(say::point_has_no_axes(clause.at, &name, sign));
            }
            match sign {
                "at" => {
                    start.position = Some(self.triple("start at", value, units::LENGTH, scope)?)
                }
                "velocity" => {
                    start.velocity = Some(self.triple("velocity", value, units::SPEED, scope)?);
                }
                "angular_velocity" => {
                    let typed = self.value(value, scope)?;
                    self.in_radians(&typed, "`angular_velocity`")?;
                    let omega = self.fits(typed, "angular_velocity", true, units::RATE)?;
                    let omega = fold::components(omega, &self.scene);
                    start.angular_velocity = Some(omega);
                }
                _ => {
                    let rows = self.rotation(value, scope)?;
                    start.rotation = Some(rows.unwrap_or_else(along_the_world));
                }
            }
            self.stays_in_plane(&name, sign, value, &start)?;
        }
        if given.is_empty() {
            return self.fail(say::start_of_part(at, &name));
        }
        self.scene.starts.parts.push(start);
        Some(())
    }

    /// A start in a planar scene keeps to the plane, with all params at their defaults.
    fn stays_in_plane(
        &mut self,
        name: &str,
        sign: &str,
        value: ValueSyntax<'_>,
        start: &PartStart,
    ) -> Option<()> {
        let Some(plane) = self.scene.planar else {
            return Some(());
        };
        let normal = plane.normal();
        let off = |formula: Option<&Formula>, wanted: f64| {
            let found = formula.and_then(|formula| fold::at_defaults(formula, &self.scene));
            found.is_some_and(|found| (found - wanted).abs() > IN_PLANE)
        };
        let across = |triple: &Option<Triple>| {
            let triple = triple.as_ref();
            off(triple.and_then(|triple| triple.get(normal)), 0.0)
        };
        let leaves = match sign {
            "at" => across(&start.position),
            "velocity" => across(&start.velocity),
            "angular_velocity" => {
                let rates = start.angular_velocity.iter().flatten().enumerate();
                { rates }.any(|(axis, rate)| axis != normal && off(Some(rate), 0.0))
            }
            _ => {
                let rows = start.rotation.as_ref();
                off(rows.and_then(|rows| rows[normal].get(normal)), 1.0)
            }
        };
        let what = match sign {
            "at" => "place",
            "rotated" => "attitude",
            _ => "motion",
        };
        match leaves {
            true => self.fail(say::start_beside(value.at, name, Plane::word(plane), what)),
            false => Some(()),
        }
    }
}
