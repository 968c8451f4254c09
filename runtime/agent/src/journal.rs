//! The folder of one rollout: enough to re-score and re-draw it without a world or a model.
//!
//! In: facts as they happen. Out: `rollout.jsonl` (one whole, synced line per step, so a crash loses at most the
//! current step) and the files that its lines name. A journal without an `end` line belongs to a rollout that did not
//! finish. The same rollout always writes the same bytes; durations and costs, which differ, are in `spent.jsonl`. So
//! an interrupted rollout is resumed by repeating it: lines that already exist are compared instead of written.

use crate::error::RunError;
use crate::policy::Question;
use crate::record::{Line, MAX_BYTES, RECORD_FILE, SPENT_FILE, SentFiles, Spent};
use fab_base::difference;
use fab_base::files;
use fab_base::jsonl::{self, Appender, Reader};
use fab_model::{Part, Request, Speaker};
use serde_json::Value;
use std::collections::VecDeque;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A run folder being written.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    journal: Appender,
    spent: Appender,
    /// The lines of an earlier part of the rollout that have not been repeated yet, oldest first.
    earlier: VecDeque<String>,
}

/// Writes a file atomically, and its folder if that is missing.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    let folder = path.parent().unwrap_or(path);
    let written = fs::create_dir_all(folder).and_then(|()| files::write_whole(path, bytes));
    written.map_err(|error| RunError::unwritable(path, error))
}

impl RunFolder {
    /// Makes a folder for one rollout; it must not exist or be empty.
    pub fn create(path: &Path) -> Result<RunFolder, RunError> {
        let entries = fs::create_dir_all(path).and_then(|()| fs::read_dir(path));
        let mut entries = entries.map_err(|error| RunError::unwritable(path, error))?;
        if entries.next().is_some() {
            return Err(RunError::Failed(format!(
                "the run folder `{}` is not empty; name a new one, nothing is overwritten",
                path.display()
            )));
        }
        let file = path.join(RECORD_FILE);
        let journal = Appender::open(&file);
        let journal = journal.map_err(|error| RunError::unwritable(&file, error))?;
        RunFolder::locked(path, journal)
    }

    /// Opens the folder of an interrupted rollout, to resume it.
    ///
    /// Nothing in it changes until a new line is appended.
    pub fn reopen(path: &Path) -> Result<RunFolder, RunError> {
        let file = path.join(RECORD_FILE);
        // `Appender::open` would create a missing file.
        let journal = fs::metadata(&file).and_then(|_| Appender::open(&file));
        let unreadable = |why| unreadable(&file, why);
        let journal = journal.map_err(|error| unreadable(error.to_string()))?;
        let mut folder = RunFolder::locked(path, journal)?;
        let (earlier, bytes) = earlier_lines(&file).map_err(unreadable)?;
        folder.earlier = earlier;
        folder.journal.keep(bytes);
        Ok(folder)
    }

    /// Makes sure that no other process writes the journal, and opens the file beside it.
    fn locked(path: &Path, journal: Appender) -> Result<RunFolder, RunError> {
        if !journal.lock() {
            return Err(RunError::Failed(format!(
                "another fabc is writing into the run folder `{}`",
                path.display()
            )));
        }
        let file = path.join(SPENT_FILE);
        let spent = Appender::open_after_whole_lines(&file, MAX_BYTES);
        Ok(RunFolder {
            path: path.to_owned(),
            journal,
            spent: spent.map_err(|why| unreadable(&file, why))?,
            earlier: VecDeque::new(),
        })
    }

    /// Returns whether the next line already exists.
    pub fn repeats(&self) -> bool {
        !self.earlier.is_empty()
    }

    /// Returns how many steps of an earlier part of the rollout are to be repeated.
    pub fn earlier_steps(&self) -> u32 {
        self.earlier.len().saturating_sub(1) as u32
    }

    /// Makes the first free folder `NAME-0001`, `NAME-0002`, … in `parent`.
    pub fn create_next(parent: &Path, name: &str) -> Result<RunFolder, RunError> {
        let folder = files::next_folder(parent, name)
            .map_err(|error| RunError::unwritable(parent, error))?;
        RunFolder::create(&folder)
    }

    /// Returns the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Appends one line and waits until it is on disk.
    ///
    /// If the line already exists it must be the same, and stays. The first new line replaces everything after the
    /// existing ones.
    pub fn append(&mut self, line: &Line) -> Result<(), RunError> {
        let text = jsonl::text(line).expect("journal lines have string keys");
        if let Some(known) = self.earlier.pop_front() {
            return if known == text {
                Ok(())
            } else {
                let (path, why) = (self.path.display(), difference(&known, &text));
                Err(RunError::Failed(format!(
                    "the rollout in `{path}` cannot be resumed, because it does not repeat identically: {why}"
                )))
            };
        }
        let written = self.journal.append_text(text);
        written.map_err(|error| self.unwritable(RECORD_FILE, error))
    }

    /// Adds a line to the rollout's durations and costs.
    pub fn spend(&mut self, line: &Spent) -> Result<(), RunError> {
        let written = self.spent.append(line);
        written.map_err(|error| self.unwritable(SPENT_FILE, error))
    }

    /// Writes a file of the run atomically, and returns its name for the journal.
    pub fn keep(&self, name: &str, bytes: &[u8]) -> Result<String, RunError> {
        write(&self.path.join(name), bytes)?;
        Ok(name.to_owned())
    }

    /// Writes a question of an action exactly as it is sent, and returns its files.
    ///
    /// In a step that is repeated they exist, and stay as they are.
    pub fn keep_question(
        &self,
        action: u32,
        of: (&str, u32),
        question: &Question,
    ) -> Result<SentFiles, RunError> {
        let stem = stem(action, of);
        let sent = format!("{stem}.request.json");
        let prompt = format!("{stem}.prompt.txt");
        if !self.repeats() {
            let text = match question {
                Question::Line { text, .. } => text.clone().into_bytes(),
                Question::Prompt(request) => {
                    for part in request.messages.iter().flat_map(|message| &message.parts) {
                        let Part::Image(png) = part else { continue };
                        let name = image_name(png.sha256());
                        // Files are written whole, so one that is there is complete.
                        if !self.path.join(&name).exists() {
                            self.keep(&name, png.bytes())?;
                        }
                    }
                    self.keep(&prompt, transcript(request).as_bytes())?;
                    serde_json::to_vec_pretty(request)
                        .expect("a request holds strings and finite numbers")
                }
            };
            self.keep(&sent, &text)?;
        }
        Ok(SentFiles {
            request_key: Some(question.key()),
            request: Some(sent),
            prompt: matches!(question, Question::Prompt(_)).then_some(prompt),
        })
    }

    /// Writes the exact reply to a question of an action, and returns its name.
    pub fn keep_reply(&self, action: u32, of: (&str, u32), text: &str) -> Result<String, RunError> {
        let file = format!("{}.reply.txt", stem(action, of));
        self.keep(&file, text.as_bytes())
    }

    fn unwritable(&self, name: &str, error: io::Error) -> RunError {
        RunError::unwritable(&self.path.join(name), error)
    }
}

fn unreadable(path: &Path, why: String) -> RunError {
    RunError::Failed(format!("cannot read `{}`: {why}", path.display()))
}

/// Returns what the names of a question's files begin with.
fn stem(action: u32, (stage, attempt): (&str, u32)) -> String {
    format!("step_{action}/{stage}_{attempt}")
}

fn image_name(sha256: &str) -> String {
    format!("images/{sha256}.png")
}

/// Writes a request in readable form: who speaks, the words, and the pictures by file name.
fn transcript(request: &Request) -> String {
    let mut text = String::new();
    for message in &request.messages {
        let speaker = match message.speaker {
            Speaker::System => "system",
            Speaker::User => "user",
            Speaker::Assistant => "assistant",
        };
        text.push_str(&format!("--- {speaker}\n"));
        for part in &message.parts {
            match part {
                Part::Text(words) => text.push_str(words),
                Part::Image(png) => {
                    text.push_str(&format!("[picture {}]", image_name(png.sha256())))
                }
            }
            text.push('\n');
        }
    }
    text
}

/// Reads the whole lines of an earlier part of the same rollout up to the point of resuming, and how many bytes they take:
/// the header, and every step that was taken. The rest (a step that ended the rollout, its end, a torn line) is written
/// again.
///
/// Fails for a line of JSON that this program does not write: it belongs to another version, and must not be overwritten.
fn earlier_lines(path: &Path) -> Result<(VecDeque<String>, u64), String> {
    let mut reader = Reader::open(path, MAX_BYTES)?;
    let (mut lines, mut bytes) = (VecDeque::new(), 0);
    while let Some(line) = reader.next_line()? {
        let text = String::from_utf8_lossy(line).into_owned();
        match serde_json::from_str(&text) {
            Ok(Line::Header(_)) if lines.is_empty() => {}
            Ok(Line::Step(step)) if !lines.is_empty() && step.stopped.is_none() => {}
            Err(error) if error.is_data() => {
                let number = lines.len() + 1;
                return Err(format!(
                    "line {number} is not as this version of fabc writes it: {error}"
                ));
            }
            _ => break,
        }
        lines.push_back(text);
        bytes = reader.whole_bytes();
    }
    Ok((lines, bytes))
}

/// Names the field in which two lines differ.
fn difference(stored: &str, now: &str) -> String {
    let object = |line: &str| serde_json::from_str::<Value>(line).unwrap_or_default();
    let (stored, now) = (object(stored), object(now));
    let line = match stored["type"].as_str() {
        Some("step") => format!("step {}", stored["step"]),
        _ => "the first line".to_owned(),
    };
    match difference::first(&stored, &now) {
        Some(found) => format!("{line} differs in {found}"),
        // The same values may be written in another way by another version.
        None => format!("{line} is written differently"),
    }
}
