//! Finds suites by their names.

use crate::exit::Failure;
use crate::sources;
use fab_base::wording::quoted;
use fab_bench::suite::Suite;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of the shipped suites, relative to the working folder.
const FOLDER: &str = "tasks/suites";

pub struct SuiteFile {
    /// The file's name without its extension.
    pub name: String,
    /// The folder of the file; the suite's task paths are relative to it.
    pub folder: PathBuf,
    pub suite: Suite,
}

/// Finds a suite by its name or path, and reads it.
pub fn find(wanted: &str) -> Result<SuiteFile, Failure> {
    let is_path = wanted.ends_with(".toml") || wanted.contains(['/', '\\']);
    let path = if is_path {
        PathBuf::from(wanted)
    } else {
        Path::new(FOLDER).join(format!("{wanted}.toml"))
    };
    if !path.is_file() {
        return Err(Failure::usage(format!(
            "there is no suite `{wanted}`: looked for the file `{}` in the working folder; {}",
            path.display(),
            there()
        )));
    }
    let wrong = |why: String| {
        Failure::environment(format!("the suite `{}` is wrong: {why}", path.display()))
    };
    let text = sources::read_text(&path).map_err(wrong)?;
    let suite = Suite::parse(&text).map_err(|error| wrong(error.to_string()))?;
    let name = path.file_stem().unwrap_or_default();
    Ok(SuiteFile {
        name: name.to_string_lossy().into_owned(),
        folder: path.parent().map(Path::to_owned).unwrap_or_default(),
        suite,
    })
}

fn there() -> String {
    let files = fs::read_dir(FOLDER).into_iter().flatten().flatten();
    let names = files.filter_map(|file| file.file_name().into_string().ok());
    let names = names.filter_map(|name| Some(name.strip_suffix(".toml")?.to_owned()));
    let names: BTreeSet<String> = names.collect();
    if names.is_empty() {
        format!("`{FOLDER}` holds none here, so go to the project's folder or name a .toml file")
    } else {
        format!("`{FOLDER}` holds {}", quoted(names))
    }
}
