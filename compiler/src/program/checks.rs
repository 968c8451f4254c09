//! The checks on a proposed action, as data.
//!
//! What they mean is defined by [`crate::verify`], their messages by [`crate::render`].

use serde::{Deserialize, Serialize};

/// The checks on a proposed action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verify {
    /// In order; the first one that fails speaks.
    pub checks: Vec<Check>,
    /// The most questions per stage and step, at least 1 (the paper: three).
    pub attempts: u32,
}

/// One check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Its name in the task and in the journal.
    pub name: String,
    /// What must hold.
    pub holds: Expr,
    /// Template of the correction message.
    pub message: String,
}

/// A condition over the proposed action and the scene; total, without loops.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub enum Expr {
    /// Every part holds.
    All {
        /// The parts.
        of: Vec<Expr>,
    },
    /// At least one part holds.
    Any {
        /// The parts.
        of: Vec<Expr>,
    },
    /// The part does not hold.
    Not {
        /// The part.
        of: Box<Expr>,
    },
    /// Two lengths in pixels compare so.
    Compare {
        /// Left of the operator.
        left: Length,
        /// The operator.
        is: Comparison,
        /// Right of the operator.
        right: Length,
    },
    /// A point lies on a mask, or at most `margin_px` away from it.
    Within {
        /// The point.
        point: PointRef,
        /// The mask's name.
        mask: String,
        /// Distance to the nearest pixel of the mask that is still accepted, pixels.
        margin_px: f64,
    },
}

/// How two numbers compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
}

/// A length in pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub enum Length {
    /// A number of pixels.
    Pixels {
        /// The number.
        px: f64,
    },
    /// The Euclidean distance between two points.
    Distance {
        /// One end.
        a: PointRef,
        /// The other end.
        b: PointRef,
    },
}

/// A point that a check can name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "of", rename_all = "snake_case")]
pub enum PointRef {
    /// A field of the proposed action.
    Action {
        /// The field.
        field: String,
    },
    /// A keypoint that is one point.
    Keypoint {
        /// The keypoint.
        name: String,
    },
}
