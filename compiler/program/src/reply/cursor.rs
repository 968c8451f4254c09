//! A position among the tokens of a clause, which moves forward as pieces are recognised.

use super::lexer::{Gap, Kind, Token};

/// The tokens of a clause, and how far they have been read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'a, 't> {
    pub tokens: &'a [Token<'t>],
    pub at: usize,
}

impl<'a, 't> Cursor<'a, 't> {
    pub fn at(tokens: &'a [Token<'t>], at: usize) -> Cursor<'a, 't> {
        Cursor { tokens, at }
    }

    pub fn rest(&self) -> &'a [Token<'t>] {
        self.tokens.get(self.at..).unwrap_or_default()
    }

    pub fn peek(&self) -> Option<&'a Token<'t>> {
        self.tokens.get(self.at)
    }

    pub fn ahead(&self, n_tokens: usize) -> Option<&'a Token<'t>> {
        self.tokens.get(self.at + n_tokens)
    }

    /// Returns whether the next token is joined to the last one.
    pub fn is_joined(&self) -> bool {
        self.at > 0 && self.peek().is_some_and(|token| token.gap == Gap::None)
    }

    pub fn eat_sign(&mut self, sign: char) -> bool {
        let is_there = self.peek().is_some_and(|token| token.is_sign(sign));
        self.at += usize::from(is_there);
        is_there
    }

    /// Skips one of these signs and returns it.
    pub fn eat_signs(&mut self, signs: &[char]) -> Option<char> {
        signs.iter().copied().find(|sign| self.eat_sign(*sign))
    }

    /// Skips one word if it is among these.
    pub fn eat_any(&mut self, words: &str) -> bool {
        let is_there = self.peek().is_some_and(|token| token.is_any(words));
        self.at += usize::from(is_there);
        is_there
    }

    /// Skips words and signs that are among these, but no more than any sentence has in a row: a reader that tries it at
    /// every token stays linear.
    pub fn skip(&mut self, words: &str, signs: &[char]) {
        let most = self.at + 40;
        while self.at < most && (self.eat_any(words) || self.eat_signs(signs).is_some()) {}
    }

    /// Skips a number and returns its text.
    pub fn eat_number(&mut self) -> Option<&'t str> {
        let token = self.peek().filter(|token| token.kind == Kind::Number)?;
        self.at += 1;
        Some(token.text)
    }
}
