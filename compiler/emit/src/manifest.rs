//! `program.json`: a program, and the list of the files made from it.
//!
//! ```json
//! {
//!   "format": 1,
//!   "compiler": "0.1.0",
//!   "program_hash": "0123456789abcdef",
//!   "artifacts": [{ "path": "prompts/plan.user.txt.j2", "sha256": "…" }],
//!   "program": { "format": 4, "task": "fold", "sources": [{ "name": "fold.fab", "sha256": "…" }], … }
//! }
//! ```
//!
//! `program` is the verifier as data, and everything else that a runtime needs; its own `format` is that of
//! [`Program`]. Every number reads back to the same bits.

use crate::artifact::Artifact;
use fab_program::{Program, hex};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Version of the format of [`Manifest`] and of the names of the files next to it.
pub const BUILD_FORMAT: u32 = 1;

/// The contents of `program.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// [`BUILD_FORMAT`] at the time of writing.
    pub format: u32,
    /// Version of the compiler that wrote it.
    pub compiler: String,
    /// [`Program::hash`] of the program below; the verifiers name it too.
    pub program_hash: String,
    /// The other files, in the order in which they are written.
    pub artifacts: Vec<ListedArtifact>,
    /// The program; its `sources` hold the hash of each source text.
    pub program: Program,
}

/// One file next to `program.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListedArtifact {
    /// Its path, relative to `program.json`; `/` as separator.
    pub path: String,
    /// SHA-256 of its bytes, hex.
    pub sha256: String,
}

/// Writes the manifest, indented, with a line end.
pub(super) fn emit(program: &Program, artifacts: &[Artifact]) -> String {
    let listed = |artifact: &Artifact| ListedArtifact {
        path: artifact.path.clone(),
        sha256: hex(&Sha256::digest(artifact.text.as_bytes())),
    };
    let manifest = Manifest {
        format: BUILD_FORMAT,
        compiler: env!("CARGO_PKG_VERSION").to_owned(),
        program_hash: program.hash(),
        artifacts: artifacts.iter().map(listed).collect(),
        program: program.clone(),
    };
    let mut text = serde_json::to_string_pretty(&manifest)
        .expect("a program has string keys and finite numbers");
    text.push('\n');
    text
}
