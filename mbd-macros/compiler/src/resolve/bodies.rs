//! Bodies, their inertia and their frames; frames of the world.

use mbd_scene::{Axis, Formula, Function, Inertia, Unit};

use super::fields::Accept;
use super::{Instance, MayDependOn, Named, Resolver, Scope, fold};
use crate::lexeme::{Bracket, Lexeme, LexemeKind, Region};
use crate::messages::resolve as say;
use crate::syntax::expression::{self, Expression};
use crate::syntax::{Cursor, ValueSyntax, unit, words};
use crate::units;

/// Instants at which a rotation that depends on time is looked at [s].
const INSTANTS: [f64; 3] = [0.0, 0.37, 2.9];

/// The rows of a rotation matrix.
pub type RotationRows = [[Formula; 3]; 3];

impl Resolver<'_> {
    /// Fills the frames of the world.
    pub fn world_frames(&mut self) {
        for instance in self.of("world") {
            let known = words::find("world", false).and_then(|spec| spec.fields);
            self.fields(&instance.item.block, known.unwrap_or(&[]));
        }
        for instance in self.of("world frame") {
            let named = Named::WorldFrame(instance.slot);
            self.poison(named, |this| {
                let (position, rotation) = this.frame(&instance, MayDependOn::Course)?;
                let frame = this.scene.world_frames.get_mut(instance.slot)?;
                frame.position = position;
                frame.rotation = rotation;
                Some(())
            });
        }
    }

    /// Fills the bodies.
    pub fn bodies(&mut self) {
        for instance in self.of("body") {
            self.body(&instance);
        }
        for instance in self.of("frame") {
            let (body, frame) = (instance.owner, instance.slot);
            self.poison(Named::Frame(body, frame), |this| {
                let (position, rotation) = this.frame(&instance, MayDependOn::Fixed)?;
                let entry = this.scene.bodies.get_mut(body)?.frames.get_mut(frame)?;
                entry.position = position;
                entry.rotation = rotation;
                Some(())
            });
        }
        for instance in self.of("body") {
            self.center(&instance);
        }
    }

    fn body(&mut self, instance: &Instance<'_>) {
        let Some(name) = self.scene.bodies.get(instance.slot).map(|b| b.name.clone()) else {
            return;
        };
        let known = words::find("body", false)
            .and_then(|spec| spec.fields)
            .unwrap_or(&[]);
        let fields = self.fields(&instance.item.block, known);
        let doubtful = fields.doubtful || instance.item.broken;
        let scope = instance.scope(MayDependOn::Fixed);
        let at = instance.item.name_at();
        let even = fields.get("shape").is_some() && fields.get("inertia").is_none();
        if let (Some(density), true) = (fields.get("density"), fields.get("mass").is_some()) {
            let at = density.word.at.into();
            self.messages.push(say::mass_and_density(at, &name));
        }
        match fields.value("inertia") {
            Some(value) => {
                let read = self.inertia(&name, value, scope);
                if let (Some((inertia, unchecked)), Some(body)) =
                    (read, self.scene.bodies.get_mut(instance.slot))
                {
                    body.inertia = inertia;
                    self.scene
                        .unchecked
                        .extend(unchecked.then_some(instance.slot));
                }
            }
            None if !doubtful && !even => self.messages.push(say::no_inertia(at, &name)),
            None => {}
        }
        match fields.value("mass") {
            Some(value) => {
                // Of a body whose inertia is taken as it stands, what it carries may have all of it.
                let accept = match self.scene.unchecked.contains(&instance.slot) {
                    true => Accept::NotNegative,
                    false => Accept::Positive,
                };
                let mass = self.quantity(&name, "mass", value, units::MASS, accept, scope);
                if let (Some(mass), Some(body)) = (mass, self.scene.bodies.get_mut(instance.slot)) {
                    body.mass = mass;
                }
            }
            None => match fields.get("density") {
                Some(_) if even => {}
                Some(density) if !doubtful => {
                    let at = density.word.at.into();
                    self.messages.push(say::density_alone(at, &name));
                }
                None if !doubtful => self.messages.push(say::no_mass(at, &name)),
                _ => {}
            },
        }
    }

    /// With `center_of_mass` declared, or found from shapes, frames and shapes are measured from the declared origin: shift them.
    fn center(&mut self, instance: &Instance<'_>) {
        let found = self.shapes(instance);
        let declared = super::shapes::field(instance, "center_of_mass");
        let (center, at) = match (declared.and_then(|field| field.clause(":")), found) {
            (Some(value), _) => {
                let scope = instance.scope(MayDependOn::Fixed);
                let center = self.triple("center_of_mass", value, units::LENGTH, scope);
                (center, value.at)
            }
            (None, found) => (found, instance.item.name_at()),
        };
        let Some(center) = center else {
            return;
        };
        if center.iter().all(|part| *part == Formula::Number(0.0)) {
            return;
        }
        let Some(body) = self.scene.bodies.get(instance.slot) else {
            return;
        };
        let mut frames = body.frames.clone();
        let mut shapes = self.scene.shapes.clone();
        let own = shapes
            .iter_mut()
            .filter(|shape| shape.body == instance.slot);
        let places = frames.iter_mut().skip(1).map(|frame| &mut frame.position);
        for place in places.chain(own.map(|shape| &mut shape.position)) {
            for (part, offset) in place.iter_mut().zip(&center) {
                let arguments = vec![part.clone(), offset.clone()];
                match self.apply(Function::Sub, arguments, at) {
                    Some(shifted) => *part = shifted,
                    None => return,
                }
            }
        }
        self.scene.shapes = shapes;
        if let Some(body) = self.scene.bodies.get_mut(instance.slot) {
            body.frames = frames;
        }
    }

    /// Position and rotation of a frame: known before a run, or functions of time.
    fn frame(
        &mut self,
        instance: &Instance<'_>,
        stage: MayDependOn,
    ) -> Option<([Formula; 3], Option<RotationRows>)> {
        let scope = instance.scope(stage);
        let position = match instance.item.clause("at") {
            None if instance.item.broken => return None,
            // Only rotated.
            None => Some([0.0; 3].map(Formula::Number)),
            Some(at) => self
                .triple("at", at, units::LENGTH, scope)
                .and_then(|parts| {
                    self.two_derivatives(&parts, at.at, true)?;
                    Some(parts)
                }),
        };
        let rotation = match instance.item.clause("rotated") {
            Some(value) => self.rotation(value, scope)?,
            None => None,
        };
        Some((position?, rotation))
    }

    /// `rpy(roll, pitch, yaw)` about fixed axes x, y, z: R = Rz Ry Rx; `euler_zyx(yaw, pitch, roll)` about moving axes is the same R;
    /// `about(axis, angle)` about one axis; `matrix([…], […], […])` gives the rows.
    pub fn rotation(
        &mut self,
        value: ValueSyntax<'_>,
        scope: Scope<'_>,
    ) -> Option<Option<RotationRows>> {
        // `about z by 30 deg`, `30 deg about z`, `rpy [0, 30, 0] deg`
        let mut words = value.lexemes.iter();
        let is_about = words.any(|lexeme| lexeme.kind == LexemeKind::Word(words::ABOUT.into()));
        let mut cursor = Cursor::new(value);
        let in_brackets = cursor.word().is_some() && cursor.group(Bracket::Square).is_some();
        let parsed = match expression::whole(value) {
            Ok(parsed) => parsed,
            Err(_) if is_about || in_brackets => {
                return self.fail(say::rotation_form(value.at));
            }
            Err(report) => return self.fail(report),
        };
        let Expression::Call {
            name, arguments, ..
        } = &parsed
        else {
            return self.fail(say::rotation_form(value.at));
        };
        let rows = match (name.text.as_str(), arguments.as_slice()) {
            (word @ ("rpy" | "euler_zyx"), [_, _, _]) => {
                let mut angles = Vec::new();
                for argument in arguments {
                    angles.push(self.angle_of_rotation(word, argument, scope));
                }
                let mut angles: Vec<Formula> = angles.into_iter().collect::<Option<_>>()?;
                if word == "euler_zyx" {
                    angles.reverse();
                }
                let [roll, pitch, yaw]: [Formula; 3] = angles.try_into().ok()?;
                self.rotated(roll, pitch, yaw, value.at)?
            }
            (words::ABOUT, [axis, angle]) => {
                let angle = self.angle_of_rotation(words::ABOUT, angle, scope);
                let axis = self.axis_of_rotation(axis, scope)?;
                self.rotated_about(axis, angle?, value.at)?
            }
            ("matrix", [_, _, _]) => {
                let mut rows = Vec::new();
                for argument in arguments {
                    let typed = self.typed(argument, scope)?;
                    let row = self.fits(typed, "matrix", true, units::NONE)?;
                    rows.push(fold::components(row, &self.scene));
                }
                rows.try_into().ok()?
            }
            _ => return self.fail(say::rotation_form(value.at)),
        };
        self.checked_rotation(rows, value.at)
    }

    /// An angle of a rotation that is written as `word(…)`.
    fn angle_of_rotation(
        &mut self,
        word: &str,
        argument: &Expression,
        scope: Scope<'_>,
    ) -> Option<Formula> {
        let typed = self.typed(argument, scope)?;
        self.in_radians(&typed, &format!("`{word}`"))?;
        let known = fold::at_defaults(&typed.formula, &self.scene);
        if let Some(angle) = known.filter(|angle| angle.abs() > std::f64::consts::TAU) {
            self.warnings
                .push(say::attitude_has_no_turns(typed.at, angle));
        }
        self.fits(typed, word, false, units::NONE)
    }

    /// The axis of `about(axis, angle)`: `x`, `y`, `z`, with a sign or without, or a vector of numbers and consts.
    fn axis_of_rotation(&mut self, argument: &Expression, scope: Scope<'_>) -> Option<Axis> {
        let at = argument.at();
        let (unsigned, sign) = match argument {
            Expression::Negative(of, _) => (&**of, -1.0),
            other => (other, 1.0),
        };
        if let Expression::Path(steps) = unsigned
            && let [step] = steps.as_slice()
            && let Some(axis) = ["x", "y", "z"]
                .iter()
                .position(|letter| *letter == step.word.text)
        {
            let mut direction = [0.0; 3];
            direction[axis] = sign;
            return Axis::new(direction);
        }
        let constant = Scope {
            stage: MayDependOn::Constant,
            ..scope
        };
        let typed = self.typed(argument, constant)?;
        if !typed.vector {
            return self.fail(say::rotation_form(at));
        }
        self.axis_of_vector(typed, words::ABOUT)
    }

    /// R = a aᵀ + cos (1 − a aᵀ) + sin [a]×. Source: Rodrigues.
    fn rotated_about(&mut self, axis: Axis, angle: Formula, at: Region) -> Option<RotationRows> {
        let Axis(a) = axis;
        let sine = self.apply(Function::Sin, vec![angle.clone()], at)?;
        let cosine = self.apply(Function::Cos, vec![angle], at)?;
        let zeros = || [0.0; 3].map(Formula::Number);
        let mut rows = [zeros(), zeros(), zeros()];
        for (i, row) in rows.iter_mut().enumerate() {
            for (j, slot) in row.iter_mut().enumerate() {
                let both = a[i] * a[j];
                let (rest, across) = match (3 + j - i) % 3 {
                    0 => (1.0 - both, 0.0),
                    // [a]× has −a_k right of the diagonal, in the order x, y, z, x.
                    1 => (-both, -a[3 - i - j]),
                    _ => (-both, a[3 - i - j]),
                };
                let by_cosine = self.plain_product(&Formula::Number(rest), &cosine, at)?;
                let by_sine = self.plain_product(&Formula::Number(across), &sine, at)?;
                let sum = self.plain_sum(Formula::Number(both), by_cosine, at)?;
                *slot = self.plain_sum(sum, by_sine, at)?;
            }
        }
        Some(rows)
    }

    /// R = Rz(yaw) Ry(pitch) Rx(roll).
    fn rotated(
        &mut self,
        roll: Formula,
        pitch: Formula,
        yaw: Formula,
        at: Region,
    ) -> Option<RotationRows> {
        let mut sin_cos = |angle: Formula| {
            let sine = self.apply(Function::Sin, vec![angle.clone()], at)?;
            let cosine = self.apply(Function::Cos, vec![angle], at)?;
            Some((sine, cosine))
        };
        let ((sr, cr), (sp, cp), (sy, cy)) = (sin_cos(roll)?, sin_cos(pitch)?, sin_cos(yaw)?);
        let zero = || Formula::Number(0.0);
        let one = || Formula::Number(1.0);
        let x = [
            [one(), zero(), zero()],
            [zero(), cr.clone(), negative(&sr)],
            [zero(), sr, cr],
        ];
        let y = [
            [cp.clone(), zero(), sp.clone()],
            [zero(), one(), zero()],
            [negative(&sp), zero(), cp],
        ];
        let z = [
            [cy.clone(), negative(&sy), zero()],
            [sy, cy, zero()],
            [zero(), zero(), one()],
        ];
        let zy = self.times(&z, &y, at)?;
        self.times(&zy, &x, at)
    }

    /// The product of two matrices; factors 0 and 1 leave no trace.
    pub fn times(
        &mut self,
        a: &RotationRows,
        b: &RotationRows,
        at: Region,
    ) -> Option<RotationRows> {
        let mut product = Vec::with_capacity(3);
        for row in a {
            let mut line = Vec::with_capacity(3);
            for column in 0..3 {
                let mut sum = Formula::Number(0.0);
                for (left, below) in row.iter().zip(b) {
                    let term = self.plain_product(left, &below[column], at)?;
                    sum = self.plain_sum(sum, term, at)?;
                }
                line.push(sum);
            }
            product.push(<[Formula; 3]>::try_from(line).ok()?);
        }
        product.try_into().ok()
    }

    fn plain_product(&mut self, a: &Formula, b: &Formula, at: Region) -> Option<Formula> {
        let (zero, one) = (Formula::Number(0.0), Formula::Number(1.0));
        if *a == zero || *b == zero {
            Some(zero)
        } else if *a == one {
            Some(b.clone())
        } else if *b == one {
            Some(a.clone())
        } else if *a == Formula::Number(-1.0) {
            Some(negative(b))
        } else {
            self.apply(Function::Mul, vec![a.clone(), b.clone()], at)
        }
    }

    fn plain_sum(&mut self, a: Formula, b: Formula, at: Region) -> Option<Formula> {
        let zero = Formula::Number(0.0);
        if a == zero {
            Some(b)
        } else if b == zero {
            Some(a)
        } else {
            self.apply(Function::Add, vec![a, b], at)
        }
    }

    /// Formulas of time that must have a velocity and an acceleration, of a frame or of a motor.
    pub fn two_derivatives(
        &mut self,
        formulas: &[Formula],
        at: Region,
        of_frame: bool,
    ) -> Option<()> {
        let timed = |part: &Formula| *part == Formula::Time;
        let mut table = None;
        for formula in formulas {
            let scene = &self.scene;
            scene.walk(formula, &mut |part| {
                if let Formula::Lookup(index, argument) = part
                    && argument.iter().any(|of| scene.contains(of, timed))
                {
                    table = Some(*index);
                }
            });
        }
        match table.and_then(|index| self.scene.tables.get(index)) {
            Some(table) => {
                let report = say::table_of_time(at, &table.name, table.smooth, of_frame);
                self.fail(report)
            }
            None => Some(()),
        }
    }

    /// A rotation that is no rotation is an error; one that turns nothing is `None`.
    fn checked_rotation(&mut self, rows: RotationRows, at: Region) -> Option<Option<RotationRows>> {
        for time in INSTANTS {
            let known: Vec<f64> = rows
                .iter()
                .flatten()
                .filter_map(|part| fold::at_time(part, &self.scene, time))
                .collect();
            let [a, b, c, d, e, f, g, h, i] = known[..] else {
                break;
            };
            let r = nalgebra::Matrix3::new(a, b, c, d, e, f, g, h, i);
            let error = (r.transpose() * r - nalgebra::Matrix3::identity()).norm();
            if error.is_nan() || error > 1e-9 || r.determinant() < 0.0 {
                return self.fail(say::no_rotation(at));
            }
        }
        self.two_derivatives(rows.as_flattened(), at, true)?;
        let number = |i: usize, j: usize| Formula::Number(if i == j { 1.0 } else { 0.0 });
        let identity: RotationRows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| number(i, j)));
        Some((rows != identity).then_some(rows))
    }

    /// `diag(…) unit`, also `[…] unit`, in a plane one number, or `full { … } unit (matrix elements)` with the unit before or behind the brackets; `(unchecked)` behind it lets through moments that no rigid body has;
    /// those that are not positive are looked at where the coordinates are known. Hands back whether that was said, too.
    fn inertia(
        &mut self,
        owner: &str,
        value: ValueSyntax<'_>,
        scope: Scope<'_>,
    ) -> Option<(Inertia, bool)> {
        let mut cursor = Cursor::new(value);
        let form = cursor.word();
        let inertia = match form.as_ref().map(|word| word.text.as_str()) {
            Some("diag") => self.diagonal(&mut cursor, Bracket::Round, value.at, scope)?,
            None if begins_list(&cursor) => {
                self.diagonal(&mut cursor, Bracket::Square, value.at, scope)?
            }
            Some("full") => self.full(&mut cursor, value.at, scope)?,
            // In a plane one moment acts, that about its normal; the others are no smaller than half of it, and as good as any.
            other
                if self.scene.planar.is_some()
                    && other.is_none_or(|word| self.names.is(word, Named::is_value)) =>
            {
                let (moment, rest) = split_unchecked(value);
                let moment = self.element("inertia", moment, None, scope)?;
                cursor = Cursor::new(rest);
                diagonal_of([moment.clone(), moment.clone(), moment])
            }
            other => {
                let shape = other.and_then(|shape| say::inertia_of_shape(value.at, shape));
                return self.fail(shape.unwrap_or_else(|| say::inertia_form(value.at)));
            }
        };
        let unchecked = unchecked(&mut cursor);
        if let Err(report) = cursor.finish("the end of the inertia") {
            return self.fail(report);
        }
        match crate::check::inertia(&inertia, &self.scene) {
            Ok(()) => Some((inertia, unchecked)),
            Err(_) if unchecked => Some((inertia, true)),
            Err(wrong) => self.fail(say::impossible_inertia(value.at, owner, wrong)),
        }
    }

    fn diagonal(
        &mut self,
        cursor: &mut Cursor<'_>,
        bracket: Bracket,
        at: Region,
        scope: Scope<'_>,
    ) -> Option<Inertia> {
        let Some(group) = cursor.group(bracket) else {
            return self.fail(say::inertia_form(at));
        };
        let parts = Cursor::new(group).comma_separated();
        if parts.len() != 3 {
            return self.fail(say::inertia_form(group.at));
        }
        let unit = self.trailing_unit(cursor)?;
        let mut moments = Vec::new();
        for part in parts {
            // The first mistake is told alone: mostly it is that of the unit of all three.
            moments.push(self.element("inertia", part, unit.as_ref(), scope)?);
        }
        moments.try_into().ok().map(diagonal_of)
    }

    fn full(&mut self, cursor: &mut Cursor<'_>, at: Region, scope: Scope<'_>) -> Option<Inertia> {
        const ELEMENTS: &[&str] = &["xx", "yy", "zz", "xy", "xz", "yz"];
        let Some(group) = cursor.group(Bracket::Brace) else {
            return self.fail(say::inertia_form(at));
        };
        let block = self.block(group);
        let fields = self.fields(&block, ELEMENTS);
        let unit = self.trailing_unit(cursor)?;
        let products = self.sign_of_products(cursor, at)?;
        let unit = match unit {
            Some(unit) => Some(unit),
            None => self.trailing_unit(cursor)?,
        };
        let mut elements = Vec::new();
        for (k, word) in ELEMENTS.iter().enumerate() {
            let element = match fields.value(word) {
                Some(value) => self.element(word, value, unit.as_ref(), scope),
                None if k >= 3 => Some(Formula::Number(0.0)),
                None if fields.doubtful => None,
                None => self.fail(say::missing_element(at, word)),
            };
            elements.push(match element {
                Some(element) if k >= 3 && products => self.apply(Function::Neg, vec![element], at),
                element => element,
            });
        }
        let elements: Vec<Formula> = elements.into_iter().collect::<Option<_>>()?;
        let [xx, yy, zz, xy, xz, yz]: [Formula; 6] = elements.try_into().ok()?;
        Some(Inertia {
            xx,
            yy,
            zz,
            xy,
            xz,
            yz,
        })
    }

    /// `(matrix elements)` is false, `(products of inertia)` true.
    fn sign_of_products(&mut self, cursor: &mut Cursor<'_>, at: Region) -> Option<bool> {
        let words: Option<Vec<String>> = cursor.group(Bracket::Round).map(|group| {
            let word = |lexeme: &'_ Lexeme| match &lexeme.kind {
                LexemeKind::Word(word) => word.clone(),
                _ => String::new(),
            };
            group.lexemes.iter().map(word).collect()
        });
        let words = words.map(|words| words.join(" "));
        match words.as_deref() {
            Some("matrix elements") => Some(false),
            Some("products of inertia") => Some(true),
            _ => self.fail(say::products_sign(at)),
        }
    }

    fn trailing_unit(&mut self, cursor: &mut Cursor<'_>) -> Option<Option<Unit>> {
        let here = cursor.here();
        match unit::suffix_alone(cursor) {
            Ok(Some(unit)) if unit.dimension != units::INERTIA => {
                let report = say::wrong_dimension(here, "inertia", units::INERTIA, unit.dimension);
                self.fail(report)
            }
            Ok(unit) => Some(unit),
            Err(report) => self.fail(report),
        }
    }

    /// One element of an inertia, with the unit behind the bracket if there is one.
    fn element(
        &mut self,
        field: &str,
        value: ValueSyntax<'_>,
        unit: Option<&Unit>,
        scope: Scope<'_>,
    ) -> Option<Formula> {
        let typed = self.value(value, scope)?;
        let typed = self.in_brackets(typed, unit)?;
        self.fits(typed, field, false, units::INERTIA)
    }
}

/// An inertia without products.
fn diagonal_of([xx, yy, zz]: [Formula; 3]) -> Inertia {
    let zero = || Formula::Number(0.0);
    Inertia {
        xx,
        yy,
        zz,
        xy: zero(),
        xz: zero(),
        yz: zero(),
    }
}

/// Whether a square bracket comes next.
fn begins_list(cursor: &Cursor<'_>) -> bool {
    let next = cursor.peek().map(|lexeme| &lexeme.kind);
    matches!(next, Some(LexemeKind::Open(Bracket::Square, _)))
}

/// A moment, and `(unchecked)` behind it, if that stands there.
fn split_unchecked(value: ValueSyntax<'_>) -> (ValueSyntax<'_>, ValueSyntax<'_>) {
    let count = value.lexemes.len();
    let part = |lexemes| ValueSyntax { lexemes, ..value };
    let said = (0..count).rev().find(|&at| {
        let mut behind = Cursor::new(part(&value.lexemes[at..]));
        unchecked(&mut behind) && behind.at_end()
    });
    let (moment, rest) = value.lexemes.split_at(said.unwrap_or(count));
    (part(moment), part(rest))
}

/// Takes `(unchecked)`.
fn unchecked(cursor: &mut Cursor<'_>) -> bool {
    let mut ahead = *cursor;
    let group = ahead.group(Bracket::Round);
    let said = group.is_some_and(|group| {
        let mut inside = Cursor::new(group);
        inside.keyword("unchecked").is_some() && inside.at_end()
    });
    if said {
        *cursor = ahead;
    }
    said
}

fn negative(formula: &Formula) -> Formula {
    match formula {
        Formula::Number(value) => Formula::Number(-value),
        other => Formula::Apply(Function::Neg, vec![other.clone()]),
    }
}
