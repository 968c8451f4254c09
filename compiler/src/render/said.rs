//! Texts that know where each stretch of them comes from.
//!
//! In: a template with the values that fill it, and what it became. Out: the same text as a [`Said`], which names for
//! every stretch the component, the file and the line. Nothing is rendered here: the stretches are laid over what the
//! template engine gave, and where the two differ, the template counts as one stretch.

use crate::program::{Template, Words};
use std::collections::BTreeMap;
use std::ops::Range;

/// Who speaks the words that stand in no file.
pub const FABC: &str = "fabc";

/// A text, and where it comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Said {
    /// The text.
    pub text: String,
    /// Its stretches, in order, apart from each other; what stands between two texts is in none of them.
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
    /// What says it: the name of a template, `example 2`, `demonstration 3`, or [`FABC`].
    pub said_by: String,
    /// The variable that the value fills; none for words that stand in the file.
    pub value: Option<String>,
    /// Where it is declared; none for [`FABC`].
    pub place: Option<Place>,
}

/// A line of a file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// The file, as in [`crate::program::SourceStamp::name`].
    pub file: String,
    /// The line, from 1.
    pub line: u32,
}

impl Said {
    /// Makes a text that `fabc` itself says.
    pub fn by_fabc(text: impl Into<String>) -> Said {
        let origin = Origin {
            said_by: FABC.to_owned(),
            value: None,
            place: None,
        };
        Said::of(text, origin)
    }

    /// Makes a text of one stretch.
    pub fn of(text: impl Into<String>, origin: Origin) -> Said {
        let text = text.into();
        let bytes = 0..text.len();
        let stretches = vec![Stretch { bytes, origin }];
        Said { text, stretches }
    }

    /// Makes a text of words that stand in a file, a stretch for each line.
    pub fn words(words: &Words, said_by: &str) -> Said {
        let mut said = Said::default();
        for (line, number) in words.text.split_inclusive('\n').zip(words.line..) {
            let origin = Origin {
                said_by: said_by.to_owned(),
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

    /// Adds another text behind `between`, which nobody says.
    pub fn push(&mut self, between: &str, more: Said) {
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
    pub(super) fn joined(texts: impl IntoIterator<Item = Said>, between: &str) -> Said {
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

/// Lays the lines and values of a template over the text that it became.
pub(super) fn laid_over(
    template: &Template,
    values: &BTreeMap<String, String>,
    rendered: String,
) -> Said {
    match pieced(template, values) {
        Some(said) if said.text == rendered => said,
        _ => Said::of(rendered, origin(template, template.line, None)),
    }
}

/// Fills a template of the form that the compiler emits; None for one of another form.
fn pieced(template: &Template, values: &BTreeMap<String, String>) -> Option<Said> {
    let mut said = Said::default();
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
        said_by: template.name.clone(),
        value: value.map(str::to_owned),
        place: Some(Place {
            file: template.declared_in.clone(),
            line,
        }),
    }
}
