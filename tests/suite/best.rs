//! `fabc best`: the search for the best actions, the worlds in which it can be made, and what it prints.

use super::pty::Session;
use super::seen_coverage::Blind;
use super::support::{Fabc, ProjectFiles, bring_library, fabc, finish};
use fab_agent::action::Action;
use fab_agent::best::{self, Aim, Choice, Found, Limits, Search, Stop};
use fab_agent::examples::Examples;
use fab_agent::policy::Expert;
use fab_agent::rollout::Job;
use fab_agent::scene::Scene;
use fab_agent::subgoals::SubgoalSet;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::calls::Budget;
use fab_program::scene::SceneView;
use fab_program::{PixelPoint, Program, Proposal, Sequence};
use fab_world::expert::MakeWorld;
use fab_world::metrics::mean_particle_distance_m;
use fab_world::start::Start;
use fab_world::{Grip, SimulatedWorld, World, WorldError, Wrapper, expert};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use std::time::Instant;

const FABC: &str = env!("CARGO_BIN_EXE_fabc");

/// One fold whose best action is known: the demonstrated one is offered. No step is retried, so that all can be tried.
const KNOWN: &str = r#"
use "lib/folding.fab"
task known extends folding {
    cloth grid(17, 17)
    goal  particle_distance < 8mm
    const alike = 0.01
    subgoals { demonstrate { fold corner(back_left) -> center } }
}
"#;

/// A crumpled cloth, pulled anywhere; nothing is demonstrated.
const ANYWHERE: &str = r#"
task anywhere {
    cloth  grid(14, 14, start: crumpled)
    goal   normalized_improvement > 0.3
    horizon 2
    camera top_down(height: 650mm, fov: 45deg, image: 224px)
    picker drop
    keypoints { cloth = mask(depth < 649mm) }
    actions {
        pick:      any of cloth
        direction: one of 0deg, 90deg, 180deg, 270deg
        distance:  one of 0.25edge
    }
    stage act {
        model vision
        show  scene
        say   "Pull {{ pick.choices }}. {{ actions.format }}"
        read  action
    }
    verify { attempts 2, else skip }
}
"#;

/// Two folds of a small cloth, by few points; a step may be skipped, and what is offered depends on how the cloth lies.
const TWICE: &str = r#"
experts inward {
    sequence { fold corner(back_left) -> center, corner(back_right) -> center }
    sequence { fold corner(back_right) -> center, corner(back_left) -> center }
}
task twice {
    cloth   grid(10, 10)
    experts inward
    goal    particle_distance < 1mm
    horizon 2
    camera  top_down(height: 650mm, fov: 45deg, image: 224px)
    keypoints {
        cloth  = mask(depth < 649mm)
        left   = points((103px, 103px))
        right  = points((120px, 103px))
        middle = points((111px, 111px))
    }
    actions {
        pick:  one of left, right
        place: one of left, middle
    }
    stage act {
        model vision
        show  scene
        say   "Carry one of {{ left }}, {{ right }} to one of {{ left }}, {{ middle }}. {{ actions.format }}"
        read  action
    }
    verify {
        check on_cloth { pick within 3px of cloth } else "{{ pick }} is not on the cloth."
        check moves { distance(pick, place) > 10px } else "Nothing would be folded."
        attempts 2, else skip
    }
}
"#;

/// A place of these tasks must be farther from its pick than this, pixels.
const MOVES_PX: f64 = 10.0;

/// A command on one of the tasks, in a folder of its own.
fn command(folder: &Path, task: &str, arguments: &str) -> Fabc {
    bring_library(folder);
    fs::write(folder.join("task.fab"), task).unwrap();
    let mut command = fabc(folder);
    command.args(["best", "task.fab", "--json"]);
    command.args(arguments.split_whitespace());
    command
}

/// Its exit code and its document, without the folder's name.
fn run(folder: &Path, task: &str, arguments: &str) -> (i32, Value) {
    document(&mut command(folder, task, arguments))
}

fn document(command: &mut Fabc) -> (i32, Value) {
    let said = finish(command);
    let mut value: Value = serde_json::from_str(&said.stdout)
        .unwrap_or_else(|error| panic!("{error}\n{}{}", said.stdout, said.stderr));
    value["out"].take();
    (said.code, value)
}

/// The mean of a row.
fn mean(row: &Value) -> f64 {
    let values = row["values"].as_array().unwrap();
    let values: Vec<f64> = values.iter().map(|it| it.as_f64().unwrap()).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

/// One of the tasks, compiled.
fn compiled(folder: &Path, task: &str) -> Program {
    bring_library(folder);
    let path = folder.join("task.fab");
    fs::write(&path, task).unwrap();
    let compiled = fab_compiler::compile(path.to_str().unwrap(), &ProjectFiles).unwrap();
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    compiled.programs.into_iter().next().unwrap()
}

/// What a test searches from the flat cloth, and after how many trials it is stopped.
struct Asked<'a> {
    program: &'a Program,
    limits: Limits,
    hint: &'a [Choice],
    stop_after: Option<u32>,
}

/// At most 20 trials, one after the other.
const FEW: Limits = Limits {
    trials: 20,
    until: None,
    seed: 0,
    threads: 1,
};

impl Asked<'_> {
    /// A few trials, and no stop.
    fn of(program: &Program) -> Asked<'_> {
        Asked {
            program,
            limits: FEW,
            hint: &[],
            stop_after: None,
        }
    }

    /// Searches it; `folder` holds its subgoal pictures.
    fn found(&self, folder: &Path) -> Found {
        let (program, stop_after) = (self.program, self.stop_after);
        let make_world =
            || -> Result<Box<dyn World>, WorldError> { Ok(Box::new(SimulatedWorld::of(program)?)) };
        let mut world = SimulatedWorld::of(program).unwrap();
        let interrupt = Interrupt::default();
        let subgoals = SubgoalSet::obtain(program, folder, &mut world, &interrupt).unwrap();
        let start = Start::flat(&program.cloth);
        let job = job(program, &start, &subgoals, &make_world, &interrupt);
        let search = Search {
            job: &job,
            limits: self.limits,
            hint: self.hint,
            progress: &|trials| {
                if Some(trials) == stop_after {
                    interrupt.raise();
                }
            },
        };
        let aim = Aim::of(&job).unwrap();
        if stop_after == Some(0) {
            interrupt.raise();
        }
        best::search(&search, &aim).unwrap()
    }
}

/// A rollout of a task, whose policy is of no account.
fn job<'a>(
    program: &'a Program,
    start: &'a Start,
    subgoals: &'a SubgoalSet,
    make_world: &'a MakeWorld<'a>,
    interrupt: &'a Interrupt,
) -> Job<'a> {
    static EXAMPLES: LazyLock<Examples> = LazyLock::new(Examples::default);
    static BUDGET: LazyLock<Budget> = LazyLock::new(Budget::default);
    static CACHE: LazyLock<Cache> = LazyLock::new(Cache::none);
    Job {
        program,
        start,
        subgoals,
        examples: &EXAMPLES,
        make_policy: &Expert,
        budget: &BUDGET,
        make_world,
        make_expert_world: make_world,
        cache: &CACHE,
        interrupt,
        horizon: None,
        early_stop: true,
        operator: None,
        repetition: 0,
        start_number: None,
    }
}

/// What offered folds lead to, found without the search: each sequence of them is executed from the start on.
struct ByHand<'a> {
    program: &'a Program,
    /// The keypoints that a pick and a place may be.
    offered: [&'a [&'a str]; 2],
    /// How far from the cloth a pick may be, pixels.
    beside_px: f64,
    may_skip: bool,
    start: Start,
    /// Where the experts leave the cloth.
    ends: Vec<Vec<[f32; 3]>>,
    /// The least distance to one of these after the last step, metres.
    least_m: f64,
    /// The actions that were executed, each counted once for the state that it begins at.
    tried: u32,
}

impl<'a> ByHand<'a> {
    /// Executes everything that a task offers on the flat cloth.
    fn of(
        program: &'a Program,
        offered: [&'a [&'a str]; 2],
        beside_px: f64,
        may_skip: bool,
    ) -> ByHand<'a> {
        let start = Start::flat(&program.cloth);
        let end = |sequence: &Sequence| {
            let mut world = SimulatedWorld::of(program).unwrap();
            world.reset(&start).unwrap();
            for fold in &sequence.folds {
                let grip = expert::grip(fold, &start, &world).unwrap();
                let motion = grip.with_manner(program.manner).into();
                world.act(&motion, &Interrupt::default()).unwrap();
            }
            world.particles().unwrap()
        };
        let ends = program.experts.iter().map(end).collect();
        let mut by_hand = ByHand {
            program,
            offered,
            beside_px,
            may_skip,
            start,
            ends,
            least_m: f64::INFINITY,
            tried: 0,
        };
        by_hand.follow(&[]);
        by_hand
    }

    /// Executes some steps, and then each that may come next; `None` skips the rest.
    fn follow(&mut self, steps: &[Option<Grip>]) {
        let mut world = SimulatedWorld::of(self.program).unwrap();
        world.reset(&self.start).unwrap();
        let observation = world.observe().unwrap();
        let first = Scene::of(self.program, &observation, None).unwrap();
        for grip in steps.iter().flatten() {
            world.act(&(*grip).into(), &Interrupt::default()).unwrap();
        }
        self.tried += u32::from(matches!(steps.last(), Some(Some(_))));
        if steps.len() == self.program.horizon as usize || steps.last() == Some(&None) {
            let particles = world.particles().unwrap();
            for end in &self.ends {
                let distance_m = mean_particle_distance_m(&particles, end).unwrap();
                self.least_m = self.least_m.min(distance_m);
            }
            return;
        }
        let observation = world.observe().unwrap();
        let scene = Scene::of(self.program, &observation, Some(&first)).unwrap();
        let points = |names: &[&str]| -> Vec<PixelPoint> {
            let points = names.iter().map(|name| scene.points(name).unwrap());
            points.flatten().collect()
        };
        let [picks, places] = self.offered.map(points);
        let mut next = Vec::new();
        for &pick in &picks {
            for &place in &places {
                let beside_px = scene.distance_px("cloth", pick).unwrap();
                if beside_px > self.beside_px || pick.distance_px(place) <= MOVES_PX {
                    continue;
                }
                let fields = [("pick", pick), ("place", place)]
                    .map(|(name, pixel)| (name.to_owned(), fab_program::Value::Point(pixel)));
                let proposal = Proposal {
                    fields: fields.to_vec(),
                };
                let action = Action::lower(self.program, &proposal, &scene, &observation);
                next.push(Some(action.unwrap().grip));
            }
        }
        if self.may_skip {
            next.push(None);
        }
        for step in next {
            let mut longer = steps.to_vec();
            longer.push(step);
            self.follow(&longer);
        }
    }
}

#[test]
fn no_offered_sequence_ends_better_than_an_exhausted_search() {
    let folder = tempfile::tempdir().unwrap();
    let program = compiled(folder.path(), TWICE);
    let asked = Asked {
        limits: Limits { trials: 100, ..FEW },
        ..Asked::of(&program)
    };
    let found = asked.found(folder.path());
    assert!(found.exhausted && found.stop.is_none(), "{found:?}");
    let offered: [&[&str]; 2] = [&["left", "right"], &["left", "middle"]];
    let by_hand = ByHand::of(&program, offered, 3.0, true);
    assert_eq!(found.value, Some(by_hand.least_m), "{found:?}");
    assert_eq!(found.trials, by_hand.tried);
    // Three actions in each of four states, but for picks of a corner that is folded.
    assert!((6..12).contains(&by_hand.tried), "{}", by_hand.tried);
}

#[test]
#[ignore = "long"]
fn the_best_of_a_known_fold_is_its_demonstration_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let (code, whole) = run(folder.path(), KNOWN, "--threads 1 --out one");
    assert_eq!(code, 0, "{whole:#}");
    let start = &whole;
    assert_eq!(start["exhausted"], true);
    assert_eq!(start["limiting"], 0);
    assert_eq!(start["best"].as_array().unwrap().len(), 1);
    let program = compiled(folder.path(), KNOWN);
    let offered: [&[&str]; 2] = [&["corners"], &["corners", "center"]];
    let by_hand = ByHand::of(&program, offered, 8.0, false);
    assert_eq!(start["value"].as_f64(), Some(by_hand.least_m));
    assert_eq!(start["trials"], by_hand.tried);
    let rows = whole["rows"].as_array().unwrap();
    let named = |name: &str| rows.iter().find(|row| row["row"] == name).unwrap();
    let value = |name: &str| mean(named(name));
    assert_eq!(value("best"), start["value"].as_f64().unwrap());
    assert!(value("best") <= value("expert"));
    assert!(value("best") < value("random"));
    assert_eq!(
        (&named("best")["oracle"], &named("random")["oracle"]),
        (&true.into(), &false.into())
    );

    let (_, on_two) = run(folder.path(), KNOWN, "--threads 2 --out two");
    assert_eq!(on_two, whole);
}

#[test]
#[ignore = "long"]
fn pulls_anywhere_are_sampled_and_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = "--trials 24 --out whole";
    let (code, whole) = run(folder.path(), ANYWHERE, arguments);
    assert_eq!(code, 0, "{whole:#}");
    let start = &whole;
    assert!(start["left"].as_u64() > Some(0), "{start:#}");
    assert_eq!(
        (&start["exhausted"], &start["trials"]),
        (&false.into(), &24.into())
    );
    let row = |name: &str| {
        let mut rows = whole["rows"].as_array().unwrap().iter();
        rows.find(|row| row["row"] == name).unwrap()
    };
    let none = row("expert")["unscored"][0].as_str().unwrap().to_owned();
    assert!(none.contains("demonstrates no folds"), "{none}");
    let value = |name: &str| mean(row(name));
    assert!(value("best") > value("random") && value("best") >= value("stand-in"));
}

#[test]
fn a_search_that_was_stopped_skips_what_is_left_after_the_best_state() {
    let home = tempfile::tempdir().unwrap();
    let program = compiled(home.path(), TWICE);
    let partial = Asked {
        stop_after: Some(2),
        ..Asked::of(&program)
    };
    let found = partial.found(home.path());
    assert_eq!((found.stop, found.trials), (Some(Stop::Interrupt), 2));
    let [acted, skipped] = &found.best[..] else {
        panic!("{found:?}");
    };
    assert!(acted.choice.is_some() && skipped.choice.is_none());
    assert!(acted.value < found.untouched, "{found:?}");
    assert_eq!((found.value, found.limiting), (Some(acted.value), Some(0)));
}

#[test]
fn a_search_that_is_interrupted_before_its_first_trial_still_reports() {
    let home = tempfile::tempdir().unwrap();
    let program = compiled(home.path(), TWICE);
    let asked = Asked {
        stop_after: Some(0),
        ..Asked::of(&program)
    };
    let found = asked.found(home.path());
    assert_eq!((found.stop, found.trials), (Some(Stop::Interrupt), 0));
    assert_eq!((found.left, found.value), (1, None));
}

#[test]
fn a_search_ends_with_its_time_and_says_what_it_left() {
    let home = tempfile::tempdir().unwrap();
    let program = compiled(home.path(), TWICE);
    let asked = Asked {
        limits: Limits {
            until: Some(Instant::now()),
            ..FEW
        },
        ..Asked::of(&program)
    };
    let found = asked.found(home.path());
    assert_eq!((found.stop, found.trials), (Some(Stop::Time), 0));
    assert_eq!((found.left, found.value), (1, None));
}

#[test]
fn the_actions_of_another_rollout_are_followed_while_trials_are_left() {
    let home = tempfile::tempdir().unwrap();
    let program = compiled(home.path(), TWICE);
    let whole = Asked::of(&program).found(home.path());
    let hint: Vec<Choice> = whole.best.into_iter().filter_map(|it| it.choice).collect();
    assert_eq!(hint.len(), 2);
    for trials in [1, 2] {
        let asked = Asked {
            limits: Limits { trials, ..FEW },
            hint: &hint,
            ..Asked::of(&program)
        };
        let found = asked.found(home.path());
        let taken = found.best.into_iter().filter_map(|it| it.choice);
        assert_eq!(taken.collect::<Vec<_>>(), hint[..trials as usize]);
    }
}

#[test]
fn an_order_that_is_drawn_is_the_same_on_any_number_of_threads() {
    let home = tempfile::tempdir().unwrap();
    let task = ANYWHERE
        .replace("14, 14", "10, 10")
        .replace("0deg, 90deg, 180deg, 270deg", "0deg, 180deg");
    let mut program = compiled(home.path(), &task);
    // No pull reaches this, so no rollout ends before its last step.
    program.goal.as_mut().unwrap().limit = 9.0;
    let [one, three] = [1, 3].map(|threads| {
        let folder = tempfile::tempdir().unwrap();
        let asked = Asked {
            limits: Limits {
                trials: 8,
                threads,
                ..FEW
            },
            ..Asked::of(&program)
        };
        let found = asked.found(folder.path());
        assert!(found.left > 0, "{found:?}");
        assert_eq!((found.trials, found.best.len()), (8, 2));
        format!("{found:#?}")
    });
    assert_eq!(one, three);
}

#[test]
#[ignore = "long"]
#[cfg(target_os = "linux")]
fn a_search_shows_how_far_it_is_and_prints_what_it_found_when_it_is_interrupted() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = "--trials 5000 --seconds 600 --threads 1";
    let mut session = Session::in_window(&command(folder.path(), ANYWHERE, arguments).process());
    session.until("8 of 5000 trials");
    session.send("\u{3}");
    let (code, shown) = session.end();
    assert_eq!(code, Some(130), "{shown}");
    let document = &shown[shown.find("{\n").expect(&shown)..];
    let found: Value = serde_json::from_str(document).expect(document);
    let start = &found;
    let trials = start["trials"].as_u64().unwrap();
    assert!(start["stop"] == "interrupt" && trials >= 8, "{start:#}");
    assert!(start["value"].is_number(), "{start:#}");
}

#[test]
fn the_best_is_behind_no_rollout_of_a_policy_however_few_the_trials() {
    let folder = tempfile::tempdir().unwrap();
    let (_, found) = run(folder.path(), ANYWHERE, "--start 6 --trials 2 --out kept");
    let best = mean(&found["rows"][0]);
    let rollouts = fs::read_dir(folder.path().join("kept")).unwrap();
    let ends = rollouts.filter_map(|entry| {
        let record = fs::read_to_string(entry.unwrap().path().join("rollout.jsonl")).ok()?;
        let end: Value = serde_json::from_str(record.lines().last()?).unwrap();
        end["report"]["normalized_improvement"].as_f64()
    });
    let ends: Vec<f64> = ends.collect();
    assert!(ends.len() > 5, "{ends:?}");
    assert!(ends.iter().all(|end| *end <= best), "{best} {ends:?}");
}

#[test]
fn what_cannot_be_searched_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let aimless = ANYWHERE.replace("goal   normalized_improvement > 0.3", "");
    let said = finish(&mut command(folder.path(), &aimless, ""));
    assert_eq!(said.code, 64);
    assert!(
        said.stdout.contains("so no result is better than another"),
        "{}",
        said.stdout
    );
    let said = finish(&mut command(folder.path(), ANYWHERE, "--world arm"));
    assert_eq!(said.code, 64);
    assert!(
        said.stdout.contains("an arm cannot take an action back"),
        "{}",
        said.stdout
    );
}

/// A world without copies.
struct Copyless(SimulatedWorld);

impl Wrapper for Copyless {
    fn inner(&self) -> &dyn World {
        &self.0
    }

    fn inner_mut(&mut self) -> &mut dyn World {
        &mut self.0
    }
}

#[test]
fn a_world_without_copies_is_searched_with_equal_results_and_one_without_particles_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let program = compiled(folder.path(), TWICE);
    let simulated = || SimulatedWorld::of(&program);
    let search = |make_world: &MakeWorld<'_>| {
        let (start, subgoals) = (Start::flat(&program.cloth), SubgoalSet::default());
        let interrupt = Interrupt::default();
        let job = Job {
            make_expert_world: &|| Ok(Box::new(simulated()?)),
            ..job(&program, &start, &subgoals, make_world, &interrupt)
        };
        let search = Search {
            job: &job,
            limits: FEW,
            hint: &[],
            progress: &|_| {},
        };
        best::search(&search, &Aim::of(&job)?)
    };
    let copied = Asked::of(&program).found(folder.path());
    let again = search(&|| Ok(Box::new(Copyless(simulated()?)))).unwrap();
    assert_eq!(format!("{again:?}"), format!("{copied:?}"));
    let blind = || -> Result<Blind, WorldError> {
        let (world, flat) = (simulated()?, None);
        Ok(Blind { world, flat })
    };
    let refused = search(&|| Ok(Box::new(blind()?))).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the world `blind` cannot lay a start again exactly, or does not know where the cloth's particles are, so actions cannot be tried in it: search in `sim`, or in a program that does both"
    );
}

#[test]
fn a_program_that_repeats_is_searched_as_the_simulator_is() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = "--trials 6 --threads 1";
    let bundled = run(folder.path(), TWICE, arguments);
    let served = format!("exec:'{FABC}' world serve");
    let mut command = self::command(folder.path(), TWICE, arguments);
    assert_eq!(document(command.args(["--world", &served])), bundled);

    let once = folder.path().join("once.sh");
    let text = format!("{served} | sed -u 's/\"repeats\":true/\"repeats\":false/'");
    fs::write(&once, text.replace("exec:", "")).unwrap();
    let world = format!("exec:sh '{}'", once.display());
    let mut command = self::command(folder.path(), TWICE, arguments);
    let refused = finish(command.args(["--world", &world]));
    let why = "cannot lay a start again exactly, or does not know";
    assert!(
        refused.code == 2 && refused.stdout.contains(why),
        "{}",
        refused.stdout
    );
}

#[test]
fn a_rollout_without_a_score_is_measured_where_it_ended() {
    let folder = tempfile::tempdir().unwrap();
    let (_, found) = run(folder.path(), TWICE, "--trials 12");
    let rows = found["rows"].as_array().unwrap();
    let stand_in = rows.iter().find(|row| row["row"] == "stand-in").unwrap();
    // It moved nothing.
    assert_eq!(stand_in["values"][0], found["untouched"]);
    assert_eq!(stand_in["unscored"], serde_json::json!(["malformed_reply"]));
    assert_eq!(stand_in["reached"], serde_json::json!([false]));
}

/// Each pull leads away from the experts' end, and a rollout whose steps are all skipped has no score.
#[test]
fn where_every_action_spoils_the_cloth_the_best_takes_one_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let spoiling = ANYWHERE
        .replace("grid(14, 14, start: crumpled)", "grid(10, 10)")
        .replace(
            "    goal   normalized_improvement > 0.3\n",
            "    experts inward\n    goal   particle_distance < 1mm\n",
        )
        .replace("0deg, 90deg, 180deg, 270deg", "0deg, 45deg");
    let experts = "experts inward { sequence { fold corner(back_left) -> center, corner(back_right) -> center } }";
    let (code, found) = run(
        folder.path(),
        &format!("{experts}\n{spoiling}"),
        "--trials 16",
    );
    assert_eq!(code, 3, "{found:#}");
    let start = &found;
    assert!(
        start["value"].as_f64() > start["untouched"].as_f64(),
        "{start:#}"
    );
    let best = start["best"].as_array().unwrap();
    assert!(
        best.iter().any(|step| !step["answer"].is_null()),
        "{start:#}"
    );
}
