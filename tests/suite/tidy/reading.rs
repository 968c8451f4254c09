//! Reads the tree for the tidy rules: text files, a manifest's dependencies, code without comments and strings.
//!
//! In: the package's root on disk, or the text of one file. Out: plain lists with line numbers from 1. It understands
//! only as much TOML and Rust as the rules need, and judges nothing.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// A name that a rule reserves.
#[derive(Clone, Copy)]
pub enum Name {
    /// The word anywhere in code.
    Word(&'static str),
    /// The word as the first part of a path or in an import; a child module may have the same name.
    Crate(&'static str),
}

/// One text file: its path from the root, separated by `/`, and its text.
pub struct TextFile {
    pub path: String,
    pub text: String,
}

/// Pairs each line with its number, from 1.
pub fn numbered(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line))
}

/// One dependency of a manifest.
pub struct Dependency {
    pub name: String,
    /// The package's name if it differs from `name`.
    package: Option<String>,
    pub line: usize,
    pub has_reason: bool,
    pub purpose: Purpose,
    /// Whether it has only a path, so that cargo leaves it out of the published manifest.
    pub by_path_alone: bool,
}

/// The purpose of a dependency.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    Build,
    Tests,
}

impl Dependency {
    /// Returns the package's name, even if it is imported under another one.
    pub fn package(&self) -> &str {
        self.package.as_ref().unwrap_or(&self.name)
    }
}

/// Lists a manifest's dependencies of every kind and platform.
///
/// The workspace's own table only sets versions; the members that use a dependency give the reasons.
pub fn dependencies(manifest: &str) -> Vec<Dependency> {
    let mut found: Vec<Dependency> = Vec::new();
    let (mut in_list, mut in_table, mut comment_above) = (false, false, false);
    let mut purpose = Purpose::Build;
    for (line, content) in numbered(manifest) {
        let hash = content.match_indices('#').map(|(at, _)| at);
        let hash = hash
            .into_iter()
            .find(|at| content[..*at].matches('"').count() % 2 == 0);
        let (toml, comment) = content.split_at(hash.unwrap_or(content.len()));
        let (toml, has_comment) = (toml.trim(), comment.contains(char::is_alphabetic));
        let header = toml
            .strip_prefix('[')
            .and_then(|rest| rest.strip_suffix(']'));
        let value_of = |key: &str| {
            let (_, rest) = toml.split_once(key)?;
            rest.trim_start()
                .strip_prefix('=')?
                .split('"')
                .nth(1)
                .map(String::from)
        };
        let mut name = None;
        if let Some(header) = header.filter(|header| !header.contains('"')) {
            let kind_end = header
                .rfind("dependencies")
                .map(|at| at + "dependencies".len());
            let rest = kind_end
                .filter(|_| !header.starts_with("workspace"))
                .map(|end| &header[end..]);
            in_list = rest == Some("");
            purpose = match header.contains("dev-dependencies") {
                true => Purpose::Tests,
                false => Purpose::Build,
            };
            name = rest.and_then(|rest| rest.strip_prefix('.'));
            in_table = name.is_some();
        } else if in_list && toml.starts_with(|first: char| first.is_alphanumeric()) {
            name = toml.split(['=', '.', ' ']).next();
        } else if let Some(table) = found
            .last_mut()
            .filter(|_| in_table && toml.starts_with("package"))
        {
            table.package = value_of("package");
        }
        if let Some(name) = name {
            let has_reason = has_comment || comment_above;
            found.push(Dependency {
                name: name.into(),
                package: value_of("package"),
                line,
                has_reason,
                purpose,
                by_path_alone: toml.contains("path =")
                    && !toml.contains("version")
                    && !toml.contains("workspace"),
            });
        }
        comment_above = toml.is_empty() && has_comment;
    }
    found
}

/// Lists the packages that a package depends on according to Cargo.lock, sorted by name, without itself and without
/// paths through `left_out`.
///
/// A lock file does not separate tests from builds, so the list may hold more than a build needs.
pub fn reached(lock: &str, package: &str, left_out: &[&str]) -> Vec<String> {
    let mut found = BTreeSet::new();
    let mut pending = vec![package.to_owned()];
    while let Some(name) = pending.pop() {
        let header = format!("name = \"{name}\"\n");
        for entry in lock
            .split("[[package]]\n")
            .filter(|it| it.starts_with(&header))
        {
            let (_, list) = entry.split_once("dependencies = [").unwrap_or_default();
            let (list, _) = list.split_once(']').unwrap_or_default();
            for other in list.split('"').skip(1).step_by(2) {
                // `"name version"` if several versions are locked.
                let other = other.split(' ').next().unwrap_or_default();
                if !left_out.contains(&other) && found.insert(other.to_owned()) {
                    pending.push(other.to_owned());
                }
            }
        }
    }
    found.into_iter().collect()
}

/// Returns whether a line of code uses a name in the reserved sense.
pub fn names(code: &str, name: Name) -> bool {
    let (Name::Word(word) | Name::Crate(word)) = name;
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
    code.match_indices(word).any(|(at, _)| {
        let (before, after) = (&code[..at], &code[at + word.len()..]);
        if before.ends_with(is_part) || after.starts_with(is_part) {
            return false;
        }
        let Name::Crate(_) = name else { return true };
        let inside_a_path = before
            .strip_suffix("::")
            .is_some_and(|path| path.ends_with(is_part));
        let imported = before.ends_with("use ") || before.ends_with("extern crate ");
        !inside_a_path && (imported || after.trim_start().starts_with("::"))
    })
}

/// Replaces comments and the contents of strings and characters by blanks; line numbers stay the same.
pub fn code_only(source: &str) -> String {
    let letters: Vec<char> = source.chars().collect();
    let starts = |at: usize, pattern: &str| {
        pattern
            .chars()
            .enumerate()
            .all(|(offset, letter)| letters.get(at + offset) == Some(&letter))
    };
    let mut code = String::new();
    let mut at = 0;
    while at < letters.len() {
        let raw_marks = letters[at + 1..]
            .iter()
            .take_while(|mark| **mark == '#')
            .count();
        let is_raw = letters[at] == 'r' && letters.get(at + 1 + raw_marks) == Some(&'"');
        let end = if starts(at, "//") {
            (at..letters.len()).find(|end| letters[*end] == '\n')
        } else if starts(at, "/*") {
            (at + 2..letters.len())
                .find(|end| starts(*end, "*/"))
                .map(|end| end + 2)
        } else if is_raw {
            let close = format!("\"{}", "#".repeat(raw_marks));
            let body = at + raw_marks + 2;
            (body..letters.len())
                .find(|end| starts(*end, &close))
                .map(|end| end + close.len())
        } else if letters[at] == '"'
            || starts(at, "'\\")
            || (letters[at] == '\'' && letters.get(at + 2) == Some(&'\''))
        {
            let mut end = at + 1;
            while end < letters.len() && letters[end] != letters[at] {
                end += if letters[end] == '\\' { 2 } else { 1 };
            }
            Some(end + 1)
        } else {
            code.push(letters[at]);
            at += 1;
            continue;
        };
        let end = end.unwrap_or(letters.len()).min(letters.len());
        code.push(' ');
        code.extend(letters[at..end].iter().filter(|letter| **letter == '\n'));
        at = end;
    }
    code
}

/// Reads every text file under the root, sorted by path, except build output and run folders.
pub fn tree() -> Vec<TextFile> {
    let mut files = Vec::new();
    read_folder(Path::new(env!("CARGO_MANIFEST_DIR")), "", &mut files);
    assert!(
        files.iter().any(|file| file.path == "Cargo.toml"),
        "the root's own files are there"
    );
    files
}

fn read_folder(folder: &Path, prefix: &str, files: &mut Vec<TextFile>) {
    let entries = fs::read_dir(folder).expect("a folder of the tree can be read");
    let mut names: Vec<String> = entries
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect();
    names.sort();
    for name in names {
        let (full, path) = (folder.join(&name), format!("{prefix}{name}"));
        if full.is_dir() {
            let generated =
                name.starts_with("target") || [".git", "runs", "node_modules"].contains(&&*name);
            if !generated && !full.is_symlink() {
                read_folder(&full, &format!("{path}/"), files);
            }
        } else if is_text(&path) {
            // A file in another encoding, such as a fixture of a damaged file, is not our text.
            if let Ok(text) = fs::read_to_string(&full) {
                files.push(TextFile { path, text });
            }
        }
    }
}

fn is_text(path: &str) -> bool {
    const KINDS: [&str; 14] = [
        "rs",
        "toml",
        "md",
        "fab",
        "sh",
        "pest",
        "py",
        "txt",
        "json",
        "yml",
        "snap",
        "Makefile",
        ".ci/run",
        "Cargo.lock",
    ];
    KINDS
        .iter()
        .any(|kind| path == *kind || path.rsplit('.').next() == Some(kind))
}
