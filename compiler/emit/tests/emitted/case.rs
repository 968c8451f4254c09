//! One case of a table: the facts, an action, and how both are passed to the emitted verifiers.

use fab_program::Proposal;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::pointing::Pointing;
use fab_program::render::RenderError;
use fab_program::scene::SceneView;
use fab_program::verify::{self, Strictness, Verdict};
use fab_program::{Choices, PixelPoint, Program, Value};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A scene of given points and of upright rectangles, both corners included.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    pub points: BTreeMap<String, Vec<PixelPoint>>,
    /// Left, top, right, bottom.
    pub regions: BTreeMap<String, [i32; 4]>,
    pub areas: BTreeMap<String, f64>,
}

impl SceneView for Scene {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        self.points.get(keypoint).cloned()
    }

    fn distance_px(&self, region: &str, point: PixelPoint) -> Option<f64> {
        let [left, top, right, bottom] = self.regions.get(region)?.map(f64::from);
        let (u, v) = (f64::from(point.u), f64::from(point.v));
        let du = (left - u).max(u - right).max(0.0);
        let dv = (top - v).max(v - bottom).max(0.0);
        Some((du * du + dv * dv).sqrt())
    }

    fn area_px(&self, mask: &str) -> Option<f64> {
        self.areas.get(mask).copied()
    }
}

#[derive(Clone, Debug)]
pub struct Case {
    pub scene: Scene,
    pub step: u32,
    pub last: Option<ExecutedAction>,
    pub proposal: Proposal,
}

impl Case {
    /// Returns the verdicts of this crate: with all checks, and with the relaxed set.
    pub fn judged(&self, program: &Program) -> [String; 2] {
        let texts = BTreeMap::new();
        let facts = Facts {
            scene: &self.scene,
            texts: &texts,
            step: self.step,
            last: self.last.as_ref(),
            proposal: None,
            pointing: Pointing::pixels([224, 224]),
        };
        [Strictness::Full, Strictness::Relaxed].map(|strictness| {
            match verify::verdict(program, facts, &self.proposal, strictness) {
                Ok(Verdict::Accept) => "accept".to_owned(),
                Ok(Verdict::Reject { check, .. }) => format!("check:{check}"),
                Err(RenderError::MissingFact { name }) => format!("missing:{name}"),
                Err(error) => panic!("{error}"),
            }
        })
    }

    /// Writes the case as one line for the drivers of the emitted verifiers.
    pub fn told(&self, program: &Program) -> String {
        let mut line = format!("{}", self.step);
        match &self.last {
            None => line.push_str(" 0"),
            Some(last) => {
                let _ = write!(line, " 1{}{}", pixel(last.pick), pixel(last.place));
                for field in &program.actions {
                    if matches!(field.choices, Choices::Directions { .. }) {
                        line.push_str(&value(last.proposal.get(&field.name).unwrap()));
                    }
                }
            }
        }
        for field in &program.actions {
            line.push_str(&value(self.proposal.get(&field.name).unwrap()));
        }
        let _ = write!(line, " {}", self.scene.points.len());
        for (name, points) in &self.scene.points {
            let _ = write!(line, " {} {}", hex(name), points.len());
            line.extend(points.iter().map(|point| pixel(*point)));
        }
        let _ = write!(line, " {}", self.scene.regions.len());
        for (name, sides) in &self.scene.regions {
            let _ = write!(line, " {}", hex(name));
            line.extend(sides.map(|side| format!(" {side}")));
        }
        let _ = write!(line, " {}", self.scene.areas.len());
        for (name, area) in &self.scene.areas {
            let _ = write!(line, " {} {:016x}", hex(name), area.to_bits());
        }
        line
    }
}

fn value(value: &Value) -> String {
    match value {
        Value::Point(point) => pixel(*point),
        Value::Direction { deg: number } | Value::Length { length: number } => {
            format!(" {:016x}", number.to_bits())
        }
        Value::Word(word) => format!(" {}", hex(word)),
    }
}

fn pixel(point: PixelPoint) -> String {
    format!(" {} {}", point.u, point.v)
}

/// Writes a text without blanks and never empty, in hex.
fn hex(text: &str) -> String {
    let bytes = text.bytes().map(|byte| format!("{byte:02x}"));
    format!("x{}", bytes.collect::<String>())
}
