//! The facts that prompts and verdicts depend on.

use crate::data::actions::Proposal;
use crate::data::actions::Value;
use crate::data::camera::PixelPoint;
use crate::data::program::Program;
use crate::pointing::{Notation, Pointing};
use crate::scene::SceneView;
use std::collections::BTreeMap;

/// An executed action.
#[derive(Clone, Debug, PartialEq)]
pub struct ExecutedAction {
    /// The model's answer.
    pub proposal: Proposal,
    /// The pixel at which it picked.
    pub pick: PixelPoint,
    /// The pixel at which it placed.
    pub place: PixelPoint,
}

/// The facts of one question or one verdict.
#[derive(Clone, Copy)]
pub struct Facts<'a> {
    /// What the camera shows.
    pub scene: &'a dyn SceneView,
    /// The texts that earlier stages of this step read, by name.
    pub texts: &'a BTreeMap<String, String>,
    /// The number of the step in the rollout, from 1.
    pub step: u32,
    /// The previous action.
    pub last: Option<&'a ExecutedAction>,
    /// The action to judge, if there is one.
    pub proposal: Option<&'a Proposal>,
    /// How the model writes points.
    pub pointing: Pointing,
}

impl<'a> Facts<'a> {
    /// Collects the facts of a step, from 1, of which nothing is read, done or proposed yet.
    pub fn of(scene: &'a dyn SceneView, step: u32, pointing: Pointing) -> Facts<'a> {
        static NO_TEXTS: BTreeMap<String, String> = BTreeMap::new();
        Facts {
            scene,
            texts: &NO_TEXTS,
            step,
            last: None,
            proposal: None,
            pointing,
        }
    }

    /// Returns the same facts with an action to judge.
    pub fn judging(self, proposal: &'a Proposal) -> Facts<'a> {
        Facts {
            proposal: Some(proposal),
            ..self
        }
    }

    /// Returns how points of this scene are written.
    pub fn notation(&self, program: &Program) -> Notation {
        Notation::of(self.pointing, &program.actions, self.scene)
    }

    /// Returns the proposed value of a field.
    pub fn proposed(&self, field: &str) -> Option<&'a Value> {
        self.proposal.and_then(|proposal| proposal.get(field))
    }
}
