//! Finds a material by name: in a `.fab` file, or among the shipped ones.

use crate::exit::Failure;
use crate::io::Io;
use crate::shipped;
use crate::sources::{self, Texts};
use clap::Args;
use fab_base::wording::quoted;
use fab_program::Material;
use fab_sim::Params;
use fab_world::simulated;
use std::collections::BTreeMap;

/// What a simulated cloth is made of.
#[derive(Args)]
pub struct MaterialArguments {
    /// A cloth of a shipped material, or of `FILE.fab:NAME`, in its colours; default: the recorded scene's cloth.
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
}

impl MaterialArguments {
    /// Returns the simulator's parameters for the cloth, and its material if one is named.
    pub fn params(&self, io: &Io) -> Result<(Params, Option<Material>), Failure> {
        let named = self.material.as_deref();
        let material = named.map(|name| find(name, io)).transpose()?;
        let params = Params {
            material: material.as_ref().map(simulated::material),
            ..Params::default()
        };
        Ok((params, material))
    }
}

/// The shipped materials, relative to the tasks folder.
const SHIPPED: &str = "lib/materials.fab";

/// Returns the shipped materials.
pub fn shipped() -> Result<Vec<Material>, Failure> {
    let texts = Texts(BTreeMap::from([(SHIPPED, shipped::text(SHIPPED))]));
    Ok(fab_compiler::compile(SHIPPED, &texts)?.materials)
}

/// Returns the material that a word names: a shipped one, or as `FILE.fab:NAME` one that a file declares or uses.
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
        None => ("fabc ships".to_owned(), shipped()?),
    };
    if let Some(found) = materials.iter().find(|it| it.name == name) {
        return Ok(found.clone());
    }
    let names = || materials.iter().map(|it| it.name.as_str());
    let near = fab_compiler::diag::nearest(name, names());
    let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`"));
    let listed = quoted(names());
    let listed = if listed.is_empty() { "none" } else { &listed };
    Err(Failure::usage(format!(
        "there is no material `{name}`{near}; {whose} {listed}. Name one of a file with `FILE.fab:NAME`"
    )))
}
