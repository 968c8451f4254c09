//! Looks at a file of keys without taking any: whether it is safe, and which names are in it.
//!
//! In: the path of a TOML file of lines `NAME = "KEY"`. Out: the names. No message repeats anything of the file but
//! names. Taking a key is left to the models that send it.

use crate::bounded;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// The longest file of keys, bytes.
const MAX_BYTES: u64 = 1 << 16;

/// Why a file of keys cannot be used.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum KeyFileError {
    /// It cannot be read.
    #[error("cannot read the keys in `{path}`: {why}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        why: String,
    },
    /// Others can read it.
    #[error("`{path}` holds keys, and others can read it: chmod 600 '{path}'")]
    NotPrivate {
        /// The file.
        path: PathBuf,
    },
    /// It is no list of keys.
    #[error("line {line} of `{path}` is not of the form NAME = \"KEY\"")]
    Shape {
        /// The file.
        path: PathBuf,
        /// The first line that is wrong, from 1.
        line: usize,
    },
}

/// Returns the names in a file of keys, in alphabetical order.
pub fn names(path: &Path) -> Result<Vec<String>, KeyFileError> {
    let unreadable = |why: String| KeyFileError::Unreadable {
        path: path.to_owned(),
        why,
    };
    let bytes = bounded::read(path, MAX_BYTES).map_err(unreadable)?;
    if !is_private(path).map_err(|error| unreadable(error.to_string()))? {
        return Err(KeyFileError::NotPrivate {
            path: path.to_owned(),
        });
    }
    let text =
        String::from_utf8(bytes).map_err(|_| unreadable("it is no UTF-8 text".to_owned()))?;
    // The reader's own message would show the line, and the key in it.
    let shape = |start: usize| KeyFileError::Shape {
        path: path.to_owned(),
        line: text
            .bytes()
            .take(start)
            .filter(|byte| *byte == b'\n')
            .count()
            + 1,
    };
    let table: Table =
        toml::from_str(&text).map_err(|error| shape(error.span().map_or(0, |span| span.start)))?;
    let mut names = Vec::with_capacity(table.len());
    for (name, value) in table {
        if !matches!(value, Value::String(_)) {
            return Err(shape(text.find(&name).unwrap_or(0)));
        }
        names.push(name);
    }
    Ok(names)
}

#[cfg(unix)]
fn is_private(path: &Path) -> std::io::Result<bool> {
    use std::os::unix::fs::PermissionsExt;
    Ok(std::fs::metadata(path)?.permissions().mode() & 0o077 == 0)
}

#[cfg(not(unix))]
fn is_private(_: &Path) -> std::io::Result<bool> {
    Ok(true)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    fn look(text: &str, mode: u32) -> Result<Vec<String>, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("keys.toml");
        fs::write(&path, text).expect("it can be written");
        fs::set_permissions(&path, fs::Permissions::from_mode(mode)).expect("it is ours");
        names(&path).map_err(|error| {
            error
                .to_string()
                .replace(&path.display().to_string(), "FILE")
        })
    }

    #[test]
    fn names_are_told_and_keys_are_not() {
        let text = "# mine\nOPENAI_API_KEY = \"sk-canary\"\nGEMINI_API_KEY = \"canary\"\n";
        assert_eq!(
            look(text, 0o600),
            Ok(vec![
                "GEMINI_API_KEY".to_owned(),
                "OPENAI_API_KEY".to_owned()
            ])
        );
    }

    #[test]
    fn a_file_that_others_can_read_is_refused_with_the_command_that_helps() {
        for mode in [0o644, 0o640, 0o604, 0o610] {
            let error = look("A = \"canary\"", mode).expect_err("it is open");
            assert_eq!(
                error,
                "`FILE` holds keys, and others can read it: chmod 600 'FILE'"
            );
        }
    }

    #[test]
    fn no_fault_of_the_file_shows_a_key() {
        for (text, line) in [
            ("A = sk-canary", 1),
            ("A = \"a\"\nB = \"sk-canary", 2),
            ("A = \"a\"\n\nB = [\"sk-canary\"]", 3),
            ("A = \"sk-canary\"\nA = \"sk-canary\"", 2),
            ("sk-canary", 1),
        ] {
            let error = look(text, 0o600).expect_err(text);
            assert_eq!(
                error,
                format!("line {line} of `FILE` is not of the form NAME = \"KEY\"")
            );
        }
        assert!(look(&"#".repeat(70_000), 0o600).is_err());
    }
}
