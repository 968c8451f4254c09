//! Writes a compiled task as files that other systems use without the compiler.
//!
//! In: compiled programs. Out: [`Artifact`]s, texts with their paths: prompt templates, the JSON Schema of an answer,
//! the checks as a module of Rust and of Python, and `program.json`, which ties them together. The same programs give
//! the same bytes. The caller writes them to disk.
//!
//! ```
//! use fab_compiler::{LoadError, Loader};
//! use fab_emit::{Target, emit};
//!
//! struct Memory;
//!
//! impl Loader for Memory {
//!     fn load(&self, _name: &str) -> Result<String, LoadError> {
//!         let text = r#"
//!             task tidy {
//!                 cloth grid(42, 42, start: crumpled)
//!                 camera top_down(height: 650mm, fov: 45deg, image: 224px)
//!                 goal coverage > 0.9
//!                 horizon 3
//!                 keypoints {
//!                     cloth   = mask(depth < 646mm)
//!                     corners = harris(cloth, max: 4, quality: 0.04, spacing: 10px)
//!                 }
//!                 actions { pick: one of corners  place: one of corners }
//!                 stage plan {
//!                     model text
//!                     say "Choose from {{ corners }}. {{ actions.format }}"
//!                     read action
//!                 }
//!                 verify { check moves { distance(pick, place) > 10px } else "They are too near." }
//!             }
//!         "#;
//!         Ok(text.to_owned())
//!     }
//! }
//!
//! let compiled = fab_compiler::compile("tidy.fab", &Memory)?;
//! let files = emit(&compiled.programs, &[Target::Program, Target::Rust, Target::Python])?;
//! let paths: Vec<&str> = files.iter().map(|file| file.path.as_str()).collect();
//! assert_eq!(
//!     paths,
//!     [
//!         "tidy/prompts/plan.user.txt.j2",
//!         "tidy/prompts/check.moves.txt.j2",
//!         "tidy/actions.schema.json",
//!         "tidy/verifier.rs",
//!         "tidy/verifier.py",
//!         "tidy/program.json",
//!     ]
//! );
//! assert!(files[3].text.contains("squared_distance(at(facts.action.pick), at(facts.action.place))"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`fill`] fills an emitted prompt with the values of [`guards_and_values`], like any other Jinja engine.

mod artifact;
mod error;
mod manifest;
mod prompts;
mod schema;
mod verifier;

pub use artifact::Artifact;
pub use error::EmitError;
pub use manifest::{BUILD_FORMAT, ListedArtifact, Manifest};
pub use prompts::{fill, guards_and_values};

use error::plain_name;
use fab_program::Program;
use std::collections::BTreeMap;

/// What is written besides the prompts and the schema, which are always written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// `program.json`: the whole program as data, and a list of the other files.
    Program,
    /// `verifier.rs`: the checks as a Rust module that needs only `core`.
    Rust,
    /// `verifier.py`: the checks as a Python module that needs only the standard library.
    Python,
}

/// Returns the folder of a program's files: `TASK`, or `TASK.VARIANT`.
pub fn folder(program: &Program) -> String {
    match &program.variant {
        Some(variant) => format!("{}.{variant}", program.task),
        None => program.task.clone(),
    }
}

/// Writes programs, each into its own folder. `program.json` comes last, because it lists the other files.
///
/// Fails only on programs that were edited by hand, and if two files would get the same name.
pub fn emit(programs: &[Program], targets: &[Target]) -> Result<Vec<Artifact>, EmitError> {
    let mut artifacts = Vec::new();
    for program in programs {
        artifacts.extend(of_one(program, targets)?);
    }
    let mut by_path: BTreeMap<String, &str> = BTreeMap::new();
    for artifact in &artifacts {
        // Some file systems do not tell `A` and `a` apart, and the files must be the same on all of them.
        let folded = artifact.path.to_ascii_lowercase();
        if let Some(other) = by_path.insert(folded, &artifact.path) {
            return Err(EmitError::SameFile {
                one: other.to_owned(),
                other: artifact.path.clone(),
            });
        }
    }
    Ok(artifacts)
}

fn of_one(program: &Program, targets: &[Target]) -> Result<Vec<Artifact>, EmitError> {
    let folder = folder(program);
    for part in [Some(&program.task), program.variant.as_ref()] {
        plain_name(part.map_or("_", String::as_str))?;
    }
    let mut artifacts = prompts::emit(program)?;
    let mut add = |path: &str, text| {
        artifacts.push(Artifact {
            path: path.to_owned(),
            text,
        });
    };
    add("actions.schema.json", schema::emit(program));
    if targets.contains(&Target::Rust) {
        add("verifier.rs", verifier::emit(program, &verifier::RUST)?);
    }
    if targets.contains(&Target::Python) {
        add("verifier.py", verifier::emit(program, &verifier::PYTHON)?);
    }
    if targets.contains(&Target::Program) {
        let text = manifest::emit(program, &artifacts);
        artifacts.push(Artifact {
            path: "program.json".to_owned(),
            text,
        });
    }
    for artifact in &mut artifacts {
        artifact.path = format!("{folder}/{}", artifact.path);
    }
    Ok(artifacts)
}
