//! Tries pulls of crumpled cloths in the simulator, to search among them or to fit the stand-in's estimate.
//!
//! `cargo run --release -p fab-agent --example collect_pulls -- SEARCH FIRST_SEED COUNT ACTIONS FOLDER`
//! `cargo run --release -p fab-agent --example collect_pulls -- SEARCH STARTS ACTIONS FOLDER`
//!
//! In: seeds of crumpled starts, or a folder of recorded ones (`*_pos.npy`, numbered by name), and what to try before each
//! action beside the stand-in's own pull. SEARCH is `each`, `fit`, or a list such as `offered:12,elsewhere:12` of
//! [`KINDS`] with numbers of pulls. `each` tries some of every kind and executes the stand-in's own pull half of the time.
//! `fit` tries the likely ones, others of the same pick and two drawn ones, and executes its own mostly. A list
//! executes the best that was tried. Out: on stdout, each start's improvement after each action, as the smoothing suite
//! measures it. FOLDER, which must not hold pulls yet, gets each question's picture and words, and two tables. `states.csv` has a line
//! per state: start, step, true coverage, offered corners, and how the cloth lies ([`Lie`]). `pulls.csv` has one per pull: start,
//! step, true coverage before, gain, pick, direction, distance, what the picker took ([`Lie::took`]), kind. `describe_pulls` turns
//! it into what `scripts/fit-pulls.py` reads, and `scripts/compare-pulls.py` compares kinds, grasps and starts.

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
use fab_model::{Message, Model, ModelError, ModelKind, Part, Reply, Request};
use fab_picture::observation::Observation;
use fab_program::facts::ExecutedAction;
use fab_program::{PixelPoint, Program, Proposal, Value};
use fab_standins::geometric::{Geometric, Offer, offers};
use fab_world::crumple;
use fab_world::metrics;
use fab_world::simulated::trials::{Trial, try_motions};
use fab_world::start::Start;
use fab_world::{Grasp, SimulatedWorld, World, WorldPoint};

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fmt::Write as _;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

type Failure = Box<dyn Error + Send + Sync>;

const TASK: &str = "tasks/smoothing.fab";

/// Which pulls are tried beside the stand-in's own. All end where the check `centered` allows.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// None.
    Own,
    /// Of the stand-in's own pick, where the check `outward` allows.
    Pick,
    /// The next ones by the stand-in's estimate.
    Next,
    /// Of offered corners, where `outward` allows.
    Offered,
    /// Picks that are not offered, where `outward` allows: the cloth's true corners, its rim, extremes of its outline.
    Elsewhere,
    /// Of offered corners, in all directions.
    Inward,
}

const KINDS: [(&str, Kind); 6] = [
    ("own", Kind::Own),
    ("pick", Kind::Pick),
    ("next", Kind::Next),
    ("offered", Kind::Offered),
    ("elsewhere", Kind::Elsewhere),
    ("inward", Kind::Inward),
];

/// What is tried before each action, and how often the stand-in's own pull is executed.
struct Search {
    /// Kinds, with the number of pulls of each.
    kinds: Vec<(Kind, usize)>,
    /// Kinds that are tried only before every second action, because they cost as much as all others.
    seldom: Vec<(Kind, usize)>,
    /// In how many of how many cases the stand-in's own pull is executed; otherwise the best is.
    own: Option<[usize; 2]>,
}

impl Search {
    fn read(text: &str) -> Option<Search> {
        use Kind::{Elsewhere, Inward, Next, Offered, Own, Pick};
        let of_list = |item: &str| {
            let (name, count) = item.split_once(':').unwrap_or((item, "0"));
            let (_, kind) = KINDS.iter().find(|(known, _)| *known == name)?;
            Some((*kind, count.parse().ok()?))
        };
        Some(match text {
            "each" => Search {
                kinds: vec![(Own, 0), (Pick, 2), (Next, 3), (Offered, 3)],
                seldom: vec![(Elsewhere, 5), (Inward, 4)],
                own: Some([1, 2]),
            },
            "fit" => Search {
                kinds: vec![(Own, 0), (Next, 6), (Pick, 4), (Offered, 2)],
                seldom: Vec::new(),
                own: Some([7, 10]),
            },
            list => Search {
                kinds: (["own"].into_iter().chain(list.split(',')))
                    .map(of_list)
                    .collect::<Option<_>>()?,
                seldom: Vec::new(),
                own: None,
            },
        })
    }
}

/// Picks on the cloth's rim, one each so many particles.
const RIM_STEP: usize = 5;

/// The checks of the task, in degrees and sides of the cloth.
const OUTWARD_DEG: f64 = 67.5;
const REACH: f64 = 0.95;

/// The goal of the task.
const GOAL: f64 = 0.95;

/// Sides of the cloths, particles.
const SIDES: [u32; 5] = [40, 41, 42, 43, 44];

fn main() -> Result<(), Failure> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [search, starts @ .., actions, folder] = words.as_slice() else {
        return Err(USAGE.into());
    };
    let search = Search::read(search).ok_or_else(|| {
        format!("`{search}` is not each, fit, or kinds such as offered:12,inward:4")
    })?;
    let starts = match starts {
        [first, count] => {
            let (first, count): (u64, u64) = (first.parse()?, count.parse()?);
            (first..first + count).map(Crumpled::Seed).collect()
        }
        [folder] => recorded(Path::new(folder))?,
        _ => return Err(USAGE.into()),
    };
    let actions: usize = actions.parse()?;
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;
    if folder.join("pulls.csv").exists() {
        return Err(format!("`{}` already holds pulls", folder.display()).into());
    }
    let threads = std::thread::available_parallelism()?.get();
    in_parallel(
        starts.len(),
        threads,
        |index| {
            let improved = smooth(&starts[index], actions, &search, &folder)?;
            let improved = improved.iter().map(|value| format!("{value:.4}"));
            let improved = improved.collect::<Vec<_>>().join(",");
            println!("{},{improved}", starts[index].number());
            Ok::<_, Failure>(Some(()))
        },
        |_| {},
    )?;
    Ok(())
}

const USAGE: &str = "give SEARCH, FIRST_SEED COUNT or STARTS, ACTIONS, and FOLDER";

/// Where a crumpled start comes from.
enum Crumpled {
    Seed(u64),
    /// A recorded one, with its number.
    Recorded(u64, Start),
}

impl Crumpled {
    fn number(&self) -> u64 {
        match self {
            Crumpled::Seed(number) | Crumpled::Recorded(number, _) => *number,
        }
    }
}

/// Loads the recorded starts of a folder, in the order of their names.
fn recorded(folder: &Path) -> Result<Vec<Crumpled>, Failure> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.to_string_lossy().ends_with("_pos.npy") {
            files.push(path);
        }
    }
    files.sort();
    let starts = (0..).zip(files).map(|(number, file)| {
        let start = Start::load(&file, None)?;
        Ok::<_, Failure>(Crumpled::Recorded(number, start))
    });
    starts.collect()
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

/// A pull to try.
#[derive(Clone, PartialEq)]
struct Candidate {
    pick: PixelPoint,
    direction_deg: f64,
    distance: f64,
}

impl Candidate {
    fn of(offer: &Offer) -> Candidate {
        Candidate {
            pick: offer.pick,
            direction_deg: offer.direction_deg,
            distance: offer.distance,
        }
    }
}

/// A pull that was tried, and its result.
struct Tried {
    proposal: Proposal,
    action: Action,
    coverage: f64,
    end: Start,
}

/// Smooths one start; returns the improvement after each action, frozen at the goal.
fn smooth(
    from: &Crumpled,
    actions: usize,
    search: &Search,
    folder: &Path,
) -> Result<Vec<f64>, Failure> {
    let seed = from.number();
    let dims = match from {
        Crumpled::Seed(seed) => [SIDES[(seed % SIDES.len() as u64) as usize]; 2],
        Crumpled::Recorded(_, start) => [start.grid.dimx, start.grid.dimy],
    };
    let compiled = fab_compiler::compile_for(TASK, &Here, Some(dims))?;
    let programs = compiled.programs.into_iter();
    let mut plain = programs.filter(|program| program.variant.is_none());
    let program = plain.next().ok_or("the task does not compile")?;
    let mut world = SimulatedWorld::of(&program)?;
    let flat = Start::flat(&program.cloth);
    let (cache, interrupt) = (Cache::none(), Interrupt::default());
    let mut start = match from {
        Crumpled::Seed(seed) => {
            crumple::start(&flat, *seed, &world, &cache, &interrupt, &mut || {})?.start
        }
        Crumpled::Recorded(_, start) => start.clone(),
    };
    let grid_coverage = |start: &Start| metrics::coverage(&start.positions, &start.grid);
    let at_start = grid_coverage(&start).ok_or("a coverage that is a number")?;
    let mut improved: Vec<f64> = Vec::new();
    let mut chance = Chance::seeded(seed);
    let (mut first, mut last): (Option<Scene>, Option<ExecutedAction>) = (None, None);
    for step in 1..=actions as u32 {
        world.reset(&start)?;
        let before = coverage(&start)?;
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
        let question = heard.question().clone();
        let offered = offers(&question)?;
        let lie = Lie::of(&start);
        let corners = points(fab_program::verify::offered(&program, &scene, "pick"));
        let line = format!(
            "{seed},{step},{before:.5},{},{}\n",
            corners.len(),
            lie.line()
        );
        append(&folder.join("states.csv"), &line)?;
        keep(&question, &folder.join(format!("{seed}-{step}")))?;
        let seldom = if step % 2 == 1 {
            search.seldom.as_slice()
        } else {
            &[]
        };
        let mut picked: Vec<(Kind, Candidate)> = Vec::new();
        for &(kind, count) in search.kinds.iter().chain(seldom) {
            let mut picks = corners.clone();
            if kind == Kind::Elsewhere {
                // A corner of which the stand-in considers no pull counts as not offered.
                picks.extend(picks_elsewhere(&start, &observation));
                picks.retain(|pick| offered.iter().all(|offer| offer.pick != *pick));
            }
            let candidates = candidates(&program, &scene, &observation, kind, picks);
            for candidate in chosen(candidates, &offered, own, kind, count, &mut chance) {
                if picked.iter().all(|(_, other)| *other != candidate) {
                    picked.push((kind, candidate));
                }
            }
        }
        let lowered = picked.into_iter().filter_map(|(kind, candidate)| {
            let proposal = proposal(&program, &candidate);
            let action = Action::lower(&program, &proposal, &scene, &observation)?;
            Some((kind, candidate, proposal, action))
        });
        let lowered: Vec<_> = lowered.collect();
        let trials: Vec<Trial<'_>> = lowered
            .iter()
            .map(|(.., action)| Trial {
                from: &world,
                grip: action.grip,
            })
            .collect();
        let ends = try_motions(&trials, 1, &interrupt, |_, end| {
            Ok::<_, Failure>((end.state.positions, end.executed.grips[0].grasp))
        })?;
        let mut tried: Vec<Tried> = Vec::new();
        let mut lines = String::new();
        for ((kind, candidate, proposal, action), end) in lowered.into_iter().zip(ends) {
            let (positions, grasp) = end.ok_or("a trial that ended")?;
            let end = Start {
                positions,
                ..start.clone()
            };
            let coverage = coverage(&end)?;
            let gain = coverage - before;
            let PixelPoint { u, v } = candidate.pick;
            let (deg, far) = (candidate.direction_deg, candidate.distance);
            let name = KINDS.iter().find(|(_, known)| *known == kind);
            let kind = name.map_or("own", |(name, _)| name);
            let took = lie.took(action.grip.pick, grasp);
            writeln!(
                lines,
                "{seed},{step},{before:.5},{gain:.6},{u},{v},{deg},{far},{took},{kind}"
            )?;
            tried.push(Tried {
                proposal,
                action,
                coverage,
                end,
            });
        }
        append(&folder.join("pulls.csv"), &lines)?;
        let is_own = search.own.is_some_and(|[of, all]| chance.below(all) < of);
        let best = tried
            .iter()
            .max_by(|a, b| a.coverage.total_cmp(&b.coverage));
        let Some(next) = (if is_own { tried.first() } else { best }) else {
            break;
        };
        start = next.end.clone();
        last = Some(ExecutedAction {
            proposal: next.proposal.clone(),
            pick: next.action.pick_on_cloth_px,
            place: next.action.place_px,
        });
        let now = grid_coverage(&start).ok_or("a coverage that is a number")?;
        let now = metrics::normalized_improvement(now, at_start).ok_or("a crumpled start")?;
        let frozen = improved.last().copied().filter(|&value| value > GOAL);
        improved.push(frozen.unwrap_or(now));
    }
    Ok(improved)
}

fn append(file: &Path, lines: &str) -> Result<(), Failure> {
    let mut file = File::options().create(true).append(true).open(file)?;
    Ok(std::io::Write::write_all(&mut file, lines.as_bytes())?)
}

/// How a cloth lies on the table, as true particles tell.
struct Lie<'s> {
    start: &'s Start,
    triangles: Vec<[usize; 3]>,
}

impl Lie<'_> {
    fn of(start: &Start) -> Lie<'_> {
        let triangles = metrics::whole_triangles(&start.grid);
        Lie { start, triangles }
    }

    /// Returns the triangles over a point of the table, uppermost first, each with whether its underside is up.
    fn layers(&self, [x, y]: [f64; 2]) -> Vec<(usize, bool)> {
        let over = self.triangles.iter().enumerate();
        let over = over.filter_map(|(index, corners)| {
            let [a, b, c] = corners.map(|corner| self.start.positions[corner].map(f64::from));
            let [pa, pb, pc] = [a, b, c].map(|[x, y, _]| [x, y]);
            let (at, whole) = ([x, y], twice_area([pa, pb, pc]));
            let shares = [[at, pb, pc], [pa, at, pc], [pa, pb, at]].map(twice_area);
            // A triangle without area has shares that are no numbers, and no layer there.
            let [in_a, in_b, in_c] = shares.map(|part| part / whole);
            let is_there = in_a >= 0.0 && in_b >= 0.0 && in_c >= 0.0;
            is_there.then(|| (in_a * a[2] + in_b * b[2] + in_c * c[2], index, whole < 0.0))
        });
        let mut over: Vec<_> = over.collect();
        over.sort_by(|a, b| b.0.total_cmp(&a.0));
        (over
            .into_iter()
            .map(|(_, index, is_under)| (index, is_under)))
        .collect()
    }

    /// Returns a particle's distances from the nearer side and from the nearest corner, in particles.
    fn inside(&self, particle: usize) -> [usize; 2] {
        let [columns, rows] = [self.start.grid.dimx, self.start.grid.dimy].map(|dim| dim as usize);
        let off = |at: usize, dim: usize| at.min(dim - 1 - at);
        let [i, j] = [
            off(particle % columns, columns),
            off(particle / columns, rows),
        ];
        [i.min(j), i.max(j)]
    }

    /// Returns, with commas between: the mean number of layers at the cloth's triangles; of those that are uppermost the share whose
    /// underside is up; the uppermost share of the triangles at the rim; the number of uppermost corners; the length of all creases,
    /// which are where a triangle faces up and its neighbour down, in sides of the cloth; the particles' mean height, mm.
    fn line(&self) -> String {
        let (mut layers, mut seen, mut under) = (0, 0, 0);
        let (mut rim, mut rim_seen) = (0, 0);
        let mut corners: BTreeSet<usize> = BTreeSet::new();
        for (index, triangle) in self.triangles.iter().enumerate() {
            let middle = [0, 1].map(|axis| {
                let points = triangle.map(|corner| f64::from(self.start.positions[corner][axis]));
                points.iter().sum::<f64>() / 3.0
            });
            let over = self.layers(middle);
            layers += over.len();
            let uppermost = over.first().filter(|(first, _)| *first == index);
            let at_rim = triangle.iter().filter(|&&at| self.inside(at)[0] == 0);
            let is_at_rim = at_rim.count() > 1;
            rim += usize::from(is_at_rim);
            if let Some((_, is_under)) = uppermost {
                seen += 1;
                under += usize::from(*is_under);
                rim_seen += usize::from(is_at_rim);
                corners.extend(triangle.iter().filter(|&&at| self.inside(at)[1] == 0));
            }
        }
        let share = |part: usize, whole: usize| part as f64 / whole.max(1) as f64;
        let heights = self.start.positions.iter().map(|[.., z]| f64::from(*z));
        format!(
            "{:.4},{:.4},{:.4},{},{:.3},{:.2}",
            share(layers, self.triangles.len()),
            share(under, seen),
            share(rim_seen, rim),
            corners.len(),
            self.creases_m() / metrics::whole_area_m2(&self.start.grid).sqrt(),
            1e3 * heights.sum::<f64>() / self.start.positions.len() as f64
        )
    }

    fn creases_m(&self) -> f64 {
        let at = |particle: usize| self.start.positions[particle].map(f64::from);
        let mut faces: BTreeMap<[usize; 2], bool> = BTreeMap::new();
        let mut creases_m = 0.0;
        for &[a, b, c] in &self.triangles {
            let [pa, pb, pc] = [a, b, c].map(at);
            let is_under = twice_area([pa, pb, pc].map(|[x, y, _]| [x, y])) < 0.0;
            for (one, other) in [(a, b), (b, c), (c, a)] {
                let edge = [one.min(other), one.max(other)];
                if faces.insert(edge, is_under) == Some(!is_under) {
                    let [from, to] = edge.map(at);
                    let along = [0, 1, 2].map(|axis| (to[axis] - from[axis]).powi(2));
                    creases_m += along.iter().sum::<f64>().sqrt();
                }
            }
        }
        creases_m
    }

    /// Returns the number of layers at a pick, which of them was taken, 1 for the uppermost and 0 for none, and the distances of the
    /// taken particle from the nearer side and from the nearest corner, in particles, with commas between.
    fn took(&self, pick: WorldPoint, grasp: Grasp) -> String {
        let over = self.layers([pick.x, pick.y]);
        let Grasp::Particle(particle) = grasp else {
            return format!("{},0,,", over.len());
        };
        let particle = particle as usize;
        let taken = (over.iter()).position(|(layer, _)| self.triangles[*layer].contains(&particle));
        let [side, corner] = self.inside(particle);
        format!(
            "{},{},{side},{corner}",
            over.len(),
            taken.map_or(0, |at| at + 1)
        )
    }
}

/// Returns twice the signed area of a triangle, positive if its corners are anticlockwise.
fn twice_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Writes the words and the picture of a question.
fn keep(question: &[Message], at: &Path) -> Result<(), Failure> {
    let parts = question.iter().flat_map(|message| &message.parts);
    let mut words = String::new();
    for part in parts {
        match part {
            Part::Text(text) => words = words + text + "\n",
            Part::Image(png) => std::fs::write(at.with_extension("png"), png.bytes())?,
        }
    }
    Ok(std::fs::write(at.with_extension("txt"), words)?)
}

/// Returns the pixels of the cloth's true corners, of points on its rim, and of its outline's extremes.
fn picks_elsewhere(start: &Start, observation: &Observation) -> Vec<PixelPoint> {
    let [columns, rows] = [start.grid.dimx, start.grid.dimy].map(|dim| dim as usize);
    let rim = (0..columns * rows).filter(|index| {
        let [i, j] = [index % columns, index / columns];
        let on_side = |at: usize, other: usize, dims: [usize; 2]| {
            (at == 0 || at + 1 == dims[0])
                && (other.is_multiple_of(RIM_STEP) || other + 1 == dims[1])
        };
        on_side(i, j, [columns, rows]) || on_side(j, i, [rows, columns])
    });
    let turns = (0..8).map(|turn| (f64::from(turn) * std::f64::consts::FRAC_PI_4).sin_cos());
    let extremes = turns.filter_map(|(sin, cos)| {
        let far = |&index: &usize| {
            let [x, y, _] = start.positions[index].map(f64::from);
            x * cos + y * sin
        };
        (0..columns * rows).max_by(|a, b| far(a).total_cmp(&far(b)))
    });
    let pixel = |index: usize| {
        let [x, y, z] = start.positions[index].map(f64::from);
        let [column, row] = observation.camera.pixel_from_world([x, y, z].into())?;
        Some(PixelPoint::new(column as i32, row as i32))
    };
    rim.chain(extremes).filter_map(pixel).collect()
}

fn points(values: Vec<Value>) -> Vec<PixelPoint> {
    let points = values.into_iter().filter_map(|value| match value {
        Value::Point(point) => Some(point),
        _ => None,
    });
    points.collect()
}

/// Returns the pulls of some picks that the checks allow.
fn candidates(
    program: &Program,
    scene: &Scene,
    observation: &Observation,
    kind: Kind,
    mut picks: Vec<PixelPoint>,
) -> Vec<Candidate> {
    let offered = |field: &str| fab_program::verify::offered(program, scene, field);
    picks.sort();
    picks.dedup();
    let found = scene.to_json();
    let number = |axis: usize| found["center"][0][axis].as_f64().unwrap_or(360.0);
    let center = [number(0), number(1)];
    let middle = f64::from(observation.rgb.width()) / 2.0;
    let camera = &program.camera;
    let per_m = middle / (camera.height_m * (camera.fov_rad / 2.0).tan());
    let longer = program.cloth.dimx.max(program.cloth.dimy);
    let edge_px = f64::from(longer - 1) * program.cloth.spacing_m * per_m;
    let mut found = Vec::new();
    for &pick in &picks {
        for direction in offered("direction") {
            let Value::Direction { deg } = direction else {
                continue;
            };
            let out = (center[1] - f64::from(pick.v)).atan2(f64::from(pick.u) - center[0]);
            let off = (deg - out.to_degrees()).rem_euclid(360.0);
            if kind != Kind::Inward && off.min(360.0 - off) > OUTWARD_DEG {
                continue;
            }
            for distance in offered("distance") {
                let Value::Length { length } = distance else {
                    continue;
                };
                let candidate = Candidate {
                    pick,
                    direction_deg: deg,
                    distance: length,
                };
                let proposal = proposal(program, &candidate);
                let Some(action) = Action::lower(program, &proposal, scene, observation) else {
                    continue;
                };
                let PixelPoint { u, v } = action.place_px;
                let away = (f64::from(u) - middle).hypot(f64::from(v) - middle);
                if away <= REACH * edge_px {
                    found.push(candidate);
                }
            }
        }
    }
    found
}

/// Takes the stand-in's own pull, and others of a kind.
fn chosen(
    mut candidates: Vec<Candidate>,
    offered: &[Offer],
    own: &Proposal,
    kind: Kind,
    count: usize,
    chance: &mut Chance,
) -> Vec<Candidate> {
    let is_own = |candidate: &Candidate| {
        own.fields
            .iter()
            .all(|(name, value)| *value == field(candidate, name))
    };
    let best = || offered.iter().map(Candidate::of);
    let Some(own) = best().find(is_own) else {
        return Vec::new();
    };
    // The checks accepted it, also where a limit is rounded differently here.
    if !candidates.contains(&own) {
        candidates.push(own.clone());
    }
    if kind == Kind::Pick {
        candidates.retain(|candidate| candidate.pick == own.pick);
    }
    let mut chosen = Vec::new();
    let next = if kind == Kind::Next { count + 1 } else { 0 };
    for offer in [own].into_iter().chain(best().take(next)) {
        if let Some(at) = candidates.iter().position(|other| *other == offer) {
            chosen.push(candidates.swap_remove(at));
        }
    }
    if !matches!(kind, Kind::Own | Kind::Next) {
        for _ in 0..count.min(candidates.len()) {
            chosen.push(candidates.swap_remove(chance.below(candidates.len())));
        }
    }
    chosen
}

fn proposal(program: &Program, offer: &Candidate) -> Proposal {
    let fields = program.actions.iter();
    let fields = fields.map(|declared| (declared.name.clone(), field(offer, &declared.name)));
    Proposal {
        fields: fields.collect(),
    }
}

fn field(offer: &Candidate, name: &str) -> Value {
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

fn coverage(start: &Start) -> Result<f64, Failure> {
    let triangles = metrics::whole_triangles(&start.grid);
    let area_m2 = metrics::whole_area_m2(&start.grid);
    let coverage = metrics::true_coverage(&start.positions, &triangles, area_m2);
    Ok(coverage.ok_or("a coverage that is a number")?)
}
