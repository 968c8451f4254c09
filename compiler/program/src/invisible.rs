//! Characters that a reader does not see, or that a terminal would act on.

use std::borrow::Cow;

/// Returns whether a character has no width, or turns the direction of writing: joiners, marks, a byte order mark.
///
/// Line and paragraph separators are among them; they look like other line ends.
pub fn is_invisible(character: char) -> bool {
    matches!(
        character,
        '\u{ad}' | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}'
    )
}

/// Returns whether a character turns the direction of writing (Unicode's `Bidi_Control`), so that a text reads other
/// than it is.
pub fn turns_writing(character: char) -> bool {
    matches!(
        character,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    )
}

/// Returns whether a character is a control character other than a line end or a tab, or turns the direction of
/// writing.
pub fn is_hidden(character: char) -> bool {
    turns_writing(character) || character.is_control() && !matches!(character, '\n' | '\r' | '\t')
}

/// Writes hidden characters as `\u{1b}`, so that foreign text cannot change what a terminal shows.
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped_where(text, is_hidden)
}

/// Writes some characters as `\u{1b}`.
pub fn escaped_where(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        if is_escaped(character) {
            shown.extend(character.escape_unicode());
        } else {
            shown.push(character);
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests;
