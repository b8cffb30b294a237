//! A position in a list of balanced lexemes.

use mbd_scene::metrics::Take;

use super::{ValueSyntax, Word, foreign, words};
use crate::lexeme::{Bracket, Lexeme, LexemeIndex, LexemeKind, Region};
use crate::messages::{LexemeMessage, syntax as say};
use crate::units;

/// A position in a list of balanced lexemes.
#[derive(Clone, Copy, Debug)]
pub struct Cursor<'a> {
    lexemes: &'a [Lexeme],
    next: usize,
    /// Where the list is, for messages at its end.
    pub whole: Region,
}

impl<'a> Cursor<'a> {
    /// The start of a value.
    pub fn new(value: ValueSyntax<'a>) -> Self {
        Cursor {
            lexemes: value.lexemes,
            next: 0,
            whole: value.at,
        }
    }

    /// Whether nothing is left.
    pub fn at_end(&self) -> bool {
        self.next >= self.lexemes.len()
    }

    /// The next lexeme.
    pub fn peek(&self) -> Option<&'a Lexeme> {
        self.lexemes.get(self.next)
    }

    /// The lexeme `n` after the next.
    pub fn ahead(&self, n: usize) -> Option<&'a Lexeme> {
        self.lexemes.get(self.next + n)
    }

    /// The lexeme `n` before the next.
    pub fn behind(&self, n: usize) -> Option<&'a Lexeme> {
        self.next.checked_sub(n).and_then(|i| self.lexemes.get(i))
    }

    /// The next lexeme's place, or the last one's at the end.
    pub fn here(&self) -> Region {
        match self.peek().or_else(|| self.lexemes.last()) {
            Some(lexeme) => lexeme.at.into(),
            None => self.whole,
        }
    }

    /// The place of the lexeme before.
    pub fn before(&self) -> Region {
        self.behind(1).map_or(self.whole, |lexeme| lexeme.at.into())
    }

    /// Whether the lexeme before is a word.
    pub fn after_word(&self) -> bool {
        self.behind(1)
            .is_some_and(|lexeme| matches!(lexeme.kind, LexemeKind::Word(_)))
    }

    /// Takes the next lexeme; of a bracket only the bracket.
    pub fn take(&mut self) -> Option<&'a Lexeme> {
        let lexeme = self.peek()?;
        self.next += 1;
        Some(lexeme)
    }

    /// Takes the next lexeme; of a bracket everything up to its end.
    pub fn take_tree(&mut self) {
        let skip = match self.peek().map(|lexeme| &lexeme.kind) {
            Some(LexemeKind::Open(_, skip)) => skip + 1,
            Some(_) => 1,
            None => 0,
        };
        self.next = (self.next + skip).min(self.lexemes.len());
    }

    /// The lexemes taken since `start`.
    pub fn since(&self, start: Cursor<'a>) -> ValueSyntax<'a> {
        let lexemes = self.lexemes.get(start.next..self.next).unwrap_or(&[]);
        let at = match (lexemes.first(), lexemes.last()) {
            (Some(first), Some(last)) => Region {
                first: first.at,
                last: last.at,
            },
            _ => start.before(),
        };
        ValueSyntax { lexemes, at }
    }

    /// The lexemes that are left.
    pub fn rest(&self) -> ValueSyntax<'a> {
        let mut end = *self;
        end.next = self.lexemes.len();
        end.since(*self)
    }

    /// Takes this sign if it comes next.
    pub fn sign(&mut self, sign: char) -> Option<LexemeIndex> {
        match self.peek() {
            Some(lexeme) if lexeme.kind == LexemeKind::Sign(sign) => {
                self.next += 1;
                Some(lexeme.at)
            }
            _ => None,
        }
    }

    /// Takes these signs if they come next, one after another.
    pub fn signs(&mut self, signs: &str) -> Option<Region> {
        let mut ahead = *self;
        let mut region: Option<Region> = None;
        for sign in signs.chars() {
            let at: Region = ahead.sign(sign)?.into();
            region = Some(region.map_or(at, |first| first.to(at)));
        }
        *self = ahead;
        region
    }

    /// The next lexeme if it is a word.
    pub fn peek_word(&self) -> Option<&'a str> {
        match self.peek().map(|lexeme| &lexeme.kind) {
            Some(LexemeKind::Word(word)) => Some(word),
            _ => None,
        }
    }

    /// Takes a word.
    pub fn word(&mut self) -> Option<Word> {
        let text = self.peek_word()?.to_string();
        let at = self.take()?.at;
        Some(Word { text, at })
    }

    /// Takes this word if it comes next.
    pub fn keyword(&mut self, word: &str) -> Option<LexemeIndex> {
        if self.peek_word() == Some(word) {
            self.take().map(|lexeme| lexeme.at)
        } else {
            None
        }
    }

    /// Takes a bracket with its content, if it comes next.
    pub fn group(&mut self, bracket: Bracket) -> Option<ValueSyntax<'a>> {
        let open = self.peek()?;
        let LexemeKind::Open(found, skip) = open.kind else {
            return None;
        };
        if found != bracket {
            return None;
        }
        let end = self.next + skip;
        let lexemes = self.lexemes.get(self.next + 1..end).unwrap_or(&[]);
        let close = self.lexemes.get(end).unwrap_or(open);
        self.next = (end + 1).min(self.lexemes.len());
        Some(ValueSyntax {
            lexemes,
            at: Region {
                first: open.at,
                last: close.at,
            },
        })
    }

    /// The report that something else was expected here.
    pub fn expected(&self, what: &str) -> LexemeMessage {
        if let Some(report) = self.before_comma_of_numbers() {
            return report;
        }
        match self.peek() {
            Some(lexeme) => say::expected(lexeme.at.into(), what, &lexeme.shown()),
            None => say::expected_at_end(self.before(), what),
        }
    }

    /// The report of numbers with commas between them outside brackets, if the comma before the next lexeme is the first of these, and what follows them:
    /// two may be one whose decimals follow a comma, `1,5 kg`, others are a list, `0, 1, 0`.
    pub fn behind_comma_of_numbers(&self) -> Option<(LexemeMessage, Cursor<'a>)> {
        let (first, comma) = (self.behind(2)?, self.behind(1)?);
        let (LexemeKind::Number(whole), LexemeKind::Sign(',')) = (&first.kind, &comma.kind) else {
            return None;
        };
        let minus = self.behind(3).filter(|it| it.kind == LexemeKind::Sign('-'));
        let mut numbers = vec![match minus {
            Some(_) => format!("-{whole}"),
            None => whole.clone(),
        }];
        let mut ahead = *self;
        let mut rest = *self;
        let mut last = first.at;
        while let Some((number, at)) = ahead.signed_number() {
            numbers.push(number);
            (last, rest) = (at, ahead);
            if ahead.sign(',').is_none() {
                break;
            }
        }
        let unit = super::unit::suffix(&mut rest).ok().flatten();
        let at = Region::from(minus.map_or(first.at, |minus| minus.at)).to(last.into());
        let report = match numbers.as_slice() {
            [_] => return None,
            [_, decimals] if !whole.contains('.') && decimals.parse::<u64>().is_ok() => {
                let at = Region::from(first.at).to(last.into());
                say::decimal_comma(at, whole, decimals, unit.as_ref())
            }
            numbers => say::list_without_brackets(at, numbers, unit.as_ref()),
        };
        Some((report, rest))
    }

    /// A number with its sign, if one comes next, and where it is.
    fn signed_number(&mut self) -> Option<(String, LexemeIndex)> {
        let mut ahead = *self;
        let sign = if ahead.sign('-').is_some() { "-" } else { "" };
        let lexeme = ahead.take()?;
        let LexemeKind::Number(number) = &lexeme.kind else {
            return None;
        };
        *self = ahead;
        Some((format!("{sign}{number}"), lexeme.at))
    }

    /// The report of numbers with commas between them, if the first comma comes next.
    fn before_comma_of_numbers(&self) -> Option<LexemeMessage> {
        let mut ahead = *self;
        ahead.sign(',')?;
        ahead.behind_comma_of_numbers().map(|(report, _)| report)
    }

    /// What is written here instead of an operator of other languages that comes next.
    fn foreign_operator(&self) -> Option<&'static str> {
        let mut operators = foreign::OPERATORS.iter();
        let begins = |operator: &str| {
            let mut ahead = *self;
            self.peek_word() == Some(operator) || ahead.signs(operator).is_some()
        };
        let found = operators.find(|(operator, _)| begins(operator));
        found.map(|(_, answer)| *answer)
    }

    /// The same inside an expression, where an operator of another language may stand.
    pub fn operand_expected(&self, what: &str) -> LexemeMessage {
        if let Some(report) = self.behind_per_cent() {
            return report;
        }
        if let Some(LexemeKind::Word(not)) = self.behind(1).map(|lexeme| &lexeme.kind)
            && not == "not"
            && self.peek().is_some()
        {
            return LexemeMessage::new(self.before(), foreign::NO_WORD_NOT);
        }
        match (self.foreign_operator(), self.behind(1), self.behind(2)) {
            (Some(answer), ..) => LexemeMessage::new(self.here(), answer),
            (None, Some(first), None) if Take::of(&first.shown()).is_some() => {
                say::taken_of_a_run(first.at.into(), &first.shown())
            }
            (None, ..) => self.expected(what),
        }
    }

    /// The report of `50 %`, where the `%` is the lexeme before and nothing that it could divide comes next.
    fn behind_per_cent(&self) -> Option<LexemeMessage> {
        let (number, sign) = (self.behind(2)?, self.behind(1)?);
        match (&number.kind, &sign.kind) {
            (LexemeKind::Number(number), LexemeKind::Sign('%')) => {
                Some(say::per_cent(sign.at.into(), number))
            }
            _ => None,
        }
    }

    /// An error unless an expression ends here.
    pub fn finish_expression(&self, what: &str) -> Result<(), LexemeMessage> {
        match self.at_end() {
            true => Ok(()),
            false => Err(self
                .word_behind_value(what)
                .unwrap_or_else(|| self.operand_expected(what))),
        }
    }

    /// The report of a word right behind a value: a unit where none can stand, or a word that begins a value with a slip in it.
    fn word_behind_value(&self, what: &str) -> Option<LexemeMessage> {
        let not = self.behind(1).is_some_and(|before| before.shown() == "not");
        let word = self
            .peek_word()
            .filter(|_| !not && self.foreign_operator().is_none())?;
        let mut ahead = *self;
        let here = self.here();
        match super::unit::suffix(&mut ahead) {
            Ok(Some(unit))
                if units::find(word)
                    .or_else(|| units::find(units::spelled(word)?))
                    .is_some() =>
            {
                Some(match self.behind(1).map(|lexeme| &lexeme.kind) {
                    Some(LexemeKind::Word(text)) if foreign::is_not_finite(text) => {
                        say::no_number(self.before(), text)
                    }
                    _ => say::unit_behind_value(here.to(ahead.before()), &unit.text),
                })
            }
            _ => words::near_clause(word).map(|ours| say::misspelt_word(here, what, word, ours)),
        }
    }

    /// An error unless nothing is left.
    pub fn finish(&self, what: &str) -> Result<(), LexemeMessage> {
        if self.at_end() {
            Ok(())
        } else {
            Err(self.expected(what))
        }
    }

    /// Splits what is left at top-level commas; a comma at the end is allowed.
    pub fn comma_separated(mut self) -> Vec<ValueSyntax<'a>> {
        let mut parts = Vec::new();
        while !self.at_end() {
            let start = self;
            while self
                .peek()
                .is_some_and(|lexeme| lexeme.kind != LexemeKind::Sign(','))
            {
                self.take_tree();
            }
            let mut part = self.since(start);
            if part.lexemes.is_empty() {
                part.at = self.here();
            }
            parts.push(part);
            self.sign(',');
        }
        parts
    }
}
