//! A folder of cached results, each named by a hash of its inputs.
//!
//! In: a key that covers everything the result depends on. Out: the cached bytes, if any. A lost or unwritable cache
//! costs time, never a result.

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
    /// Caches results in `folder`, which is created on first use.
    pub fn at(folder: PathBuf) -> Cache {
        Cache {
            folder: Some(folder),
        }
    }

    /// Caches nothing.
    pub fn none() -> Cache {
        Cache { folder: None }
    }

    /// Returns whether results are cached at all.
    pub fn is_kept(&self) -> bool {
        self.folder.is_some()
    }

    /// Returns a key that covers every part.
    pub fn key(parts: impl IntoIterator<Item = impl AsRef<[u8]>>) -> String {
        let mut hash = Sha256::new();
        for part in parts {
            let part = part.as_ref();
            // The length prefix keeps two different lists from hashing as the same bytes.
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
        crate::digest::hex(&hash.finalize())
    }

    /// Returns the particle positions cached under `key`; `None` unless they are `count` finite positions.
    pub fn positions(&self, key: &str, count: usize) -> Option<Vec<[f32; 3]>> {
        let positions = npy::decode(&self.get(key)?)?;
        let whole =
            positions.len() == count && positions.iter().flatten().all(|value| value.is_finite());
        whole.then_some(positions)
    }

    /// Caches particle positions under `key`; fails with the reason if they cannot be written.
    pub fn put_positions(&self, key: &str, positions: &[[f32; 3]]) -> Result<(), String> {
        self.put(key, &npy::encode(positions))
    }

    /// Returns the bytes cached under `key`, a string of letters and digits.
    pub fn get(&self, key: &str) -> Option<Vec<u8>> {
        fs::read(self.folder.as_ref()?.join(key)).ok()
    }

    /// Caches bytes under `key`; fails with the reason if they cannot be written.
    pub fn put(&self, key: &str, bytes: &[u8]) -> Result<(), String> {
        let Some(folder) = &self.folder else {
            return Ok(());
        };
        fs::create_dir_all(folder)
            .and_then(|()| files::write_whole(&folder.join(key), bytes))
            .map_err(|error| format!("cannot keep a result in `{}`: {error}", folder.display()))
    }
}
