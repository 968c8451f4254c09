//! Runs a task's own tests: reads and judges an answer without a model or a camera.
//!
//! In: a program and one of its tests. Out: the result of the answer, and whether it was expected.

use crate::data::actions::Proposal;
use crate::data::actions::Value;
use crate::data::camera::PixelPoint;
use crate::data::program::Program;
use crate::data::stage::Read;
use crate::data::test::{Expect, Given, Test};
use crate::facts::{ExecutedAction, Facts};
use crate::pointing::Pointing;
use crate::render::RenderError;
use crate::reply::{self, Reading};
use crate::scene::SceneView;
use crate::verify::{self, Strictness, Verdict};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// The result of a test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trial {
    /// Whether the test expects the finding.
    #[serde(rename = "passed")]
    pub is_expected: bool,
    /// The result of the answer.
    #[serde(rename = "found")]
    pub finding: Finding,
    /// The deviations that were tolerated in the answer.
    pub repairs: Vec<String>,
}

/// The result of an answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "finding", rename_all = "snake_case")]
pub enum Finding {
    /// The action may run.
    #[serde(rename = "accept")]
    Accepted,
    /// A check rejects it.
    #[serde(rename = "reject")]
    Rejected {
        /// The check.
        check: String,
        /// The value of each side of the check.
        values: Vec<(String, String)>,
        /// The message to the model.
        message: String,
    },
    /// It cannot be read.
    Malformed {
        /// The message to the model.
        message: String,
    },
    /// A text was read.
    Text {
        /// The text.
        text: String,
    },
    /// The test does not give what a check or its message needs.
    Lacking {
        /// What is missing.
        name: String,
    },
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Finding::Accepted => f.write_str("the answer is accepted"),
            Finding::Rejected {
                check,
                values,
                message,
            } => {
                write!(f, "the check `{check}` refuses the answer")?;
                for (what, value) in values {
                    write!(f, "; {what}: {value}")?;
                }
                write!(f, "\n{message}")
            }
            Finding::Malformed { message } => write!(f, "the answer is malformed\n{message}"),
            Finding::Text { text } => write!(f, "the answer's text is `{text}`"),
            Finding::Lacking { name } => {
                write!(
                    f,
                    "the test does not give `{name}`; write `given {name} = …`"
                )
            }
        }
    }
}

/// Runs one test on a program of its task.
pub fn run(program: &Program, test: &Test) -> Trial {
    let (finding, repairs) = finding(program, test);
    let is_expected = match (&test.expect, &finding) {
        (Expect::Accept, Finding::Accepted) | (Expect::Malformed, Finding::Malformed { .. }) => {
            true
        }
        (Expect::Reject { check: wanted }, Finding::Rejected { check, .. }) => wanted == check,
        (Expect::Text { text: wanted }, Finding::Text { text }) => wanted == text,
        _ => false,
    };
    Trial {
        finding,
        is_expected,
        repairs,
    }
}

fn finding(program: &Program, test: &Test) -> (Finding, Vec<String>) {
    let read = program.stages.get(test.stage).map(|stage| &stage.read);
    let malformed = |message: String| (Finding::Malformed { message }, Vec::new());
    if let Some(Read::Text { before, after, .. }) = read {
        return match reply::read_text(before, after, &test.reply) {
            Ok(Reading { value, repairs, .. }) => (Finding::Text { text: value }, repairs),
            Err(error) => malformed(error.message),
        };
    }
    let Reading { value, repairs, .. } = match reply::read_action(program, &test.reply) {
        Ok(reading) => reading,
        Err(error) => return malformed(error.message),
    };
    let finding = match judged(program, &test.given, &value) {
        Ok(Verdict::Accept) => Finding::Accepted,
        Ok(Verdict::Reject {
            check,
            values,
            message,
        }) => Finding::Rejected {
            check,
            values,
            message,
        },
        Err(RenderError::MissingFact { name }) => Finding::Lacking { name },
        Err(error) => Finding::Lacking {
            name: error.to_string(),
        },
    };
    (finding, repairs)
}

fn judged(program: &Program, given: &Given, proposal: &Proposal) -> Result<Verdict, RenderError> {
    let scene = Rectangles { program, given };
    // What a verdict needs must be given: a missing mask would look like an empty one. Of the lists that a field chooses from
    // one is enough, so that a task which offers more points needs no more in the tests of what it extends.
    let is_given = |name: &String| scene.points(name).is_some() || scene.region(name).is_some();
    for names in verify::keypoints(program) {
        if !names.iter().any(is_given) {
            let name = names.into_iter().next().unwrap_or_default();
            return Err(RenderError::MissingFact { name });
        }
    }
    let texts: BTreeMap<String, String> = given.texts.iter().cloned().collect();
    let last = given.last.map(|[pick, place]| ExecutedAction {
        proposal: Proposal {
            fields: vec![
                ("pick".to_owned(), Value::Point(pick)),
                ("place".to_owned(), Value::Point(place)),
            ],
        },
        pick,
        place,
    });
    let facts = Facts {
        scene: &scene,
        texts: &texts,
        step: given.step,
        last: last.as_ref(),
        proposal: None,
        pointing: Pointing::of_camera(&program.camera),
    };
    verify::verdict(program, facts, proposal, Strictness::Full)
}

/// A scene whose masks and boxes are rectangles.
struct Rectangles<'a> {
    program: &'a Program,
    given: &'a Given,
}

impl Rectangles<'_> {
    /// Returns left, top, right and bottom, all included.
    fn region(&self, name: &str) -> Option<[i32; 4]> {
        let (_, [a, b]) = self.given.regions.iter().find(|(known, _)| known == name)?;
        Some([a.u.min(b.u), a.v.min(b.v), a.u.max(b.u), a.v.max(b.v)])
    }
}

impl SceneView for Rectangles<'_> {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        let given = self.given.points.iter().find(|(name, _)| name == keypoint);
        if let Some((_, points)) = given {
            return Some(points.clone());
        }
        // Points that never change need not be given.
        match &self.program.keypoint(keypoint)?.extractor {
            crate::data::keypoints::Extractor::Fixed { points } => Some(points.clone()),
            _ => None,
        }
    }

    fn distance_px(&self, region: &str, point: PixelPoint) -> Option<f64> {
        let [left, top, right, bottom] = self.region(region)?;
        let beyond = |at: i32, low: i32, high: i32| {
            let (at, low, high) = (f64::from(at), f64::from(low), f64::from(high));
            (low - at).max(at - high).max(0.0)
        };
        let (du, dv) = (beyond(point.u, left, right), beyond(point.v, top, bottom));
        Some((du * du + dv * dv).sqrt())
    }

    fn area_px(&self, mask: &str) -> Option<f64> {
        let [left, top, right, bottom] = self.region(mask)?;
        let side = |low: i32, high: i32| f64::from(high) - f64::from(low) + 1.0;
        Some(side(left, right) * side(top, bottom))
    }
}
