//! Texts that know where each stretch of them comes from.
//!
//! In: a template with its values, and its rendered text. Out: the same text as a [`PromptText`], which gives the
//! component, the file and the line of every stretch. Nothing is rendered here. The stretches are matched against the
//! rendered text; if the two differ, the whole template counts as one stretch.

use crate::data::stage::{LiteralText, Template};
use std::collections::BTreeMap;
use std::ops::Range;

/// The source of words that are in no file.
pub const FABC: &str = "fabc";

/// A text, and where it comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PromptText {
    /// The text.
    pub text: String,
    /// Its stretches, in order and without overlap. A separator between two texts belongs to none of them.
    pub stretches: Vec<Stretch>,
}

/// A piece of a text: words of one line of a file, or a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stretch {
    /// Its bytes in the text.
    pub bytes: Range<usize>,
    /// Where it comes from.
    pub origin: Origin,
}

/// Where a stretch of a text comes from.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Origin {
    /// The name of a template, `example 2`, `demonstration 3`, or [`FABC`].
    pub source: String,
    /// The variable of a value; `None` for words in the file.
    pub value: Option<String>,
    /// Where it is declared; `None` for [`FABC`].
    pub place: Option<Place>,
}

/// A line of a file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// The file, as in [`crate::data::files::SourceStamp::name`].
    pub file: String,
    /// The line, from 1.
    pub line: u32,
}

impl PromptText {
    /// Makes a text that `fabc` itself adds.
    pub fn by_fabc(text: impl Into<String>) -> PromptText {
        let origin = Origin {
            source: FABC.to_owned(),
            value: None,
            place: None,
        };
        PromptText::of(text, origin)
    }

    /// Makes a text of one stretch.
    pub fn of(text: impl Into<String>, origin: Origin) -> PromptText {
        let text = text.into();
        let bytes = 0..text.len();
        let stretches = vec![Stretch { bytes, origin }];
        PromptText { text, stretches }
    }

    /// Makes a text from words in a file, with a stretch for each line.
    pub fn literal(words: &LiteralText, source: &str) -> PromptText {
        let mut said = PromptText::default();
        for (line, number) in words.text.split_inclusive('\n').zip(words.line..) {
            let origin = Origin {
                source: source.to_owned(),
                value: None,
                place: Some(Place {
                    file: words.declared_in.clone(),
                    line: number,
                }),
            };
            said.put(line, origin);
        }
        said
    }

    /// Appends another text after the separator `between`, which has no source.
    pub fn push(&mut self, between: &str, more: PromptText) {
        self.text.push_str(between);
        let offset = self.text.len();
        self.text.push_str(&more.text);
        let moved = more.stretches.into_iter().map(|stretch| Stretch {
            bytes: stretch.bytes.start + offset..stretch.bytes.end + offset,
            origin: stretch.origin,
        });
        self.stretches.extend(moved);
    }

    /// Joins texts.
    pub(super) fn joined(texts: impl IntoIterator<Item = PromptText>, between: &str) -> PromptText {
        let mut texts = texts.into_iter();
        let mut all = texts.next().unwrap_or_default();
        for text in texts {
            all.push(between, text);
        }
        all
    }

    fn put(&mut self, text: &str, origin: Origin) {
        if text.is_empty() {
            return;
        }
        let start = self.text.len();
        self.text.push_str(text);
        let bytes = start..self.text.len();
        self.stretches.push(Stretch { bytes, origin });
    }
}

/// Matches the lines and values of a template against its rendered text.
pub(super) fn laid_over(
    template: &Template,
    values: &BTreeMap<String, String>,
    rendered: String,
) -> PromptText {
    match pieced(template, values) {
        Some(said) if said.text == rendered => said,
        _ => PromptText::of(rendered, origin(template, template.line, None)),
    }
}

/// Fills a template in the form that the compiler emits; `None` for any other form.
fn pieced(template: &Template, values: &BTreeMap<String, String>) -> Option<PromptText> {
    let mut said = PromptText::default();
    let mut line = template.line;
    let mut rest = template.text.as_str();
    while !rest.is_empty() {
        let (words, behind) = rest.split_at(rest.find("{{ ").unwrap_or(rest.len()));
        for words in words.split_inclusive('\n') {
            said.put(words, origin(template, line, None));
            line += u32::from(words.ends_with('\n'));
        }
        rest = behind;
        if let Some(inner) = behind.strip_prefix("{{ ") {
            let (variable, behind) = inner.split_once(" }}")?;
            match variable {
                "\"{\"" => said.put("{", origin(template, line, None)),
                _ => said.put(
                    values.get(variable)?,
                    origin(template, line, Some(variable)),
                ),
            }
            rest = behind;
        }
    }
    Some(said)
}

fn origin(template: &Template, line: u32, value: Option<&str>) -> Origin {
    Origin {
        source: template.name.clone(),
        value: value.map(str::to_owned),
        place: Some(Place {
            file: template.declared_in.clone(),
            line,
        }),
    }
}

#[cfg(test)]
mod tests;
