//! The text of a stage, as lines with their origins.
//!
//! In: a stage's messages, whose texts record their origins. Out: the lines that `fabc render` prints and `fabc snap`
//! pins, the same for both.

use fab_program::render::{Origin, PromptText};

/// One message for display.
pub struct DisplayMessage {
    /// Who speaks.
    pub role: &'static str,
    /// Its parts, in order.
    pub parts: Vec<DisplayPart>,
}

/// A part of a displayed message.
pub enum DisplayPart {
    /// Text.
    Text(PromptText),
    /// A picture.
    Picture {
        /// The picture's description.
        title: String,
        /// The PNG bytes, if requested and if this build can draw it.
        png: Option<Vec<u8>>,
    },
}

/// A stage for display.
pub struct ShownStage {
    /// Its name.
    pub name: String,
    /// Its messages, in order.
    pub messages: Vec<DisplayMessage>,
    /// How many of the messages make up the first question.
    pub n_asked_first: usize,
    /// What a model would be told after each check's rejection, by the check's name.
    pub corrections: Vec<(String, PromptText)>,
    /// The findings about the given answers, in words.
    pub findings: Vec<String>,
    /// The same as data, as a run records them.
    pub results: Vec<serde_json::Value>,
}

/// A line of a page.
pub struct Line {
    /// The line's text.
    pub text: String,
    /// Where its text comes from; `None` for headings, blank lines between texts, and pictures.
    pub origin: Option<Origin>,
    /// Values in it: the range of characters, from 0 and without its end, and the variable.
    pub values: Vec<(usize, usize, String)>,
}

impl ShownStage {
    /// Returns the lines of all messages, with a heading above each.
    pub fn lines(&self) -> Vec<Line> {
        let mut lines = Vec::new();
        for message in &self.messages {
            lines.push(Line::bare(format!("--- {}", message.role)));
            for part in &message.parts {
                match part {
                    DisplayPart::Text(said) => lines.extend(of_text(said)),
                    DisplayPart::Picture { title, .. } => {
                        lines.push(Line::bare(format!("[picture: {title}]")));
                    }
                }
            }
        }
        for (check, said) in &self.corrections {
            lines.push(Line::bare(format!("--- told where `{check}` refuses")));
            lines.extend(of_text(said));
        }
        lines
    }

    /// Returns the parts of the first question.
    pub fn first_question(&self) -> impl Iterator<Item = &DisplayPart> {
        let asked = self.messages.iter().take(self.n_asked_first);
        asked.flat_map(|message| &message.parts)
    }

    /// Returns the texts of the first question, without headings.
    pub fn texts(&self) -> impl Iterator<Item = &PromptText> {
        self.first_question().filter_map(|part| match part {
            DisplayPart::Text(said) => Some(said),
            DisplayPart::Picture { .. } => None,
        })
    }

    /// Returns the page as text.
    pub fn text(&self) -> String {
        let lines = self.lines().into_iter();
        lines.map(|line| line.text + "\n").collect()
    }
}

impl Line {
    fn bare(text: String) -> Line {
        Line {
            text,
            origin: None,
            values: Vec::new(),
        }
    }
}

/// Splits a text into lines.
fn of_text(said: &PromptText) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut start = 0;
    let mut next = 0;
    for text in said.text.split('\n') {
        let end = start + text.len();
        let mut line = Line::bare(text.to_owned());
        // Stretches are in order; one that continues in the next line is visited again there.
        while let Some(stretch) = said.stretches.get(next) {
            let bytes = &stretch.bytes;
            if bytes.start > end {
                break;
            }
            let from = bytes.start.max(start);
            let to = bytes.end.min(end);
            if from < to || bytes.end > end {
                line.origin.get_or_insert_with(|| stretch.origin.clone());
            }
            if let (Some(variable), true) = (&stretch.origin.value, from < to) {
                let characters = |range: &str| range.chars().count();
                let column = characters(&said.text[start..from]);
                let width = characters(&said.text[from..to]);
                line.values.push((column, column + width, variable.clone()));
            }
            if bytes.end > end + 1 {
                break;
            }
            next += 1;
        }
        lines.push(line);
        start = end + 1;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use fab_program::render::{Place, Stretch};

    fn origin(line: u32, value: Option<&str>) -> Origin {
        Origin {
            source: "role".to_owned(),
            value: value.map(str::to_owned),
            place: Some(Place {
                file: "a.fab".to_owned(),
                line,
            }),
        }
    }

    /// A text of consecutive stretches.
    fn said(pieces: &[(&str, u32, Option<&str>)]) -> PromptText {
        let mut said = PromptText::default();
        for (text, line, value) in pieces {
            let start = said.text.len();
            said.text.push_str(text);
            said.stretches.push(Stretch {
                bytes: start..said.text.len(),
                origin: origin(*line, *value),
            });
        }
        said
    }

    fn shown(said: &PromptText) -> Vec<(String, Option<u32>, usize)> {
        let line = |line: Line| {
            let place = line.origin.and_then(|origin| origin.place);
            (line.text, place.map(|place| place.line), line.values.len())
        };
        of_text(said).into_iter().map(line).collect()
    }

    #[test]
    fn a_line_knows_its_file_and_its_values() {
        let said = said(&[
            ("Corners: ", 3, None),
            ("(1, 2), (3, 4)", 3, Some("corners")),
            (".\n", 3, None),
            ("\n", 4, None),
            ("Go.", 5, None),
        ]);
        let expected = [
            ("Corners: (1, 2), (3, 4).".to_owned(), Some(3), 1),
            (String::new(), Some(4), 0),
            ("Go.".to_owned(), Some(5), 0),
        ];
        assert_eq!(shown(&said), expected);
        assert_eq!(of_text(&said)[0].values, [(9, 23, "corners".to_owned())]);
    }

    #[test]
    fn a_value_of_several_lines_belongs_to_the_line_that_shows_it() {
        let said = said(&[
            ("Answer:\n", 7, None),
            ("Pick = (x, y)\nPlace = (x, y)", 8, Some("format")),
            ("\n", 8, None),
            ("End", 9, None),
        ]);
        let expected = [
            ("Answer:".to_owned(), Some(7), 0),
            ("Pick = (x, y)".to_owned(), Some(8), 1),
            ("Place = (x, y)".to_owned(), Some(8), 1),
            ("End".to_owned(), Some(9), 0),
        ];
        assert_eq!(shown(&said), expected);
    }

    #[test]
    fn what_stands_between_two_texts_is_nobodys() {
        let mut both = said(&[("One", 1, None)]);
        both.push("\n\n", said(&[("Two", 5, None)]));
        let expected = [
            ("One".to_owned(), Some(1), 0),
            (String::new(), None, 0),
            ("Two".to_owned(), Some(5), 0),
        ];
        assert_eq!(shown(&both), expected);
    }
}
