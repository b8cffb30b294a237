//! Lexemes of a macro call.

use proc_macro2::{Delimiter, Group, Span, TokenStream, TokenTree};

use super::{Bracket, DeclarationSource, Lexed, LexemeIndex, LexemeKind, Lexer, Places};
use crate::messages::{Messages, syntax as say};

/// Groups deeper than this are refused.
const DEEPEST: usize = 200;

/// The lexemes of the tokens between the braces of `model! { … }`.
pub fn from_tokens(tokens: TokenStream) -> Lexed {
    let mut lexer = Lexer::new(Places::of_tokens());
    let mut messages = Messages::default();
    lexer.tokens(tokens, 0, &mut messages);
    (lexer.lexemes, lexer.places, messages)
}

impl Lexer {
    fn spanned(&mut self, kind: LexemeKind, span: Span) -> LexemeIndex {
        let at = self.next_at();
        if let DeclarationSource::Tokens(spans) = &mut self.places.source {
            spans.push(span);
        }
        self.push(kind, at);
        at
    }

    fn tokens(&mut self, tokens: TokenStream, depth: usize, messages: &mut Messages) {
        let mut tokens = tokens.into_iter().peekable();
        while let Some(token) = tokens.next() {
            match token {
                TokenTree::Ident(word) => {
                    let span = word.span();
                    self.spanned(LexemeKind::Word(word.to_string()), span);
                }
                TokenTree::Literal(literal) => {
                    self.literal(&literal.to_string(), literal.span(), messages)
                }
                TokenTree::Punct(sign) if sign.as_char() == '#' => {
                    let doc = match tokens.peek() {
                        Some(TokenTree::Group(group)) => doc_of(group),
                        _ => None,
                    };
                    let kind = match doc {
                        Some(text) => {
                            tokens.next();
                            LexemeKind::Doc(text)
                        }
                        None => LexemeKind::Sign('#'),
                    };
                    self.spanned(kind, sign.span());
                }
                TokenTree::Punct(sign) => {
                    self.spanned(LexemeKind::Sign(sign.as_char()), sign.span());
                }
                TokenTree::Group(group) => self.group(&group, depth, messages),
            }
        }
    }

    fn group(&mut self, group: &Group, depth: usize, messages: &mut Messages) {
        let bracket = match group.delimiter() {
            Delimiter::Parenthesis => Some(Bracket::Round),
            Delimiter::Bracket => Some(Bracket::Square),
            Delimiter::Brace => Some(Bracket::Brace),
            Delimiter::None => None,
        };
        let at = bracket.map(|b| self.spanned(LexemeKind::Open(b, 0), group.span_open()));
        if depth < DEEPEST {
            self.tokens(group.stream(), depth + 1, messages);
        } else if let Some(at) = at {
            messages.push(say::too_deep(at.into()));
        }
        if let Some(bracket) = bracket {
            self.spanned(LexemeKind::Close(bracket), group.span_close());
        }
    }

    fn literal(&mut self, text: &str, span: Span, messages: &mut Messages) {
        let (sign, digits) = match text.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, text),
        };
        let end = super::scan::number_end(digits);
        if end == 0 {
            let path = self.awaits_path();
            let shown = match string(text) {
                Some(string) if path => string,
                _ => text.trim_matches('"').to_string(),
            };
            let report = self.string_after();
            let at = self.spanned(LexemeKind::Text(shown), span);
            if !path {
                messages.push(report.unwrap_or_else(|| say::string(at.into())));
            }
            return;
        }
        if sign {
            self.spanned(LexemeKind::Sign('-'), span);
        }
        self.spanned(LexemeKind::Number(digits[..end].to_string()), span);
        if end < digits.len() {
            self.spanned(LexemeKind::Word(digits[end..].to_string()), span);
        }
    }
}

/// The text of `[doc = "…"]`. A macro that forwards doc comments wraps what it captured in invisible groups.
fn doc_of(group: &Group) -> Option<String> {
    let mut inner = visible(group.stream()).into_iter();
    let (word, sign, text) = (inner.next()?, inner.next()?, inner.next()?);
    match (word, sign, text) {
        (TokenTree::Ident(word), TokenTree::Punct(sign), TokenTree::Literal(text))
            if word == "doc" && sign.as_char() == '=' =>
        {
            match syn::Lit::new(text) {
                syn::Lit::Str(text) => Some(text.value()),
                _ => None,
            }
        }
        _ => None,
    }
}

/// What a string literal of Rust stands for.
fn string(literal: &str) -> Option<String> {
    syn::parse_str::<syn::LitStr>(literal)
        .ok()
        .map(|literal| literal.value())
}

/// The tokens without invisible groups.
fn visible(tokens: TokenStream) -> Vec<TokenTree> {
    let open = |token| match token {
        TokenTree::Group(group) if group.delimiter() == Delimiter::None => {
            group.stream().into_iter().collect()
        }
        other => vec![other],
    };
    tokens.into_iter().flat_map(open).collect()
}
