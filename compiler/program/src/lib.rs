//! A compiled task and what it means.

pub mod data;
pub mod eval;
pub mod exact;
pub mod facts;
pub mod measures;
pub mod pointing;
pub mod render;
pub mod reply;
pub mod scene;
pub mod space;
pub mod test;
pub mod tokens;
pub mod units;
pub mod verify;
pub mod vocabulary;

pub use data::actions::{ActionField, Choices, Direction, LengthChoice, Proposal, Value};
pub use data::annotate::{Layer, Mark, Spot};
pub use data::camera::{Camera, ImageUp, PixelPoint};
pub use data::cloth::{Cloth, ClothStart};
pub use data::demos::Demos;
pub use data::files::{FileRef, SourceStamp};
pub use data::folds::{ClothPoint, Fold, Sequence};
pub use data::goal::{Goal, Metric};
pub use data::keypoints::{
    Channel, EXTRACTORS, Extractor, ExtractorRow, Inside, Keypoint, Moment, Response, Side, Sight,
};
pub use data::picker::Picker;
pub use data::placeholders::{NumberFormat, Placeholder};
pub use data::points::{End, Heading, Point};
pub use data::program::{PROGRAM_FORMAT, Program, hex};
pub use data::shape::KeypointShape;
pub use data::stage::{
    Arrow, Example, Layers, LiteralText, ModelRole, Picture, Read, Stage, SubgoalStep, Template,
    Variable,
};
pub use data::subgoals::{SubgoalImage, Subgoals};
pub use data::test::{Expect, Given, Test};
pub use data::uses::{Depends, Uses};
pub use data::values::{Comparison, Condition};
pub use data::verify::{Check, Exhausted, OVERLAP, ResultCheck, Verify};
pub use measures::{Length, Number, PointMeasure};
pub use units::LengthUnit;
