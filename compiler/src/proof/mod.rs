//! Proves that a program's prompt, schema, reader, verifier and sampler agree on the action space.
//!
//! In: a program. Out: contradictions. Each offered value is written as the prompt and the schema write it. It must
//! be read back unchanged and must not be rejected. Values that are not offered must be rejected with a message that
//! lists the choices. Points come from two generated scenes. The work is bounded and deterministic.

pub(crate) mod certain;
mod declared;
mod flaws;
mod memory;
mod not_offered;
mod scene;

use fab_program::Proposal;
use fab_program::pointing::Notation;
use fab_program::reply;
use fab_program::space;
use fab_program::verify::{self, Verdict};
use fab_program::{ActionField, Choices, Program, Value};
pub use flaws::{Flaw, MAX_CHOICES, MAX_FIELDS};

use flaws::Flaws;
use scene::Generated;

/// Returns the contradictions in a program's action space; empty if it is consistent.
///
/// There is at most one flaw per value, in the order in which they are found. Results are cached by action space.
pub fn flaws(program: &Program) -> Vec<Flaw> {
    let key = memory::key(program);
    if let Some(known) = memory::recall(&key) {
        return known;
    }
    let found = prove(program);
    memory::keep(key, &found);
    found
}

fn prove(program: &Program) -> Vec<Flaw> {
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
    // All values except points have been tried. The smaller scene adds the case of a single point.
    let one = Generated::one(program);
    let proof = Proof::of(program, &one);
    proof.check_answer(
        0,
        &reply::schema_in(program, &Notation::pixels(), &proof.offered),
        &mut found,
    );
    found.list
}

/// A program in one scene.
struct Proof<'a> {
    program: &'a Program,
    scene: &'a Generated,
    /// The offered values of each field.
    offered: Vec<(String, Vec<Value>)>,
    /// The same values as prompts write them.
    texts: Vec<Vec<String>>,
}

/// A field and one of its values, as data and as prompts write it.
#[derive(Clone, Copy)]
struct Tried<'p> {
    field: &'p ActionField,
    value: &'p Value,
    text: &'p str,
}

impl<'a> Proof<'a> {
    fn of(program: &'a Program, scene: &'a Generated) -> Proof<'a> {
        let offered: Vec<(String, Vec<Value>)> = program
            .actions
            .iter()
            .map(|field| (field.name.clone(), scene.offered(field)))
            .collect();
        let written = |(field, (_, values)): (&ActionField, &(String, Vec<Value>))| {
            let texts = values.iter().map(|value| space::text(field, value));
            texts.collect()
        };
        let texts = program.actions.iter().zip(&offered).map(written).collect();
        Proof {
            program,
            scene,
            offered,
            texts,
        }
    }

    /// Returns the fields with one value each: value `index`, counting round if there are fewer.
    fn tried(&self, index: usize) -> Vec<Tried<'_>> {
        let values = self.offered.iter().zip(&self.texts);
        self.program
            .actions
            .iter()
            .zip(values)
            .map(|(field, ((_, values), texts))| Tried {
                field,
                value: &values[index % values.len()],
                text: &texts[index % texts.len()],
            })
            .collect()
    }

    /// Checks that every offered value is read back unchanged, from text and from JSON, and is not rejected.
    fn check_offered(&self, found: &mut Flaws) {
        let schema = reply::schema_in(self.program, &Notation::pixels(), &self.offered);
        let most = self.texts.iter().map(Vec::len).max();
        for index in 0..most.unwrap_or(0) {
            self.check_answer(index, &schema, found);
        }
    }

    /// Checks that the answer with value `index` of each field is read back, from text and from JSON.
    fn check_answer(&self, index: usize, schema: &serde_json::Value, found: &mut Flaws) {
        let tried = self.tried(index);
        self.check_reading(&tried, &answer(&tried), Form::Asked, found);
        let mut object = serde_json::Map::new();
        for (one, texts) in tried.iter().zip(&self.texts) {
            // For a region the schema gives only the form.
            if let Choices::Region { .. } = one.field.choices {
                object.insert(one.field.name.clone(), one.text.into());
                continue;
            }
            let listed = &schema["properties"][&one.field.name]["enum"][index % texts.len()];
            if *listed != one.text {
                let message = format!("`{}` is not in the schema", one.text);
                found.push(one.field, one.text, message);
            }
            object.insert(one.field.name.clone(), listed.clone());
        }
        let object = serde_json::Value::Object(object).to_string();
        self.check_reading(&tried, &object, Form::Json, found);
    }

    fn check_reading(&self, tried: &[Tried<'_>], answer: &str, form: Form, found: &mut Flaws) {
        let reading = match reply::read_action(self.program, answer) {
            Ok(reading) => reading,
            Err(malformed) => {
                let wrong = tried.iter().find(|one| one.field.name == malformed.field);
                if let Some(one) = wrong.or(tried.first()) {
                    let why = malformed.message.lines().next().unwrap_or_default();
                    let (text, form) = (one.text, form.named());
                    let message = format!("`{text}` cannot be read from {form}: {why}");
                    found.push(one.field, text, message);
                }
                return;
            }
        };
        for Tried { field, value, text } in tried {
            let read = reading.value.get(&field.name);
            if read != Some(*value) {
                let read = read.map_or(String::new(), |read| space::text(field, read));
                let message = format!("`{text}` is read as `{read}` from {}", form.named());
                found.push(field, text, message);
            }
        }
        // Prompts do not ask for JSON, so reading it always counts as a repair.
        if form == Form::Json {
            return;
        }
        for repair in &reading.repairs {
            let names =
                |one: &&Tried<'_>| repair.contains(&format!("as the {}", space::spoken(one.field)));
            if let Some(one) = tried.iter().find(names).or(tried.first()) {
                let message = format!("`{}` is read only with a repair: {repair}", one.text);
                found.push(one.field, one.text, message);
            }
        }
        if let Some((field, text)) = self.unoffered(&reading.value) {
            found.push(field, &text, format!("`{text}` is offered, and refused"));
        }
    }

    /// Returns the first field whose value the verifier rejects as not offered, and the value's text.
    fn unoffered(&self, proposal: &Proposal) -> Option<(&'a ActionField, String)> {
        let refused = verify::unoffered(self.program, self.scene, proposal, &Notation::pixels);
        let Ok(Some(Verdict::Reject { values, .. })) = refused else {
            return None;
        };
        let (name, text) = values.into_iter().next()?;
        Some((self.program.field(&name)?, text))
    }

    /// Checks that values that are not offered are rejected, with the field's name and its choices.
    fn check_others(&self, found: &mut Flaws) {
        for (position, (field, (_, offered))) in
            self.program.actions.iter().zip(&self.offered).enumerate()
        {
            let others = match field.choices {
                Choices::Region { .. } => not_offered::beside(self.program, &self.texts[position]),
                _ => not_offered::of(field, offered, &self.texts[position]),
            };
            let mut tried = self.tried(0);
            let choice = match &field.choices {
                Choices::Region { mask } => space::any_of(mask),
                _ => tried[position].text.to_owned(),
            };
            for other in &others {
                tried[position].text = other;
                if let Err(message) = self.refused(field, &choice, &answer(&tried)) {
                    let excerpt: String = other.chars().take(40).collect();
                    let message = format!("`{excerpt}` is not offered, but {message}");
                    found.push(field, &excerpt, message);
                }
            }
        }
    }

    /// Fails if an answer is not rejected for a field, or if the message lacks the field's name or its first choice.
    fn refused(&self, field: &ActionField, first: &str, answer: &str) -> Result<(), String> {
        let names_both = |message: &str, choice: &str| {
            message.contains(&space::spoken(field)) && message.contains(choice)
        };
        let (refused, is_clear) = match reply::read_action(self.program, answer) {
            Err(malformed) => {
                // Only the verifier knows which points a scene offers.
                let choice = if field.is_point() { "(x, y)" } else { first };
                let is_clear = names_both(&malformed.message, choice);
                (malformed.field, is_clear)
            }
            Ok(reading) => {
                match verify::unoffered(self.program, self.scene, &reading.value, &Notation::pixels)
                {
                    Ok(Some(Verdict::Reject {
                        values, message, ..
                    })) => {
                        let name = values.into_iter().next().map(|(name, _)| name);
                        (name.unwrap_or_default(), names_both(&message, first))
                    }
                    _ => {
                        let read = reading.value.get(&field.name);
                        let read = read.map_or(String::new(), |read| space::text(field, read));
                        return Err(format!("read as `{read}`"));
                    }
                }
            }
        };
        if refused != field.name {
            Err(format!("`{refused}` is refused instead"))
        } else if is_clear {
            Ok(())
        } else {
            Err("its refusal does not name the field and the choices".to_owned())
        }
    }

    /// Checks that the sampler draws offered values.
    fn check_sampler(&self, found: &mut Flaws) {
        for draw in [0, 1, 2, 12_345_678_901, u64::MAX] {
            let drawn = space::sample(self.program, self.scene, &mut |_| draw);
            if let Some((field, text)) = drawn.and_then(|drawn| self.unoffered(&drawn)) {
                found.push(
                    field,
                    &text,
                    format!("`{text}` is sampled, but not offered"),
                );
            }
        }
    }
}

/// Writes an answer in the format that prompts ask for.
fn answer(tried: &[Tried<'_>]) -> String {
    let lines: Vec<String> = tried
        .iter()
        .map(|one| space::statement(one.field, one.text))
        .collect();
    lines.join("\n")
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
