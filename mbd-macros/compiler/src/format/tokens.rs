//! A text as tokens, and what stands between them.

use std::ops::Range;

use crate::lexeme::{Bracket, Scanned, scan};

/// A comment that is no documentation.
#[derive(Clone, Debug)]
pub struct Comment {
    /// Its text, without blanks at its end.
    pub text: String,
    /// How many lines end between it and what stands before it.
    pub lines_before: usize,
}

impl Comment {
    /// Whether nothing can follow it on its line.
    pub fn ends_line(&self) -> bool {
        self.text.starts_with("//")
    }

    /// Whether it is more than a part of a line.
    pub fn breaks(&self) -> bool {
        self.ends_line() || self.text.contains('\n')
    }
}

/// What stands before a token.
#[derive(Clone, Debug, Default)]
pub struct Gap {
    /// The comments.
    pub comments: Vec<Comment>,
    /// How many lines end behind the last comment, or behind the token before.
    pub lines: usize,
    /// Whether there is anything at all.
    pub any: bool,
}

impl Gap {
    /// Whether the line of what stands before ends here.
    pub fn ends_line(&self) -> bool {
        match self.comments.first() {
            Some(first) => first.lines_before > 0,
            None => self.lines > 0,
        }
    }

    /// Whether the line of a comment ends before the next token.
    pub fn ends_line_behind(&self, comment: usize) -> bool {
        let rest = self.comments.get(comment..).unwrap_or(&[]);
        let next = rest.iter().skip(1).map(|comment| comment.lines_before);
        rest.iter().any(Comment::ends_line) || next.chain([self.lines]).any(|lines| lines > 0)
    }

    fn is_whole(&self) -> bool {
        !self.comments.iter().any(Comment::breaks)
    }

    /// This gap with what follows it.
    fn and(mut self, next: Gap) -> Gap {
        for (k, mut comment) in next.comments.into_iter().enumerate() {
            comment.lines_before += if k == 0 { self.lines } else { 0 };
            self.comments.push(comment);
            self.lines = 0;
        }
        self.lines += next.lines;
        self.any |= next.any;
        self
    }
}

/// A token: a lexeme with its place.
#[derive(Clone, Debug)]
pub struct Token {
    /// What it is.
    pub kind: Scanned,
    /// Its text.
    pub text: String,
    /// What stands before it.
    pub gap: Gap,
    /// A comma that says nothing, before `]` or `}`.
    pub dropped: bool,
}

impl Token {
    /// Whether it fits on a line with what stands before it.
    pub fn joins(&self) -> bool {
        self.gap.is_whole() && self.kind != Scanned::Doc
    }

    /// Its width in characters.
    pub fn width(&self) -> usize {
        match self.dropped {
            true => 0,
            false => self.text.chars().count(),
        }
    }
}

/// The tokens of a text.
#[derive(Clone, Debug)]
pub struct Tokens {
    /// The tokens.
    pub list: Vec<Token>,
    /// What stands behind the last one.
    pub rest: Gap,
}

impl Tokens {
    /// The tokens of a text whose lines may end in either way.
    pub fn divided(text: &str) -> Tokens {
        let mut list: Vec<Token> = Vec::new();
        let mut gap = Gap::default();
        let mut at = 0;
        while let Some((kind, length)) = scan(&text[at..]) {
            let place: Range<usize> = at..at + length;
            let found = &text[place];
            at += length;
            match kind {
                Scanned::Blank => gap.lines += usize::from(found == "\n"),
                Scanned::Comment => gap.comments.push(Comment {
                    text: found.replace("\r\n", "\n").trim_end().to_owned(),
                    lines_before: std::mem::take(&mut gap.lines),
                }),
                _ => list.push(Token {
                    kind,
                    text: found.trim_end_matches('\r').to_owned(),
                    gap: std::mem::take(&mut gap),
                    dropped: false,
                }),
            }
            gap.any |= matches!(kind, Scanned::Blank | Scanned::Comment);
        }
        let mut tokens = Tokens { list, rest: gap };
        tokens.drop_commas();
        tokens
    }

    /// Drops the commas behind the last element of a list. What stood before one stands before its bracket.
    fn drop_commas(&mut self) {
        for i in 1..self.list.len().saturating_sub(1) {
            let [before, comma, after] = &mut self.list[i - 1..=i + 1] else {
                continue;
            };
            let ends = matches!(after.kind, Scanned::Close(Bracket::Square | Bracket::Brace));
            let element = !matches!(before.kind, Scanned::Open(_) | Scanned::Sign(',' | ';'));
            if comma.kind == Scanned::Sign(',') && ends && element {
                comma.dropped = true;
                after.gap = std::mem::take(&mut comma.gap).and(std::mem::take(&mut after.gap));
            }
        }
    }

    /// Whether both have the same tokens and the same comments in the same order, but for commas that say nothing.
    pub fn says_the_same(&self, other: &Tokens) -> bool {
        fn tokens(all: &Tokens) -> impl Iterator<Item = (Scanned, &str)> {
            let kept = all.list.iter().filter(|token| !token.dropped);
            kept.map(|token| (token.kind, token.text.as_str()))
        }
        fn comments(all: &Tokens) -> impl Iterator<Item = &str> {
            let gaps = all.list.iter().map(|token| &token.gap).chain([&all.rest]);
            gaps.flat_map(|gap| &gap.comments)
                .map(|comment| comment.text.as_str())
        }
        tokens(self).eq(tokens(other)) && comments(self).eq(comments(other))
    }
}
