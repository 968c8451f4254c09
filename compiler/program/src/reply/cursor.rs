//! A position in an answer, which moves forward as pieces are recognised.

/// A text, and how far it has been read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'t> {
    pub text: &'t str,
    pub at: usize,
}

impl<'t> Cursor<'t> {
    pub fn new(text: &'t str, at: usize) -> Cursor<'t> {
        Cursor { text, at }
    }

    pub fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    pub fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// Skips one character.
    pub fn step(&mut self) {
        self.at += self.peek().map_or(0, char::len_utf8);
    }

    /// Skips all wanted characters and returns them.
    pub fn skip(&mut self, wanted: impl Fn(char) -> bool) -> &'t str {
        let rest = self.rest();
        let length = rest
            .find(|character| !wanted(character))
            .unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    /// Skips one character if it is the wanted one.
    pub fn eat(&mut self, wanted: char) -> bool {
        let is_there = self.peek() == Some(wanted);
        if is_there {
            self.step();
        }
        is_there
    }

    /// Skips a word in any case, if the whole word is here.
    pub fn eat_word(&mut self, word: &str) -> bool {
        let is_there = starts_with_word(self.rest(), word);
        if is_there {
            self.at += word.len();
        }
        is_there
    }
}

/// Returns whether `text` begins with this whole ASCII word, in any case.
pub(super) fn starts_with_word(text: &str, word: &str) -> bool {
    let Some(start) = text.get(..word.len()) else {
        return false;
    };
    start.eq_ignore_ascii_case(word)
        && !text[word.len()..].starts_with(|next: char| next.is_alphanumeric())
}

/// Returns whether a character is only decoration: Markdown, quotes, LaTeX, escapes.
pub(super) fn decorates(character: char) -> bool {
    matches!(
        character,
        '*' | '_' | '`' | '"' | '\'' | '“' | '”' | '$' | '\\' | '~'
    )
}

/// Returns at most the last `most` bytes of a text, starting at a whole character.
pub(super) fn tail(text: &str, most: usize) -> &str {
    let mut from = text.len().saturating_sub(most);
    while !text.is_char_boundary(from) {
        from += 1;
    }
    &text[from..]
}

/// Returns at most the first `most` bytes of a text, to a whole character.
pub(super) fn head(text: &str, most: usize) -> &str {
    let mut to = text.len().min(most);
    while !text.is_char_boundary(to) {
        to -= 1;
    }
    &text[..to]
}

/// Returns the first word of a text; empty if it does not begin with a word.
pub(super) fn first_word(text: &str) -> &str {
    let length = text
        .find(|character: char| !character.is_alphanumeric())
        .unwrap_or(text.len());
    &text[..length]
}
