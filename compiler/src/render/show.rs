//! Values as texts.

use crate::eval::{Eval, rounded};
use crate::exact;
use crate::facts::{Facts, Missing};
use crate::program::{Choices, PixelPoint, Program, Read, Shown, Value, Written};
use crate::space;

/// Writes what is known.
pub(super) fn known(program: &Program, facts: Facts<'_>, shown: &Shown) -> Result<String, Missing> {
    let eval = Eval { program, facts };
    let missing = |name: &str| Missing {
        name: name.to_owned(),
    };
    let of_field = |name: &str, value: Option<&Value>| {
        let field = program.field(name).ok_or_else(|| missing(name))?;
        let value = value.ok_or_else(|| missing(name))?;
        Ok(space::text(field, value))
    };
    match shown {
        Shown::Text { name } => facts.texts.get(name).cloned().ok_or_else(|| missing(name)),
        Shown::Points { keypoint } => {
            let points = facts.scene.points(keypoint);
            let points = points.ok_or_else(|| missing(keypoint))?;
            let texts: Vec<String> = points.iter().map(PixelPoint::to_string).collect();
            Ok(texts.join(", "))
        }
        Shown::Point { point } => Ok(rounded(eval.point(point)?).to_string()),
        Shown::Length { length, written } => Ok(number(eval.length(length)?, written)),
        Shown::Angle { a, b, written } => Ok(number(eval.angle_deg(a, b)?, written)),
        Shown::Number {
            number: value,
            written,
        } => Ok(number(eval.number(value)?, written)),
        Shown::Field { field } => of_field(field, facts.proposed(field)),
        Shown::LastField { field } => {
            let last = facts.last.ok_or_else(|| missing("last"))?;
            of_field(field, last.proposal.get(field))
        }
        Shown::Choices { field } => {
            let field = program.field(field).ok_or_else(|| missing(field))?;
            Ok(match &field.choices {
                Choices::Region { mask } => space::any_of(mask),
                _ => space::listed(field, &space::choices(field, facts.scene)),
            })
        }
        Shown::Nearest { field, to } => {
            let deg = eval.nearest_deg(field, to)?;
            of_field(field, Some(&Value::Direction { deg }))
        }
    }
}

/// Says what would stand there.
pub(super) fn typed(program: &Program, name: &str, shown: &Shown) -> String {
    let reader = |text: &str| {
        let reads = program
            .stages
            .iter()
            .find(|stage| matches!(&stage.read, Read::Text { name: read, .. } if read == text));
        reads.map_or("another stage", |stage| stage.name.as_str())
    };
    let what = match shown {
        Shown::Text { name } => format!("the answer of stage {}", reader(name)),
        Shown::Points { .. } => "points (x, y), …".to_owned(),
        Shown::Point { .. } => "a point (x, y)".to_owned(),
        Shown::Length { written, .. } => format!("a length in{}", written.unit),
        Shown::Angle { written, .. } => format!("an angle in{}", written.unit),
        Shown::Number { .. } => "a number".to_owned(),
        Shown::Field { .. } => "the proposed value".to_owned(),
        Shown::LastField { .. } => "the value in the action before".to_owned(),
        Shown::Choices { .. } => "what it may be".to_owned(),
        Shown::Nearest { .. } => "the nearest choice".to_owned(),
    };
    format!("<{name}: {what}>")
}

fn number(value: f64, written: &Written) -> String {
    let digits = exact::written(value * written.factor, usize::from(written.decimals));
    format!("{digits}{}", written.unit)
}
