//! The Jinja source of a text: literal words and variables, in the subset that [`super`] names.
//!
//! In: literal words, and names of variables. Out: source that renders to them. A `{` that Jinja could interpret is
//! escaped.

/// Writes Jinja source.
#[derive(Default)]
pub struct Jinja {
    text: String,
    /// Whether a literal `{` is pending until the next character is known.
    has_brace: bool,
}

impl Jinja {
    /// Writes literal words.
    pub fn literal(&mut self, literal: &str) {
        for character in literal.chars() {
            self.settle(matches!(character, '{' | '%' | '#'));
            if character == '{' {
                self.has_brace = true;
            } else {
                self.text.push(character);
            }
        }
    }

    /// Writes a variable.
    pub fn variable(&mut self, path: &str) {
        self.settle(true);
        self.text.push_str(&placeholder(path));
    }

    /// Writes a pending brace, escaped if Jinja would join it with the next character.
    fn settle(&mut self, would_join: bool) {
        if std::mem::take(&mut self.has_brace) {
            self.text
                .push_str(if would_join { "{{ \"{\" }}" } else { "{" });
        }
    }

    /// Returns the source.
    pub fn finish(mut self) -> String {
        self.settle(false);
        self.text
    }
}

/// Returns how a variable is written.
pub fn placeholder(variable: &str) -> String {
    format!("{{{{ {variable} }}}}")
}

/// Escapes words so that they render to themselves anywhere in a template.
pub fn escaped(words: &str) -> String {
    let mut jinja = Jinja::default();
    jinja.literal(words);
    jinja.settle(true);
    jinja.text
}
