//! The action space of a program: the choices of each field, and their text.
//!
//! In: the declaration, and a scene for fields that choose among its points. Out: values and their texts. Prompt,
//! answer format, schema, reader, verifier and sampler all use these functions, so they cannot drift apart.

use crate::data::actions::Proposal;
use crate::data::actions::{ActionField, Choices, Value};
use crate::data::camera::PixelPoint;
use crate::data::manner::{MANNERS, Manner};
use crate::data::program::Program;
use crate::exact::written;
use crate::scene::SceneView;

/// The most digits after the decimal point of a number in a prompt.
pub const DECIMALS: usize = 4;

/// Returns the values that a field offers in a scene, in the order in which a prompt lists them, each once.
///
/// A keypoint that the scene lacks offers nothing, and unreachable points are not offered. The pixels of a region are
/// not listed: see [`is_offered`].
pub fn choices(field: &ActionField, scene: &dyn SceneView) -> Vec<Value> {
    match &field.choices {
        Choices::Points { keypoints } => {
            let mut offered: Vec<PixelPoint> = Vec::new();
            let points = keypoints
                .iter()
                .filter_map(|keypoint| scene.points(keypoint));
            let is_out_of_reach =
                |point: &PixelPoint| scene.unreachable().iter().any(|it| it.point == *point);
            for point in points.flatten().filter(|point| !is_out_of_reach(point)) {
                if !offered.contains(&point) {
                    offered.push(point);
                }
            }
            offered.into_iter().map(Value::Point).collect()
        }
        _ => declared(field),
    }
}

/// Returns whether a field may have this value in a scene.
pub fn is_offered(field: &ActionField, value: &Value, scene: &dyn SceneView) -> bool {
    match (&field.choices, value) {
        (Choices::Region { mask }, Value::Point(pixel)) => scene
            .distance_px(mask, *pixel)
            .is_some_and(|distance_px| distance_px <= 0.0),
        _ => choices(field, scene).contains(value),
    }
}

/// Writes the choices of a field that offers a region.
pub fn any_of(mask: &str) -> String {
    format!("any point on the {}", mask.replace('_', " "))
}

/// Returns the choices of a field that do not depend on the scene; empty for a field of points.
pub fn declared(field: &ActionField) -> Vec<Value> {
    match &field.choices {
        Choices::Points { .. } | Choices::Region { .. } => Vec::new(),
        Choices::Directions { choices } => choices
            .iter()
            .map(|choice| Value::Direction { deg: choice.deg })
            .collect(),
        Choices::Lengths { choices, .. } => choices
            .iter()
            .map(|choice| Value::Length {
                length: choice.value,
            })
            .collect(),
        Choices::Words { choices } => choices.iter().cloned().map(Value::Word).collect(),
    }
}

/// Returns the manner of one action: what its fields say, and for the others what the task states.
///
/// Returns `None` if a field has a value that is not offered, which the verifier refuses.
pub fn manner(program: &Program, proposal: &Proposal) -> Option<Manner> {
    let mut manner = program.manner;
    for arg in MANNERS {
        let Some(field) = program.field(arg.name) else {
            continue;
        };
        let (Choices::Lengths { choices, .. }, Value::Length { length }) =
            (&field.choices, proposal.get(arg.name)?)
        else {
            return None;
        };
        let chosen = choices.iter().find(|choice| choice.value == *length)?;
        manner = manner.with(arg.name, chosen.m);
    }
    Some(manner)
}

/// Writes a value as prompts list it and answers state it. Points are in pixels;
/// [`Notation`](crate::pointing::Notation) writes other frames.
pub fn text(field: &ActionField, value: &Value) -> String {
    match value {
        Value::Point(point) => point.to_string(),
        Value::Direction { deg } => format!("{} deg", written(*deg, DECIMALS)),
        Value::Length { length } => match &field.choices {
            Choices::Lengths { unit, .. } => {
                format!("{} {}", written(*length, DECIMALS), unit.name)
            }
            _ => written(*length, DECIMALS),
        },
        Value::Word(word) => word.clone(),
    }
}

/// Lists values as prompts do.
pub fn listed(field: &ActionField, values: &[Value]) -> String {
    let texts: Vec<String> = values.iter().map(|value| text(field, value)).collect();
    texts.join(", ")
}

/// Returns a field's name as it is written in sentences.
pub fn spoken(field: &ActionField) -> String {
    field.name.replace('_', " ")
}

/// Writes a field and its value as the format asks for them.
pub fn statement(field: &ActionField, value: &str) -> String {
    let mut letters = field.name.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    let noun = if field.is_point() { " Point" } else { "" };
    format!(
        "{}{}{noun} = {value}",
        first.map(String::from).unwrap_or_default(),
        letters.as_str().replace('_', " ")
    )
}

/// Returns the lines in which an answer must state an action. This replaces `{{ actions.format }}`.
///
/// - `point`: the form of a point, see [`crate::pointing::Pointing::form`].
pub fn format_with(point: &str, actions: &[ActionField]) -> String {
    let line = |field: &ActionField| {
        let values: Vec<String> = declared(field)
            .iter()
            .map(|value| text(field, value))
            .collect();
        let values = if field.is_point() {
            point.to_owned()
        } else {
            values.join(" | ")
        };
        statement(field, &values)
    };
    actions.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// Draws a random action. All choices of a field are equally likely.
///
/// - `below`: returns a number below its argument, which is at least 1; a larger result is reduced to that range.
///
/// Returns `None` if a field has nothing to offer.
pub fn sample(
    program: &Program,
    scene: &dyn SceneView,
    below: &mut dyn FnMut(u64) -> u64,
) -> Option<Proposal> {
    let mut fields = Vec::with_capacity(program.actions.len());
    for field in &program.actions {
        if let Choices::Region { mask } = &field.choices {
            // An area is a whole number far below 2^53.
            let n_pixels = scene.area_px(mask).unwrap_or(0.0) as u64;
            if n_pixels == 0 {
                return None;
            }
            let pixel = scene.region_pixel(mask, below(n_pixels) % n_pixels)?;
            fields.push((field.name.clone(), Value::Point(pixel)));
            continue;
        }
        let mut offered = choices(field, scene);
        if offered.is_empty() {
            return None;
        }
        let n_offered = offered.len() as u64;
        // Smaller than the length of a list in memory, so the conversion loses nothing.
        let index = (below(n_offered) % n_offered) as usize;
        fields.push((field.name.clone(), offered.swap_remove(index)));
    }
    Some(Proposal { fields })
}
