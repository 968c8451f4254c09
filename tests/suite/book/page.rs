//! Parses the pages of the book into blocks.
//!
//! In: Markdown. Out: [`Page`]s with their fenced blocks in order. Callers decide what a block means; the command's own
//! tests read the same blocks, to parse each line that calls it.

use std::fs;
use std::path::{Path, PathBuf};

/// The pages outside `docs/`.
const BESIDE_THE_BOOK: [&str; 2] = ["README.md", "ARCHITECTURE.md"];

/// One page.
pub struct Page {
    /// Path from the project's root, with `/`.
    pub path: String,
    pub text: String,
    pub blocks: Vec<Block>,
}

/// A fenced block.
#[derive(Clone, Debug)]
pub struct Block {
    /// The text after the opening fence.
    pub info: String,
    pub text: String,
    /// The line of the opening fence, from 1.
    pub line: usize,
}

/// A command in a console block, and the output that the page shows.
#[derive(Debug, PartialEq, Eq)]
pub struct Step {
    /// The lines as on the page, including prompts and continuations.
    pub shown: String,
    pub command: String,
    pub output: String,
    pub code: i32,
}

impl Page {
    /// Parses a page; an error names the line of an unclosed fence.
    pub fn read(path: &str, text: String) -> Result<Page, String> {
        let mut blocks = Vec::new();
        let mut open: Option<(Block, &str)> = None;
        for (index, line) in text.lines().enumerate() {
            let number = index + 1;
            match &mut open {
                Some((block, fence)) if line.trim_end() == *fence => {
                    blocks.push(block.clone());
                    open = None;
                }
                Some((block, _)) => {
                    block.text.push_str(line);
                    block.text.push('\n');
                }
                None => {
                    let info = line.trim_start_matches('`');
                    let fence = &line[..line.len() - info.len()];
                    if fence.len() >= 3 {
                        let block = Block {
                            info: info.trim().to_owned(),
                            text: String::new(),
                            line: number,
                        };
                        open = Some((block, fence));
                    } else if line.trim_start().starts_with("```") {
                        return Err(format!("{path}:{number}: a fence begins its line"));
                    }
                }
            }
        }
        match open {
            Some((block, _)) => Err(format!("{path}:{}: the block has no end", block.line)),
            None => Ok(Page {
                path: path.to_owned(),
                text,
                blocks,
            }),
        }
    }

    /// Returns the text with some blocks replaced.
    pub fn with(&self, changes: &[(Block, String)]) -> String {
        let mut lines = self.text.lines().enumerate();
        let mut text = String::new();
        while let Some((index, line)) = lines.next() {
            text.push_str(&format!("{line}\n"));
            let change = changes.iter().find(|(block, _)| block.line == index + 1);
            if let Some((block, changed)) = change {
                text.push_str(changed);
                for _ in block.text.lines() {
                    lines.next();
                }
            }
        }
        text
    }

    /// Returns the values of a comment `<!-- NAME: VALUES -->`.
    pub fn stated(&self, name: &str) -> Vec<String> {
        let opening = format!("<!-- {name}: ");
        let stated = self.text.lines().filter_map(|line| {
            let values = line.strip_prefix(&opening)?;
            values.strip_suffix(" -->")
        });
        stated
            .flat_map(|values| values.split(", ").map(str::to_owned))
            .collect()
    }
}

impl Block {
    /// Returns the first word of the info string, the language.
    pub fn language(&self) -> &str {
        self.info.split(' ').next().unwrap_or_default()
    }

    /// Returns the info string after the language.
    pub fn rest(&self) -> &str {
        self.info.split_once(' ').map_or("", |(_, rest)| rest)
    }

    /// Parses a console block; an error names the line that is out of place.
    pub fn steps(&self) -> Result<Vec<Step>, String> {
        let mut steps: Vec<Step> = Vec::new();
        let mut continues = false;
        for (index, line) in self.text.lines().enumerate() {
            let command = line.strip_prefix("$ ");
            let continued = line.strip_prefix("> ").filter(|_| continues);
            match (command, continued, steps.last_mut()) {
                (Some(command), _, _) => steps.push(Step {
                    shown: format!("{line}\n"),
                    command: command.to_owned(),
                    output: String::new(),
                    code: 0,
                }),
                (None, Some(more), Some(step)) => {
                    step.shown.push_str(&format!("{line}\n"));
                    step.command = format!("{}{more}", step.command.trim_end_matches('\\'));
                }
                (None, None, Some(step)) => {
                    if let Some(code) = line.strip_prefix("? ") {
                        step.code = code
                            .parse()
                            .map_err(|_| format!("line {}: no exit code", self.line + index + 1))?;
                    } else {
                        step.output.push_str(line);
                        step.output.push('\n');
                    }
                }
                (None, _, None) => {
                    return Err(format!(
                        "line {}: a console block begins with `$ `",
                        self.line + index + 1
                    ));
                }
            }
            continues = (command.is_some() || continued.is_some()) && line.ends_with('\\');
        }
        Ok(steps)
    }
}

/// Returns every page of a project: those of `docs/`, sorted by name, and those outside it.
pub fn pages(root: &Path) -> Vec<Page> {
    let mut paths: Vec<PathBuf> = BESIDE_THE_BOOK.iter().map(PathBuf::from).collect();
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        let entries = fs::read_dir(root.join(&folder)).expect("a folder of the book can be read");
        for entry in entries.flatten() {
            let path = folder.join(entry.file_name());
            if root.join(&path).is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                paths.push(path);
            }
        }
    }
    paths.sort();
    let read = |path: &PathBuf| {
        let name = path.to_str().expect("names are UTF-8").replace('\\', "/");
        let text = fs::read_to_string(root.join(path)).expect("a page is UTF-8 text");
        Page::read(&name, text).unwrap_or_else(|wrong| panic!("{wrong}"))
    };
    paths.iter().map(read).collect()
}
