//! A world that is another program: the bundled simulator over lines, and the handling of wrong lines.
#![cfg(unix)]

use super::support::{self, fabc, finish, project};
use fab_base::child::CommandLine;
use fab_base::interrupt::Interrupt;
use fab_program::{Manner, Picker};
use fab_world::conformance::{PROMISES, camera};
use fab_world::start::Start;
use fab_world::{ExternalWorld, Grip, Motion, SimulatedWorld, World, WorldError, WorldPoint};
use std::path::Path;

const FABC: &str = env!("CARGO_BIN_EXE_fabc");

/// The bundled simulator as a program whose output `sed` changes.
fn edited(script: &str) -> CommandLine {
    let pipe = format!("'{FABC}' world serve | sed -u -e '{script}'");
    let quoted = shlex::try_quote(&pipe).unwrap();
    CommandLine::parse(&format!("sh -c {quoted}")).unwrap()
}

fn started(command: &CommandLine) -> Result<ExternalWorld, WorldError> {
    ExternalWorld::start(
        command,
        &camera(),
        Picker::default(),
        None,
        &Interrupt::default(),
    )
}

/// Lays a small cloth, looks, and folds a corner.
fn played(command: &CommandLine) -> Result<(), WorldError> {
    let mut world = started(command)?;
    let start = Start::flat(&support::small_task().cloth);
    world.reset(&start)?;
    world.observe()?;
    let [x, y, z] = start.positions[0].map(f64::from);
    let grip = Grip::new(WorldPoint::new(x, y, z), WorldPoint::new(0.0, 0.0, 0.005));
    world.act(&grip.into(), &Interrupt::default()).map(drop)
}

#[test]
fn the_simulator_over_lines_keeps_every_promise() {
    let command = CommandLine::parse(&format!("'{FABC}' world serve")).unwrap();
    for promise in PROMISES {
        let make = || started(&command).map(|world| Box::new(world) as Box<dyn World>);
        let kept = promise.check(&make);
        assert!(kept.is_ok(), "{}: {}", promise.name, kept.unwrap_err());
    }
}

#[test]
#[ignore = "long"]
fn wrong_answers_are_named_with_their_values() {
    for (script, words) in [
        (
            "s/\"code\":\"[^\"]*\",//",
            "answers `hello` wrongly: missing field `code`",
        ),
        (
            "s/\"code\":\"[^\"]*\"/\"code\":\"\"/",
            "states an empty `code`, and results are stored under it",
        ),
        (
            "s/\"name\":\"sim\"/\"refused\":\"no licence\"/",
            "refuses `hello`: no licence",
        ),
        (
            "s/\"limits_s\":{}/\"limits_s\":{\"dance\":1}/",
            "states the limit `dance` as 1 s; the questions are `hello`",
        ),
        (
            "s/\"protocol\":2,//",
            "answers version 1 of the lines, and this fabc asks in version 2, in which `act` and its answer have a list of \
             `grips`; let it answer that, and add `\"protocol\": 2` to its `hello`",
        ),
        (
            "s/\"grippers\":1/\"grippers\":0/",
            "states `grippers` as 0; a world has at least 1",
        ),
        (
            "s/\"grippers\":1/\"grippers\":2/",
            "the motion has 1 grip, and the world `sim` has 2 grippers",
        ),
        (
            "s/\"grips\":\\[.*\\]/\"grips\":[]/",
            "`sim`: it says what 0 grips did, and was asked for 1",
        ),
        ("s/particles.npy/gone.npy/", "`sim`: its positions `"),
        (
            "s/\"focal_px\":\\[[0-9.]*/\"focal_px\":[0.0/",
            "`focal_px` is [0, 270.3919189857867], and both have to be above 0",
        ),
        (
            "s/\"world_from_camera\":\\[\\[1.0/\"world_from_camera\":[[2.0/",
            "`world_from_camera` is not a pose",
        ),
        ("s/rgb.png/depth.npy/", "is an array of NumPy (`.npy`)"),
        ("s/depth.npy/rgb.png/", "it is a PNG picture"),
        (
            "s/\"time_s\":[0-9.]*/\"refused\":\"the lens is dirty\"/",
            "it refuses `observe`: the lens is dirty",
        ),
        (
            "s/\"grasp\":{[^}]*}/\"grasp\":\"maybe\"/",
            "which is not a valid answer",
        ),
        (
            "s/\"released_at\":\\[[-0-9.]*/\"released_at\":[1e999/",
            "which is not a valid answer",
        ),
        (
            "s/\"duration_s\":[0-9.]*/\"duration_s\":-1/",
            "negative duration",
        ),
        (
            "s/^{}$/{\"refused\":\"only flat cloths\"}/",
            "the start `flat` cannot be laid on the table: only flat cloths",
        ),
        (
            "s/\"limits_s\":{}/\"limits_s\":{\"act\":1}/; /duration_s/d",
            "did not answer within 1 s",
        ),
        (
            "s/\"acts_on\":\\[[^]]*/\"acts_on\":[\"lifts\"/",
            "acts on `lifts`, and a manner has `lift`, `speed`, `release_height`, `press`",
        ),
        ("/duration_s/q", ""),
    ] {
        let done = played(&edited(script));
        if words.is_empty() {
            // The program ends after its last answer, which the next request, for particles, finds out.
            assert!(
                done.unwrap_err()
                    .to_string()
                    .contains("ended before it answered")
            );
            continue;
        }
        let error = done.expect_err(script).to_string();
        assert!(error.contains(words), "{script}: {error}");
    }
}

#[test]
fn a_world_is_asked_only_for_the_manners_that_it_announces() {
    let lift = Manner::default().with("lift", 0.03);
    let grip = Grip::new(WorldPoint::new(0.05, 0.05, 0.005), WorldPoint::origin());
    let motion = Motion::from(grip.with_manner(lift));
    let acts_on = |names: &str| {
        let script = format!("s/\"acts_on\":\\[[^]]*/\"acts_on\":[{names}/");
        let mut world = started(&edited(&script)).unwrap();
        world
            .reset(&Start::flat(&support::small_task().cloth))
            .unwrap();
        let done = world.act(&motion, &Interrupt::default());
        (world.refuses(&motion), done)
    };
    let (why, done) = acts_on("\"lift\",\"speed\"");
    assert_eq!(why, None);
    assert_eq!(done.unwrap().grips[0].grip.manner, lift);
    let (why, done) = acts_on("\"speed\"");
    let why = why.unwrap();
    assert_eq!(why, "the world `sim` does not act on `lift`");
    assert!(done.unwrap_err().to_string().contains(&why));
}

#[test]
fn a_world_that_knows_no_materials_refuses_one_by_name() {
    let task = project("tasks/hem.fab");
    let program = support::task("hem");
    let material = program.cloth.material.as_ref();
    let why =
        "its `hello` does not say `\"materials\": true`, and the task's cloth is made of `cotton`";
    for (answer, refusal) in [("false", Some(why)), ("true", None)] {
        let script = format!("s/\"materials\":true/\"materials\":{answer}/");
        let made = started(&edited(&script)).unwrap().with_material(material);
        let told = made.err().map(|error| error.to_string());
        assert_eq!(told.is_some(), refusal.is_some(), "{told:?}");
        assert!(
            told.unwrap_or_default()
                .contains(refusal.unwrap_or_default())
        );
        let any = started(&edited(&script)).unwrap().with_material(None);
        assert!(any.is_ok());
    }
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("world.sh");
    let text = format!("'{FABC}' world serve | sed -u 's/\"materials\":true/\"materials\":false/'");
    std::fs::write(&script, text).unwrap();
    let world = format!("exec:sh '{}'", script.display());
    let said = finish(fabc(folder.path()).args(["run", &task, "--world", &world]));
    assert_eq!(said.code, 2, "{}", said.stderr);
    assert!(said.stderr.contains(why), "{}", said.stderr);
}

#[test]
#[ignore = "long"]
fn a_cloth_of_a_material_is_crumpled_over_lines_as_in_the_simulator() {
    let program = support::task("hem");
    let material = program.cloth.material.as_ref();
    let mut flat = Start::flat(&support::small_task().cloth);
    flat.name = "flat".to_owned();
    let command = CommandLine::parse(&format!("'{FABC}' world serve")).unwrap();
    let over_lines = started(&command).unwrap().with_material(material).unwrap();
    let here = SimulatedWorld::new(&camera(), Picker::default()).unwrap();
    let heap = |world: &dyn World| {
        let heap = world.crumple(&flat, 1, &Interrupt::default());
        heap.unwrap().positions
    };
    let of_material = heap(&here.clone().with_material(material));
    assert!(heap(&over_lines) == of_material);
    assert!(heap(&here) != of_material);
}

#[test]
#[ignore = "long"]
fn a_suite_of_a_material_is_measured_over_lines() {
    let folder = super::bench::project(&super::physical::SUITE.replace(
        "lie = \"operator\"\ncount = 3",
        "lie = \"flat\"\nsides = [28]\nturns_deg = [0]",
    ));
    let task = folder.path().join("tasks/tiny.fab");
    let text = std::fs::read_to_string(&task).unwrap();
    let text = format!("use \"lib/materials.fab\"\n{text}");
    let made = text.replace("cloth grid(28, 28)", "cloth grid(28, 28, material: cotton)");
    assert_ne!(made, text);
    std::fs::write(&task, made).unwrap();
    let world = format!("exec:'{FABC}' world serve");
    let said = finish(fabc(folder.path()).args([
        "bench", "tiny", "--world", &world, "--jobs", "1", "--out", "out", "--json",
    ]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert!(said.stdout.contains("\"finished\": 1"), "{}", said.stdout);
}

fn run(folder: &Path, world: &str, out: &str) -> support::Captured {
    let task = project("tasks/double_triangle.fab");
    finish(fabc(folder).args(["run", &task, "--world", world, "--out", out]))
}

#[test]
#[ignore = "long"]
fn a_rollout_over_lines_comes_out_as_in_the_simulator_and_can_be_gone_on_with() {
    let folder = tempfile::tempdir().unwrap();
    let over_lines = format!("exec:'{FABC}' world serve");
    let here = run(folder.path(), "sim", "here");
    let there = run(folder.path(), &over_lines, "there");
    assert_eq!((here.code, there.code), (0, 0), "{}", there.stderr);
    let record =
        |name: &str| std::fs::read_to_string(folder.path().join(name).join("rollout.jsonl"));
    let whole = record("there").unwrap();
    assert_eq!(record("here").unwrap(), whole);
    assert!(folder.path().join("there/world.stderr.txt").exists());

    let cut = whole.match_indices('\n').nth(1).unwrap().0 + 1;
    std::fs::write(folder.path().join("there/rollout.jsonl"), &whole[..cut]).unwrap();
    let again = finish(fabc(folder.path()).args(["resume", "there"]));
    assert_eq!(again.code, 0, "{}", again.stderr);
    assert_eq!(record("there").unwrap(), whole);
}

#[test]
#[ignore = "long"]
fn a_world_that_does_not_repeat_is_not_gone_on_with() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("once.sh");
    let text = format!("'{FABC}' world serve | sed -u 's/\"repeats\":true/\"repeats\":false/'");
    std::fs::write(&script, text).unwrap();
    let world = format!("exec:sh '{}'", script.display());
    let done = run(folder.path(), &world, "once");
    assert_eq!(done.code, 0, "{}", done.stderr);
    let record = folder.path().join("once/rollout.jsonl");
    let whole = std::fs::read_to_string(&record).unwrap();
    let cut = whole.match_indices('\n').nth(1).unwrap().0 + 1;
    std::fs::write(&record, &whole[..cut]).unwrap();
    let again = finish(fabc(folder.path()).args(["resume", "once"]));
    assert_eq!(again.code, 2);
    assert!(
        again
            .stderr
            .contains("the world `sim` says that it cannot lay a start again"),
        "{}",
        again.stderr
    );
    assert_eq!(std::fs::read_to_string(&record).unwrap(), whole[..cut]);
}

#[test]
#[ignore = "long"]
fn a_world_with_two_grippers_is_refused_before_anything_moves() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("two.sh");
    let text = format!("'{FABC}' world serve | sed -u 's/\"grippers\":1/\"grippers\":2/'");
    std::fs::write(&script, text).unwrap();
    let world = format!("exec:sh '{}'", script.display());
    let refused = run(folder.path(), &world, "two");
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    let why = "`double_triangle` cannot be executed in the world `sim`: the task's actions are for 1 gripper, and the world has \
               2 grippers";
    assert!(refused.stderr.contains(why), "{}", refused.stderr);
    let lines = std::fs::read_to_string(folder.path().join("two/rollout.jsonl"));
    assert_eq!(lines.unwrap_or_default(), "");
}

#[test]
#[ignore = "long"]
fn world_check_says_each_promise_and_exits_by_them() {
    let folder = tempfile::tempdir().unwrap();
    let good = format!("exec:'{FABC}' world serve");
    let done = finish(fabc(folder.path()).args(["world", "check", &good, "--json"]));
    assert_eq!(done.code, 0, "{}", done.stderr);
    let value: serde_json::Value = serde_json::from_str(&done.stdout).unwrap();
    assert_eq!(value["broken"], 0);
    assert_eq!(value["promises"].as_array().unwrap().len(), PROMISES.len());

    let bad = "exec:sh -c 'while read line; do echo \"{}\"; done'";
    let done = finish(fabc(folder.path()).args(["world", "check", bad]));
    assert_eq!(done.code, 2, "{}", done.stderr);
    assert!(
        done.stderr
            .contains("answers `hello` wrongly: missing field `name`"),
        "{}",
        done.stderr
    );
}
