//! Writes what a probe found out as an entry of a file of facts.

use super::{Abilities, Probe};
use crate::catalogue::{Date, Facts, PositionFormat};
use fab_model::lowering::Resize;
use serde_json::{Value, json};

/// How much worse than the best the next convention must fit to be ruled out.
const CLEARLY: f64 = 2.0;
/// The largest mean error of a model that sees the dots, as a part of the smaller picture's side.
const MOST_ERROR: f64 = 0.1;

impl Probe {
    /// Returns how the model states positions, if each dot was named and one unit and order fits clearly best.
    pub fn coordinates(&self) -> Option<PositionFormat> {
        let best = self.tried.first()?;
        if self.read < self.dots || best.error.mean > MOST_ERROR * f64::from(super::SIDES_PX[0]) {
            return None;
        }
        let fits_too = |error: f64| error < best.error.mean.max(0.5) * CLEARLY;
        let is_same = |tried: &&super::Tried| {
            (tried.lowering.unit, tried.lowering.order) == (best.lowering.unit, best.lowering.order)
        };
        if self
            .tried
            .iter()
            .any(|tried| !is_same(&tried) && fits_too(tried.error.mean))
        {
            return None;
        }
        // Sizes that were hardly changed fit nearly as well: then the picture as sent is assumed.
        let unresized = self.tried.iter().filter(is_same).find(|tried| {
            !matches!(tried.lowering.resize, Resize::Multiples { .. }) && fits_too(tried.error.mean)
        });
        let resize = unresized.unwrap_or(best).lowering.resize;
        Some(PositionFormat {
            unit: best.lowering.unit,
            order: best.lowering.order,
            multiples_of_px: match resize {
                Resize::Multiples { of_px } => Some(of_px.get()),
                Resize::Never | Resize::Within { .. } => None,
            },
        })
    }
}

/// Joins the facts that dots and short questions show.
pub fn facts(dots: Option<&Probe>, abilities: &Abilities) -> Facts {
    let coordinates = dots.and_then(Probe::coordinates);
    Facts {
        coordinates,
        // A model that says where dots are has seen them.
        vision: abilities.facts.vision.or(coordinates.map(|_| true)),
        ..abilities.facts.clone()
    }
}

/// Writes the TOML of a model, ready to paste; remarks are comments.
pub fn toml(provider: &str, id: &str, facts: &Facts, remarks: &[String], today: Date) -> String {
    let mut fields = vec![
        ("provider".to_owned(), json!(provider)),
        ("id".to_owned(), json!(id)),
    ];
    let known = serde_json::to_value(facts)
        .expect("facts are tables, texts, finite numbers and truth values");
    if let Value::Object(known) = known {
        fields.extend(known.into_iter().filter(|(_, value)| !value.is_null()));
    }
    fields.push(("as_of".to_owned(), json!(today)));
    fields.push(("source".to_owned(), json!("fabc probe")));
    let fields = fields
        .iter()
        .map(|(name, value)| format!("{name} = {}", inline(value)));
    let remarks = remarks.iter().map(|remark| {
        // What a server wrote must not end the comment.
        let remark: String = remark
            .chars()
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        format!("# {remark}")
    });
    let lines: Vec<String> = std::iter::once("[[model]]".to_owned())
        .chain(fields)
        .chain(remarks)
        .collect();
    lines.join("\n")
}

/// Writes a value on one line; TOML escapes texts as JSON does.
fn inline(value: &Value) -> String {
    match value {
        Value::Object(fields) => {
            let fields = fields.iter().filter(|(_, value)| !value.is_null());
            let fields: Vec<String> = fields
                .map(|(name, value)| format!("{name} = {}", inline(value)))
                .collect();
            format!("{{ {} }}", fields.join(", "))
        }
        Value::Array(values) => {
            let values: Vec<String> = values.iter().map(inline).collect();
            format!("[{}]", values.join(", "))
        }
        plain => plain.to_string(),
    }
}
