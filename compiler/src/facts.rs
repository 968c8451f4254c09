//! What is known when a question is asked or an answer judged.

use crate::eval::Eval;
use crate::pointing::{Notation, Pointing};
use crate::program::{PixelPoint, Point, Program, Value};
use crate::reply::Proposal;
use std::collections::BTreeMap;

/// What an observation shows, as far as texts and checks ask.
pub trait SceneView {
    /// Returns the points of a keypoint, one for a point; None for a mask, a box, an outline or an unknown name.
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>>;

    /// Returns the distance from `point` to the nearest pixel of a mask or box, pixels, 0 in it; None for an
    /// unknown name or an empty mask.
    fn distance_px(&self, region: &str, point: PixelPoint) -> Option<f64>;

    /// Returns the number of a mask's pixels; None for an unknown name.
    fn area_px(&self, mask: &str) -> Option<f64>;

    /// Returns a pixel of a mask by its number from 0, row by row; None beyond the last one, and where a scene
    /// does not know its masks' pixels.
    fn region_pixel(&self, _mask: &str, _number: u64) -> Option<PixelPoint> {
        None
    }

    /// Returns the candidate points that nothing can be done at, none of which is offered.
    fn unreachable(&self) -> &[Unreachable] {
        &[]
    }
}

/// A point of the picture that is out of reach of what picks and places there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreachable {
    /// The point.
    pub point: PixelPoint,
    /// Why, in words that a model is told.
    pub why: String,
}

/// An action that was carried out.
#[derive(Clone, Debug, PartialEq)]
pub struct Done {
    /// What the model answered.
    pub proposal: Proposal,
    /// The pixel that was picked.
    pub pick: PixelPoint,
    /// The pixel that it was placed on.
    pub place: PixelPoint,
}

/// What is known when a question is asked or an answer judged.
#[derive(Clone, Copy)]
pub struct Facts<'a> {
    /// What the camera shows.
    pub scene: &'a dyn SceneView,
    /// What earlier stages of this step read, by name.
    pub texts: &'a BTreeMap<String, String>,
    /// Which step of the rollout this is, from 1.
    pub step: u32,
    /// The action before this one.
    pub last: Option<&'a Done>,
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

    /// Returns a point as a whole pixel.
    pub fn pixel(&self, program: &Program, point: &Point) -> Result<PixelPoint, Missing> {
        let eval = Eval {
            program,
            facts: *self,
        };
        eval.pixel(point)
    }

    /// Returns the proposed value of a field.
    pub fn proposed(&self, field: &str) -> Option<&'a Value> {
        self.proposal.and_then(|proposal| proposal.get(field))
    }
}

/// A keypoint, a field or a text that is not there; a scene of the same program never lacks one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// Its name.
    pub name: String,
}

impl std::fmt::Display for Missing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "`{}` is not known here", self.name)
    }
}

impl std::error::Error for Missing {}
