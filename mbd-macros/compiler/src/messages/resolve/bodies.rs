//! Messages about bodies: mass, inertia, shapes, and how frames are turned.

use mbd_scene::solids::Solid;

use super::items::short;
use crate::check::WrongInertia;
use crate::lexeme::Region;
use crate::messages::LexemeMessage;
use crate::messages::similar::did_you_mean;
use crate::messages::syntax::ended;
use crate::syntax::foreign;

pub fn no_mass(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "body `{name}` has no mass. add `mass: 1.0 kg`; for a massless junction of lines use `point {name};`"
        ),
    )
}

pub fn no_inertia(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "body `{name}` has no inertia. add `inertia: diag(1.0, 1.0, 1.0) kg*m^2`, or `shape: box [0.2, 0.3, 0.4] m`, from which it follows; for a mass without rotation use `point {name} {{ mass: 1.0 kg }}`"
        ),
    )
}

pub fn inertia_of_shape(at: Region, shape: &str) -> Option<LexemeMessage> {
    let ours = foreign::translated(foreign::FOREIGN_SHAPES, shape).unwrap_or(shape);
    let solid = Solid::ALL.iter().find(|solid| solid.keyword() == ours)?;
    let text = format!(
        "an inertia is given by its numbers; leave it out, and it follows from `shape: {}` and the mass",
        solid_form(*solid)
    );
    Some(LexemeMessage::new(at, text))
}

/// A shape as it is written.
fn solid_form(solid: Solid) -> String {
    let word = solid.keyword();
    match solid {
        Solid::Box => format!("{word} [0.2, 0.3, 0.4] m"),
        _ => {
            let sizes = solid.sizes().iter();
            let sizes: Vec<String> = sizes.map(|size| format!("{size}: 0.1 m")).collect();
            format!("{word} {{ {} }}", sizes.join(", "))
        }
    }
}

pub fn shape_form(at: Region, found: Option<&str>) -> LexemeMessage {
    let known = || Solid::ALL.iter().map(|solid| solid.keyword());
    let list: Vec<&str> = known().collect();
    let list = format!(
        "shapes here: {}, as in `shape: {}`, several in brackets",
        list.join(", "),
        solid_form(Solid::Box)
    );
    let Some(found) = found else {
        return LexemeMessage::new(at, format!("expected a shape. {list}"));
    };
    if found == "mesh" {
        return LexemeMessage::new(at, foreign::NO_MESH.to_string());
    }
    let suggestion = match foreign::translated(foreign::FOREIGN_SHAPES, found) {
        Some(ours) => format!("; here it is called `{ours}`."),
        None => ended(did_you_mean(found, known())),
    };
    LexemeMessage::new(at, format!("unknown shape `{found}`{suggestion} {list}"))
}

pub fn shape_sizes(at: Region, solid: Solid) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("a {} is written `{}`", solid.keyword(), solid_form(solid)),
    )
}

pub fn missing_size(at: Region, solid: Solid, word: &str) -> LexemeMessage {
    let word = format!("the {} has no `{word}`", solid.keyword());
    LexemeMessage::new(at, format!("{word}: write `{}`", solid_form(solid)))
}

pub fn tube_without_wall(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the tube of `{name}` has no wall: its `inner` radius must be smaller than its `radius`"
        ),
    )
}

pub fn no_edge(at: Region, name: &str, axis: &str, found: f64) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("the box of `{name}` is {found} m along {axis}: its edges must be positive"),
    )
}

pub fn mass_and_density(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!("body `{name}` has a `mass` and a `density`: give one of them"),
    )
}

pub fn density_alone(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the `density` of `{name}` has nothing to fill: give a `mass`; or give a `shape` and no `inertia`, and mass and inertia follow from both"
        ),
    )
}

pub fn center_of_shapes(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "the centre of mass of `{name}` follows from its shapes, as its inertia does: leave out `center_of_mass`, or give `inertia`"
        ),
    )
}

pub fn inertia_form(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected an inertia such as `diag(1.0, 1.0, 2.0) kg*m^2`, or `full { xx: 1.0, yy: 1.0, zz: 2.0, xy: 0.1 } kg*m^2 (matrix elements)`",
    )
}

pub fn missing_element(at: Region, word: &str) -> LexemeMessage {
    LexemeMessage::new(at, format!("the inertia has no element `{word}`"))
}

pub fn products_sign(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "say how products are meant: `(matrix elements)`, xy = -∫ x y dm, or `(products of inertia)`, xy = +∫ x y dm",
    )
}

pub fn impossible_inertia(at: Region, owner: &str, wrong: WrongInertia) -> LexemeMessage {
    let text = match wrong {
        WrongInertia::NotPositive(smallest) => {
            // A negative one is a slip; one of zero may be meant.
            let instead = match smallest < 0.0 {
                true => "",
                false => {
                    ". in relative coordinates `(unchecked)` behind it (`inertias: unchecked` of a URDF) takes it as it stands"
                }
            };
            format!(
                "the inertia of `{owner}` must be positive about every axis: {}{instead}",
                no_body(wrong)
            )
        }
        WrongInertia::Triangle(..) => format!(
            "{}. check the unit, and that it is about the centre of mass",
            no_body(wrong)
        ),
    };
    LexemeMessage::new(at, text)
}

/// Why principal moments are those of no rigid body.
pub fn no_body(wrong: WrongInertia) -> String {
    match wrong {
        WrongInertia::NotPositive(smallest) => format!(
            "its smallest principal moment is {} kg*m^2",
            short(smallest)
        ),
        WrongInertia::Triangle(largest, others) => format!(
            "no rigid body has these principal moments: the largest ({}) exceeds the sum of the other two ({})",
            short(largest),
            short(others)
        ),
    }
}

pub fn rotation_form(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "expected a rotation: `about(axis, angle)`, such as `about(y, 90 deg)`, `rpy(roll, pitch, yaw)` about fixed axes, `euler_zyx(yaw, pitch, roll)` about moving axes, or `matrix(row, row, row)`",
    )
}

pub fn no_rotation(at: Region) -> LexemeMessage {
    LexemeMessage::new(
        at,
        "this matrix is no rotation: its rows must be perpendicular unit vectors in right-handed order",
    )
}

pub fn mass_and_equilibrium(at: Region, name: &str) -> LexemeMessage {
    LexemeMessage::new(
        at,
        format!(
            "point `{name}` has a mass and an equilibrium: a point with mass moves by Newton's law, so remove one"
        ),
    )
}
