//! Collects the gains of pulls in the simulator, for refitting the stand-in's estimate.
//!
//! `cargo run --release -p fab-agent --example collect_pulls -- FIRST_SEED COUNT ACTIONS > pulls.csv`
//!
//! In: seeds of crumpled starts. Out: a line per pull: its start, step, true coverage before and gain, and the features
//! of [`FEATURES`]. Each start is smoothed by the stand-in. Before each action its own pull, the next five by its
//! estimate and two random ones are tried from the same state. In three of ten cases the best of them is executed
//! instead of its own, to reach states that it would not reach by itself. `scripts/fit-pulls.py` fits the estimate.

use fab_agent::action::Action;
use fab_agent::examples::Examples;
use fab_agent::pictures::Pictures;
use fab_agent::policy::{Asking, Decision, Exchange, Policy, Prompted, StepView};
use fab_agent::scene::Scene;
use fab_base::cache::Cache;
use fab_base::chance::Chance;
use fab_base::interrupt::Interrupt;
use fab_base::parallel::in_parallel;
use fab_compiler::{LoadError, Loader};
use fab_model::Models;
use fab_model::calls::Calls;
use fab_model::{Message, Model, ModelError, ModelKind, Reply, Request};
use fab_program::Proposal;
use fab_program::facts::ExecutedAction;
use fab_program::{Program, Value};
use fab_standins::geometric::{FEATURES, Geometric, Offer, offers};
use fab_world::crumple;
use fab_world::metrics;
use fab_world::start::Start;
use fab_world::{SimulatedWorld, World};

use std::error::Error;
use std::fmt::Write as _;
use std::sync::{Mutex, MutexGuard, PoisonError};

type Failure = Box<dyn Error + Send + Sync>;

const TASK: &str = "tasks/smoothing.fab";

/// How many pulls are tried beside the stand-in's own: the next ones by its estimate, and random ones.
const NEXT: usize = 5;
const BY_CHANCE: usize = 2;

/// Sides of the cloths, particles.
const SIDES: [u32; 5] = [40, 41, 42, 43, 44];

fn main() -> Result<(), Failure> {
    let given: Vec<usize> = std::env::args()
        .skip(1)
        .map(|word| word.parse())
        .collect::<Result<_, _>>()?;
    let [first, count, actions] = given[..] else {
        return Err("give the first seed, how many seeds, and how many actions each".into());
    };
    let threads = std::thread::available_parallelism()?.get();
    let tried = in_parallel(
        count,
        threads,
        |index| smooth((first + index) as u64, actions).map(Some),
        |done| eprintln!("{done} of {count} starts"),
    )?;
    println!("start,step,coverage,gain,{}", FEATURES.join(","));
    print!("{}", tried.into_iter().flatten().collect::<String>());
    Ok(())
}

/// The working directory's files.
struct Here;

impl Loader for Here {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        std::fs::read_to_string(name).map_err(|error| LoadError {
            message: format!("{name}: {error}"),
        })
    }
}

/// The stand-in, and the last question that it got.
#[derive(Default)]
struct Overheard(Mutex<Vec<Message>>);

impl Overheard {
    fn question(&self) -> MutexGuard<'_, Vec<Message>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Model for Overheard {
    fn name(&self) -> &str {
        Geometric.name()
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        *self.question() = request.messages.clone();
        Geometric.ask(request, calls)
    }
}

/// A pull that was tried, and its result.
struct Tried {
    proposal: Proposal,
    action: Action,
    coverage: f64,
    end: Start,
}

/// Smooths one start and returns a line for each pull tried.
fn smooth(seed: u64, actions: usize) -> Result<String, Failure> {
    let side = SIDES[(seed % SIDES.len() as u64) as usize];
    let compiled = fab_compiler::compile_for(TASK, &Here, Some([side, side]))?;
    let programs = compiled.programs.into_iter();
    let mut plain = programs.filter(|program| program.variant.is_none());
    let program = plain.next().ok_or("the task does not compile")?;
    let mut world = SimulatedWorld::of(&program)?;
    let flat = Start::flat(&program.cloth);
    let (cache, interrupt) = (Cache::none(), Interrupt::default());
    let mut start = crumple::start(&flat, seed, &world, &cache, &interrupt, &mut || {})?.start;
    let mut chance = Chance::seeded(seed);
    let (mut first, mut last): (Option<Scene>, Option<ExecutedAction>) = (None, None);
    let mut lines = String::new();
    for step in 1..=actions as u32 {
        world.reset(&start)?;
        let before = coverage(&world, &start)?;
        let observation = world.observe()?;
        let scene = Scene::of(&program, &observation, first.as_ref())?;
        first.get_or_insert_with(|| scene.clone());
        let examples = Examples::default();
        let pictures = Pictures::of(
            &program,
            &scene,
            &observation,
            last.as_ref(),
            None,
            examples,
        )?;
        let view = StepView::without_rollout(
            &program,
            &scene,
            &observation,
            step,
            last.as_ref(),
            &pictures,
        );
        let heard = Overheard::default();
        let models = Models {
            vision: &heard,
            text: &heard,
        };
        let mut exchange = Exchange {
            asking: &mut Asking::unrecorded(),
            record: &mut |_| Ok(()),
            interrupt: &interrupt,
            twins: None,
        };
        let decision = Prompted { models }.decide(&view, &mut exchange)?;
        let Decision::Act { grips, .. } = decision else {
            break;
        };
        let [own] = grips.as_slice() else {
            break;
        };
        let mut offered = offers(&heard.question())?;
        let picked: Vec<Offer> = picked(&mut offered, own, &mut chance);
        let mut tried: Vec<Tried> = Vec::new();
        for offer in picked {
            let proposal = proposal(&program, &offer);
            let Some(action) = Action::lower(&program, &proposal, &scene, &observation) else {
                continue;
            };
            world.reset(&start)?;
            world.act(&action.motion, &interrupt)?;
            let coverage = coverage(&world, &start)?;
            let features = offer.features.map(|value| format!("{value:.5}"));
            let gain = coverage - before;
            let features = features.join(",");
            writeln!(lines, "{seed},{step},{before:.5},{gain:.6},{features}")?;
            tried.push(Tried {
                end: Start {
                    positions: world.particles().ok_or("the world knows its cloth")?,
                    ..start.clone()
                },
                proposal,
                action,
                coverage,
            });
        }
        let is_best = chance.below(10) < 3;
        let best = tried
            .iter()
            .max_by(|a, b| a.coverage.total_cmp(&b.coverage));
        let Some(next) = (if is_best { best } else { tried.first() }) else {
            break;
        };
        start = next.end.clone();
        last = Some(ExecutedAction {
            proposal: next.proposal.clone(),
            pick: next.action.pick_on_cloth_px,
            place: next.action.place_px,
        });
    }
    Ok(lines)
}

/// Takes the stand-in's own pull, the next ones by its estimate, and some at random.
fn picked(offered: &mut Vec<Offer>, own: &Proposal, chance: &mut Chance) -> Vec<Offer> {
    let is_own = |offer: &Offer| {
        own.fields
            .iter()
            .all(|(name, value)| *value == field(offer, name))
    };
    let mut picked = Vec::new();
    if let Some(at) = offered.iter().position(is_own) {
        picked.push(offered.remove(at));
    }
    picked.extend(offered.drain(..NEXT.min(offered.len())));
    for _ in 0..BY_CHANCE.min(offered.len()) {
        picked.push(offered.swap_remove(chance.below(offered.len())));
    }
    picked
}

fn proposal(program: &Program, offer: &Offer) -> Proposal {
    let fields = program.actions.iter();
    let fields = fields.map(|declared| (declared.name.clone(), field(offer, &declared.name)));
    Proposal {
        fields: fields.collect(),
    }
}

fn field(offer: &Offer, name: &str) -> Value {
    match name {
        "direction" => Value::Direction {
            deg: offer.direction_deg,
        },
        "distance" => Value::Length {
            length: offer.distance,
        },
        _ => Value::Point(offer.pick),
    }
}

fn coverage(world: &SimulatedWorld, start: &Start) -> Result<f64, Failure> {
    let particles = world.particles().ok_or("the world knows its cloth")?;
    let triangles = metrics::whole_triangles(&start.grid);
    let area_m2 = metrics::whole_area_m2(&start.grid);
    let coverage = metrics::true_coverage(&particles, &triangles, area_m2);
    Ok(coverage.ok_or("a coverage that is a number")?)
}
