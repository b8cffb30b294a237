//! XML as a robot. Every mistake is told at its element; reading goes on behind it.

use std::collections::BTreeMap;

use mbd_scene::solids::Solid;
use nalgebra::Matrix3;
use roxmltree::{Attribute, Document, Error, Node, ParsingOptions};

use super::robot::{
    Inertial, Mimic, Robot, UrdfGeometry, UrdfJoint, UrdfJointKind, UrdfLimit, UrdfLink, UrdfOrigin,
};
use crate::lexeme::{LexemeIndex, Lexer, LineStarts};
use crate::messages::{LexemeMessage, Messages, urdf as say};

/// A file with more bytes is no robot.
pub const LARGEST: usize = 10_000_000;
/// More elements, attributes and texts are no robot.
const NODES: u32 = 1_000_000;
/// More links are no robot: the equations would not be compiled.
const LINKS: usize = 2_000;
/// An element with more attributes is none of a robot; the parser compares each with all others.
const ATTRIBUTES: usize = 1_000;
/// More mistakes help nobody.
const MOST: usize = 100;

/// Reads a robot; what is wrong with it is in `messages`.
pub fn read(text: &str, lexer: &mut Lexer, messages: &mut Messages) -> Option<Robot> {
    let mut reader = UrdfReader {
        lines: LineStarts::new(text),
        lexer,
        messages,
        told: 0,
        unread: BTreeMap::new(),
    };
    // The first place of all is the start of the file.
    let start = reader.at(0);
    if text.len() > LARGEST {
        reader.tell(say::too_large(start, text.len()));
        return None;
    }
    if let Some((offset, found)) = crowded(text) {
        let at = reader.at(offset);
        reader.tell(say::too_many_attributes(at, found, ATTRIBUTES));
        return None;
    }
    // Entities are refused by the parser: a robot needs none, and they may be endless.
    let options = ParsingOptions {
        allow_dtd: false,
        nodes_limit: NODES,
        ..ParsingOptions::default()
    };
    let robot = match Document::parse_with_options(text, options) {
        Ok(document) => reader.robot(document.root_element()),
        Err(error) => {
            let at = match error {
                // What is missing is missing at the end.
                Error::UnclosedRootNode | Error::UnexpectedEndOfStream | Error::NoRootNode => {
                    reader.at(text.trim_end().len())
                }
                _ => {
                    let position = error.pos();
                    let (line, column) = (position.row as usize, position.col as usize);
                    reader.lexer.place((line, column))
                }
            };
            reader.tell(say::no_xml(at, &error));
            None
        }
    };
    robot.filter(|_| reader.told == 0)
}

struct UrdfReader<'r, 't> {
    lines: LineStarts<'t>,
    lexer: &'r mut Lexer,
    messages: &'r mut Messages,
    /// How many mistakes were told.
    told: usize,
    unread: BTreeMap<String, usize>,
}

/// The first element with more attributes than any has, and how many: counted by their signs, whatever else is wrong with it.
fn crowded(text: &str) -> Option<(usize, usize)> {
    let mut elements = text.split_inclusive('>');
    let mut offset = 0;
    elements.find_map(|part| {
        let start = offset + part.find('<').unwrap_or(0);
        offset += part.len();
        let found = part.bytes().filter(|byte| *byte == b'=').count();
        (found > ATTRIBUTES).then_some((start, found))
    })
}

/// The elements inside an element.
fn elements<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

fn tag<'a>(node: Node<'a, '_>) -> &'a str {
    node.tag_name().name()
}

/// A link or joint whose names are not resolved yet.
struct UrdfDraft<'a, 'i> {
    node: Node<'a, 'i>,
    name: String,
    at: LexemeIndex,
}

impl UrdfReader<'_, '_> {
    fn at(&mut self, offset: usize) -> LexemeIndex {
        let position = self.lines.position(offset);
        self.lexer.place(position)
    }

    fn tell(&mut self, report: LexemeMessage) {
        self.told += 1;
        self.messages.push(report);
    }

    /// Tells of a mistake at an element. Places are looked for only as long as anyone reads them.
    fn wrong(&mut self, node: Node<'_, '_>, report: impl FnOnce(LexemeIndex) -> LexemeMessage) {
        self.wrong_at(node.range().start, report);
    }

    fn wrong_at(&mut self, offset: usize, report: impl FnOnce(LexemeIndex) -> LexemeMessage) {
        if self.told < MOST {
            let at = self.at(offset);
            self.tell(report(at));
        }
    }

    fn robot(&mut self, node: Node<'_, '_>) -> Option<Robot> {
        if tag(node) != "robot" {
            self.wrong(node, |at| say::no_robot(at, tag(node)));
            return None;
        }
        let [links, joints] = ["link", "joint"].map(|kind| self.drafts(node, kind));
        for element in elements(node).filter(|node| !["link", "joint"].contains(&tag(*node))) {
            self.unknown(element, "robot", &["link", "joint"]);
        }
        if links.is_empty() && self.told == 0 {
            self.wrong(node, say::no_links);
        }
        if links.len() > LINKS {
            self.wrong(node, |at| say::too_many(at, links.len(), LINKS));
            return None;
        }
        let (names, joint_names) = (numbered(&links), numbered(&joints));
        let read_links = links.iter().map(|draft| self.link(draft)).collect();
        let read_joints: Vec<Option<UrdfJoint>> = joints
            .iter()
            .map(|draft| self.joint(draft, &names, &joint_names))
            .collect();
        let mut robot = Robot {
            name: node.attribute("name").unwrap_or_default().trim().to_owned(),
            links: read_links,
            joints: read_joints.into_iter().collect::<Option<_>>()?,
            root: 0,
            unread: std::mem::take(&mut self.unread).into_iter().collect(),
        };
        if self.told == 0 {
            for report in super::tree::mistakes(&mut robot) {
                self.tell(report);
            }
        }
        Some(robot)
    }

    /// The links or the joints of a robot, each name once.
    fn drafts<'a, 'i>(&mut self, robot: Node<'a, 'i>, kind: &str) -> Vec<UrdfDraft<'a, 'i>> {
        let (mut drafts, mut first) = (Vec::new(), BTreeMap::new());
        for node in elements(robot).filter(|node| tag(*node) == kind) {
            let Some(name) = self.name(node) else {
                continue;
            };
            let at = self.at(node.range().start);
            match first.get(&name) {
                Some(earlier) => self.tell(say::twice(at, kind, &name, *earlier)),
                None => {
                    first.insert(name.clone(), at);
                    drafts.push(UrdfDraft { node, name, at });
                }
            }
        }
        drafts
    }

    /// An element that is not looked into; one that is nearly a known one is a mistake.
    fn unknown(&mut self, node: Node<'_, '_>, inside: &str, known: &[&str]) {
        let found = tag(node);
        let xacro = node
            .tag_name()
            .namespace()
            .is_some_and(|name| name.contains("xacro"));
        if xacro {
            self.wrong(node, |at| say::xacro(at, found));
        } else if let Some(meant) = crate::messages::similar::nearest(found, known.iter().copied())
        {
            self.wrong(node, |at| say::unknown_element(at, found, inside, meant));
        } else {
            let seen = self.unread.entry(found.to_owned()).or_default();
            *seen += 1;
        }
    }

    /// The children of these names, each at most once; other children count as not read.
    fn children<'a, 'i, const N: usize>(
        &mut self,
        node: Node<'a, 'i>,
        known: [&str; N],
    ) -> [Option<Node<'a, 'i>>; N] {
        let mut found = [None; N];
        for child in elements(node) {
            match known.iter().position(|name| *name == tag(child)) {
                Some(index) if found[index].is_none() => found[index] = Some(child),
                Some(index) => {
                    let (name, inside) = (known[index], tag(node));
                    self.wrong(child, |at| say::second_element(at, name, inside));
                }
                None => self.unknown(child, tag(node), &known),
            }
        }
        found
    }

    /// The attributes of an element that says how something moves: others than these are mistakes.
    fn attributes(&mut self, node: Node<'_, '_>, known: &[&str]) {
        for attribute in node.attributes() {
            let name = attribute.name();
            if !known.contains(&name) {
                let (element, offset) = (tag(node), attribute.range().start);
                self.wrong_at(offset, |at| {
                    say::unknown_attribute(at, name, element, known)
                });
            }
        }
    }

    fn name(&mut self, node: Node<'_, '_>) -> Option<String> {
        match node.attribute("name").map(str::trim) {
            Some(name) if !name.is_empty() => Some(name.to_owned()),
            _ => {
                self.wrong(node, |at| say::no_attribute(at, tag(node), "name"));
                None
            }
        }
    }

    /// The number of an attribute, if it is given.
    fn number(&mut self, node: Node<'_, '_>, name: &str) -> Option<f64> {
        let attribute = node.attribute_node(name)?;
        let [number] = self.numbers(node, &attribute)?;
        Some(number)
    }

    /// The number of an attribute that must be given.
    fn needed(&mut self, node: Node<'_, '_>, name: &str) -> Option<f64> {
        if node.attribute(name).is_none() {
            self.wrong(node, |at| say::no_attribute(at, tag(node), name));
        }
        self.number(node, name)
    }

    /// Finite numbers, apart by blanks.
    fn numbers<const N: usize>(
        &mut self,
        node: Node<'_, '_>,
        attribute: &Attribute<'_, '_>,
    ) -> Option<[f64; N]> {
        let text = attribute.value();
        let numbers = text.split_whitespace().map(|number| number.parse::<f64>());
        let numbers: Option<Vec<f64>> = numbers
            .map(|number| number.ok().filter(|number| number.is_finite()))
            .collect();
        let found = numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        if found.is_none() {
            let (element, name) = (tag(node), attribute.name());
            self.wrong_at(attribute.range().start, |at| {
                say::no_numbers(at, (element, name), text, N)
            });
        }
        // A zero has no sign.
        found.map(|numbers| numbers.map(|number| number + 0.0))
    }

    fn triple(&mut self, node: Node<'_, '_>, name: &str) -> Option<[f64; 3]> {
        let attribute = node.attribute_node(name)?;
        self.numbers(node, &attribute)
    }

    fn origin(&mut self, node: Option<Node<'_, '_>>) -> UrdfOrigin {
        let Some(node) = node else {
            return UrdfOrigin::default();
        };
        self.attributes(node, &["xyz", "rpy"]);
        UrdfOrigin {
            xyz: self.triple(node, "xyz").unwrap_or_default(),
            rpy: self.attitude(node).unwrap_or_default(),
        }
    }

    /// Roll, pitch and yaw [rad]; what turns further than any file of radians does was meant in degrees.
    fn attitude(&mut self, origin: Node<'_, '_>) -> Option<[f64; 3]> {
        let attribute = origin.attribute_node("rpy")?;
        let angles = self.numbers(origin, &attribute)?;
        let Some(angle) = in_degrees(&angles) else {
            return Some(angles);
        };
        self.wrong_at(attribute.range().start, |at| say::in_degrees(at, angle));
        None
    }

    fn link(&mut self, draft: &UrdfDraft<'_, '_>) -> UrdfLink {
        let [inertial] = self.children(draft.node, ["inertial"]);
        UrdfLink {
            name: draft.name.clone(),
            at: draft.at,
            inertial: inertial.and_then(|node| self.inertial(&draft.name, node)),
            shapes: self.shapes(draft.node),
        }
    }

    /// The simple solids of a link, which then are no longer what is left out.
    fn shapes(&mut self, link: Node<'_, '_>) -> Vec<UrdfGeometry> {
        for kind in ["visual", "collision"] {
            let drawn = elements(link).filter(|node| tag(*node) == kind);
            let shapes: Vec<UrdfGeometry> = drawn.filter_map(geometry).collect();
            if !shapes.is_empty() {
                if let Some(count) = self.unread.get_mut(kind) {
                    *count = count.saturating_sub(shapes.len());
                }
                self.unread.retain(|_, count| *count > 0);
                return shapes;
            }
        }
        Vec::new()
    }

    fn inertial(&mut self, link: &str, node: Node<'_, '_>) -> Option<Inertial> {
        const ELEMENTS: [&str; 6] = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];
        let [origin, mass, inertia] = self.children(node, ["origin", "mass", "inertia"]);
        let origin = self.origin(origin);
        for (given, name) in [(mass, "mass"), (inertia, "inertia")] {
            if given.is_none() {
                self.wrong(node, |at| say::no_element(at, "inertial", name));
            }
        }
        let (mass, inertia) = (mass?, inertia?);
        self.attributes(mass, &["value"]);
        self.attributes(inertia, &ELEMENTS);
        let kilograms = self.needed(mass, "value")?;
        if kilograms < 0.0 {
            self.wrong(mass, |at| say::negative_mass(at, link, kilograms));
        }
        let [xx, yy, zz] = ["ixx", "iyy", "izz"].map(|name| self.needed(inertia, name));
        let [xy, xz, yz] = ["ixy", "ixz", "iyz"].map(|name| match inertia.attribute(name) {
            Some(_) => self.number(inertia, name),
            None => Some(0.0),
        });
        let (xx, yy, zz, xy, xz, yz) = (xx?, yy?, zz?, xy?, xz?, yz?);
        Some(Inertial {
            origin,
            mass: kilograms,
            inertia: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            at: self.at(inertia.range().start),
        })
    }

    fn joint(
        &mut self,
        draft: &UrdfDraft<'_, '_>,
        links: &BTreeMap<&str, usize>,
        joints: &BTreeMap<&str, usize>,
    ) -> Option<UrdfJoint> {
        let node = draft.node;
        let known = [
            "origin", "parent", "child", "axis", "limit", "dynamics", "mimic",
        ];
        let [origin, parent, child, axis, limit, dynamics, mimic] = self.children(node, known);
        let kind = self.kind(draft);
        let origin = self.origin(origin);
        let [parent, child] = [(parent, "parent"), (child, "child")].map(|(end, name)| {
            let Some(end) = end else {
                self.wrong(node, |at| say::no_element(at, "joint", name));
                return None;
            };
            self.attributes(end, &["link"]);
            self.reference(end, "link", links)
        });
        let turns = matches!(
            kind,
            Some(UrdfJointKind::Hinge | UrdfJointKind::Prismatic | UrdfJointKind::Planar)
        );
        let axis = self.axis(&draft.name, axis, turns);
        let limit = self.limit(limit);
        let dynamics = self.dynamics(&draft.name, dynamics);
        let mimic = match mimic {
            // What does not move follows nothing.
            Some(node) if kind != Some(UrdfJointKind::Fixed) => {
                Some(self.mimic(draft, node, joints)?)
            }
            _ => None,
        };
        Some(UrdfJoint {
            name: draft.name.clone(),
            at: draft.at,
            kind: kind?,
            parent: parent?,
            child: child?,
            origin,
            axis: axis?,
            limit,
            dynamics: dynamics?,
            mimic,
        })
    }

    fn kind(&mut self, draft: &UrdfDraft<'_, '_>) -> Option<UrdfJointKind> {
        let node = draft.node;
        let Some(attribute) = node.attribute_node("type") else {
            self.wrong(node, |at| say::no_attribute(at, "joint", "type"));
            return None;
        };
        let word = attribute.value().trim();
        let found = UrdfJointKind::TYPES.iter().find(|(name, _)| *name == word);
        if found.is_none() {
            let name = &draft.name;
            self.wrong_at(attribute.range().start, |at| {
                let types = UrdfJointKind::TYPES.map(|(name, _)| name);
                say::joint_type(at, name, word, &types)
            });
        }
        found.map(|(_, kind)| *kind)
    }

    /// The link or joint that an attribute names.
    fn reference(
        &mut self,
        node: Node<'_, '_>,
        attribute: &str,
        known: &BTreeMap<&str, usize>,
    ) -> Option<usize> {
        let Some(given) = node.attribute_node(attribute) else {
            self.wrong(node, |at| say::no_attribute(at, tag(node), attribute));
            return None;
        };
        let name = given.value().trim();
        let found = known.get(name).copied();
        if found.is_none() {
            self.wrong_at(given.range().start, |at| {
                say::no_such(at, (tag(node), attribute), name, known.keys().copied())
            });
        }
        found
    }

    /// `<axis>`; without one x. Some writers give a zero where none is `needed`.
    fn axis(&mut self, joint: &str, node: Option<Node<'_, '_>>, needed: bool) -> Option<[f64; 3]> {
        let Some(node) = node else {
            return Some([1.0, 0.0, 0.0]);
        };
        self.attributes(node, &["xyz"]);
        if node.attribute("xyz").is_none() {
            self.wrong(node, |at| say::no_attribute(at, "axis", "xyz"));
        }
        let axis = self.triple(node, "xyz")?;
        if needed && axis.iter().all(|component| *component == 0.0) {
            self.wrong(node, |at| say::zero_axis(at, joint));
            return None;
        }
        Some(axis)
    }

    fn limit(&mut self, node: Option<Node<'_, '_>>) -> UrdfLimit {
        let Some(node) = node else {
            return UrdfLimit::default();
        };
        let [lower, upper, effort, velocity] =
            ["lower", "upper", "effort", "velocity"].map(|name| self.number(node, name));
        // An end that is not said is zero.
        let said = lower.is_some() || upper.is_some();
        UrdfLimit {
            range: said.then(|| [lower.unwrap_or(0.0), upper.unwrap_or(0.0)]),
            effort,
            velocity,
        }
    }

    fn dynamics(&mut self, joint: &str, node: Option<Node<'_, '_>>) -> Option<[f64; 2]> {
        let Some(node) = node else {
            return Some([0.0; 2]);
        };
        let [damping, friction] = ["damping", "friction"].map(|name| {
            if node.attribute(name).is_none() {
                return Some(0.0);
            }
            let number = self.number(node, name)?;
            if number < 0.0 {
                self.wrong(node, |at| say::negative(at, joint, name, number));
                return None;
            }
            Some(number)
        });
        Some([damping?, friction?])
    }

    fn mimic(
        &mut self,
        draft: &UrdfDraft<'_, '_>,
        node: Node<'_, '_>,
        joints: &BTreeMap<&str, usize>,
    ) -> Option<Mimic> {
        self.attributes(node, &["joint", "multiplier", "offset"]);
        let joint = self.reference(node, "joint", joints);
        let [multiplier, offset] = [("multiplier", 1.0), ("offset", 0.0)].map(|(name, usual)| {
            match node.attribute(name) {
                Some(_) => self.number(node, name),
                None => Some(usual),
            }
        });
        if joints.get(draft.name.as_str()).copied() == joint && joint.is_some() {
            self.wrong(node, |at| say::mimics_itself(at, &draft.name));
            return None;
        }
        Some(Mimic {
            joint: joint?,
            multiplier: multiplier?,
            offset: offset?,
            at: self.at(node.range().start),
        })
    }
}

fn numbered<'d>(drafts: &'d [UrdfDraft<'_, '_>]) -> BTreeMap<&'d str, usize> {
    let names = drafts.iter().map(|draft| draft.name.as_str());
    names
        .enumerate()
        .map(|(index, name)| (name, index))
        .collect()
}

/// The solid of a `<visual>` or a `<collision>`; `None` of a mesh, and of what is not written as the format has it: pictures stop no run.
fn geometry(node: Node<'_, '_>) -> Option<UrdfGeometry> {
    let inside = |name: &str| elements(node).find(|child| tag(*child) == name);
    let shape = elements(inside("geometry")?).next()?;
    let solid = Solid::ALL
        .into_iter()
        .find(|solid| solid.keyword() == tag(shape))?;
    let sizes: Vec<f64> = match solid {
        Solid::Box => list(shape, "size")?,
        _ => {
            let sizes = solid.sizes().iter();
            let sizes = sizes.map(|name| list(shape, name)?.first().copied());
            sizes.collect::<Option<_>>()?
        }
    };
    let fits = sizes.len() == solid.sizes().len() && sizes.iter().all(|size| *size > 0.0);
    let place = |name: &str| match inside("origin") {
        Some(origin) if origin.has_attribute(name) => list(origin, name)?.try_into().ok(),
        _ => Some([0.0; 3]),
    };
    let origin = UrdfOrigin {
        xyz: place("xyz")?,
        rpy: place("rpy")?,
    };
    let fits = fits && in_degrees(&origin.rpy).is_none();
    fits.then_some(UrdfGeometry {
        solid,
        sizes,
        origin,
    })
}

/// The largest angle of a file [rad]: two turns.
const LARGEST_ANGLE: f64 = 4.0 * std::f64::consts::PI;

/// The first of these angles that no file of radians has.
fn in_degrees(angles: &[f64]) -> Option<f64> {
    let mut angles = angles.iter().copied();
    angles.find(|angle| angle.abs() > LARGEST_ANGLE)
}

/// Finite numbers of an attribute.
fn list(node: Node<'_, '_>, name: &str) -> Option<Vec<f64>> {
    let numbers = node.attribute(name)?.split_whitespace();
    numbers
        .map(|number| number.parse().ok().filter(|x: &f64| x.is_finite()))
        .collect()
}
