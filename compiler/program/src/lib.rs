//! A compiled manipulation task, and what it means: the prompts for a model, the reading of its answers, and whether
//! a proposed action may run.
//!
//! A [`Program`] is plain data: the compiler makes it from a `.fab` file, and it is stored as JSON. This crate is all
//! that a robot's own software needs to use one. It has no parser, no camera, no model and no system library. The
//! caller describes what the camera sees through [`scene::SceneView`]. The same inputs give the same bytes on every
//! machine.
//!
//! ```
//! use fab_program::facts::Facts;
//! use fab_program::pointing::Pointing;
//! use fab_program::scene::SceneView;
//! use fab_program::verify::{Strictness, Verdict, verdict};
//! use fab_program::{PixelPoint, Program, render, reply};
//! use std::collections::BTreeMap;
//!
//! /// What the camera sees: here two corners, whatever the task calls them.
//! struct TwoCorners;
//!
//! impl SceneView for TwoCorners {
//!     fn points(&self, _keypoint: &str) -> Option<Vec<PixelPoint>> {
//!         Some(vec![PixelPoint::new(41, 167), PixelPoint::new(180, 60)])
//!     }
//!     fn distance_px(&self, _region: &str, _point: PixelPoint) -> Option<f64> {
//!         None
//!     }
//!     fn area_px(&self, _mask: &str) -> Option<f64> {
//!         None
//!     }
//! }
//!
//! // `program.json` of `fabc build` holds this under `program`.
//! let json = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/tidy.json"));
//! let program: Program = serde_json::from_str(json)?; // refused if it has another format
//!
//! let texts = BTreeMap::new(); // what earlier stages of the same step read
//! let facts = Facts {
//!     scene: &TwoCorners,
//!     texts: &texts,
//!     step: 1,
//!     last: None,
//!     proposal: None,
//!     pointing: Pointing::of_camera(&program.camera),
//! };
//!
//! // The messages of a stage, ready for a model.
//! let messages = render::messages(&program, &program.stages[0], render::Values::Known(facts))?;
//! let question = &messages[0].content.text;
//! assert!(question.starts_with("Choose from (41, 167), (180, 60)."));
//!
//! // The model's answer, as loosely as models write.
//! let answer = "The lower corner is free.\n**Pick Point**: (41, 167), Place Point = (180, 60)";
//! let action = reply::read_action(&program, answer).map_err(|wrong| wrong.message)?.value;
//! assert_eq!(action.point("pick"), Some(PixelPoint::new(41, 167)));
//!
//! // Whether it may run; a rejection carries the message for the model.
//! assert_eq!(verdict(&program, facts, &action, Strictness::Full)?, Verdict::Accept);
//! let same = reply::read_action(&program, "Pick Point = (41, 167)\nPlace Point = (41, 167)");
//! let same = same.map_err(|wrong| wrong.message)?.value;
//! match verdict(&program, facts, &same, Strictness::Full)? {
//!     Verdict::Reject { check, message, .. } => {
//!         assert_eq!(check, "moves");
//!         assert_eq!(message, "(41, 167) and (41, 167) are too near.");
//!     }
//!     Verdict::Accept => panic!("it does not move"),
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The language is defined in tables, one row per word: units in [`units::UNITS`], measures in
//! [`measures::MEASURES`], extractors of keypoints in [`EXTRACTORS`]. The compiler, the reading of answers and the
//! emitted files read the rows; [`vocabulary`] says what a row is.

pub mod data;
pub mod eval;
pub mod exact;
pub mod facts;
pub mod invisible;
pub mod measures;
pub mod nearest;
pub mod pointing;
pub mod render;
pub mod reply;
pub mod samples;
pub mod scene;
pub mod space;
pub mod spaces;
pub mod test;
pub mod tokens;
pub mod units;
pub mod verify;
pub mod vocabulary;
pub mod words;

pub use data::actions::{ActionField, Choices, Direction, LengthChoice, Proposal, Value};
pub use data::annotate::{Layer, Mark, Spot};
pub use data::camera::{Camera, ImageUp, PixelPoint};
pub use data::cloth::{
    Cloth, ClothStart, PARTICLES_A_SIDE, RECORDED_HEIGHT_M, RECORDED_SPACING_M, STATED_SPACING_MM,
    particles_along,
};
pub use data::demos::Demos;
pub use data::files::{FileRef, SourceStamp};
pub use data::folds::{ClothPoint, Fold, Sequence};
pub use data::goal::{Goal, Metric};
pub use data::keypoints::{
    Channel, EXTRACTORS, Extractor, ExtractorRow, Inside, Keypoint, Moment, Response, Side, Sight,
};
pub use data::manner::{MANNERS, Manner, manner_field};
pub use data::material::{Colour, Directions, Face, Material, hsv};
pub use data::picker::Picker;
pub use data::placeholders::{NumberFormat, Placeholder};
pub use data::points::{End, Heading, Point};
pub use data::program::{PROGRAM_FORMAT, Program, hex};
pub use data::rehearse::{Distrusted, Rehearsal, RehearsalMeasure, TwinRanges};
pub use data::shape::KeypointShape;
pub use data::stage::{
    Arrow, Example, Layers, LiteralText, ModelRole, Picture, Read, Reasoning, ReasoningLevel,
    Stage, SubgoalStep, Template, Variable,
};
pub use data::subgoals::{SubgoalImage, Subgoals};
pub use data::test::{Expect, Given, Test};
pub use data::trial::{
    Effect, LEAST_SLIDE_MM, PINS_FILE, SmallestFold, StepTrial, Trial, Unoffered, pins_folder,
};
pub use data::uses::{Depends, Uses};
pub use data::values::{Comparison, Condition};
pub use data::verify::{Check, Exhausted, OVERLAP, ResultCheck, Verify};
pub use measures::{Length, Number, PointMeasure};
pub use units::LengthUnit;
