//! Rows of `goal` and `horizon`.

use fab_program::vocabulary::Range;
use fab_program::{Comparison, Metric};

/// A measure that a goal may name.
pub(crate) struct MetricRow {
    pub metric: Metric,
    /// The comparisons that count as reaching it.
    pub reached: [Comparison; 2],
    pub limit: Range,
    /// A goal with this measure.
    pub example: &'static str,
    pub doc: &'static str,
}

const BELOW: [Comparison; 2] = [Comparison::Less, Comparison::AtMost];
const ABOVE: [Comparison; 2] = [Comparison::Greater, Comparison::AtLeast];

/// The measures of goals.
pub(crate) const METRICS: &[MetricRow] = &[
    MetricRow {
        metric: Metric::ParticleDistance,
        reached: BELOW,
        limit: Range::new("a distance", (0.001, "mm"), (10.0, "m")),
        example: "goal particle_distance < 40mm",
        doc: "the mean distance between each particle of the result and the same particle of the nearest expert result; reached below its limit, judged after the last step",
    },
    MetricRow {
        metric: Metric::Coverage,
        reached: ABOVE,
        limit: Range::plain("a fraction", 0.0, 1.0),
        example: "goal coverage > 0.9",
        doc: "the covered area divided by that of the flat cloth; reached above its limit, judged after each step",
    },
    MetricRow {
        metric: Metric::NormalizedImprovement,
        reached: ABOVE,
        // A cloth may end with less than it began with.
        limit: Range::plain("a fraction", -1.0, 1.0),
        example: "goal normalized_improvement > 0.95",
        doc: "which part of the coverage missing at the start has been gained; reached above its limit, judged after each step",
    },
];

/// The most actions of a rollout.
pub(crate) const STEPS: Range = Range::plain("a number of steps", 1.0, 100.0);
