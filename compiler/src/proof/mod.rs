//! Proves for a program that prompt, schema, reader, verifier and sampler mean the same action space.
//!
//! In: a program. Out: what contradicts itself. Each offered value is written as prompts and schema write it,
//! and must be read back as itself and not be refused; values beside the offered ones must be refused with the
//! choices. Points are those of two generated scenes. The work is bounded and the same every time.

mod declared;
mod others;
mod scene;

use crate::program::{ActionField, Choices, Program, Value};
use crate::reply::{self, Proposal};
use crate::space;
use crate::verify::{self, Verdict};
use scene::Generated;

/// The most choices of one field; more are no list that a model can choose from.
pub const MAX_CHOICES: usize = 1_000;

/// The most fields of an action.
pub const MAX_FIELDS: usize = 16;

/// The most flaws that are reported.
const MAX_FLAWS: usize = 50;

/// A contradiction in an action space.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// The field.
    pub field: String,
    /// The value as prompts write it; empty where the field as a whole is flawed.
    pub value: String,
    /// What is wrong, lower case and without a full stop.
    pub message: String,
}

/// Returns what contradicts itself in a program's action space; nothing where it is consistent.
///
/// At most one flaw for each value, in the order in which they are found.
pub fn flaws(program: &Program) -> Vec<Flaw> {
    let mut found = Flaws::default();
    declared::check(program, &mut found);
    if found.is_hopeless {
        return found.list;
    }
    let many = Generated::many(program);
    let proof = Proof::of(program, &many);
    if proof.offered.iter().any(|(_, values)| values.is_empty()) {
        return found.list;
    }
    proof.check_offered(&mut found);
    proof.check_others(&mut found);
    proof.check_sampler(&mut found);
    // What is no point has been tried; the smaller scene adds the case of a single one.
    let one = Generated::one(program);
    let proof = Proof::of(program, &one);
    proof.check_answer(0, &reply::schema(program, &proof.offered), &mut found);
    found.list
}

/// What was found so far.
#[derive(Default)]
struct Flaws {
    list: Vec<Flaw>,
    /// Whether values cannot be tried at all.
    is_hopeless: bool,
}

impl Flaws {
    fn push(&mut self, field: &ActionField, value: &str, message: String) {
        let is_known = self
            .list
            .iter()
            .any(|flaw| flaw.field == field.name && flaw.value == value);
        if !is_known && self.list.len() < MAX_FLAWS {
            self.list.push(Flaw {
                field: field.name.clone(),
                value: value.to_owned(),
                message,
            });
        }
    }
}

/// A program in one scene.
struct Proof<'a> {
    program: &'a Program,
    scene: &'a Generated,
    /// For each field what it may be.
    offered: Vec<(String, Vec<Value>)>,
}

impl<'a> Proof<'a> {
    fn of(program: &'a Program, scene: &'a Generated) -> Proof<'a> {
        let offered = program
            .actions
            .iter()
            .map(|field| (field.name.clone(), space::choices(field, scene)))
            .collect();
        Proof {
            program,
            scene,
            offered,
        }
    }

    /// Returns the fields with one value each: the `index`-th, from the first again where there are fewer.
    fn values(&self, index: usize) -> Vec<(&'a ActionField, &Value)> {
        let fields = self.program.actions.iter().zip(&self.offered);
        fields
            .map(|(field, (_, values))| (field, &values[index % values.len()]))
            .collect()
    }

    /// Every offered value is read back as itself, from text and from JSON, and is not refused.
    fn check_offered(&self, found: &mut Flaws) {
        let schema = reply::schema(self.program, &self.offered);
        let most = self.offered.iter().map(|(_, values)| values.len()).max();
        for index in 0..most.unwrap_or(0) {
            self.check_answer(index, &schema, found);
        }
    }

    /// The answer that states the `index`-th value of each field is read back, from text and from JSON.
    fn check_answer(&self, index: usize, schema: &serde_json::Value, found: &mut Flaws) {
        let values = self.values(index);
        let lines: Vec<String> = values
            .iter()
            .map(|(field, value)| space::statement(field, &space::text(field, value)))
            .collect();
        self.check_reading(&values, &lines.join("\n"), Form::Asked, found);
        let mut object = serde_json::Map::new();
        for ((field, value), (_, all)) in values.iter().zip(&self.offered) {
            let listed = &schema["properties"][&field.name]["enum"][index % all.len()];
            let text = space::text(field, value);
            if *listed != text.as_str() {
                found.push(field, &text, format!("`{text}` is not in the schema"));
            }
            object.insert(field.name.clone(), listed.clone());
        }
        let object = serde_json::Value::Object(object).to_string();
        self.check_reading(&values, &object, Form::Json, found);
    }

    fn check_reading(
        &self,
        values: &[(&ActionField, &Value)],
        answer: &str,
        form: Form,
        found: &mut Flaws,
    ) {
        let reading = match reply::read_action(self.program, answer) {
            Ok(reading) => reading,
            Err(malformed) => {
                let wrong = values
                    .iter()
                    .find(|(field, _)| field.name == malformed.field);
                if let Some((field, value)) = wrong {
                    let text = space::text(field, value);
                    let why = malformed.message.lines().next().unwrap_or_default();
                    let message = format!("`{text}` cannot be read from {}: {why}", form.named());
                    found.push(field, &text, message);
                }
                return;
            }
        };
        for (field, value) in values {
            let text = space::text(field, value);
            let read = reading.value.get(&field.name);
            if read != Some(value) {
                let read = read.map_or(String::new(), |read| space::text(field, read));
                let message = format!("`{text}` is read as `{read}` from {}", form.named());
                found.push(field, &text, message);
            }
            let repair = format!("as the {}", space::spoken(field));
            if let Some(repair) = reading.repairs.iter().find(|it| it.contains(&repair))
                && form == Form::Asked
            {
                let message = format!("`{text}` is read only with a repair: {repair}");
                found.push(field, &text, message);
            }
        }
        if let Ok(Some(Verdict::Reject { values: parts, .. })) =
            verify::unoffered(self.program, self.scene, &reading.value)
            && let Some((name, text)) = parts.first()
            && let Some(field) = self.program.field(name)
        {
            found.push(field, text, format!("`{text}` is offered, and refused"));
        }
    }

    /// Values beside the offered ones are refused, with the field's name and its choices.
    fn check_others(&self, found: &mut Flaws) {
        for (position, (field, (_, offered))) in
            self.program.actions.iter().zip(&self.offered).enumerate()
        {
            for other in others::of(field, offered) {
                let lines: Vec<String> = self
                    .values(0)
                    .iter()
                    .enumerate()
                    .map(|(index, (field, value))| {
                        let text = space::text(field, value);
                        space::statement(field, if index == position { &other } else { &text })
                    })
                    .collect();
                if let Err(message) = self.refused(field, &offered[0], &lines.join("\n")) {
                    let shown: String = other.chars().take(40).collect();
                    found.push(
                        field,
                        &shown,
                        format!("`{shown}` is not offered, but {message}"),
                    );
                }
            }
        }
    }

    /// Fails where an answer is not refused for a field, or without its name and its first choice.
    fn refused(&self, field: &ActionField, first: &Value, answer: &str) -> Result<(), String> {
        let is_point = matches!(field.choices, Choices::Points { .. });
        let (refused, message) = match reply::read_action(self.program, answer) {
            Err(malformed) => (malformed.field, malformed.message),
            Ok(reading) => match verify::unoffered(self.program, self.scene, &reading.value) {
                Ok(Some(Verdict::Reject {
                    values, message, ..
                })) => {
                    let name = values
                        .first()
                        .map_or(String::new(), |(name, _)| name.clone());
                    (name, message)
                }
                _ => {
                    let read = reading.value.get(&field.name);
                    let read = read.map_or(String::new(), |read| space::text(field, read));
                    return Err(format!("read as `{read}`"));
                }
            },
        };
        let choice = if is_point {
            String::new()
        } else {
            space::text(field, first)
        };
        if refused != field.name {
            Err(format!("`{refused}` is refused instead"))
        } else if !message.contains(&space::spoken(field)) || !message.contains(&choice) {
            Err("its refusal does not name the field and the choices".to_owned())
        } else {
            Ok(())
        }
    }

    /// The sampler draws what is offered.
    fn check_sampler(&self, found: &mut Flaws) {
        for draw in [0, 1, 2, 12_345_678_901, u64::MAX] {
            let drawn = space::sample(self.program, self.scene, &mut |below| draw % below.max(1));
            let Some(drawn) = drawn else {
                continue;
            };
            for (field, (_, values)) in self.program.actions.iter().zip(&self.offered) {
                let value = drawn.get(&field.name);
                if let Some(value) = value.filter(|value| !values.contains(value)) {
                    let text = space::text(field, value);
                    found.push(field, &text, format!("`{text}` is drawn, but not offered"));
                }
            }
            self.check_verdict(&drawn, found);
        }
    }

    fn check_verdict(&self, drawn: &Proposal, found: &mut Flaws) {
        if let Ok(Some(Verdict::Reject { values, .. })) =
            verify::unoffered(self.program, self.scene, drawn)
            && let Some((name, text)) = values.first()
            && let Some(field) = self.program.field(name)
        {
            found.push(field, text, format!("`{text}` is drawn, and refused"));
        }
    }
}

/// How an answer is written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    /// As the format asks.
    Asked,
    /// As the schema asks.
    Json,
}

impl Form {
    fn named(self) -> &'static str {
        match self {
            Form::Asked => "the answer that is asked for",
            Form::Json => "the answer that the schema asks for",
        }
    }
}
