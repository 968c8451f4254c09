//! The protocol on a real table: an operator lays the cloth and judges, and coverage is measured from pictures.

use super::bench::project;
use super::seen_coverage::{Blind, flat};
use super::support::{self, ProjectFiles, fabc, finish};
use fab_agent::examples::Examples;
use fab_agent::judgement::{Cause, Judgement, Operator};
use fab_agent::policy::{Policy, Prompted};
use fab_agent::record::Report;
use fab_agent::subgoals::{Origin, SubgoalSet};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_bench::suite::Suite;
use fab_bench::vary::Variation;
use fab_bench::{Answers, Bench, Entry, Task, play, rows, starts, table};
use fab_model::Models;
use fab_model::calls::Budget;
use fab_program::{ClothStart, Program};
use fab_standins::Random;
use fab_world::vary::AxisValues;
use fab_world::{SimulatedWorld, World, WorldError};
use serde_json::Value;
use std::collections::{BTreeMap, VecDeque};
use std::fs;
use std::path::Path;
use std::sync::Mutex;

pub(super) const SUITE: &str = r#"
about = "Three folds on a table."
statistic = "mean"
metrics = ["reached_by_operator", "normalized_improvement_source", "goal_reached"]
tasks = ["../tiny.fab"]
[starts]
lie = "operator"
count = 3
[[method]]
name = "plain"
[[quoted]]
task = "tiny"
method = "somebody"
metric = "reached_by_operator"
statistic = "share"
value = 0.5
n = 4
source = "a paper"
"#;

/// Runs the small suite with these lines typed, and returns its document and its messages.
fn typed(folder: &Path, lines: &str) -> (Value, String) {
    let said = finish(
        fabc(folder)
            .args(["bench", "tiny", "--operator", "--json", "--out", "out"])
            .stdin(lines),
    );
    let document = serde_json::from_str(&said.stdout);
    (
        document.unwrap_or_else(|_| panic!("{}", said.stderr)),
        said.stderr,
    )
}

fn rows_of(document: &Value) -> Vec<Value> {
    document["rows"].as_array().unwrap().clone()
}

#[test]
fn the_operator_is_asked_once_and_the_table_says_what_was_said() {
    let folder = project(SUITE);
    let (first, said) = typed(
        folder.path(),
        "y\n\nn\ndetection\na corner lay hidden\nno\nr\n\n",
    );
    assert_eq!(said.matches("Was the task reached?").count(), 3, "{said}");
    let rows = rows_of(&first);
    let ours = &rows[0];
    assert_eq!(ours["metric"], "reached_by_operator");
    assert!((ours["value"].as_f64().unwrap() - 1.0 / 3.0).abs() < 1e-12);
    assert_eq!(
        ours["causes"],
        serde_json::json!({ "detection": 1, "reasoning": 1 })
    );
    assert!(
        ours["note"]
            .as_str()
            .unwrap()
            .contains("a rehearsal in the simulator")
    );
    let quoted = &rows[2];
    assert_eq!(
        (&quoted["quoted"], &quoted["n"]),
        (&Value::Bool(true), &4.into())
    );
    // Wilson's interval of 2 of 4.
    let [low, high] = [0, 1].map(|end| quoted["ci95"][end].as_f64().unwrap());
    assert!(
        (low - 0.150_0).abs() < 1e-4 && (high - 0.850_0).abs() < 1e-4,
        "{low} {high}"
    );
    let metrics: Vec<&Value> = rows.iter().map(|row| &row["metric"]).collect();
    assert_eq!(
        metrics,
        ["reached_by_operator", "goal_reached", "reached_by_operator"],
        "a fold has no row of coverage"
    );

    let journal = folder
        .path()
        .join("out/tiny/plain/start-001-1/rollout.jsonl");
    let journal = fs::read_to_string(journal).unwrap();
    let end: Value = serde_json::from_str(journal.lines().last().unwrap()).unwrap();
    assert_eq!(
        end["report"]["operator"],
        serde_json::json!({ "reached": false, "why": "detection", "words": "a corner lay hidden" })
    );

    let (again, said) = typed(folder.path(), "");
    assert!(!said.contains("Was the task reached?"), "{said}");
    assert_eq!(rows_of(&again)[0]["value"], ours["value"]);
}

#[test]
fn what_nobody_judged_is_left_out_of_the_share_and_nothing_else() {
    let folder = project(SUITE);
    let (document, said) = typed(folder.path(), "y\n\n");
    assert_eq!(said.matches("nobody answered").count(), 2, "{said}");
    let rows = rows_of(&document);
    assert_eq!(rows[0]["value"], 1.0);
    let [low, _] = [0, 1].map(|end| rows[0]["ci95"][end].as_f64().unwrap());
    assert!(
        (low - 0.2065).abs() < 1e-4,
        "the interval is that of one rollout: {low}"
    );
    assert_eq!(document["rollouts"]["finished"], 3);
}

#[test]
fn suites_for_a_table_are_held_to_what_is_known_there() {
    for (from, to, wanted) in [
        (
            "\"reached_by_operator\", ",
            "\"mean_particle_distance_mm\", ",
            "the particle positions of a cloth laid by hand are unknown",
        ),
        ("count = 3", "count = 0", "`starts.count`: 0 is not from 1"),
        (
            "value = 0.5",
            "value = 1.5",
            "1.5 is not a share from 0 to 1",
        ),
        ("n = 4", "n = 0", "`quoted.n`: 0 is not from 1"),
    ] {
        assert!(SUITE.contains(from));
        let error = Suite::parse(&SUITE.replace(from, to)).unwrap_err();
        assert!(error.to_string().contains(wanted), "{error}");
    }
    let folder = project(&SUITE.replace(
        "[[method]]",
        "[starts_of.other]\nlie = \"operator\"\ncount = 2\n[[method]]",
    ));
    let said = support::finish(fabc(folder.path()).args(["bench", "tiny"]));
    assert!(
        said.stderr
            .contains("starts of a task `other`, and has `tiny`"),
        "{}",
        said.stderr
    );
}

/// An operator with scripted judgements.
struct Written(Mutex<VecDeque<Judgement>>);

impl Operator for Written {
    fn judge(&self, report: &Report, _: &Path) -> Option<Judgement> {
        assert_eq!(report.operator, None);
        self.0.lock().unwrap().pop_front()
    }
}

/// The shipped smoothing task of the real table, with a small flat cloth.
pub(super) fn smoothing() -> Program {
    let compiled = fab_compiler::compile("tasks/real/smoothing.fab", &ProjectFiles).unwrap();
    let mut program = compiled.programs.into_iter().next().unwrap();
    (program.cloth.dimx, program.cloth.dimy) = (28, 28);
    program.cloth.start = ClothStart::Flat;
    program.horizon = 1;
    program
}

#[test]
#[ignore = "long"]
fn coverage_by_pictures_has_columns_of_its_own() {
    let program = smoothing();
    assert!(
        program
            .keypoints
            .iter()
            .all(|it| !it.extractor.needs_depth()),
        "the real table's tasks know no depth"
    );
    let suite = Suite::parse(
        &SUITE
            .replace("tiny", "smoothing")
            .replace(
                "\"normalized_improvement_source\"",
                "\"normalized_improvement_picture\", \"covered_0.85_picture\", \"normalized_improvement_source\", \"covered_0.85_source\"",
            ),
    )
    .unwrap();
    // Compared with the picture of a larger cloth, so that coverage is incomplete at first.
    let picture = flat(&program, 40);
    let make_world = |program: &Program, _: &AxisValues| -> Result<Box<dyn World>, WorldError> {
        Ok(Box::new(Blind {
            world: SimulatedWorld::new(&program.camera, program.picker)?,
            flat: Some(picture.clone()),
        }))
    };
    let random = Random::seeded(5);
    let models = Models {
        vision: &random,
        text: &random,
    };
    let prompted = Prompted::new(models);
    let failed = Judgement {
        reached: false,
        why: Some(Cause::Hardware),
        words: None,
    };
    let operator = Written(Mutex::new(VecDeque::from(vec![failed; 3])));
    let folder = tempfile::tempdir().unwrap();
    let bench = Bench {
        suite: &suite,
        tasks: vec![Task {
            name: "smoothing".to_owned(),
            starts: starts::generated(&suite.starts, &program.cloth),
            program: program.clone(),
        }],
        entries: vec![Entry {
            task: 0,
            method: &suite.methods[0],
            variation: Variation::default(),
            make_policy: &prompted,
            policy: prompted.description(),
            models: Some(models),
            programs: BTreeMap::from([([28, 28], program.clone())]),
            subgoals: SubgoalSet {
                origin: Origin::Author,
                ..SubgoalSet::default()
            },
            examples: Examples::default(),
            varies: false,
            repeats: 1,
        }],
        make_world: &make_world,
        arm: None,
        elsewhere: None,
        out: folder.path().to_owned(),
        threads: 2,
        answers: Answers::PerStart,
        cache: &Cache::none(),
        budget: &Budget::default(),
        operator: Some(&operator),
        interrupt: &Interrupt::default(),
        listen: &|_, _| {},
    };
    let results = play::play(&bench, &|_, _, _| {}).unwrap();
    let rows = rows::rows(&bench, &results);
    let metrics: Vec<&str> = rows.iter().map(|row| row.metric.row().name).collect();
    assert_eq!(
        metrics,
        [
            "reached_by_operator",
            "normalized_improvement_picture",
            "covered_0.85_picture",
            "goal_reached",
            "reached_by_operator"
        ]
    );
    assert_eq!(rows[0].effort.causes, BTreeMap::from([("hardware", 3)]));
    assert_eq!(rows[0].note, None, "that was no rehearsal in `sim`");
    assert_eq!(rows[2].value, 0.0, "a third of the larger cloth is missing");
    let text = table::text(&suite, &rows);
    for wanted in [
        "NI, picture",
        "not reached for",
        "3 hardware",
        "neither SoftGym's measure",
    ] {
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
    assert!(!text.contains("NI, source"), "{text}");

    // If particles are unknown, only the operator can judge a distance between them.
    let mut fold = smoothing();
    fold.goal = support::task("double_triangle").goal;
    fold.task = "fold".to_owned();
    let entry = Entry {
        task: 0,
        method: &suite.methods[0],
        variation: Variation::default(),
        make_policy: &prompted,
        policy: prompted.description(),
        models: Some(models),
        programs: BTreeMap::from([([28, 28], fold.clone())]),
        subgoals: SubgoalSet {
            origin: Origin::Author,
            ..SubgoalSet::default()
        },
        examples: Examples::default(),
        varies: false,
        repeats: 1,
    };
    let tasks = vec![Task {
        name: "fold".to_owned(),
        starts: starts::generated(&suite.starts, &fold.cloth),
        program: fold,
    }];
    let bench = Bench {
        tasks,
        entries: vec![entry],
        ..bench
    };
    let results = play::play(&bench, &|_, _, _| {}).unwrap();
    assert_eq!(results.rollouts.len(), 3);
    assert_eq!(
        rows::rows(&bench, &results),
        [],
        "nothing is known, and nobody answered"
    );
}
