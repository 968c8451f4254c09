//! The change of a group in estimated tokens and in money.

use super::groups::Tokens;
use serde_json::{Value, json};

/// A model's price of a question.
pub struct Pricing {
    /// The model, as `PROVIDER:NAME`.
    pub model: String,
    /// Today's price of so many input tokens, US dollars.
    pub usd: Box<dyn Fn(u64) -> f64>,
}

/// Returns the cost in `--json`: the text of each question of the group, sent once; null without a model.
pub fn to_json(tokens: &Tokens, pricing: Option<&Pricing>) -> Value {
    match (tokens.sums(), pricing) {
        (Some([before, after]), Some(pricing)) => json!({
            "model": pricing.model,
            "before_usd": (pricing.usd)(before),
            "after_usd": (pricing.usd)(after),
        }),
        _ => Value::Null,
    }
}

/// Describes the change in tokens and cost in one or two lines; `None` if the group has no question.
pub fn in_words(tokens: &Tokens, pricing: Option<&Pricing>) -> Option<String> {
    let [before, after] = tokens.sums()?;
    let [least, most] = tokens.range()?;
    let count = tokens.questions.len();
    let each = match (least == most, count) {
        (true, _) => format!("{least:+} per question"),
        (false, _) => format!("{least:+} to {most:+} per question"),
    };
    let mut words = format!("tokens (estimated): {each}");
    if count > 1 {
        let sum = i128::from(after) - i128::from(before);
        words.push_str(&format!(", {sum:+} over {count} questions"));
    }
    words.push_str(&match pricing {
        Some(pricing) => {
            let usd = |tokens: i64| {
                let amount = (pricing.usd)(tokens.unsigned_abs());
                let sign = if tokens < 0 { '-' } else { '+' };
                format!("{sign}{amount:.7} USD")
            };
            let each = match least == most {
                true => usd(least),
                false => format!("{} to {}", usd(least), usd(most)),
            };
            format!(
                "\ncost (estimated): {each} per question with {}",
                pricing.model
            )
        }
        None if cfg!(feature = "runtime") => {
            "\nfor the cost, add `--model PROVIDER:NAME`".to_owned()
        }
        None => "\nthis build knows no prices".to_owned(),
    });
    Some(words)
}
