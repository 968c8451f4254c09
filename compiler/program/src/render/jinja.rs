//! The Jinja source of a text: literal words and variables, in the subset that [`super`] names.
//!
//! In: words as they are to appear, and names of variables. Out: source that renders to them, a `{` that Jinja could
//! take for its own being escaped.

/// Writes Jinja source.
#[derive(Default)]
pub struct Jinja {
    text: String,
    /// Whether a literal `{` waits to learn what follows it.
    has_brace: bool,
}

impl Jinja {
    /// Writes words as they are to appear.
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

    /// Writes a place that a value goes to.
    pub fn variable(&mut self, path: &str) {
        self.settle(true);
        self.text.push_str(&placeholder(path));
    }

    /// Writes a waiting brace, escaped where Jinja would join it with what follows.
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

/// Escapes words so that they render to themselves in any place of a template.
pub fn escaped(words: &str) -> String {
    let mut jinja = Jinja::default();
    jinja.literal(words);
    jinja.settle(true);
    jinja.text
}
