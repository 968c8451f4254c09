//! Caches proofs: tasks that share a library share its action space.
//!
//! [`super::flaws`] depends only on the parts of a program in [`key`], so caching changes no result.

use super::flaws::Flaw;
use fab_program::{Extractor, Program};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// The most cached action spaces; when it is full, the cache is cleared.
const MOST: usize = 256;

static CACHE: Mutex<BTreeMap<String, Vec<Flaw>>> = Mutex::new(BTreeMap::new());

/// Returns everything a proof depends on: fields, fixed points, the picture's side, the cloth's longer side.
pub(super) fn key(program: &Program) -> String {
    let points: Vec<(&str, bool, &[_])> = program
        .keypoints
        .iter()
        .map(|keypoint| match &keypoint.extractor {
            Extractor::Fixed { points } => (keypoint.name.as_str(), true, points.as_slice()),
            _ => (keypoint.name.as_str(), false, &[][..]),
        })
        .collect();
    let shapes: Vec<String> = program
        .keypoints
        .iter()
        .map(|keypoint| format!("{:?}", keypoint.extractor.shape()))
        .collect();
    let edge_m = program.cloth.edge_m();
    serde_json::to_string(&(
        &program.actions,
        points,
        shapes,
        program.camera.image_px,
        edge_m,
    ))
    .expect("these have string keys and finite numbers")
}

/// Returns the cached flaws of a key.
pub(super) fn recall(key: &str) -> Option<Vec<Flaw>> {
    // Each entry is written at once, so the cache is whole even if a thread panicked.
    let cache = CACHE
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    cache.get(key).cloned()
}

/// Caches the flaws of a key.
pub(super) fn keep(key: String, flaws: &[Flaw]) {
    let mut cache = CACHE
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    if cache.len() >= MOST {
        cache.clear();
    }
    cache.insert(key, flaws.to_vec());
}
