//! Writes the value of each placeholder as text.

use crate::data::actions::{ActionField, Value};
use crate::data::placeholders::{NumberFormat, Placeholder};
use crate::data::program::Program;
use crate::data::stage::Read;
use crate::data::verify::OVERLAP;
use crate::eval::{Eval, rounded};
use crate::facts::Facts;
use crate::measures::{self, Length};
use crate::pointing::{Notation, Pointing};
use crate::scene::{Missing, SceneView};
use crate::space;

/// The unit after a length in pixels.
const PIXELS: &str = " px";

/// Writes a placeholder's value from the facts.
pub(super) fn known(
    program: &Program,
    facts: Facts<'_>,
    shown: &Placeholder,
) -> Result<String, Missing> {
    if let Some(text) = constant(program, &facts.pointing, shown) {
        return Ok(text);
    }
    let eval = Eval { program, facts };
    let notation = facts.notation(program);
    let of_field = |name: &str, value: Option<&Value>| {
        let field = program.field(name).ok_or_else(|| Missing::of(name))?;
        let value = value.ok_or_else(|| Missing::of(name))?;
        Ok(notation.value(field, value))
    };
    match shown {
        Placeholder::Text { name } => facts
            .texts
            .get(name)
            .cloned()
            .ok_or_else(|| Missing::of(name)),
        Placeholder::Points { keypoint } => {
            let points = facts.scene.points(keypoint);
            let points = points.ok_or_else(|| Missing::of(keypoint))?;
            let texts: Vec<String> = points
                .iter()
                .map(|point| notation.written(*point))
                .collect();
            Ok(texts.join(", "))
        }
        Placeholder::Point { point } => Ok(notation.written(rounded(eval.point(point)?))),
        Placeholder::Length { length, written } => {
            Ok(self::length(eval.length(length)?, written, &facts.pointing))
        }
        Placeholder::Angle { a, b, written } => Ok(written.write(eval.angle_deg(a, b)?)),
        Placeholder::Number {
            number: value,
            written,
        } => Ok(written.write(eval.number(value)?)),
        Placeholder::Field { field } => of_field(field, facts.proposed(field)),
        Placeholder::LastField { field } => {
            let last = facts.last.ok_or_else(|| Missing::of("last"))?;
            of_field(field, last.proposal.get(field))
        }
        Placeholder::Nearest { field, to } => {
            let deg = eval.nearest_deg(field, to)?;
            of_field(field, Some(&Value::Direction { deg }))
        }
        Placeholder::Quadrant { point, about } => {
            Ok(measures::quadrant(eval.point(point)?, eval.point(about)?).to_owned())
        }
        Placeholder::Unreachable => Ok(unreachable(facts.scene, &notation)),
        Placeholder::Format | Placeholder::PointForm => Err(Missing::of("actions")),
    }
}

/// Writes the unreachable points, each with the reason.
pub(super) fn unreachable(scene: &dyn SceneView, notation: &Notation) -> String {
    let points = scene.unreachable().iter();
    let texts: Vec<String> = points
        .map(|it| format!("{}: {}", notation.written(it.point), it.why))
        .collect();
    if texts.is_empty() {
        "none".to_owned()
    } else {
        texts.join("; ")
    }
}

/// Writes the value of a placeholder that depends only on how points are written; `None` for the others.
pub fn constant(program: &Program, pointing: &Pointing, shown: &Placeholder) -> Option<String> {
    match shown {
        Placeholder::Format => Some(space::format_with(pointing.form(), &program.actions)),
        Placeholder::PointForm => Some(pointing.phrase()),
        Placeholder::Length {
            length: Length::Constant { value },
            written,
        } => Some(length(*value, written, pointing)),
        _ => None,
    }
}

/// Returns whether a placeholder shows points.
pub(super) fn has_points(program: &Program, shown: &Placeholder) -> bool {
    match shown {
        Placeholder::Points { .. }
        | Placeholder::Point { .. }
        | Placeholder::Format
        | Placeholder::Unreachable => true,
        Placeholder::Field { field } | Placeholder::LastField { field } => {
            program.field(field).is_some_and(ActionField::is_point)
        }
        _ => false,
    }
}

/// Describes a placeholder's value in angle brackets.
pub(super) fn typed(program: &Program, name: &str, shown: &Placeholder) -> String {
    if let Some(text) = constant(program, &Pointing::of_camera(&program.camera), shown) {
        return text;
    }
    let reader = |text: &str| {
        let reads = program
            .stages
            .iter()
            .find(|stage| matches!(&stage.read, Read::Text { name: read, .. } if read == text));
        reads.map_or("another stage", |stage| stage.name.as_str())
    };
    let what = match shown {
        Placeholder::Text { name } if name == OVERLAP => {
            "the share of the next subgoal's cloth that the result covers".to_owned()
        }
        Placeholder::Text { name } => format!("the answer of stage {}", reader(name)),
        Placeholder::Points { .. } => "points (x, y), …".to_owned(),
        Placeholder::Point { .. } => "a point (x, y)".to_owned(),
        Placeholder::Length { written, .. } => format!("a length in{}", written.unit),
        Placeholder::Angle { written, .. } => format!("an angle in{}", written.unit),
        Placeholder::Number { .. } => "a number".to_owned(),
        Placeholder::Field { .. } => "the proposed value".to_owned(),
        Placeholder::LastField { .. } => "the value in the action before".to_owned(),
        Placeholder::Nearest { .. } => "the nearest choice".to_owned(),
        Placeholder::Quadrant { .. } => "upper or lower, and left or right".to_owned(),
        Placeholder::Unreachable => "points out of reach, each with why".to_owned(),
        Placeholder::Format | Placeholder::PointForm => "words".to_owned(),
    };
    format!("<{name}: {what}>")
}

/// Writes a length. One in pixels is written in the unit of the model's coordinates.
fn length(value: f64, written: &NumberFormat, pointing: &Pointing) -> String {
    let in_pixels =
        (written.unit == PIXELS).then(|| pointing.frame().length(value * written.factor));
    in_pixels.flatten().unwrap_or_else(|| written.write(value))
}
