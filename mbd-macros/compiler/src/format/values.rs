//! Values that are too long for a line: lists with their elements on lines of their own, sums and products broken before their signs.

use super::layout::{DeclarationLayout, GapEdge};
use super::spacing::Sign;
use super::{LEVEL, is_sign};
use crate::lexeme::{Bracket, LexemeKind};

/// Brackets in brackets are broken this deep.
const DEEPEST: usize = 32;

/// The elements of a list, first and last token, and the comma behind each.
type Elements = Vec<((usize, usize), Option<usize>)>;

impl DeclarationLayout<'_> {
    /// Writes a part, on several lines where it does not fit on this one with `tail` characters behind it.
    pub(super) fn broken_up(&mut self, first: usize, last: usize, indent: usize, tail: usize) {
        self.part((first, last), indent, tail, DEEPEST);
    }

    fn part(&mut self, (first, last): (usize, usize), indent: usize, tail: usize, deep: usize) {
        if deep == 0 || self.fits(first, last, tail) {
            return self.on_line(first, last, indent);
        }
        let lists = self.lists(first, last);
        let open: Vec<usize> = lists
            .iter()
            .copied()
            .filter(|&list| self.must_break(list, self.close(list).unwrap_or(list)))
            .collect();
        if !open.is_empty() {
            return self.around((first, last), &open, indent, deep);
        }
        if let Some(value) = self.value(first, last)
            && !self.is_braces(value)
            && self.fits_from(indent + LEVEL, value, last, tail)
        {
            self.on_line(first, value - 1, indent);
            self.next_line(value, indent + LEVEL, GapEdge::Start);
            return self.on_line(value, last, indent + LEVEL);
        }
        let clauses = self.clauses(first, last);
        if !clauses.is_empty() {
            return self.filled((first, last), &clauses, indent, tail, deep);
        }
        let branches = self.branches(first, last);
        if !branches.is_empty() {
            return self.around((first, last), &branches, indent, deep);
        }
        let cuts = self.cuts(first, last);
        if !cuts.is_empty() {
            return self.filled((first, last), &cuts, indent, tail, deep);
        }
        let groups = self.groups(first, last).into_iter();
        let wide = |&open: &usize| self.width(open, self.close(open).unwrap_or(open));
        match groups.max_by_key(wide).filter(|open| wide(open) > 2) {
            Some(widest) => self.around((first, last), &[widest], indent, deep),
            None => self.on_line(first, last, indent),
        }
    }

    /// The words before the values of an item, but for that of the first.
    fn clauses(&self, first: usize, last: usize) -> Vec<usize> {
        (first + 1..=last).filter(|&at| self.clauses[at]).collect()
    }

    /// The braces of `if a < b { this } else { that }`.
    fn branches(&self, first: usize, last: usize) -> Vec<usize> {
        let groups = self.groups(first, last);
        let is_if = |at: usize| self.lexemes[at].kind == LexemeKind::Word("if".into());
        let (mut at, mut found) = (first, false);
        while at <= last && !found {
            found = is_if(at);
            at = self.close(at).unwrap_or(at) + 1;
        }
        let braces = groups.into_iter().filter(|&open| self.is_braces(open));
        braces.filter(|_| found).collect()
    }

    fn is_braces(&self, open: usize) -> bool {
        matches!(self.lexemes[open].kind, LexemeKind::Open(Bracket::Brace, _))
    }

    /// The brackets of a part that are in no others.
    fn groups(&self, first: usize, last: usize) -> Vec<usize> {
        let mut groups = Vec::new();
        let mut at = first;
        while at <= last {
            let close = self.close(at);
            groups.extend(close.map(|_| at));
            at = close.unwrap_or(at) + 1;
        }
        groups
    }

    /// Those that hold lists or fields.
    fn lists(&self, first: usize, last: usize) -> Vec<usize> {
        let is = |open: &usize| {
            let square = matches!(
                self.lexemes[*open].kind,
                LexemeKind::Open(Bracket::Square | Bracket::Brace, _)
            );
            square && (self.is_list(*open) || self.begins_field(*open + 1))
        };
        self.groups(first, last).into_iter().filter(is).collect()
    }

    /// Whether a field begins there: a word and a colon.
    fn begins_field(&self, at: usize) -> bool {
        let kind = |at: usize| self.lexemes.get(at).map(|lexeme| &lexeme.kind);
        matches!(kind(at), Some(LexemeKind::Word(_)))
            && kind(at + 1).is_some_and(|next| is_sign(next, ':'))
    }

    /// Where the value behind a `=` begins.
    fn value(&self, first: usize, last: usize) -> Option<usize> {
        let mut at = first;
        while at < last {
            if self.signs[at] == Sign::Equal {
                return Some(at + 1);
            }
            at = self.close(at).unwrap_or(at) + 1;
        }
        None
    }

    /// Where a part may be cut: at the signs that bind least, in no brackets.
    fn cuts(&self, first: usize, last: usize) -> Vec<usize> {
        let mut cuts: Vec<(Sign, usize)> = Vec::new();
        let mut at = first;
        while at < last {
            let sign = self.signs[at];
            if at > first && sign.parts() {
                cuts.push((sign, at + usize::from(sign == Sign::Comma)));
            }
            at = self.close(at).unwrap_or(at) + 1;
        }
        let least = cuts.iter().map(|(sign, _)| *sign).min();
        let least = cuts.into_iter().filter(|(sign, _)| Some(*sign) == least);
        least.map(|(_, at)| at).collect()
    }

    /// Fills lines with the parts between cuts.
    fn filled(
        &mut self,
        (first, last): (usize, usize),
        cuts: &[usize],
        indent: usize,
        tail: usize,
        deep: usize,
    ) {
        let starts = std::iter::once(&first).chain(cuts);
        let ends = cuts.iter().map(|&cut| cut - 1).chain([last]);
        let mut whole = true;
        for (&start, end) in starts.zip(ends) {
            let ended = self.ended;
            let tail = if end == last { tail } else { 0 };
            if start == first {
                self.part((start, end), indent, tail, deep - 1);
                whole = self.ended == ended;
            } else if whole && self.fits(start, end, tail + 1) {
                self.behind(start, indent);
                self.on_line(start, end, indent);
            } else {
                self.next_line(start, indent + LEVEL, GapEdge::Start);
                let ended = self.ended;
                self.part((start, end), indent + LEVEL, tail, deep - 1);
                whole = self.ended == ended;
            }
        }
    }

    /// Writes a part with these of its brackets on several lines.
    fn around(
        &mut self,
        (first, last): (usize, usize),
        opens: &[usize],
        indent: usize,
        deep: usize,
    ) {
        let mut at = first;
        while at <= last {
            if at > first {
                self.behind(at, indent);
            }
            at = match self.close(at) {
                Some(close) if opens.contains(&at) => {
                    self.list((at, close), indent, deep - 1);
                    close
                }
                Some(close) => {
                    self.on_line(at, close, indent);
                    close
                }
                None => {
                    self.text(at);
                    at
                }
            } + 1;
        }
    }

    /// Writes brackets with what they hold on lines of its own.
    fn list(&mut self, (open, close): (usize, usize), indent: usize, deep: usize) {
        let round = matches!(self.lexemes[open].kind, LexemeKind::Open(Bracket::Round, _));
        let elements = self.elements(open, close);
        let alone = self.stand_alone(&elements);
        let separated = !round && self.is_list(open);
        self.text(open);
        let count = elements.len();
        for (k, ((first, last), comma)) in elements.into_iter().enumerate() {
            let written = match comma {
                Some(_) if round => true,
                _ => separated,
            };
            let tail = usize::from(written);
            let own = !self.tokens[first].joins() || self.tokens[first].gap.ends_line();
            let fits = k > 0 && !alone && (round || !own) && self.fits(first, last, tail + 1);
            if fits && self.tokens[first].joins() {
                self.behind(first, indent);
            } else {
                let edge = if k == 0 {
                    GapEdge::Start
                } else {
                    GapEdge::None
                };
                self.next_line(first, indent + LEVEL, edge);
            }
            self.part((first, last), indent + LEVEL, tail, deep);
            if written && (k + 1 < count || separated) {
                self.push(",");
            }
            if let Some(comma) = comma {
                self.comments_behind(comma, indent + LEVEL);
            }
        }
        self.next_line(close, indent, GapEdge::Close);
        self.text(close);
    }

    fn elements(&self, open: usize, close: usize) -> Elements {
        let mut elements = Vec::new();
        let (mut first, mut at) = (open + 1, open + 1);
        while at < close {
            if is_sign(&self.lexemes[at].kind, ',') && at > first {
                elements.push(((first, at - 1), Some(at)));
                first = at + 1;
            }
            at = self.close(at).unwrap_or(at) + 1;
        }
        if first < close {
            elements.push(((first, close - 1), None));
        }
        elements
    }

    /// Whether each element has a line of its own: fields, sums and products, and what holds lists or fields itself.
    fn stand_alone(&self, elements: &Elements) -> bool {
        elements.iter().any(|((first, last), _)| {
            self.begins_field(*first)
                || !self.lists(*first, *last).is_empty()
                || !self.cuts(*first, *last).is_empty()
        })
    }
}
