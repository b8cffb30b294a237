//! Shapes of bodies, and mass, centre of mass and inertia where these follow from them.

use std::ops::{Add, Div, Mul, Sub};

use mbd_scene::solids::{Heaviness, Lump, PlacedSolid, Shape, Solid};
use mbd_scene::{Formula, Function, Inertia, Scene, Triple};

use super::bodies::RotationRows;
use super::fields::Accept;
use super::{Instance, MayDependOn, Resolver, Scope, fold};
use crate::lexeme::{Bracket, LexemeKind};
use crate::messages::resolve as say;
use crate::syntax::expression::{self, Expression};
use crate::syntax::{Cursor, Item, ValueSyntax};
use crate::units;

/// A field of a body that was understood.
pub fn field<'i, 'a>(instance: &Instance<'i>, word: &str) -> Option<&'i Item<'a>>
where
    'a: 'i,
    'i: 'a,
{
    let mut fields = instance.item.block.iter();
    fields.find(|field| field.word.text == word && !field.broken)
}

impl Resolver<'_> {
    /// Fills the shapes of a body, measured from its declared origin. Without a declared inertia they give mass and inertia, and their centre of mass
    /// is handed back.
    pub fn shapes(&mut self, instance: &Instance<'_>) -> Option<Triple> {
        let value = field(instance, "shape")?.clause(":")?;
        let name = self.scene.bodies.get(instance.slot)?.name.clone();
        let scope = instance.scope(MayDependOn::Fixed);
        let first = self.scene.shapes.len();
        for part in parts(value) {
            let shape = self.shape((instance.slot, &name), part, scope)?;
            self.scene.shapes.push(shape);
        }
        if field(instance, "inertia").is_some() {
            return None;
        }
        if let Some(center) = field(instance, "center_of_mass") {
            let at = center.word.at.into();
            return self.fail(say::center_of_shapes(at, &name));
        }
        let density = field(instance, "density").and_then(|field| field.clause(":"));
        let heaviness = match density {
            Some(value) => {
                let (wanted, accept) = (units::DENSITY, Accept::Positive);
                let density = self.quantity(&name, "density", value, wanted, accept, scope)?;
                Heaviness::Density(FormulaNumber::of(&density, &self.scene))
            }
            None => {
                let mass = &self.scene.bodies.get(instance.slot)?.mass;
                Heaviness::Mass(FormulaNumber::of(mass, &self.scene))
            }
        };
        let solids: Vec<PlacedSolid<FormulaNumber>> = (self.scene.shapes.iter().skip(first))
            .map(|shape| placed(shape, &self.scene))
            .collect();
        let Some(lump) = Lump::of(&solids, heaviness) else {
            return self.fail(say::shape_form(value.at, None));
        };
        let [xx, yy, zz, xy, xz, yz] = lump.inertia.map(|element| element.0);
        let body = self.scene.bodies.get_mut(instance.slot)?;
        if density.is_some() {
            body.mass = lump.mass.0;
        }
        body.inertia = Inertia {
            xx,
            yy,
            zz,
            xy,
            xz,
            yz,
        };
        Some(lump.center.map(|part| part.0))
    }

    /// `box [a, b, c] m at frame`, `cylinder { radius: 0.1 m, length: 1 m } at [0.0, 0.0, 0.5] m rotated rpy(0.0, 90 deg, 0.0)`.
    fn shape(
        &mut self,
        (body, name): (usize, &str),
        value: ValueSyntax<'_>,
        scope: Scope<'_>,
    ) -> Option<Shape> {
        let mut cursor = Cursor::new(value);
        let word = cursor.word();
        let found = word.as_ref().map(|word| word.text.as_str());
        let solid = Solid::ALL
            .into_iter()
            .find(|solid| Some(solid.keyword()) == found);
        let Some(solid) = solid else {
            return self.fail(say::shape_form(value.at, found));
        };
        let start = cursor;
        until(&mut cursor, &["at", "rotated"]);
        let sizes = self.sizes((solid, name), cursor.since(start), scope)?;
        let mut place = (
            [0, 1, 2].map(|_| Formula::Number(0.0)),
            None::<RotationRows>,
        );
        if cursor.keyword("at").is_some() {
            let start = cursor;
            until(&mut cursor, &["rotated"]);
            place = self.shape_place(body, cursor.since(start), scope)?;
        }
        if cursor.keyword("rotated").is_some() {
            let start = cursor;
            until(&mut cursor, &[]);
            let value = cursor.since(start);
            let rotation = self.rotation(value, scope)?;
            place.1 = match (place.1, rotation) {
                (Some(frame), Some(own)) => Some(self.times(&frame, &own, value.at)?),
                (frame, own) => frame.or(own),
            };
        }
        let (position, rotation) = place;
        Some(Shape {
            body,
            solid,
            sizes,
            position,
            rotation,
        })
    }

    /// The sizes of a solid: of a box a vector, of others named.
    fn sizes(
        &mut self,
        (solid, name): (Solid, &str),
        value: ValueSyntax<'_>,
        scope: Scope<'_>,
    ) -> Option<Vec<Formula>> {
        if solid == Solid::Box {
            // `box(1 m, 2 m, 3 m)` is a call of other tools.
            let called = Cursor::new(value).group(Bracket::Round);
            if value.lexemes.is_empty()
                || called.is_some_and(|group| Cursor::new(group).comma_separated().len() > 1)
            {
                return self.fail(say::shape_sizes(value.at, solid));
            }
            let edges = self.triple(solid.keyword(), value, units::LENGTH, scope)?;
            for (edge, axis) in edges.iter().zip(["x", "y", "z"]) {
                let length = fold::at_defaults(edge, &self.scene);
                if let Some(length) = length.filter(|length| length.is_nan() || *length <= 0.0) {
                    return self.fail(say::no_edge(value.at, name, axis, length));
                }
            }
            return Some(edges.to_vec());
        }
        let mut cursor = Cursor::new(value);
        let group = cursor.group(Bracket::Brace).filter(|_| cursor.at_end());
        let Some(group) = group else {
            return self.fail(say::shape_sizes(value.at, solid));
        };
        let block = self.block(group);
        let fields = self.fields(&block, solid.sizes());
        let mut sizes = Vec::new();
        for word in solid.sizes() {
            let (wanted, accept) = (units::LENGTH, Accept::Positive);
            sizes.push(match fields.value(word) {
                Some(value) => self.quantity(name, word, value, wanted, accept, scope),
                None if fields.doubtful => None,
                None => self.fail(say::missing_size(value.at, solid, word)),
            });
        }
        let sizes: Vec<Formula> = sizes.into_iter().collect::<Option<_>>()?;
        if let (Solid::Tube, [outer, inner, _]) = (solid, sizes.as_slice()) {
            let [outer, inner] =
                [outer, inner].map(|radius| fold::at_defaults(radius, &self.scene));
            if outer
                .zip(inner)
                .is_some_and(|(outer, inner)| inner >= outer)
            {
                return self.fail(say::tube_without_wall(value.at, name));
            }
        }
        Some(sizes)
    }

    /// A frame of the body, or a place from its origin.
    fn shape_place(
        &mut self,
        body: usize,
        value: ValueSyntax<'_>,
        scope: Scope<'_>,
    ) -> Option<(Triple, Option<RotationRows>)> {
        if let Ok(Expression::Path(steps)) = expression::whole(value)
            && let [step] = steps.as_slice()
            && !self.is_vector(step.word.text.as_str())
        {
            let frame = self.body_frame(body, step, scope)?;
            let frame = self.scene.bodies.get(body)?.frames.get(frame)?;
            return Some((frame.position.clone(), frame.rotation.clone()));
        }
        let position = self.triple("at", value, units::LENGTH, scope)?;
        Some((position, None))
    }

    /// Whether a word names a vector that is known before a run.
    fn is_vector(&self, word: &str) -> bool {
        let consts = self.scene.consts.iter();
        let mut vectors = consts.filter(|constant| constant.value.vector().is_some());
        vectors.any(|constant| constant.name == word)
    }
}

/// The shapes of a field: those in brackets, or one.
fn parts(value: ValueSyntax<'_>) -> Vec<ValueSyntax<'_>> {
    let mut cursor = Cursor::new(value);
    match cursor.group(Bracket::Square) {
        Some(group) if cursor.at_end() => Cursor::new(group).comma_separated(),
        _ => vec![value],
    }
}

/// Goes on to one of these words, or to the end.
fn until(cursor: &mut Cursor<'_>, words: &[&str]) {
    while let Some(lexeme) = cursor.peek() {
        if matches!(&lexeme.kind, LexemeKind::Word(word) if words.contains(&word.as_str())) {
            return;
        }
        cursor.take_tree();
    }
}

/// A shape in the numbers of the laws of solids.
fn placed(shape: &Shape, scene: &Scene) -> PlacedSolid<FormulaNumber> {
    let terms = |triple: &Triple| triple.each_ref().map(|part| FormulaNumber::of(part, scene));
    PlacedSolid {
        solid: shape.solid,
        sizes: shape
            .sizes
            .iter()
            .map(|size| FormulaNumber::of(size, scene))
            .collect(),
        position: terms(&shape.position),
        rotation: shape
            .rotation
            .as_ref()
            .map(|rows| rows.each_ref().map(terms)),
    }
}

/// A formula as a number of the laws of solids: what is known is computed at once, zeros and ones leave no trace.
#[derive(Clone, Debug)]
struct FormulaNumber(Formula);

impl FormulaNumber {
    fn of(formula: &Formula, scene: &Scene) -> Self {
        let known = fold::known(formula, scene, false);
        let known = known.and_then(mbd_scene::Fixed::scalar);
        FormulaNumber(known.map_or_else(|| formula.clone(), Formula::Number))
    }

    fn number(&self) -> Option<f64> {
        match self.0 {
            Formula::Number(number) => Some(number),
            _ => None,
        }
    }

    fn apply(self, function: Function, other: FormulaNumber, known: fn(f64, f64) -> f64) -> Self {
        match (self.number(), other.number()) {
            (Some(a), Some(b)) => FormulaNumber(Formula::Number(known(a, b))),
            _ => FormulaNumber(Formula::Apply(function, vec![self.0, other.0])),
        }
    }

    fn is(&self, number: f64) -> bool {
        self.number() == Some(number)
    }
}

impl From<f64> for FormulaNumber {
    fn from(number: f64) -> Self {
        FormulaNumber(Formula::Number(number))
    }
}

impl Add for FormulaNumber {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        match (self.is(0.0), other.is(0.0)) {
            (true, _) => other,
            (_, true) => self,
            _ => self.apply(Function::Add, other, |a, b| a + b),
        }
    }
}

impl Sub for FormulaNumber {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        match other.is(0.0) {
            true => self,
            false => self.apply(Function::Sub, other, |a, b| a - b),
        }
    }
}

impl Mul for FormulaNumber {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self.is(0.0) || other.is(0.0) {
            return FormulaNumber::from(0.0);
        }
        match (self.is(1.0), other.is(1.0)) {
            (true, _) => other,
            (_, true) => self,
            _ => self.apply(Function::Mul, other, |a, b| a * b),
        }
    }
}

impl Div for FormulaNumber {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        match self.is(0.0) || other.is(1.0) {
            true => self,
            false => self.apply(Function::Div, other, |a, b| a / b),
        }
    }
}
