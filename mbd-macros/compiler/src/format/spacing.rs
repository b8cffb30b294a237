//! Which tokens of one line have a blank between them.

use super::is_sign;
use super::marks::{Mark, opens};
use super::tokens::Tokens;
use crate::lexeme::{Bracket, Lexeme, LexemeKind, scan};

/// Whether a blank stands before each token, on a line with the one before it.
pub fn blanks(tokens: &Tokens, lexemes: &[Lexeme], marks: &[Mark]) -> Vec<bool> {
    let spacing = Spacing {
        tokens,
        lexemes,
        marks,
        roles: roles(lexemes, marks),
    };
    (0..lexemes.len()).map(|at| spacing.blank(at)).collect()
}

/// What a part of a text may be cut at; what binds least comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sign {
    /// The `,` between two arguments.
    Comma,
    /// `<`, `<=`, `>`, `>=`
    Comparison,
    /// `+`, `-`
    Sum,
    /// `*`, `/`, `%`
    Product,
    /// The `=` before a value: no cut.
    Equal,
    /// No sign that a text is cut at.
    Other,
}

impl Sign {
    /// Whether a text may be cut here.
    pub fn parts(self) -> bool {
        self < Sign::Equal
    }
}

/// What each lexeme is where a text is cut.
pub fn signs(lexemes: &[Lexeme], marks: &[Mark]) -> Vec<Sign> {
    let roles = roles(lexemes, marks);
    let sign = |(lexeme, role): (&Lexeme, &Role)| match (&lexeme.kind, role) {
        (LexemeKind::Sign(','), _) => Sign::Comma,
        (LexemeKind::Sign('<' | '>'), Role::Between) => Sign::Comparison,
        (LexemeKind::Sign('+' | '-'), Role::Between) => Sign::Sum,
        (LexemeKind::Sign('*' | '/' | '%'), Role::Between) => Sign::Product,
        (LexemeKind::Sign('='), Role::Between) => Sign::Equal,
        _ => Sign::Other,
    };
    lexemes.iter().zip(&roles).map(sign).collect()
}

/// What a sign is to its neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    /// No sign that matters here.
    Other,
    /// Between two operands: a blank on both sides.
    Between,
    /// A later sign of the one before: `=` of `<=`, the second of `&&`.
    Continued,
    /// Joins both sides: `.`, `..`, `^`, `::`.
    Joint,
    /// The minus of what follows.
    Minus,
}

fn roles(lexemes: &[Lexeme], marks: &[Mark]) -> Vec<Role> {
    let sign = |at: usize, sign: char| lexemes.get(at).is_some_and(|l| is_sign(&l.kind, sign));
    let mut roles: Vec<Role> = Vec::with_capacity(lexemes.len());
    for (at, lexeme) in lexemes.iter().enumerate() {
        let LexemeKind::Sign(found) = lexeme.kind else {
            roles.push(Role::Other);
            continue;
        };
        let last = at.checked_sub(1).map(|before| roles[before]);
        let after = |before: char| at > 0 && sign(at - 1, before) && last != Some(Role::Continued);
        let of_range = at > 1 && sign(at - 1, '.') && sign(at - 2, '.');
        let continued = match found {
            '=' => of_range || "<>=!".chars().any(after),
            '.' | ':' | '&' | '|' => after(found),
            _ => false,
        };
        roles.push(match found {
            '>' if marks[at] == Mark::Scalar => Role::Other,
            _ if [Mark::Scalar, Mark::InUnit, Mark::Range].contains(&marks[at]) => Role::Joint,
            _ if continued && found == '=' => Role::Continued,
            '&' | '|' if continued => Role::Continued,
            '&' | '|' if sign(at + 1, found) => Role::Between,
            // `..=` stands apart, `..` joins.
            '.' if sign(at + 1, '.') && sign(at + 2, '=') => Role::Between,
            '.' if continued && sign(at + 1, '=') => Role::Continued,
            ':' if continued || sign(at + 1, ':') => Role::Joint,
            '.' | '^' => Role::Joint,
            '-' if begins_operand(lexemes, marks, at) => Role::Minus,
            '+' | '-' | '*' | '/' | '%' | '=' | '<' | '>' | '!' => Role::Between,
            _ => Role::Other,
        });
    }
    roles
}

/// Whether an operand begins there, not an operator between two.
fn begins_operand(lexemes: &[Lexeme], marks: &[Mark], at: usize) -> bool {
    let Some(before) = at.checked_sub(1) else {
        return true;
    };
    match &lexemes[before].kind {
        LexemeKind::Word(word) => marks[before] == Mark::Before || word == "if",
        LexemeKind::Number(_) | LexemeKind::Close(_) | LexemeKind::Text(_) => false,
        LexemeKind::Sign(_) | LexemeKind::Open(..) | LexemeKind::Doc(_) => true,
    }
}

struct Spacing<'a> {
    tokens: &'a Tokens,
    lexemes: &'a [Lexeme],
    marks: &'a [Mark],
    roles: Vec<Role>,
}

impl Spacing<'_> {
    fn blank(&self, at: usize) -> bool {
        let Some(before) = at.checked_sub(1) else {
            return false;
        };
        self.wanted(before, at) || self.merges(before, at)
    }

    fn wanted(&self, before: usize, at: usize) -> bool {
        let (last, next) = (&self.lexemes[before].kind, &self.lexemes[at].kind);
        match (self.roles[before], self.roles[at]) {
            (_, Role::Continued) => return false,
            (Role::Joint | Role::Minus, _) => return false,
            (_, Role::Joint) => return false,
            (Role::Between | Role::Continued, _) => return true,
            _ => {}
        }
        match (last, next) {
            _ if [Mark::InUnit, Mark::Index, Mark::Scalar].contains(&self.marks[at]) => false,
            (_, LexemeKind::Sign(',' | ';' | ':')) => false,
            (LexemeKind::Open(Bracket::Brace, _), LexemeKind::Close(_)) => false,
            (_, LexemeKind::Close(bracket)) => *bracket == Bracket::Brace,
            (LexemeKind::Open(bracket, _), _) => *bracket == Bracket::Brace,
            (_, LexemeKind::Open(bracket, _)) if *bracket != Bracket::Brace => {
                self.apart(before, at)
            }
            (LexemeKind::Word(_), LexemeKind::Text(_)) => self.tokens.list[at].gap.any,
            (LexemeKind::Sign('#'), _) => false,
            _ => true,
        }
    }

    /// Whether a round or square bracket stands apart from the token before it: it is neither a call nor an index.
    fn apart(&self, before: usize, at: usize) -> bool {
        let last = &self.lexemes[before].kind;
        match last {
            LexemeKind::Word(_) if self.marks[before] != Mark::Plain => true,
            LexemeKind::Word(word) if word == "if" => self.is_condition(at),
            LexemeKind::Word(_) => false,
            _ => true,
        }
    }

    /// Whether the bracket behind an `if` holds its condition, or one of several: a brace follows, or what joins them.
    fn is_condition(&self, at: usize) -> bool {
        let LexemeKind::Open(_, skip) = self.lexemes[at].kind else {
            return false;
        };
        let next = self.lexemes.get(at + skip + 1);
        next.is_some_and(|next| {
            let joins = matches!(next.kind, LexemeKind::Sign('&' | '|'));
            joins || opens(&next.kind, Bracket::Brace)
        })
    }

    /// Whether both would be read as something else without a blank.
    fn merges(&self, before: usize, at: usize) -> bool {
        let joins = self.roles[at] == Role::Joint;
        let next = self.tokens.list.get(at + 1).filter(|_| joins);
        let [before, at] = [before, at].map(|at| &self.tokens.list[at]);
        let next = next.map_or("", |next| next.text.as_str());
        let together = format!("{}{}{next}", before.text, at.text);
        scan(&together) != Some((before.kind, before.text.len()))
    }
}
