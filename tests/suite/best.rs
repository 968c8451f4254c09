//! `fabc best`: the search for the best actions, its journal, and what it prints.

use super::pty::Session;
use super::support::{Fabc, ProjectFiles, bring_library, fabc, finish};
use fab_agent::action::Action;
use fab_agent::best::journal::{Identity, TRIALS_FILE, TrialJournal};
use fab_agent::best::{self, Choice, Found, Limits, Search};
use fab_agent::scene::Scene;
use fab_agent::subgoals::SubgoalSet;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_program::scene::SceneView;
use fab_program::{PixelPoint, Program, Proposal, Sequence};
use fab_world::metrics::mean_particle_distance_m;
use fab_world::start::Start;
use fab_world::{Grip, SimulatedWorld, World, expert};
use serde_json::Value;
use std::fs;
use std::path::Path;

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
        say   "Carry one of {{ pick.choices }} to one of {{ place.choices }}. {{ actions.format }}"
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
    let said = finish(&mut command(folder, task, arguments));
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
    hints: &'a [Vec<Choice>],
    stop_after: Option<u32>,
}

/// At most 20 trials, one after the other.
const FEW: Limits = Limits {
    trials: 20,
    beam: 4,
    seed: 0,
    threads: 1,
};

impl Asked<'_> {
    /// A few trials, and no stop.
    fn of(program: &Program) -> Asked<'_> {
        Asked {
            program,
            limits: FEW,
            hints: &[],
            stop_after: None,
        }
    }

    /// Searches it, and keeps the trials in `folder`.
    fn found(&self, folder: &Path) -> Found {
        let (program, stop_after) = (self.program, self.stop_after);
        let make_world = || SimulatedWorld::of(program);
        let mut world = make_world().unwrap();
        let interrupt = Interrupt::default();
        let subgoals = SubgoalSet::obtain(program, folder, &mut world, &interrupt).unwrap();
        let start = Start::flat(&program.cloth);
        let identity = Identity {
            program: program.hash(),
            start: start.digest(),
            params: world.parameters(),
            code: world.code(),
            subgoals: subgoals.digest(),
        };
        let journal = TrialJournal::open(folder, &identity).unwrap();
        let search = Search {
            program,
            start: &start,
            subgoals: &subgoals,
            make_world: &make_world,
            cache: &Cache::none(),
            horizon: None,
            limits: self.limits,
            hints: self.hints,
            journal: Some(&journal),
            interrupt: &interrupt,
            progress: &|trials| {
                if Some(trials) == stop_after {
                    interrupt.raise();
                }
            },
        };
        best::search(&search).unwrap()
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
    /// The actions that a check refuses, counted likewise.
    refused: u64,
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
            refused: 0,
        };
        by_hand.follow(&[]);
        by_hand
    }

    /// Executes some steps, and then each that may come next; `None` is a skipped step.
    fn follow(&mut self, steps: &[Option<Grip>]) {
        let mut world = SimulatedWorld::of(self.program).unwrap();
        world.reset(&self.start).unwrap();
        let observation = world.observe().unwrap();
        let first = Scene::of(self.program, &observation, None).unwrap();
        for grip in steps.iter().flatten() {
            world.act(&(*grip).into(), &Interrupt::default()).unwrap();
        }
        self.tried += u32::from(matches!(steps.last(), Some(Some(_))));
        if steps.len() == self.program.horizon as usize {
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
                    self.refused += 1;
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
        limits: Limits {
            trials: 100,
            beam: 16,
            ..FEW
        },
        ..Asked::of(&program)
    };
    let found = asked.found(folder.path());
    assert!(found.exhausted, "{found:?}");
    let offered: [&[&str]; 2] = [&["left", "right"], &["left", "middle"]];
    let by_hand = ByHand::of(&program, offered, 3.0, true);
    assert_eq!(found.value(), Some(by_hand.least_m), "{found:?}");
    assert_eq!(
        (found.trials, found.refused, found.unreadable),
        (by_hand.tried, by_hand.refused, 0)
    );
    // Three actions in each of five states, but for picks of a corner that is folded.
    assert!((7..15).contains(&by_hand.tried), "{}", by_hand.tried);
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
    assert_eq!(
        (&start["trials"], &start["refused"]),
        (&by_hand.tried.into(), &by_hand.refused.into())
    );
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

    // The journal of the first search knows every trial of the second.
    let (_, mut again) = run(folder.path(), KNOWN, "--threads 2 --out one");
    assert_eq!(again["known"], start["trials"]);
    again["known"] = start["known"].clone();
    assert_eq!(again, whole);

    fs::write(
        folder.path().join("other.fab"),
        KNOWN.replace("17, 17", "18, 18"),
    )
    .unwrap();
    let other = finish(fabc(folder.path()).args(["best", "other.fab", "--out", "one"]));
    assert_eq!(other.code, 2, "{}", other.stderr);
    assert!(
        other
            .stderr
            .contains("it holds another search: its program is"),
        "{}",
        other.stderr
    );
}

#[test]
#[ignore = "long"]
fn pulls_anywhere_are_sampled_and_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = "--trials 24 --out whole";
    let (code, whole) = run(folder.path(), ANYWHERE, arguments);
    assert_eq!(code, 0, "{whole:#}");
    let start = &whole;
    assert_eq!(start["sampled"][0], "any point on the cloth");
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
    let after = start["after"].as_array().unwrap().iter();
    let after: Vec<f64> = after.filter_map(Value::as_f64).collect();
    assert_eq!(after.len(), 2);
    // Doing nothing in the second step is one of the choices.
    assert!(after[1] >= after[0], "{after:?}");
}

#[test]
#[ignore = "long"]
fn the_best_actions_skip_steps_that_would_spoil_the_cloth_however_few_the_trials() {
    let folder = tempfile::tempdir().unwrap();
    let longer = ANYWHERE
        .replace("improvement > 0.3", "improvement > 1")
        .replace("horizon 2", "horizon 3");
    let (code, found) = run(folder.path(), &longer, "--start 1 --trials 18");
    assert_eq!(code, 3, "{found:#}");
    let start = &found;
    let after = start["after"].as_array().unwrap();
    let after: Vec<f64> = after.iter().map(|it| it.as_f64().unwrap()).collect();
    assert!(after.is_sorted(), "{after:?}");
    assert_eq!(start["value"].as_f64(), after.last().copied());
    assert_eq!(start["trials"], 18);
    // A skipped step is not the one that gains least.
    let best = start["best"].as_array().unwrap();
    let limiting = start["limiting"].as_u64().unwrap() as usize;
    assert!(
        best.iter().any(|step| step["answer"].is_null()),
        "{start:#}"
    );
    assert!(!best[limiting]["answer"].is_null(), "{start:#}");
}

#[test]
#[ignore = "long"]
fn a_search_that_was_stopped_has_what_it_found_and_goes_on_from_there() {
    let [whole, stopped] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let program = compiled(whole.path(), KNOWN);
    let asked = Asked::of(&program);
    let expected = asked.found(whole.path());
    assert!(!expected.interrupted);
    let partial = Asked {
        stop_after: Some(5),
        ..Asked::of(&program)
    };
    let partial = partial.found(stopped.path());
    assert!(partial.interrupted);
    assert_eq!(partial.trials, 5);
    assert!(partial.best.is_some() || !partial.under_way.is_empty());
    let journal = stopped.path().join(TRIALS_FILE);
    // A line that was cut off is one trial less.
    let text = fs::read_to_string(&journal).unwrap();
    fs::write(&journal, &text[..text.len() - 3]).unwrap();
    let resumed = asked.found(stopped.path());
    assert_eq!(resumed.known, 4);
    assert_eq!(
        (resumed.best, resumed.trials),
        (expected.best, expected.trials)
    );
}

#[test]
fn a_search_that_was_stopped_skips_what_is_left_after_the_best_state() {
    let home = tempfile::tempdir().unwrap();
    let program = compiled(home.path(), TWICE);
    // Without decisions of other rollouts, and with those of one that skips all steps.
    for hints in [vec![], vec![vec![Choice::Skip; 2]]] {
        let folder = tempfile::tempdir().unwrap();
        let asked = Asked {
            hints: &hints,
            stop_after: Some(2),
            ..Asked::of(&program)
        };
        let found = asked.found(folder.path());
        assert!(found.interrupted, "{found:?}");
        let least = found.after.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least < found.untouched, "{found:?}");
        assert_eq!(found.value(), Some(least), "{found:?}");
        let choices = found.best.iter().flatten().map(|taken| &taken.choice);
        let is_skipped: Vec<bool> = choices.map(|choice| *choice == Choice::Skip).collect();
        assert_eq!(is_skipped, [false, true]);
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
        assert_eq!(found.sampled, ["any point on the cloth"]);
        assert_eq!((found.trials, found.after.len()), (8, 2));
        format!("{found:#?}")
    });
    assert_eq!(one, three);
}

#[test]
#[ignore = "long"]
fn drawn_actions_go_on_in_the_folder_of_their_search_and_in_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = TWICE.replace("one of left, right", "any of cloth");
    let (_, mut whole) = run(folder.path(), &drawn, "--trials 14 --threads 1 --out whole");
    let start = &mut whole;
    assert_eq!(start["sampled"][0], "any point on the cloth");
    assert_eq!(start["trials"], 14);
    assert_eq!(start["known"].take(), 0);
    run(folder.path(), &drawn, "--trials 4 --threads 3 --out kept");
    let (_, mut resumed) = run(folder.path(), &drawn, "--trials 14 --threads 2 --out kept");
    let known = resumed["known"].take();
    assert!((1..=4).contains(&known.as_u64().unwrap()), "{known}");
    assert_eq!(resumed, whole);

    for (option, told) in [("--seed 1", "seed"), ("--horizon 1", "horizon")] {
        let arguments = format!("--trials 14 --out kept {option}");
        let said = finish(&mut command(folder.path(), &drawn, &arguments));
        assert_eq!(said.code, 2, "{}", said.stdout);
        let is_named = said.stdout.contains(told) && said.stdout.contains("nothing is overwritten");
        assert!(is_named, "{}", said.stdout);
    }
}

#[test]
#[ignore = "long"]
#[cfg(target_os = "linux")]
fn a_search_shows_how_far_it_is_and_prints_what_it_found_when_it_is_interrupted() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = "--trials 5000 --threads 1 --out kept";
    let mut session = Session::in_window(&command(folder.path(), ANYWHERE, arguments).process());
    session.until("8 of 5000 trials");
    session.send("\u{3}");
    let (code, shown) = session.end();
    assert_eq!(code, Some(130), "{shown}");
    let document = &shown[shown.find("{\n").expect(&shown)..];
    let found: Value = serde_json::from_str(document).expect(document);
    let start = &found;
    let trials = start["trials"].as_u64().unwrap();
    assert!(start["interrupted"] == true && trials >= 8, "{start:#}");
    // Steps may be skipped, so the best of all states can be the last one.
    let after = start["after"].as_array().unwrap().iter();
    let untouched = start["untouched"].as_f64().unwrap();
    let most = after.filter_map(Value::as_f64).fold(untouched, f64::max);
    assert_eq!(start["value"].as_f64(), Some(most), "{start:#}");
    let begun = "--trials 24 --threads 1 --out kept";
    let (_, more) = run(folder.path(), ANYWHERE, begun);
    // With fewer trials it takes fewer actions of a state, so not all that are kept.
    let known = more["known"].as_u64().unwrap();
    assert!((8..=trials).contains(&known), "{known} of {trials}");
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
        .replace("0deg, 90deg, 180deg, 270deg", "0deg, 270deg");
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
