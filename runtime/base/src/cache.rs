//! A folder of results that are named by what they were computed from.
//!
//! In: a key that covers everything the result depends on. Out: the bytes, if they were kept. A lost
//! or unwritable cache costs time, never a result.

use crate::{files, npy};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::PathBuf;

/// A content-addressed store on disk, or nowhere.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: Option<PathBuf>,
}

impl Cache {
    /// Keeps results in `folder`, which is made when first needed.
    pub fn at(folder: PathBuf) -> Cache {
        Cache {
            folder: Some(folder),
        }
    }

    /// Keeps nothing.
    pub fn none() -> Cache {
        Cache { folder: None }
    }

    /// Returns whether it keeps anything.
    pub fn is_kept(&self) -> bool {
        self.folder.is_some()
    }

    /// Returns a key that covers every part.
    pub fn key<'p>(parts: impl IntoIterator<Item = &'p str>) -> String {
        let mut hash = Sha256::new();
        for part in parts {
            // With its length, so that no two lists of parts run together alike.
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
        crate::digest::hex(&hash.finalize())
    }

    /// Returns the particle positions kept under `key`; None where they are not `count` finite ones.
    pub fn positions(&self, key: &str, count: usize) -> Option<Vec<[f32; 3]>> {
        let positions = npy::decode(&self.get(key)?)?;
        let whole =
            positions.len() == count && positions.iter().flatten().all(|value| value.is_finite());
        whole.then_some(positions)
    }

    /// Keeps particle positions under `key`; says why where they cannot be kept.
    pub fn put_positions(&self, key: &str, positions: &[[f32; 3]]) -> Result<(), String> {
        self.put(key, &npy::encode(positions))
    }

    /// Returns the bytes kept under `key`, a string of letters and digits.
    pub fn get(&self, key: &str) -> Option<Vec<u8>> {
        fs::read(self.folder.as_ref()?.join(key)).ok()
    }

    /// Keeps bytes under `key`; says why where they cannot be kept.
    pub fn put(&self, key: &str, bytes: &[u8]) -> Result<(), String> {
        let Some(folder) = &self.folder else {
            return Ok(());
        };
        fs::create_dir_all(folder)
            .and_then(|()| files::write_whole(&folder.join(key), bytes))
            .map_err(|error| format!("cannot keep a result in `{}`: {error}", folder.display()))
    }
}
