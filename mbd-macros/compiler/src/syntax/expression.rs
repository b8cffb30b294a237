//! Expressions: numbers with units, vectors, paths, calls and operators.

use mbd_scene::Unit;

use super::chain::Chain;
use super::{Cursor, ValueSyntax, Word, unit};
use crate::lexeme::{Bracket, LexemeKind, Region};
use crate::messages::{LexemeMessage, syntax as say};
use crate::number::vanishes;

/// Brackets and operators may nest this deep.
const DEEPEST: usize = 120;

/// An expression as written.
#[derive(Clone, Debug)]
pub enum Expression {
    /// A number.
    Number {
        /// Its value, without the unit.
        value: f64,
        /// Its text.
        text: String,
        /// Its unit.
        unit: Option<Unit>,
        /// Its place.
        at: Region,
    },
    /// `[a, b, c]` with a unit for all.
    Vector {
        /// The components.
        parts: Vec<Expression>,
        /// The unit after the bracket.
        unit: Option<Unit>,
        /// Its place.
        at: Region,
    },
    /// `capsule.bridle[i].position`
    Path(Vec<PathStep>),
    /// `norm(v)`
    Call {
        /// The function.
        name: Word,
        /// Its arguments.
        arguments: Vec<Expression>,
        /// Its place.
        at: Region,
    },
    /// `(…).x`
    Component {
        /// The vector.
        of: Box<Expression>,
        /// `x`, `y` or `z`.
        axis: Word,
    },
    /// `a < b`, the condition of an `if`, or two of them with `&&` or `||`
    Compare {
        /// `< <= > >= && ||`
        sign: &'static str,
        /// The operands.
        sides: Box<[Expression; 2]>,
    },
    /// `-a`
    Negative(Box<Expression>, Region),
    /// `a + b`
    Binary {
        /// `+ - * / % ^`
        sign: char,
        /// The operands.
        sides: Box<[Expression; 2]>,
    },
}

/// One name of a path.
#[derive(Clone, Debug)]
pub struct PathStep {
    /// The name.
    pub word: Word,
    /// Its index.
    pub index: Option<Box<Expression>>,
}

impl Expression {
    /// From its first to its last lexeme.
    pub fn at(&self) -> Region {
        match self {
            Expression::Number { at, .. }
            | Expression::Vector { at, .. }
            | Expression::Call { at, .. }
            | Expression::Negative(_, at) => *at,
            Expression::Path(steps) => match (steps.first(), steps.last()) {
                (Some(first), Some(last)) => Region {
                    first: first.word.at,
                    last: last.word.at,
                },
                _ => Region::START,
            },
            Expression::Component { of, axis } => of.at().to(axis.at.into()),
            Expression::Binary { sides, .. } | Expression::Compare { sides, .. } => {
                sides[0].at().to(sides[1].at())
            }
        }
    }
}

/// Parses a value that is one expression.
pub fn whole(value: ValueSyntax<'_>) -> Result<Expression, LexemeMessage> {
    let mut cursor = Cursor::new(value);
    // A comparison is read here, so that it is refused by what it is.
    let parsed = Parser { depth: 0 }.either(&mut cursor)?.0;
    cursor.finish_expression("an operator or the end")?;
    Ok(parsed)
}

/// Parses an expression at the start of the cursor.
pub fn prefix(cursor: &mut Cursor<'_>) -> Result<Expression, LexemeMessage> {
    Ok(Parser { depth: 0 }.sum(cursor)?.0)
}

/// Parses a path that fills the value.
pub fn path(value: ValueSyntax<'_>) -> Result<Vec<PathStep>, LexemeMessage> {
    let mut cursor = Cursor::new(value);
    let steps = Parser { depth: 0 }.path(&mut cursor)?;
    cursor.finish("the end of the name")?;
    Ok(steps)
}

struct Parser {
    depth: usize,
}

/// An expression with the depth of its tree.
type Deep = Result<(Expression, usize), LexemeMessage>;

impl Parser {
    fn enter(&mut self, at: Region) -> Result<(), LexemeMessage> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(say::deep_expression(at));
        }
        Ok(())
    }

    fn sum(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        let first = self.product(cursor)?;
        self.chain(cursor, first, ['+', '-'], Self::product)
    }

    /// A sum, or conditions with `||` between them.
    fn either(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        self.together(cursor, "||", |this, cursor| {
            this.together(cursor, "&&", Self::comparison)
        })
    }

    /// Conditions with one sign between them.
    fn together(
        &mut self,
        cursor: &mut Cursor<'_>,
        sign: &'static str,
        part: impl Fn(&mut Self, &mut Cursor<'_>) -> Deep,
    ) -> Deep {
        let (mut all, mut depth) = part(self, cursor)?;
        while cursor.signs(sign).is_some() {
            let (next, other) = part(self, cursor)?;
            depth = depth.max(other) + 1;
            if depth > DEEPEST {
                return Err(say::deep_expression(next.at()));
            }
            let sides = Box::new([all, next]);
            all = Expression::Compare { sign, sides };
        }
        Ok((all, depth))
    }

    /// A sum, or two with a comparison between them, or conditions in brackets.
    fn comparison(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        let mut ahead = *cursor;
        if let Some(group) = ahead.group(Bracket::Round).filter(|it| compares(*it)) {
            *cursor = ahead;
            return self.conditions(group);
        }
        let (left, depth) = self.sum(cursor)?;
        let mut signs = ["<=", ">=", "<", ">"].into_iter();
        let here = cursor.here();
        if cursor.signs("==").is_some() || cursor.signs("!=").is_some() {
            return Err(say::equality(here));
        }
        let Some(sign) = signs.find(|sign| cursor.signs(sign).is_some()) else {
            return Ok((left, depth));
        };
        let (right, other) = self.sum(cursor)?;
        let sides = Box::new([left, right]);
        Ok((Expression::Compare { sign, sides }, depth.max(other) + 1))
    }

    fn product(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        let mut found = self.negative(cursor)?;
        loop {
            found = self.chain(cursor, found, ['*', '/'], Self::negative)?;
            let here = cursor.here();
            if cursor.sign('%').is_none() {
                return Ok(found);
            }
            let ((left, depth), (right, other)) = (found, self.negative(cursor)?);
            let depth = depth.max(other) + 1;
            if depth > DEEPEST {
                return Err(say::deep_expression(here));
            }
            let sides = Box::new([left, right]);
            found = (Expression::Binary { sign: '%', sides }, depth);
        }
    }

    /// Operands of one rank behind the first.
    fn chain(
        &mut self,
        cursor: &mut Cursor<'_>,
        first: (Expression, usize),
        signs: [char; 2],
        operand: fn(&mut Self, &mut Cursor<'_>) -> Deep,
    ) -> Deep {
        let here = first.0.at();
        let mut chain = Chain::new(signs, first);
        while let Some(sign) = signs.into_iter().find(|&s| cursor.sign(s).is_some()) {
            if sign == '*' && cursor.sign('*').is_some() {
                return Err(say::two_stars(cursor.before()));
            }
            chain.push(sign, operand(self, cursor)?);
        }
        let tree = chain.grouped(DEEPEST);
        tree.filter(|(_, depth)| *depth <= DEEPEST)
            .ok_or_else(|| say::deep_expression(here))
    }

    fn negative(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        let Some(at) = cursor.sign('-') else {
            return self.power(cursor);
        };
        self.enter(at.into())?;
        let (inner, depth) = self.negative(cursor)?;
        self.depth -= 1;
        let at = Region::from(at).to(inner.at());
        Ok((Expression::Negative(Box::new(inner), at), depth + 1))
    }

    fn power(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        let (base, depth) = self.postfix(cursor)?;
        if cursor.sign('^').is_none() {
            return Ok((base, depth));
        }
        self.enter(base.at())?;
        let (exponent, other) = self.negative(cursor)?;
        self.depth -= 1;
        let sides = Box::new([base, exponent]);
        Ok((
            Expression::Binary { sign: '^', sides },
            depth.max(other) + 1,
        ))
    }

    fn postfix(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        let (mut inner, mut depth) = self.primary(cursor)?;
        while !range(cursor) && cursor.sign('.').is_some() {
            let axis = cursor
                .word()
                .ok_or_else(|| cursor.expected("a component `x`, `y` or `z`"))?;
            depth += 1;
            if depth > DEEPEST {
                return Err(say::deep_expression(axis.at.into()));
            }
            inner = Expression::Component {
                of: Box::new(inner),
                axis,
            };
        }
        Ok((inner, depth))
    }

    fn primary(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        let here = cursor.here();
        match cursor.peek().map(|lexeme| &lexeme.kind) {
            Some(LexemeKind::Number(text)) => {
                cursor.take();
                let value = number(text, here)?;
                let unit = unit::suffix(cursor)?;
                let at = here.to(cursor.before());
                let text = text.clone();
                if let Some(unit) = unit.as_ref().filter(|u| !(value * u.factor).is_finite()) {
                    return Err(say::huge_number(at, &format!("{text} {}", unit.text)));
                }
                Ok((
                    Expression::Number {
                        value,
                        text,
                        unit,
                        at,
                    },
                    1,
                ))
            }
            Some(LexemeKind::Open(Bracket::Round, _)) => {
                let group = cursor
                    .group(Bracket::Round)
                    .ok_or_else(|| say::deep_expression(here))?;
                if Cursor::new(group).comma_separated().len() == 3 {
                    return Err(say::round_vector(group.at));
                }
                self.enter(here)?;
                let mut inner = Cursor::new(group);
                let parsed = self.sum(&mut inner)?;
                inner.finish_expression("an operator or `)`")?;
                self.depth -= 1;
                Ok(parsed)
            }
            Some(LexemeKind::Sign('|')) => Err(say::bars(here)),
            Some(LexemeKind::Sign('.'))
                if let Some(LexemeKind::Number(digits)) = cursor.ahead(1).map(|it| &it.kind) =>
            {
                let digit = cursor.ahead(1).map_or(here, |it| here.to(it.at.into()));
                Err(say::leading_point(digit, digits))
            }
            Some(LexemeKind::Open(Bracket::Square, _)) => {
                let group = cursor
                    .group(Bracket::Square)
                    .ok_or_else(|| say::deep_expression(here))?;
                let (parts, depth) = self.list(group)?;
                let unit = unit::suffix(cursor)?;
                let at = group.at.to(cursor.before());
                let vector = Expression::Vector { parts, unit, at };
                Ok((vector, depth + 1))
            }
            Some(LexemeKind::Word(_)) => self.named(cursor),
            _ => Err(cursor.operand_expected("a number, a name, `(` or `[`")),
        }
    }

    /// A call or a path.
    fn named(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        let mut ahead = *cursor;
        let name = ahead.word();
        let called = ahead.group(Bracket::Round).filter(|_| is_call(*cursor));
        if let (Some(name), Some(group)) = (name, called) {
            *cursor = ahead;
            let (arguments, depth) = self.list(group)?;
            let at = Region::from(name.at).to(group.at);
            return Ok((
                Expression::Call {
                    name,
                    arguments,
                    at,
                },
                depth + 1,
            ));
        }
        if cursor.peek_word() == Some("if") {
            return self.branches(cursor);
        }
        let steps = self.path(cursor)?;
        if let (Some(LexemeKind::Open(Bracket::Round, _)), [before @ .., last]) =
            (cursor.peek().map(|lexeme| &lexeme.kind), steps.as_slice())
        {
            let path: Vec<&str> = before.iter().map(|step| step.word.text.as_str()).collect();
            let at = last.word.at.into();
            return Err(say::function_behind(at, &path.join("."), &last.word.text));
        }
        Ok((Expression::Path(steps), 1))
    }

    /// `if a < b { this } else { that }`, another way to write the function `if`.
    fn branches(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        let here = cursor.here();
        let name = cursor.word().ok_or_else(|| say::two_branches(here))?;
        self.enter(here)?;
        let (condition, first) = self.condition(cursor)?;
        let (this, second) = self.branch(cursor, here)?;
        if cursor.keyword("else").is_none() {
            return Err(say::two_branches(here));
        }
        let (that, third) = match cursor.peek_word() {
            Some("if") => self.branches(cursor)?,
            _ => self.branch(cursor, here)?,
        };
        self.depth -= 1;
        let at = here.to(cursor.before());
        let arguments = vec![condition, this, that];
        let depth = first.max(second).max(third) + 1;
        Ok((
            Expression::Call {
                name,
                arguments,
                at,
            },
            depth,
        ))
    }

    /// Conditions before a brace, in brackets or without.
    fn condition(&mut self, cursor: &mut Cursor<'_>) -> Deep {
        let mut ahead = *cursor;
        let group = ahead.group(Bracket::Round).filter(|_| {
            let next = ahead.peek().map(|lexeme| &lexeme.kind);
            matches!(next, Some(LexemeKind::Open(Bracket::Brace, _)))
        });
        let Some(group) = group else {
            return self.either(cursor);
        };
        *cursor = ahead;
        self.conditions(group)
    }

    /// Conditions in brackets.
    fn conditions(&mut self, group: ValueSyntax<'_>) -> Deep {
        self.enter(group.at)?;
        let mut inner = Cursor::new(group);
        let conditions = self.either(&mut inner)?;
        inner.finish_expression("an operator or `)`")?;
        self.depth -= 1;
        Ok(conditions)
    }

    /// `{ value }`
    fn branch(&mut self, cursor: &mut Cursor<'_>, at: Region) -> Deep {
        let group = cursor.group(Bracket::Brace);
        let mut inner = Cursor::new(group.ok_or_else(|| say::two_branches(at))?);
        let parsed = self.sum(&mut inner)?;
        inner.finish_expression("an operator or `}`")?;
        Ok(parsed)
    }

    /// Expressions separated by commas.
    fn list(&mut self, group: ValueSyntax<'_>) -> Result<(Vec<Expression>, usize), LexemeMessage> {
        self.enter(group.at)?;
        let mut parts = Vec::new();
        let mut deepest = 0;
        for part in Cursor::new(group).comma_separated() {
            let mut inner = Cursor::new(part);
            let (parsed, depth) = self.either(&mut inner)?;
            inner.finish_expression("an operator or `,`")?;
            parts.push(parsed);
            deepest = deepest.max(depth);
        }
        self.depth -= 1;
        Ok((parts, deepest))
    }

    fn path(&mut self, cursor: &mut Cursor<'_>) -> Result<Vec<PathStep>, LexemeMessage> {
        let mut steps = Vec::new();
        loop {
            let word = cursor.word().ok_or_else(|| cursor.expected("a name"))?;
            let index = match cursor.group(Bracket::Square) {
                Some(group) => {
                    self.enter(group.at)?;
                    let mut inner = Cursor::new(group);
                    let (index, _) = self.sum(&mut inner)?;
                    inner.finish("`]`")?;
                    self.depth -= 1;
                    Some(Box::new(index))
                }
                None => None,
            };
            steps.push(PathStep { word, index });
            if range(cursor) || cursor.sign('.').is_none() {
                return Ok(steps);
            }
        }
    }
}

/// Whether a word and brackets behind it are a call: not `if (a < b) { … }`, where what is in brackets is the condition, or a part of it.
pub fn is_call(mut cursor: Cursor<'_>) -> bool {
    let is_if = cursor.peek_word() == Some("if");
    cursor.take();
    let group = cursor.group(Bracket::Round);
    group.is_some_and(|group| !is_if || Cursor::new(group).comma_separated().len() > 1)
}

/// Whether something is compared in brackets, not in brackets inside them, nor in an `if` there, which is a value.
fn compares(group: ValueSyntax<'_>) -> bool {
    let mut inner = Cursor::new(group);
    while let Some(lexeme) = inner.peek() {
        match &lexeme.kind {
            LexemeKind::Sign('<' | '>') => return true,
            LexemeKind::Word(word) if word == "if" => return false,
            LexemeKind::Open(bracket, _) if inner.group(*bracket).is_some() => {}
            _ => {
                inner.take();
            }
        }
    }
    false
}

/// Whether the two dots of a range come next.
pub fn range(cursor: &Cursor<'_>) -> bool {
    let mut ahead = *cursor;
    ahead.signs("..").is_some()
}

/// The value of a number's text.
fn number(text: &str, at: Region) -> Result<f64, LexemeMessage> {
    let digits: String = text.chars().filter(|&c| c != '_').collect();
    match digits.parse::<f64>() {
        Ok(value) if vanishes(&digits, value) => Err(say::tiny_number(at, text)),
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(say::huge_number(at, text)),
    }
}
