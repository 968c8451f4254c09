//! `fabc best`: the search for the best actions, its journal, and what it prints.

use super::pty::Session;
use super::support::{Fabc, ProjectFiles, bring_library, fabc, finish};
use fab_agent::best::journal::{Identity, TRIALS_FILE, TrialJournal};
use fab_agent::best::{self, Found, Limits, Search};
use fab_agent::subgoals::SubgoalSet;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_world::start::Start;
use fab_world::{SimulatedWorld, World};
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

/// The same fold to the middle of a side, which no answer can name.
const LACKING: &str = r#"
use "lib/folding.fab"
task lacking extends folding {
    cloth grid(17, 17)
    goal  particle_distance < 1mm
    subgoals { demonstrate { fold corner(back_left) -> middle(back) } }
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

#[test]
#[ignore = "long"]
fn the_best_of_a_known_fold_is_its_demonstration_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let (code, whole) = run(folder.path(), KNOWN, "--threads 1 --out one");
    assert_eq!(code, 0, "{whole:#}");
    let start = &whole["starts"][0];
    assert_eq!(start["exhausted"], true);
    assert_eq!(start["limiting"], 0);
    assert_eq!(start["best"].as_array().unwrap().len(), 1);
    let rows = whole["rows"].as_array().unwrap();
    let named = |name: &str| rows.iter().find(|row| row["row"] == name).unwrap();
    let value = |name: &str| named(name)["value"].as_f64().unwrap();
    // The row is a rollout of its own, which ends in the same state.
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
    assert_eq!(again["starts"][0]["known"], start["trials"]);
    again["starts"][0]["known"] = start["known"].clone();
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
fn a_point_that_is_not_offered_is_named_with_the_line_that_offers_it() {
    let folder = tempfile::tempdir().unwrap();
    let (code, found) = run(folder.path(), LACKING, "--trials 60");
    assert_eq!(code, 3, "the goal is missed");
    assert_eq!(found["goal_missed"], true);
    let start = &found["starts"][0];
    let better = &start["unoffered"];
    let what = better["what"].as_str().unwrap();
    assert!(what.starts_with("place middle(back), at ("), "{start:#}");
    assert_eq!(
        (&better["step"], &better["measured"]),
        (&1.into(), &"at_end".into())
    );
    let cure = better["cure"].as_str().unwrap();
    assert!(
        cure.contains("`place: one of corners, center, sides`"),
        "{cure}"
    );
    assert!(better["value"].as_f64() < start["value"].as_f64());

    // Another field keeps the value of the best offered action.
    let lifted = LACKING.replace(
        "    goal ",
        "    actions { pick: one of corners  place: one of corners, center  lift: one of 50mm }\n    goal ",
    );
    let (_, found) = run(folder.path(), &lifted, "--trials 60");
    let what = found["starts"][0]["unoffered"]["what"].as_str();
    assert!(
        what.is_some_and(|it| it.starts_with("place middle(back)")),
        "{found:#}"
    );

    // Half of the trials, and not one more.
    let (_, found) = run(folder.path(), LACKING, "--trials 12");
    let tried = found["starts"][0]["unoffered_trials"].as_u64().unwrap();
    assert!((1..=6).contains(&tried), "{tried}");
}

#[test]
#[ignore = "long"]
fn pulls_anywhere_are_sampled_and_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = "--trials 24 --out whole";
    let (code, whole) = run(folder.path(), ANYWHERE, arguments);
    assert_eq!(code, 0, "{whole:#}");
    let start = &whole["starts"][0];
    assert_eq!(start["sampled"][0], "any point on the cloth");
    assert_eq!(
        (&start["exhausted"], &start["trials"]),
        (&false.into(), &24.into())
    );
    let row = |name: &str| {
        let mut rows = whole["rows"].as_array().unwrap().iter();
        rows.find(|row| row["row"] == name).unwrap()
    };
    let none = row("expert")["none"].as_str().unwrap().to_owned();
    assert!(none.contains("demonstrates no folds"), "{none}");
    let value = |name: &str| row(name)["value"].as_f64().unwrap();
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
    let start = &found["starts"][0];
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

/// Searches the known fold; `stop_after` so many trials.
fn searched(folder: &Path, stop_after: Option<u32>) -> Found {
    let path = folder.join("known.fab");
    bring_library(folder);
    fs::write(&path, KNOWN).unwrap();
    let compiled = fab_compiler::compile(path.to_str().unwrap(), &ProjectFiles).unwrap();
    let program = compiled.programs.first().unwrap();
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
        limits: Limits {
            trials: 20,
            beam: 4,
            seed: 0,
            threads: 1,
        },
        hints: &[],
        journal: Some(&journal),
        interrupt: &interrupt,
        progress: &|trials| {
            if Some(trials) == stop_after {
                interrupt.raise();
            }
        },
    };
    best::search(&search).unwrap().0
}

#[test]
#[ignore = "long"]
fn a_search_that_was_stopped_has_what_it_found_and_goes_on_from_there() {
    let [whole, stopped] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let expected = searched(whole.path(), None);
    assert!(!expected.interrupted);
    let partial = searched(stopped.path(), Some(5));
    assert!(partial.interrupted);
    assert_eq!(partial.trials, 5);
    assert!(partial.best.is_some() || !partial.under_way.is_empty());
    let journal = stopped.path().join(TRIALS_FILE);
    // A line that was cut off is one trial less.
    let text = fs::read_to_string(&journal).unwrap();
    fs::write(&journal, &text[..text.len() - 3]).unwrap();
    let resumed = searched(stopped.path(), None);
    assert_eq!(resumed.known, 4);
    assert_eq!(
        (resumed.best, resumed.trials),
        (expected.best, expected.trials)
    );
}

#[test]
#[ignore = "long"]
fn several_starts_get_means_with_intervals_and_a_curve() {
    let folder = tempfile::tempdir().unwrap();
    let (code, found) = run(folder.path(), ANYWHERE, "--trials 16 --starts 3");
    assert!(code == 0 || code == 3, "{found:#}");
    let starts = found["starts"].as_array().unwrap();
    let seeds: Vec<_> = starts.iter().map(|start| &start["seed"]).collect();
    assert_eq!(seeds, [0, 1, 2]);
    let mean = |of: &dyn Fn(&Value) -> f64| starts.iter().map(of).sum::<f64>() / 3.0;
    let curve = found["after"].as_array().unwrap();
    assert_eq!(curve.len(), 2);
    for (count, point) in curve.iter().enumerate() {
        let value = point["value"].as_f64().unwrap();
        let expected = mean(&|start| start["after"][count].as_f64().unwrap());
        assert!((value - expected).abs() < 1e-9, "{point}");
        let ends = [0, 1].map(|end| point["ci95"][end].as_f64().unwrap());
        assert!(ends[0] <= value && value <= ends[1], "{point}");
    }
    let best = &found["rows"][0];
    assert_eq!(
        (&best["row"], &best["rollouts"]),
        (&"best".into(), &3.into())
    );
    let value = best["value"].as_f64().unwrap();
    assert!((value - mean(&|start| start["value"].as_f64().unwrap())).abs() < 1e-9);
}

#[test]
#[ignore = "long"]
#[cfg(target_os = "linux")]
fn a_search_shows_how_far_it_is_and_prints_what_it_found_when_it_is_interrupted() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = "--trials 5000 --starts 2 --threads 1 --out kept";
    let mut session = Session::in_window(&command(folder.path(), ANYWHERE, arguments).process());
    session.until("[--------------------] start 1 of 2: 8 of 5000 trials, at most ");
    session.until(" left");
    session.send("\u{3}");
    let (code, shown) = session.end();
    assert_eq!(code, Some(130), "{shown}");
    let document = &shown[shown.find("{\n").expect(&shown)..];
    let found: Value = serde_json::from_str(document).expect(document);
    let start = &found["starts"][0];
    let trials = start["trials"].as_u64().unwrap();
    assert!(start["interrupted"] == true && trials >= 8, "{start:#}");
    assert!(!start["best"].is_null() || !start["under_way"].as_array().unwrap().is_empty());
    let begun = "--trials 24 --starts 1 --threads 1 --out kept";
    let (_, more) = run(folder.path(), ANYWHERE, begun);
    // With fewer trials it takes fewer actions of a state, so not all that are kept.
    let known = more["starts"][0]["known"].as_u64().unwrap();
    assert!((8..=trials).contains(&known), "{known} of {trials}");
}

#[test]
#[cfg(target_os = "linux")]
fn rows_are_printed_if_it_is_interrupted_before_anything_is_tried() {
    let folder = tempfile::tempdir().unwrap();
    // The expert's rollout leaves its end in the cache; the search needs the state after its first fold, too.
    let fold = "fold corner(back_left) -> center";
    let two = KNOWN.replace(fold, &format!("{fold}\nfold corner(front_right) -> center"));
    let arguments = "--start 7 --threads 1 --out kept";
    let mut session = Session::in_window(&command(folder.path(), &two, arguments).process());
    session.until("start 1 of 1: 1 of 7 rollouts beside it");
    session.send("\u{3}");
    let (code, shown) = session.end();
    assert_eq!(code, Some(130), "{shown}");
    let document = &shown[shown.find("{\n").expect(&shown)..];
    let found: Value = serde_json::from_str(document).expect(document);
    let none = &Value::Null;
    let rows = found["unsearched"]["rows"].as_array().expect(&shown).iter();
    let row = |name: &str| rows.clone().find(|row| row["row"] == name).unwrap();
    // The first rollout is the expert's.
    assert_ne!(&row("expert")["value"], none, "{shown}");
    assert_eq!(row("stand-in")["none"], "interrupted", "{shown}");
}

#[test]
fn the_best_is_behind_no_rollout_of_a_policy_however_few_the_trials() {
    let folder = tempfile::tempdir().unwrap();
    let (_, found) = run(folder.path(), ANYWHERE, "--start 6 --trials 2 --out kept");
    let best = found["rows"][0]["value"].as_f64().unwrap();
    let rollouts = fs::read_dir(folder.path().join("kept/start-1")).unwrap();
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
    for world in ["arm", "exec:true"] {
        let said = finish(&mut command(
            folder.path(),
            KNOWN,
            &format!("--world {world}"),
        ));
        assert_eq!(said.code, 64);
        assert!(
            said.stdout.contains(&format!("`--world {world}`")),
            "{}",
            said.stdout
        );
    }
    let said = finish(&mut command(
        folder.path(),
        KNOWN,
        "--start x.npy --starts 2",
    ));
    assert!(said.stdout.contains("names a file"), "{}", said.stdout);

    let aimless = ANYWHERE.replace("goal   normalized_improvement > 0.3", "");
    let said = finish(&mut command(folder.path(), &aimless, ""));
    assert_eq!(said.code, 64);
    assert!(
        said.stdout.contains("so no result is better than another"),
        "{}",
        said.stdout
    );
}
