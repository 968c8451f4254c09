//! A suite on an arm whose cloths a person lays: what the person is told, and what is not done without a person.

use super::physical::{SUITE, smoothing};
use super::seen_coverage::{Blind, flat};
use fab_agent::examples::Examples;
use fab_agent::policy::{Policy, Prompted};
use fab_agent::subgoals::{Origin, SubgoalSet};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_bench::on_arm::{Cloths, OnArm};
use fab_bench::suite::Suite;
use fab_bench::vary::Variation;
use fab_bench::{Answers, Bench, Entry, Task, first_questions_of, play, rows, starts};
use fab_model::Models;
use fab_model::calls::Budget;
use fab_program::Program;
use fab_standins::Random;
use fab_world::About;
use fab_world::vary::AxisValues;
use fab_world::{SimulatedWorld, World, WorldError};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

#[test]
#[ignore = "long"]
fn a_person_is_told_in_words_and_nothing_is_connected_for_an_estimate() {
    let program = smoothing();
    let picture = flat(&program, 40);
    let suite = Suite::parse(&SUITE.replace("tiny", "smoothing").replace(
        "\"normalized_improvement_source\"",
        "\"normalized_improvement_picture\"",
    ))
    .unwrap();
    let simulated = |program: &Program| -> Result<Box<dyn World>, WorldError> {
        let world = SimulatedWorld::new(&program.camera, program.picker)?;
        Ok(Box::new(world))
    };
    let connected: Mutex<Vec<PathBuf>> = Mutex::default();
    let make_world = |program: &Program, folder: &Path| -> Result<Box<dyn World>, WorldError> {
        connected.lock().unwrap().push(folder.to_owned());
        Ok(Box::new(Blind {
            world: SimulatedWorld::new(&program.camera, program.picker)?,
            flat: Some(picture.clone()),
        }))
    };
    let random = Random::seeded(5);
    let prompted = Prompted::new(Models {
        vision: &random,
        text: &random,
    });
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
            models: Some(prompted.models),
            programs: BTreeMap::from([([28, 28], program.clone())]),
            subgoals: SubgoalSet {
                origin: Origin::Author,
                ..SubgoalSet::default()
            },
            examples: Examples::default(),
            varies: false,
            repeats: 1,
        }],
        make_world: &|program: &Program, _: &AxisValues| simulated(program),
        arm: Some(OnArm {
            about: About {
                name: "jaco".to_owned(),
                parameters: SimulatedWorld::new(&program.camera, program.picker)
                    .unwrap()
                    .parameters(),
                code: simulated(&program).unwrap().code(),
            },
            cloths: Cloths::ByHand,
            make_world: &make_world,
            make_look: &simulated,
        }),
        elsewhere: None,
        out: folder.path().to_owned(),
        threads: 4,
        answers: Answers::PerStart,
        cache: &Cache::none(),
        budget: &Budget::default(),
        operator: None,
        interrupt: &Interrupt::default(),
        listen: &|_, _| {},
    };
    assert_eq!(bench.side_by_side(), 1);
    assert_eq!(first_questions_of(&bench).unwrap().len(), 1);
    assert_eq!(*connected.lock().unwrap(), Vec::<PathBuf>::new());

    let results = play::play(&bench, &|_, _, _| {}).unwrap();
    assert_eq!((results.world.as_str(), results.stopped), ("jaco", None));
    let runs: Vec<PathBuf> = ["start-000-1", "start-001-1", "start-002-1"]
        .map(|start| folder.path().join("smoothing/plain").join(start))
        .into();
    assert_eq!(
        *connected.lock().unwrap(),
        runs,
        "one world a rollout, in order"
    );
    let names = runs.iter().map(|run| {
        let journal = fs::read_to_string(run.join("rollout.jsonl")).unwrap();
        let header: Value = serde_json::from_str(journal.lines().next().unwrap()).unwrap();
        header["start"]["name"].as_str().unwrap().to_owned()
    });
    assert_eq!(names.collect::<Vec<_>>(), ["flat, 1", "flat, 2", "flat, 3"]);
    let rows = rows::rows(&bench, &results);
    assert_eq!(rows[0].metric.row().name, "normalized_improvement_picture");
    assert_eq!(rows[0].note, None, "that was no rehearsal");

    let again = play::play(&bench, &|_, _, _| {}).unwrap();
    assert_eq!((again.found, again.rollouts.len()), (3, 3));
    assert_eq!(
        connected.lock().unwrap().len(),
        3,
        "nothing is connected to read what has ended"
    );
}

#[test]
fn suites_without_a_figure_for_real_cloth_are_refused_and_the_shipped_one_is_not() {
    let shipped = |name: &str| {
        let path = super::support::root().join(format!("tasks/suites/{name}.toml"));
        Suite::parse(&fs::read_to_string(path).unwrap()).unwrap()
    };
    for (name, refused_for) in [
        ("physical", None),
        ("folding", Some("mean_particle_distance_mm")),
        ("smoothing", Some("normalized_improvement_source")),
        ("verification", Some("normalized_improvement_source")),
    ] {
        let suite = shipped(name);
        assert!(Cloths::Simulated.check(&suite).is_ok());
        match (Cloths::ByHand.check(&suite), refused_for) {
            (Ok(()), None) => {}
            (Err(error), Some(metric)) => {
                let message = error.to_string();
                assert!(
                    message.contains(&format!("measures `{metric}`")),
                    "{message}"
                );
            }
            (found, _) => panic!("{name}: {found:?}"),
        }
    }
    let words = |name: &str| -> Vec<String> {
        let suite = shipped(name);
        let program = smoothing();
        let points = starts::generated(&suite.starts, &program.cloth);
        points
            .iter()
            .take(2)
            .map(starts::StartPoint::in_words)
            .collect()
    };
    assert_eq!(words("folding")[0], "flat, turned by 0 degrees");
    assert_eq!(
        words("smoothing"),
        ["crumpled by hand, 1", "crumpled by hand, 2"]
    );
}
