//! The policy that plays a network: it takes the offered action with the highest value.
//!
//! In: an ONNX file whose inputs are among [`INPUTS`] and whose output is `values`. Out: of the offered actions that the
//! task's checks accept, the one with the highest value. The network values [`BATCH`] actions at a time.
//! `docs/policies.md` documents the inputs. `smoother` is such a network, part of the program.
//!
//! The runtime computes with what the processor offers, so the last bits of a value depend on the processor.

use super::expert::least_refused;
use super::proposing::{Source, stop, until_accepted};
use super::{Decision, Description, Exchange, Kind, Policy, RunError, StepView};
use crate::action::{Action, MOST_COMBINATIONS, combinations};
use crate::outcome::Outcome;
use fab_base::wording::quoted;
use fab_base::{digest, files};
use fab_program::verify::{Strictness, Verdict};
use fab_program::{ActionField, Choices, Face, Program, Proposal, space};
use rten::{DataType, Dimension, Model, NodeInfo, Value, ValueType};
use std::path::Path;
use std::sync::Arc;

/// The network that smooths; `scripts/smoother/fit.py` fits such a file.
const SMOOTHER: &[u8] = include_bytes!("smoother.onnx");

/// The largest file, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// The most actions that a network values at once: `smoother` needs some 0.2 MB for each, several times.
const BATCH: usize = 256;

/// What a network may take, with its shape: H and W are the picture's height and width, N is the number of actions.
const INPUTS: [(&str, &[&str]); 7] = [
    ("color", &["H", "W", "3"]),
    ("depth", &["H", "W"]),
    ("cloth", &["H", "W"]),
    ("faces", &["2", "3"]),
    ("edge", &[]),
    ("picks", &["N", "2"]),
    ("places", &["N", "2"]),
];

/// What a network returns.
const OUTPUTS: [(&str, &[&str]); 1] = [("values", &["N"])];

/// The fields by which a network is told an action.
const MOVING: [&str; 4] = ["pick", "place", "direction", "distance"];

/// Plays a network.
#[derive(Clone)]
pub struct Onnx {
    name: String,
    model: Arc<Model>,
    /// SHA-256 of the file.
    code: String,
}

impl Onnx {
    /// Reads a network from a file; its name is `onnx:FILE`. Fails with the reason, in words.
    pub fn read(path: &Path) -> Result<Onnx, String> {
        let file = path.display().to_string();
        let bytes = files::read(path, MAX_BYTES);
        let bytes = bytes.map_err(|why| format!("`{file}` cannot be read: {why}"))?;
        Onnx::of(format!("onnx:{file}"), &file, bytes)
    }

    /// Returns the network that smooths crumpled cloths, one pull at a time.
    pub fn smoother() -> Onnx {
        let name = "smoother";
        Onnx::of(name.to_owned(), name, SMOOTHER.to_vec())
            .expect("the network in the program is whole")
    }

    fn of(name: String, file: &str, bytes: Vec<u8>) -> Result<Onnx, String> {
        let code = digest::of(&bytes);
        let model = Model::load(bytes).map_err(|error| {
            format!("`{file}` is not an ONNX network that fabc can run: {error}")
        })?;
        let model = Arc::new(model);
        Ok(Onnx { name, model, code })
    }
}

/// Checks the names, types and shapes of inputs and output for pictures of this width and height; fails with what is wrong.
fn check_interface(model: &Model, image_px: u32) -> Result<(), String> {
    let inputs = model.input_ids().iter().map(|id| (id, &INPUTS[..]));
    let outputs = model.output_ids().iter().map(|id| (id, &OUTPUTS[..]));
    let mut tells_apart = false;
    for (id, known) in inputs.chain(outputs) {
        let info = model.node_info(*id);
        let name = info.as_ref().and_then(NodeInfo::name).unwrap_or_default();
        let Some((_, shape)) = known.iter().find(|(known, _)| *known == name) else {
            return Err(format!(
                "takes or returns `{name}`, which fabc does not know; the inputs are {}, and the output is `values`",
                quoted(INPUTS.map(|(input, _)| input))
            ));
        };
        tells_apart |= ["picks", "places"].contains(&name);
        let dtype = info.as_ref().and_then(NodeInfo::dtype);
        if dtype.is_some_and(|it| it != ValueType::Tensor(DataType::Float)) {
            return Err(format!(
                "declares `{name}` of another type; it must be float32"
            ));
        }
        // A side without a number may have any length.
        let fits = |(declared, side): (&Dimension, &&str)| match (declared, *side) {
            (Dimension::Symbolic(_), _) => true,
            (Dimension::Fixed(length), "H" | "W") => *length == image_px as usize,
            (Dimension::Fixed(length), side) => length.to_string() == side,
        };
        let declared = info.as_ref().and_then(NodeInfo::shape);
        let Some(declared) = declared.filter(|declared| {
            declared.len() != shape.len() || !declared.iter().zip(*shape).all(fits)
        }) else {
            continue;
        };
        let declared = declared.iter().map(|side| match side {
            Dimension::Fixed(length) => length.to_string(),
            Dimension::Symbolic(name) => name.clone(),
        });
        return Err(format!(
            "declares `{name}` as [{}]; it must be [{}], where H and W are {image_px}",
            declared.collect::<Vec<_>>().join(", "),
            shape.join(", ")
        ));
    }
    if tells_apart {
        return Ok(());
    }
    let why = "takes neither `picks` nor `places`, so it cannot tell actions apart";
    Err(why.to_owned())
}

/// An offered action, and where it picks and places in the picture, `[column, row]`, pixels.
struct Offer {
    proposal: Proposal,
    pick_px: [f64; 2],
    place_px: [f64; 2],
}

impl Policy for Onnx {
    fn description(&self) -> Description {
        Description {
            code: Some(self.code.clone()),
            ..Description::new(Kind::Network, self.name.clone())
        }
    }

    fn varies(&self) -> bool {
        false
    }

    fn prepare(&self, program: &Program) -> Result<(), RunError> {
        let (task, policy) = (program.title(), &self.name);
        let is_region = |it: &&ActionField| matches!(it.choices, Choices::Region { .. });
        if let Some(field) = program.actions.iter().find(is_region) {
            return Err(RunError::Unfit(format!(
                "`{}` of `{task}` is any pixel of a mask, and `--policy {policy}` compares listed points: write `one of`",
                field.name
            )));
        }
        let checked = check_interface(&self.model, program.camera.image_px);
        checked.map_err(|why| RunError::Unfit(format!("the network of `--policy {policy}` {why}")))
    }

    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, RunError> {
        let ranked = match self.offers(step) {
            Ok(offers) => self.ranked(step, accepted_first(step, offers)?),
            Err(why) => Err(why),
        };
        until_accepted(step, exchange, &mut |refusals, _| {
            let mut source = Source::default();
            let answer = match &ranked {
                Err(why) => stop(Outcome::PolicyFailed, why),
                Ok(ranked) => match ranked.get(refusals.len()) {
                    Some((value, offer)) => {
                        source.note = Some(format!("value {value:.3}"));
                        Ok(offer.proposal.clone())
                    }
                    None => stop(Outcome::NoCandidates, "no other action is offered"),
                },
            };
            Ok((source, answer))
        })
    }
}

impl Onnx {
    /// Lists the offered actions: every combination of the fields that move the gripper, and of each other field the
    /// value that is nearest to the usual.
    /// Fails if there are more than [`MOST_COMBINATIONS`].
    fn offers(&self, step: &StepView<'_>) -> Result<Vec<Offer>, String> {
        let all = combinations(step.program, |field| {
            if MOVING.contains(&field.name.as_str()) {
                space::choices(field, step.scene)
            } else {
                least_refused(step.ground, field, &[]).into_iter().collect()
            }
        });
        if all.len() > MOST_COMBINATIONS {
            let n_offered = all.len();
            let (task, policy) = (step.program.title(), &self.name);
            return Err(format!(
                "`{task}` offers {n_offered} actions, and `--policy {policy}` compares at most {MOST_COMBINATIONS}: offer fewer"
            ));
        }
        let offers = all.filter_map(|proposal| {
            let observation = step.observation;
            let action = Action::lower(step.program, &proposal, step.scene, observation)?;
            let pixel = |point| observation.camera.pixel_from_world(point);
            Some(Offer {
                pick_px: pixel(action.grip.pick)?,
                place_px: pixel(action.grip.place)?,
                proposal,
            })
        });
        Ok(offers.collect())
    }

    /// Values the offered actions; the highest first, equal ones in the order of the offer. Fails with the reason.
    fn ranked(&self, step: &StepView<'_>, offers: Vec<Offer>) -> Result<Vec<(f32, Offer)>, String> {
        let mut values = Vec::with_capacity(offers.len());
        for batch in offers.chunks(BATCH) {
            values.extend(self.values_of_batch(step, batch)?);
        }
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return Err(format!(
                "the network's value of action {} of {} is {}, which is not finite",
                at + 1,
                values.len(),
                values[at]
            ));
        }
        let mut ranked: Vec<_> = values.into_iter().zip(offers).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        Ok(ranked)
    }

    /// Runs the network once.
    fn values_of_batch(&self, step: &StepView<'_>, offers: &[Offer]) -> Result<Vec<f32>, String> {
        let inputs = self.model.input_ids().iter().filter_map(|id| {
            let info = self.model.node_info(*id)?;
            let (name, shape) = INPUTS.iter().find(|(name, _)| info.name() == Some(*name))?;
            let (width, height) = step.observation.rgb.dimensions();
            let shape = shape.iter().map(|side| match *side {
                "H" => height as usize,
                "W" => width as usize,
                "N" => offers.len(),
                length => length.parse().expect("a side is a letter or a number"),
            });
            let shape: Vec<usize> = shape.collect();
            let value = Value::from_shape(shape, input(name, step, offers));
            Some(value.map(|value| (*id, value.into())))
        });
        let inputs = inputs.collect::<Result<Vec<_>, _>>();
        let inputs = inputs.map_err(|error| error.to_string())?;
        let outputs = self.model.run(inputs, self.model.output_ids(), None);
        let outputs = outputs.map_err(|error| format!("the network failed: {error}"))?;
        let output = outputs.into_iter().next();
        let output = output.ok_or("the network returned nothing")?;
        let ([length], values) = output
            .into_shape_vec::<f32, 1>()
            .map_err(|error| format!("the network's `values` must be [N], float32: {error}"))?;
        if length != offers.len() {
            return Err(format!(
                "the network returned {length} values for {} actions",
                offers.len()
            ));
        }
        Ok(values)
    }
}

/// Returns the numbers of an input, row by row.
fn input(name: &str, step: &StepView<'_>, offers: &[Offer]) -> Vec<f32> {
    let observation = step.observation;
    let cloth = &step.program.cloth;
    let level = |level: &u8| f32::from(*level) / 255.0;
    let points = |of: fn(&Offer) -> [f64; 2]| {
        let points = offers.iter().flat_map(of);
        points.map(|part| part as f32).collect()
    };
    match name {
        "color" => observation.rgb.as_raw().iter().map(level).collect(),
        "depth" => observation.depth_m.as_raw().clone(),
        "cloth" => {
            let (width, height) = observation.rgb.dimensions();
            let mask = step.scene.cloth();
            let pixels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
            let is_cloth = |(column, row)| mask.is_some_and(|mask| mask.contains_at(column, row));
            pixels.map(|at| f32::from(u8::from(is_cloth(at)))).collect()
        }
        "faces" => {
            let faces = [Face::Upper, Face::Under].map(|face| cloth.colour(face).rgb);
            faces.as_flattened().iter().map(level).collect()
        }
        "edge" => vec![(cloth.edge_m() * step.program.camera.px_per_m()) as f32],
        "picks" => points(|offer| offer.pick_px),
        _ => points(|offer| offer.place_px),
    }
}

/// Keeps the actions that the task's checks accept; all of them if there is none, for a task that then drops a check.
fn accepted_first(step: &StepView<'_>, offers: Vec<Offer>) -> Result<Vec<Offer>, RunError> {
    let (facts, mut accepted, mut refused) = (step.facts(), Vec::new(), Vec::new());
    for offer in offers {
        match step.verdict(facts, &offer.proposal, Strictness::Full)? {
            Verdict::Accept => accepted.push(offer),
            Verdict::Reject { .. } => refused.push(offer),
        }
    }
    Ok(if accepted.is_empty() {
        refused
    } else {
        accepted
    })
}
