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

/// Resolves the path of a `use`, which may also lead into the folder `lib` beside the entry's folder.
pub(crate) fn within_or_library(file: &str, path: &str) -> Option<String> {
    let is_library = |path: &String| path.starts_with("../lib/");
    within(file, path).or_else(|| Some(beside(file, path)).filter(is_library))
}

#[cfg(test)]
mod tests;
