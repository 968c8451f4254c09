//! The text of a stage, as lines with their origins.
//!
//! In: a stage's messages, whose texts record their origins. Out: the lines that `fabc render` prints and `fabc snap`
//! pins, the same for both.

use super::corrections_of;
use fab_program::render::{Origin, PromptText, RenderError, Values};
use fab_program::{Program, Stage};

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

/// Returns the messages of a stage for display; the authoring tool draws no pictures, and reads no demonstrations.
#[cfg(not(feature = "runtime"))]
pub fn messages(
    program: &Program,
    stage: &Stage,
    values: Values<'_>,
    step: u32,
) -> Result<Vec<DisplayMessage>, RenderError> {
    use fab_program::render::{self, PromptSpeaker};
    let messages = render::messages(program, stage, values)?.into_iter();
    let displayed = messages.map(|message| {
        let pictures = message.pictures.iter().map(|picture| DisplayPart::Picture {
            title: super::title(picture, step),
            png: None,
        });
        DisplayMessage {
            role: match message.speaker {
                PromptSpeaker::System => "system",
                PromptSpeaker::User => "user",
                PromptSpeaker::Assistant => "assistant",
            },
            parts: std::iter::once(DisplayPart::Text(message.content))
                .chain(pictures)
                .collect(),
        }
    });
    Ok(displayed.collect())
}

impl ShownStage {
    /// Makes a stage of its first question.
    pub fn of(
        program: &Program,
        stage: &Stage,
        values: Values<'_>,
        messages: Vec<DisplayMessage>,
    ) -> Result<ShownStage, RenderError> {
        Ok(ShownStage {
            name: stage.name.clone(),
            n_asked_first: messages.len(),
            messages,
            corrections: corrections_of(program, stage, values)?,
            findings: Vec::new(),
            results: Vec::new(),
        })
    }

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
mod tests;
