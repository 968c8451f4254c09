//! Pinned subgoal pictures beside a task's file.
//!
//! In: a program and the folder of its file. Out: the pictures that `fabc subgoals` drew, if they still match the
//! program. `pins.json` beside them records what they were drawn from, and their hashes.

use super::{ArrowPx, Origin, SubgoalSet};
use crate::error::RunError;
use crate::journal;
use fab_base::files;
use fab_picture::png;
use fab_program::{Fold, PINS_FILE, Program, Subgoals, Trial, pins_folder};
use fab_world::World;
use image::RgbImage;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};

/// The contents of `pins.json` beside the pinned pictures: what they were drawn from.
#[derive(Serialize, Deserialize)]
struct Pins {
    format: u32,
    /// Hash of cloth, camera and folds.
    drawn_from: String,
    /// Hash of the world's parameters.
    params: String,
    arrows: Vec<ArrowPx>,
    /// Hashes of the pictures' pixels, in order.
    pictures: Vec<String>,
    /// What the steps did to the cloth, for `fabc check`; older files lack it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tried: Option<Trial>,
}

const PINS_FORMAT: u32 = 2;

/// The longest file of pins accepted, bytes.
const MAX_PINS_BYTES: u64 = 1 << 22;

/// Looks for pinned pictures that match the program: its own, or for a variant those of the task itself.
///
/// If there are none, returns the origin of pictures that are then drawn. Pictures that are missing or changed since they
/// were pinned do not count.
pub(super) fn load(
    program: &Program,
    folds: &[Fold],
    folder: &Path,
    world: &dyn World,
) -> Result<SubgoalSet, Origin> {
    match of_folder(program, folds, &pin_folder(program, folder), world) {
        Err(Origin::Drawn) if program.variant.is_some() => {
            let tasks = folder.join(pins_folder(&program.task));
            // If the task folds differently, having nothing pinned for its variant is fine.
            of_folder(program, folds, &tasks, world).map_err(|_| Origin::Drawn)
        }
        own => own,
    }
}

fn of_folder(
    program: &Program,
    folds: &[Fold],
    source: &Path,
    world: &dyn World,
) -> Result<SubgoalSet, Origin> {
    let text = files::read_text(&source.join(PINS_FILE), MAX_PINS_BYTES);
    let text = text.map_err(|_| Origin::Drawn)?;
    let pins: Pins = serde_json::from_str(&text).map_err(|_| Origin::DrawnAnew)?;
    if pins.format != PINS_FORMAT
        || pins.drawn_from != drawn_from(program, folds)
        || pins.arrows.len() != folds.len()
    {
        return Err(Origin::DrawnAnew);
    }
    let mut pictures = Vec::new();
    for number in 0..=folds.len() {
        let picture = png::load(&source.join(format!("{number}.png")));
        let picture = picture.map_err(|_| Origin::DrawnAnew)?;
        if pins.pictures.get(number) != Some(&hash_of(&picture)) {
            return Err(Origin::DrawnAnew);
        }
        pictures.push(picture);
    }
    let arrows = pins.arrows.into_iter().map(Some).collect();
    // Colours and manners are in neither hash. A variant may fold as its task does.
    let tried = pins.tried.map(|it| it.of);
    let is_same =
        tried.is_none() || program.variant.is_some() || tried == program.demonstration_hash();
    Ok(SubgoalSet {
        pictures,
        arrows,
        origin: if pins.params == world.parameters() && is_same {
            Origin::Pinned
        } else {
            Origin::PinnedByOther
        },
        ..SubgoalSet::default()
    })
}

impl SubgoalSet {
    /// Writes drawn pictures where [`SubgoalSet::obtain`] looks for them, and returns the files.
    ///
    /// The description is written last, so an interrupted call leaves no complete-looking set.
    pub fn pin(
        &self,
        program: &Program,
        folder: &Path,
        params: &str,
    ) -> Result<Vec<PathBuf>, RunError> {
        let Some(Subgoals::Demonstrate { folds }) = &program.subgoals else {
            return Ok(Vec::new());
        };
        let target = pin_folder(program, folder);
        let description = target.join(PINS_FILE);
        if description.exists() {
            let removed = fs::remove_file(&description);
            removed.map_err(|error| RunError::unwritable(&description, error))?;
        }
        let mut files = Vec::new();
        for (number, picture) in self.pictures.iter().enumerate() {
            let path = target.join(format!("{number}.png"));
            journal::write(&path, &png::encode(picture))?;
            files.push(path);
        }
        let pins = Pins {
            format: PINS_FORMAT,
            drawn_from: drawn_from(program, folds),
            params: params.to_owned(),
            arrows: self.arrows.iter().copied().flatten().collect(),
            pictures: self.pictures.iter().map(hash_of).collect(),
            tried: self.trial.clone(),
        };
        let text = serde_json::to_string_pretty(&pins).expect("pins hold finite numbers") + "\n";
        journal::write(&description, text.as_bytes())?;
        files.push(description);
        Ok(files)
    }
}

/// Variants of a task may fold differently, so each has its own pictures.
fn pin_folder(program: &Program, folder: &Path) -> PathBuf {
    folder.join(pins_folder(&program.title()))
}

fn drawn_from(program: &Program, folds: &[Fold]) -> String {
    // They are drawn from the flat cloth, whatever start a rollout has.
    let cloth = &program.cloth;
    let source = serde_json::json!({
        "cloth": [cloth.dimx, cloth.dimy],
        "spacing_m": cloth.spacing_m,
        "camera": program.camera,
        "folds": folds,
    });
    fab_base::digest::of(source.to_string())
}

/// Returns the hash of a picture's size and pixels, hex.
fn hash_of(picture: &RgbImage) -> String {
    let mut hash = Sha256::new();
    super::add_picture(&mut hash, picture);
    fab_base::digest::hex(&hash.finalize())
}
