//! Finds a material by name: in a `.fab` file, or among the shipped ones.

use crate::exit::Failure;
use crate::io::Io;
use crate::{shipped, sources};
use fab_base::wording::quoted;
use fab_program::Material;

/// The shipped materials, relative to the tasks folder.
const SHIPPED: &str = "lib/materials.fab";

/// Returns the material that a word names.
///
/// - `word`: `NAME` for a shipped one, or `FILE.fab:NAME` for one that a file declares or uses.
///
/// Fails if the file cannot be read or has an error in a material, or if nothing has that name.
pub fn find(word: &str, io: &Io) -> Result<Material, Failure> {
    let (file, name) = match word.rsplit_once(':') {
        Some((file, name)) => (Some(shipped::find(file, io)?), name),
        None => (None, word),
    };
    let (whose, materials) = match &file {
        Some(file) => (
            format!("`{file}` declares"),
            sources::compile(file)?.materials,
        ),
        None => {
            struct Embedded;
            impl fab_compiler::Loader for Embedded {
                fn load(&self, _: &str) -> Result<String, fab_compiler::LoadError> {
                    Ok(shipped::text(SHIPPED).to_owned())
                }
            }
            let compiled = fab_compiler::compile(SHIPPED, &Embedded)
                .map_err(|error| Failure::environment(error.message))?;
            ("fabc ships".to_owned(), compiled.materials)
        }
    };
    let names: Vec<&str> = materials.iter().map(|it| it.name.as_str()).collect();
    let near = fab_compiler::diag::nearest(name, names.iter().copied());
    let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`"));
    let listed = quoted(&names);
    let found = materials.iter().find(|it| it.name == name).cloned();
    found.ok_or_else(|| {
        Failure::usage(format!(
            "there is no material `{name}`{near}; {whose} {}. Name one of a file with `FILE.fab:NAME`",
            if listed.is_empty() { "none" } else { &listed }
        ))
    })
}
