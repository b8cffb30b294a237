//! Where lines end: an item a line, fields between braces on one line or one a line.

use super::marks::marks;
use super::spacing::{Sign, blanks, signs};
use super::tokens::{Gap, Token, Tokens};
use super::{LEVEL, WIDTH, is_sign};
use crate::lexeme::{Bracket, Lexeme, LexemeKind, Scanned};
use crate::syntax::{Item, ModelSyntax, words};

/// What stands around a declaration.
#[derive(Clone, Debug)]
pub enum Margin {
    /// Nothing: it is a file.
    File,
    /// The brackets of a macro call.
    Call {
        /// What its line begins with.
        blanks: String,
        /// Whether the brackets are braces.
        in_braces: bool,
    },
}

/// A declaration as it is written line by line.
pub struct DeclarationLayout<'a> {
    pub(super) tokens: &'a [Token],
    pub(super) lexemes: &'a [Lexeme],
    pub(super) signs: Vec<Sign>,
    model: &'a ModelSyntax<'a>,
    rest: &'a Gap,
    margin: Margin,
    blanks: Vec<bool>,
    /// Whether a token is the brace that holds the fields of an item.
    fields: Vec<bool>,
    /// Whether a token is the word before one of several values of an item: `velocity`, `rotated`.
    pub(super) clauses: Vec<bool>,
    /// How wide everything before a token is on one line, and how often it cannot be on one: sums, so that those of a part are differences.
    widths: Vec<usize>,
    broken: Vec<usize>,
    out: String,
    column: usize,
    /// Whether nothing can follow on this line: it ends with a comment.
    line_is_over: bool,
    /// How many lines have ended.
    pub(super) ended: usize,
    /// The blanks that the next text of this line begins with.
    indent: Option<usize>,
}

impl<'a> DeclarationLayout<'a> {
    /// The layout of a model; each token is one lexeme.
    pub fn new(
        tokens: &'a Tokens,
        lexemes: &'a [Lexeme],
        model: &'a ModelSyntax<'a>,
        margin: Margin,
    ) -> Self {
        let marks = marks(lexemes, model);
        let mut layout = DeclarationLayout {
            tokens: &tokens.list,
            lexemes,
            signs: signs(lexemes, &marks),
            model,
            rest: &tokens.rest,
            margin,
            blanks: blanks(tokens, lexemes, &marks),
            fields: vec![false; lexemes.len()],
            clauses: vec![false; lexemes.len()],
            widths: vec![0],
            broken: vec![0],
            out: String::new(),
            column: 0,
            line_is_over: false,
            ended: 0,
            indent: None,
        };
        layout.find_fields(&model.items);
        layout.measure();
        layout
    }

    fn find_fields(&mut self, items: &[Item<'_>]) {
        for item in items {
            let first = item.block.first().map(|first| first.at.first.index());
            let open = first.and_then(|first| self.before_docs(first));
            if let Some(is) = open.and_then(|open| self.fields.get_mut(open)) {
                *is = true;
            }
            // What is equal to something is broken at the signs of that.
            if item.clauses.iter().all(|given| given.sign != "=") {
                for given in item.clauses.iter().skip(1) {
                    if let Some(is) = self.clauses.get_mut(given.at.first.index()) {
                        *is = true;
                    }
                }
            }
            self.find_fields(&item.block);
        }
    }

    fn measure(&mut self) {
        let (mut width, mut broken) = (0, 0);
        for (at, token) in self.tokens.iter().enumerate() {
            let comments = token.gap.comments.iter();
            width += comments
                .map(|comment| 1 + comment.text.chars().count())
                .sum::<usize>();
            width += token.width() + usize::from(self.has_blank(at));
            self.widths.push(width);
            broken += usize::from(!token.joins()) + usize::from(self.is_held_open(at));
            self.broken.push(broken);
        }
    }

    fn has_blank(&self, at: usize) -> bool {
        !self.tokens[at].dropped && (self.blanks[at] || !self.tokens[at].gap.comments.is_empty())
    }

    /// The last token of the group that opens there.
    pub(super) fn close(&self, open: usize) -> Option<usize> {
        match self.lexemes.get(open)?.kind {
            LexemeKind::Open(_, skip) => Some(open + skip),
            _ => None,
        }
    }

    /// Whether the brackets that open there hold several elements, or fields.
    pub(super) fn is_list(&self, open: usize) -> bool {
        let Some(close) = self.close(open) else {
            return false;
        };
        let mut at = open + 1;
        while at < close {
            if is_sign(&self.lexemes[at].kind, ',') {
                return true;
            }
            at = self.close(at).unwrap_or(at) + 1;
        }
        false
    }

    /// Whether brackets are written with their content on lines of its own, and stay so.
    fn is_held_open(&self, open: usize) -> bool {
        let LexemeKind::Open(Bracket::Brace | Bracket::Square, skip) = self.lexemes[open].kind
        else {
            return false;
        };
        let first = self.tokens.get(open + 1);
        let ends = first.is_some_and(|first| first.gap.ends_line());
        skip > 1 && ends && (self.is_list(open) || self.fields[open])
    }

    /// The token before an item with its documentation.
    fn before_docs(&self, mut first: usize) -> Option<usize> {
        while matches!(
            self.lexemes.get(first.checked_sub(1)?)?.kind,
            LexemeKind::Doc(_)
        ) {
            first -= 1;
        }
        first.checked_sub(1)
    }

    /// How wide a part is on one line.
    pub(super) fn width(&self, first: usize, last: usize) -> usize {
        self.tokens[first].width() + self.widths[last + 1] - self.widths[first + 1]
    }

    /// Whether a part cannot be on one line, however wide that is.
    pub(super) fn must_break(&self, first: usize, last: usize) -> bool {
        let own = usize::from(!self.tokens[first].joins());
        self.broken[last + 1] - self.broken[first] > own
    }

    /// Whether a part fits on the line as far as it is written, with as many characters behind it.
    pub(super) fn fits(&self, first: usize, last: usize, tail: usize) -> bool {
        self.fits_from(self.column, first, last, tail)
    }

    /// Whether a part fits on a line from a column on.
    pub(super) fn fits_from(&self, column: usize, first: usize, last: usize, tail: usize) -> bool {
        !self.must_break(first, last) && column + self.width(first, last) + tail <= WIDTH
    }

    /// The whole text.
    pub fn written(mut self) -> String {
        let (indent, end) = match &self.margin {
            Margin::File => (0, 0),
            Margin::Call { blanks, in_braces } => {
                let width = blanks
                    .chars()
                    .map(|c| if c == '\t' { LEVEL } else { 1 })
                    .sum();
                if self.is_only_a_robot(width) {
                    let blank = if *in_braces { " " } else { "" };
                    self.push(blank);
                    self.on_line(0, self.tokens.len() - 1, width);
                    self.push(blank);
                    return self.out;
                }
                (width + LEVEL, width)
            }
        };
        self.model(indent);
        let rest = self.rest;
        if matches!(self.margin, Margin::Call { .. }) {
            self.lines(rest, end, GapEdge::Close);
            self.push("");
        } else {
            self.lines(rest, end, GapEdge::End);
        }
        self.out
    }

    /// Whether all there is names a file, on a line that begins at this column: `model!(urdf = "arm.urdf")`.
    fn is_only_a_robot(&self, column: usize) -> bool {
        let (Some(last), [only]) = (
            self.tokens.len().checked_sub(1),
            self.model.items.as_slice(),
        ) else {
            return false;
        };
        let sign = self.lexemes.get(1).map(|sign| &sign.kind);
        let comments = !self.rest.comments.is_empty() || !self.tokens[0].gap.comments.is_empty();
        let tail = "model!();".len();
        only.word.text == "urdf"
            && sign.is_some_and(|sign| is_sign(sign, '='))
            && !comments
            && self.fits_from(column, 0, last, tail)
    }

    fn model(&mut self, indent: usize) {
        let head = self
            .lexemes
            .iter()
            .position(|l| !matches!(l.kind, LexemeKind::Doc(_)));
        let open = (0..self.lexemes.len()).find(|&at| self.is_brace(at));
        let behind = head.and_then(|head| self.lexemes.get(head + 1));
        let is_robot = behind.is_some_and(|sign| is_sign(&sign.kind, '='));
        let model = self.model;
        let (Some(head), Some(open), false) = (head, open, is_robot) else {
            return self.items(
                (0, self.tokens.len()),
                &model.items,
                false,
                indent,
                GapEdge::Start,
            );
        };
        self.docs(0, head, indent, GapEdge::Start);
        self.next_line(
            head,
            indent,
            if head == 0 {
                GapEdge::Start
            } else {
                GapEdge::None
            },
        );
        self.on_line(head, open, indent);
        let close = self.close(open).unwrap_or(open);
        self.braces((open, close), &model.items, false, indent);
    }

    fn is_brace(&self, at: usize) -> bool {
        matches!(self.lexemes[at].kind, LexemeKind::Open(Bracket::Brace, _))
    }

    /// What stands between braces, each item on a line, and the closing brace.
    fn braces(
        &mut self,
        (open, close): (usize, usize),
        items: &[Item<'_>],
        inside: bool,
        indent: usize,
    ) {
        self.items(
            (open + 1, close),
            items,
            inside,
            indent + LEVEL,
            GapEdge::Start,
        );
        if close > open + 1 || !self.tokens[close].gap.comments.is_empty() {
            self.next_line(close, indent, GapEdge::Close);
        }
        self.text(close);
    }

    /// Items, each on a line, up to the token `to`.
    fn items(
        &mut self,
        (from, to): (usize, usize),
        items: &[Item<'_>],
        inside: bool,
        indent: usize,
        edge: GapEdge,
    ) {
        let mut next = from;
        for item in items {
            let edge = if next == from { edge } else { GapEdge::None };
            let last = self.last_of(item);
            self.item((next, last), item, inside, indent, edge);
            next = last + 1;
        }
        // Documentation of nothing.
        self.docs(
            next,
            to,
            indent,
            if next == from { edge } else { GapEdge::None },
        );
    }

    /// The last token of an item. That of a file which gives a whole declaration is its path, or the comma behind it.
    fn last_of(&self, item: &Item<'_>) -> usize {
        let last = item.at.last.index();
        match item.given(":").filter(|_| item.at.first == item.at.last) {
            Some(given) if item.word.text == "urdf" => {
                let path = given.value.at.last.index();
                let behind = self.lexemes.get(path + 1).map(|next| &next.kind);
                path + usize::from(matches!(behind, Some(LexemeKind::Sign(',' | ';'))))
            }
            _ => last,
        }
    }

    fn docs(&mut self, from: usize, to: usize, indent: usize, edge: GapEdge) {
        for at in from..to {
            self.next_line(at, indent, if at == from { edge } else { GapEdge::None });
            self.text(at);
        }
    }

    fn item(
        &mut self,
        (from, last): (usize, usize),
        item: &Item<'_>,
        inside: bool,
        indent: usize,
        edge: GapEdge,
    ) {
        let is_head = |at: &usize| self.tokens[*at].kind != Scanned::Doc;
        let first = (from..=last).find(is_head).unwrap_or(from);
        self.docs(from, first, indent, edge);
        let edge = if first == from { edge } else { GapEdge::None };
        self.next_line(first, indent, edge);
        let separated = is_sign(&self.lexemes[last].kind, ',') && last > first;
        let end = if separated { last - 1 } else { last };
        // The last field has a comma, too.
        let comma = separated || inside;
        let tail = usize::from(comma);
        match self.block((first, end), item, inside) {
            Some((open, close)) if !self.fits(first, end, tail) => {
                self.broken_up(first, open - 1, indent, 2);
                self.behind(open, indent);
                self.text(open);
                self.braces((open, close), &item.block, true, indent);
                if close < end {
                    self.behind(close + 1, indent);
                    self.on_line(close + 1, end, indent);
                }
            }
            _ => self.broken_up(first, end, indent, tail),
        }
        if comma {
            self.push(",");
        }
        if separated {
            self.comments_behind(last, indent);
        }
    }

    /// The braces of an item that hold its fields.
    fn block(
        &self,
        (first, end): (usize, usize),
        item: &Item<'_>,
        inside: bool,
    ) -> Option<(usize, usize)> {
        words::find(&item.word.text, inside)?.fields?;
        let close = match &self.lexemes[end].kind {
            sign if is_sign(sign, ';') => end.checked_sub(1)?,
            _ => end,
        };
        let mut opens = (first + 1..close).rev();
        let open = opens.find(|&at| self.close(at) == Some(close))?;
        let owns = open + 1 == close || self.fields[open];
        (self.is_brace(open) && owns).then_some((open, close))
    }

    /// Writes what stands before a token, up to the beginning of its line.
    pub(super) fn next_line(&mut self, at: usize, indent: usize, edge: GapEdge) {
        let tokens = self.tokens;
        self.lines(&tokens[at].gap, indent, edge);
    }

    fn lines(&mut self, gap: &Gap, indent: usize, edge: GapEdge) {
        let inner = if edge == GapEdge::Close {
            indent + LEVEL
        } else {
            indent
        };
        let ends = [GapEdge::Close, GapEdge::End].contains(&edge);
        let mut first = edge == GapEdge::Start;
        for (k, comment) in gap.comments.iter().enumerate() {
            let alone = ends || gap.ends_line_behind(k);
            let follows = comment.lines_before == 0 && (k > 0 || alone);
            if follows && self.has_line() && !self.line_is_over {
                self.push(" ");
            } else {
                self.start_line(comment.lines_before > 1 && !first, inner);
                first = false;
            }
            self.push(&comment.text);
        }
        let last = gap.comments.last();
        let stays = last.is_some_and(|last| !last.ends_line()) && gap.lines == 0;
        if stays && !ends {
            return self.push(" ");
        }
        self.start_line(gap.lines > 1 && !ends && !first, indent);
    }

    /// Whether something stands on the line, or the declaration follows a brace.
    fn has_line(&self) -> bool {
        !self.out.is_empty() || matches!(self.margin, Margin::Call { .. })
    }

    /// The comments before a comma that has been written.
    pub(super) fn comments_behind(&mut self, comma: usize, indent: usize) {
        let tokens = self.tokens;
        for comment in &tokens[comma].gap.comments {
            self.blank(indent);
            self.push(&comment.text);
        }
    }

    /// A blank, or the next line where nothing can follow on this one.
    fn blank(&mut self, indent: usize) {
        match self.line_is_over {
            true => self.start_line(false, indent),
            false => self.push(" "),
        }
    }

    /// Writes a part with its blanks, on one line but for comments that end it.
    pub(super) fn on_line(&mut self, first: usize, last: usize, indent: usize) {
        self.text(first);
        for at in first + 1..=last {
            self.behind(at, indent);
            self.text(at);
        }
    }

    /// Writes what stands between a token and the one before it on the same line.
    pub(super) fn behind(&mut self, at: usize, indent: usize) {
        let tokens = self.tokens;
        if !tokens[at].joins() {
            return self.next_line(at, indent + LEVEL, GapEdge::None);
        }
        for comment in &tokens[at].gap.comments {
            self.blank(indent + LEVEL);
            self.push(&comment.text);
        }
        if self.has_blank(at) || self.line_is_over {
            self.blank(indent + LEVEL);
        }
    }

    /// Writes one token.
    pub(super) fn text(&mut self, at: usize) {
        let tokens = self.tokens;
        if !tokens[at].dropped {
            self.push(&tokens[at].text);
        }
    }

    /// Ends the line, and begins another with as many blanks.
    pub(super) fn start_line(&mut self, empty: bool, indent: usize) {
        if self.has_line() {
            self.out.push('\n');
            if empty {
                self.out.push('\n');
            }
        }
        self.ended += 1;
        self.line_is_over = false;
        self.column = indent;
        self.indent = Some(indent);
    }

    /// Writes a text on the line.
    pub(super) fn push(&mut self, text: &str) {
        if let Some(indent) = self.indent.take() {
            let own = match &self.margin {
                Margin::File => "",
                Margin::Call { blanks, .. } => blanks.as_str(),
            };
            let width: usize = own.chars().map(|c| if c == '\t' { LEVEL } else { 1 }).sum();
            self.out.push_str(own);
            let more = indent.saturating_sub(width);
            self.out.extend(std::iter::repeat_n(' ', more));
        }
        self.out.push_str(text);
        self.line_is_over = text.starts_with("//");
        match text.rsplit_once('\n') {
            Some((_, last)) => self.column = last.chars().count(),
            None => self.column += text.chars().count(),
        }
    }
}

/// Where a gap is: no empty line stands behind an opening bracket or before a closing one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GapEdge {
    /// Behind an opening bracket, or at the start of the text.
    Start,
    /// Between two.
    None,
    /// Before a closing bracket.
    Close,
    /// At the end of the text.
    End,
}
