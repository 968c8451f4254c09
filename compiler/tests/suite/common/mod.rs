//! Tasks and loaders that the tests share.

#![allow(dead_code, clippy::unwrap_used)]

pub mod jinja2;

use fab_compiler::explain::Files;
use fab_compiler::{Compiled, Listed, LoadError, Loader, Wanted};
use fab_program::Proposal;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::pointing::Pointing;
use fab_program::scene::{SceneView, Unreachable};
use fab_program::{PixelPoint, Program, Value};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A small task with every section that a task needs.
pub const TASK: &str = include_str!("task.fab");

/// Files in memory, by name.
#[derive(Default)]
pub struct Memory(pub BTreeMap<String, String>);

impl Memory {
    pub fn of<const N: usize>(files: [(&str, &str); N]) -> Memory {
        Memory(
            files
                .map(|(name, text)| (name.to_owned(), text.to_owned()))
                .into(),
        )
    }
}

impl Loader for Memory {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        self.0.get(name).cloned().ok_or_else(|| LoadError {
            message: format!("there is no file `{name}`"),
        })
    }

    fn look(&self, path: &str, wanted: Wanted) -> Listed {
        Files("").look(path, wanted)
    }

    fn trial(&self, title: &str) -> Option<fab_program::Trial> {
        Files("").trial(title)
    }

    fn refuses_cloth(&self, material: &fab_program::Material, spacing_m: f64) -> Option<String> {
        Files("").refuses_cloth(material, spacing_m)
    }
}

/// A folder, with one file's text replaced.
pub struct Changed<'t> {
    pub folder: &'t Path,
    pub name: &'t str,
    pub text: &'t str,
}

impl Loader for Changed<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        if name == self.name {
            return Ok(self.text.to_owned());
        }
        fs::read_to_string(self.folder.join(name)).map_err(|_| LoadError {
            message: format!("there is no file `{name}`"),
        })
    }
}

/// Compiles one file.
pub fn compile(name: &str, text: &str) -> Compiled {
    fab_compiler::compile(name, &Memory::of([(name, text)])).unwrap()
}

/// Returns the only program of a file that must have no errors.
pub fn program(name: &str, text: &str) -> Program {
    let mut programs = programs(name, &Memory::of([(name, text)]));
    assert_eq!(programs.len(), 1);
    programs.remove(0)
}

/// Returns the programs of a file that must have no errors and may use others.
pub fn programs(entry: &str, files: &Memory) -> Vec<Program> {
    let compiled = fab_compiler::compile(entry, files).unwrap();
    let shown = fab_compiler::diag::to_text(
        &compiled.diagnostics,
        &compiled.sources,
        fab_compiler::diag::Color::Plain,
    );
    assert!(!compiled.has_errors(), "{shown}");
    compiled.programs
}

/// Returns the messages of all findings in a text.
pub fn messages(text: &str) -> Vec<String> {
    compile("task.fab", text)
        .diagnostics
        .into_iter()
        .map(|it| format!("{} {}", it.code.as_str(), it.message))
        .collect()
}

/// Returns the folder of the workspace.
pub fn workspace() -> PathBuf {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let root = here
        .ancestors()
        .find(|folder| folder.join("Cargo.lock").exists());
    root.unwrap().to_owned()
}

/// The points, masks and texts of a test.
#[derive(Default)]
pub struct Known {
    pub points: Vec<(&'static str, Vec<PixelPoint>)>,
    /// Masks and boxes as rectangles: left, top, right, bottom, all included.
    pub regions: Vec<(&'static str, [i32; 4])>,
    pub texts: BTreeMap<String, String>,
    pub last: Option<ExecutedAction>,
    pub unreachable: Vec<Unreachable>,
}

impl Known {
    pub fn facts(&self) -> Facts<'_> {
        Facts {
            scene: self,
            texts: &self.texts,
            step: if self.last.is_some() { 2 } else { 1 },
            last: self.last.as_ref(),
            proposal: None,
            pointing: Pointing::pixels([224, 224]),
        }
    }
}

impl SceneView for Known {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        let found = self.points.iter().find(|(name, _)| *name == keypoint);
        found.map(|(_, points)| points.clone())
    }

    fn distance_px(&self, region: &str, point: PixelPoint) -> Option<f64> {
        let (_, [left, top, right, bottom]) =
            self.regions.iter().find(|(name, _)| *name == region)?;
        let beyond = |at: i32, low: i32, high: i32| f64::from((low - at).max(at - high).max(0));
        Some(beyond(point.u, *left, *right).hypot(beyond(point.v, *top, *bottom)))
    }

    fn area_px(&self, mask: &str) -> Option<f64> {
        let (_, [left, top, right, bottom]) =
            self.regions.iter().find(|(name, _)| *name == mask)?;
        Some(f64::from((right - left + 1) * (bottom - top + 1)))
    }

    fn unreachable(&self) -> &[Unreachable] {
        &self.unreachable
    }
}

pub fn pixels(points: &[(i32, i32)]) -> Vec<PixelPoint> {
    points
        .iter()
        .map(|(u, v)| PixelPoint::new(*u, *v))
        .collect()
}

/// An action by pick and place.
pub fn pick_and_place(pick: (i32, i32), place: (i32, i32)) -> Proposal {
    let point = |(u, v)| Value::Point(PixelPoint::new(u, v));
    Proposal {
        fields: vec![
            ("pick".to_owned(), point(pick)),
            ("place".to_owned(), point(place)),
        ],
    }
}
