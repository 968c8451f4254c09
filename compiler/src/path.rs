//! Paths in `use` and `image`: `/` between folders, relative to the file that contains them.

/// The longest path, bytes: messages and programs repeat it.
pub(crate) const MAX_BYTES: usize = 1024;

/// Resolves `path` relative to the folder of `file`: without `.`, and with `..` only at the front.
pub(crate) fn beside(file: &str, path: &str) -> String {
    let folder = file.rfind('/').map_or("", |at| &file[..at + 1]);
    normalised(&format!("{folder}{path}"))
}

/// Returns the last part of a path.
pub(crate) fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

fn normalised(path: &str) -> String {
    let root = if path.starts_with('/') { "/" } else { "" };
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => {
                parts.pop();
            }
            // Nothing is above the root.
            ".." if !root.is_empty() => {}
            part => parts.push(part),
        }
    }
    format!("{root}{}", parts.join("/"))
}

/// Returns what is wrong with a path's form, if anything.
pub(crate) fn fault(path: &str) -> Option<&'static str> {
    let has_drive = path.as_bytes().get(1) == Some(&b':');
    if path.trim().is_empty() {
        Some("is empty")
    } else if path.len() > MAX_BYTES {
        Some("is too long")
    } else if path.contains('\\') {
        Some("has a `\\`; folders are separated by `/`")
    } else if path.starts_with('/') || path.starts_with('~') || has_drive {
        Some("is absolute; write it relative to this file")
    } else {
        None
    }
}

/// Resolves `path` in `file`, both relative to the entry's folder; `None` if it leads out of that folder.
pub(crate) fn within(file: &str, path: &str) -> Option<String> {
    let path = beside(file, path);
    let leads_out = path == ".." || path.starts_with("../");
    (!leads_out).then_some(path)
}

/// Does the same as [`within`], and also accepts paths into the folder `lib` beside the entry's folder.
pub(crate) fn within_or_library(file: &str, path: &str) -> Option<String> {
    let path = beside(file, path);
    let is_library = path.starts_with("../lib/");
    let leads_out = path == ".." || path.starts_with("../");
    (is_library || !leads_out).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_relative_to_the_file_and_normalised() {
        assert_eq!(beside("tasks/a.fab", "lib/b.fab"), "tasks/lib/b.fab");
        assert_eq!(beside("tasks/lib/b.fab", "./../c.fab"), "tasks/c.fab");
        assert_eq!(beside("a.fab", "../../c.fab"), "../../c.fab");
        assert_eq!(beside("/x/a.fab", "../../c.fab"), "/c.fab");
        assert_eq!(beside("a.fab", "b//c.fab"), "b/c.fab");
    }

    #[test]
    fn no_path_leads_out_of_the_folder() {
        assert_eq!(within("a.fab", "lib/../b.fab"), Some("b.fab".to_owned()));
        assert_eq!(within("lib/a.fab", "../b.fab"), Some("b.fab".to_owned()));
        for path in ["../b.fab", "..", "lib/../../b.fab", "./.././b.fab"] {
            assert_eq!(within("a.fab", path), None, "{path}");
        }
        assert_eq!(within("lib/a.fab", "../../task/b.fab"), None);
        assert_eq!(within("a.fab", "../lib/b.fab"), None);
    }

    #[test]
    fn a_library_may_lie_beside_the_folder_and_nothing_else() {
        for (file, path) in [
            ("a.fab", "../lib/b.fab"),
            ("../lib/a.fab", "b.fab"),
            ("deep/a.fab", "../../lib/b.fab"),
        ] {
            assert_eq!(
                within_or_library(file, path),
                Some("../lib/b.fab".to_owned())
            );
        }
        assert_eq!(
            within_or_library("../lib/a.fab", "sub/b.fab"),
            Some("../lib/sub/b.fab".to_owned())
        );
        for (file, path) in [
            ("a.fab", "../b.fab"),
            ("a.fab", "../lib"),
            ("a.fab", "../library/b.fab"),
            ("a.fab", "../../lib/b.fab"),
            ("a.fab", "../lib/../b.fab"),
            ("../lib/a.fab", "../b.fab"),
            ("../lib/a.fab", "../../lib/b.fab"),
        ] {
            assert_eq!(within_or_library(file, path), None, "{file} {path}");
        }
    }
}
