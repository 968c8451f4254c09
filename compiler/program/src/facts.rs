//! The facts that prompts and verdicts depend on.

use crate::data::actions::Proposal;
use crate::data::actions::Value;
use crate::data::camera::PixelPoint;
use crate::data::program::Program;
use crate::pointing::{Notation, Pointing};
use crate::scene::SceneView;
use std::collections::BTreeMap;

/// An action that was carried out.
#[derive(Clone, Debug, PartialEq)]
pub struct ExecutedAction {
    /// What the model answered.
    pub proposal: Proposal,
    /// The pixel that was picked.
    pub pick: PixelPoint,
    /// The pixel that it was placed on.
    pub place: PixelPoint,
}

/// The facts of one question or one verdict.
#[derive(Clone, Copy)]
pub struct Facts<'a> {
    /// What the camera shows.
    pub scene: &'a dyn SceneView,
    /// What earlier stages of this step read, by name.
    pub texts: &'a BTreeMap<String, String>,
    /// Which step of the rollout this is, from 1.
    pub step: u32,
    /// The action before this one.
    pub last: Option<&'a ExecutedAction>,
    /// The action that is judged, where there is one.
    pub proposal: Option<&'a Proposal>,
    /// How the model that is asked or judged writes points.
    pub pointing: Pointing,
}

impl<'a> Facts<'a> {
    /// Returns the same with an action to judge.
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
