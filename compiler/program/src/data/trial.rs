//! What the steps of a demonstration did to the cloth when they were last executed, and whether an answer can make them.
//!
//! `fabc subgoals` finds it out and keeps it beside the pictures, so that `fabc check` needs no simulator.

use crate::data::actions::{ActionField, Choices};
use crate::data::camera::PixelPoint;
use crate::data::cloth::{Cloth, ClothStart};
use crate::data::manner::MANNERS;
use crate::data::program::{Program, hex};
use crate::data::subgoals::Subgoals;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// The file that holds what a demonstration was drawn from, and its [`Trial`], in the folder that [`pins_folder`] names.
pub const PINS_FILE: &str = "pins.json";

/// Returns the name of the folder beside a task's file that holds its pinned pictures.
///
/// - `title`: as [`Program::title`] gives it. Variants may fold differently, so each has its own.
pub fn pins_folder(title: &str) -> String {
    format!("{}.subgoals", title.replace('/', "."))
}

/// The results of a demonstration's steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// What was executed, as [`Program::demonstration_hash`] says it.
    pub of: String,
    /// What its points were compared with, as [`Program::offers_hash`] says it; older files lack it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offers: Option<String>,
    /// The result of each step.
    pub steps: Vec<StepTrial>,
}

/// The least slide of a whole cloth that messages mention, millimetres.
pub const LEAST_SLIDE_MM: f64 = 1.0;

/// The result of one step; distances are along the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepTrial {
    /// From pick to place, millimetres.
    pub planned_mm: f64,
    /// What became of the cloth.
    pub effect: Effect,
    /// Its ends for which no offered point stands.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unoffered: Vec<Unoffered>,
}

/// An end of a step for which no offered point stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unoffered {
    /// `pick` or `place`.
    pub end: String,
    /// The nearest offered point, `[column, row]`.
    pub nearest: PixelPoint,
    /// How far that is from the demonstrated one, millimetres.
    pub away_mm: f64,
    /// A declared keypoint that has such a point, or a mask that reaches it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keypoint: Option<String>,
}

/// What a step did to the cloth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Effect {
    /// Some of it was folded over.
    Changed,
    /// It opened again: it lies as before, or only slid.
    WentBack {
        /// How far the picked point was carried, millimetres.
        carried_mm: f64,
        /// How far it then lay from where it was, millimetres.
        stayed_mm: f64,
        /// How far the whole cloth slid, millimetres; 0 where it was not measured.
        #[serde(default)]
        slid_mm: f64,
        /// The smallest fold from the same pick in the same direction that stays.
        smallest: SmallestFold,
    },
    /// Nothing was grasped.
    Missed,
}

/// The shortest way that a picked point must be carried for the fold to stay, as a search found it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SmallestFold {
    /// The shortest that stayed, millimetres.
    From {
        /// Its length.
        mm: u32,
    },
    /// None stayed.
    NoneUpTo {
        /// The longest that was tried, millimetres.
        mm: u32,
    },
}

impl Program {
    /// Returns the identity of the task's demonstration: SHA-256 of the flat cloth, the picker, the folds and how they
    /// are carried, hex; `None` without one.
    pub fn demonstration_hash(&self) -> Option<String> {
        let Some(Subgoals::Demonstrate { folds }) = &self.subgoals else {
            return None;
        };
        // It is executed on the flat cloth, whatever start a rollout has.
        let cloth = Cloth {
            start: ClothStart::Flat,
            ..self.cloth.clone()
        };
        let manner = Some(&self.manner).filter(|manner| !manner.is_default());
        let bytes = match manner {
            None => serde_json::to_vec(&(cloth, &self.picker, folds)),
            Some(manner) => serde_json::to_vec(&(cloth, &self.picker, folds, manner)),
        };
        let bytes = bytes.expect("a demonstration has string keys and finite numbers");
        Some(hex(&Sha256::digest(bytes)))
    }

    /// Returns the identity of what the task's points follow from: SHA-256 of camera, keypoints and the fields that say
    /// where the cloth is picked and placed, hex.
    pub fn offers_hash(&self) -> String {
        let is_where = |field: &&ActionField| {
            let is_manner = MANNERS.iter().any(|it| it.name == field.name);
            !is_manner && !matches!(field.choices, Choices::Words { .. })
        };
        let fields: Vec<&ActionField> = self.actions.iter().filter(is_where).collect();
        let bytes = serde_json::to_vec(&(&self.camera, &self.keypoints, fields));
        hex(&Sha256::digest(
            bytes.expect("a program has string keys and finite numbers"),
        ))
    }
}
