//! `fabc bench` on suites so small that they take moments: figures, files, resuming and stopping.

use super::support::{bring_library, fabc, finish};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// One fold of a small cloth.
const TASK: &str = r#"
use "lib/folding.fab"
task tiny extends folding {
    cloth grid(28, 28)
    goal  particle_distance < 8mm
    subgoals { demonstrate { fold corner(back_right) -> corner(front_left) } }
    experts half
}
experts half {
    sequence { fold corner(back_right) -> corner(front_left) }
    sequence { fold corner(front_left) -> corner(back_right) }
    sequence { fold corner(back_left) -> corner(front_right) }
    sequence { fold corner(front_right) -> corner(back_left) }
}
"#;

const SUITE: &str = r#"
about = "One small fold."
statistic = "mean"
metrics = ["mean_particle_distance_mm", "mean_particle_distance_mm_gamma_0.9", "goal_reached"]
repeats = 2
tasks = ["../tiny.fab"]
[starts]
lie = "flat"
sides = [28, 30]
turns_deg = [0]
[[method]]
name = "plain"
stand_in_note = "plumbing only"
[[method]]
name = "random"
model = "random:3"
[[method]]
name = "in_context"
variant = "in_context"
optional = true
[[gap]]
name = "plain over random"
of = "plain"
over = "random"
[[quoted]]
task = "tiny"
method = "somebody"
metric = "mean_particle_distance_mm"
statistic = "mean"
value = 12.5
source = "a paper"
"#;

/// A project folder with the task and its suite.
pub(super) fn project(suite: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let tasks = folder.path().join("tasks");
    fs::create_dir_all(tasks.join("suites")).unwrap();
    bring_library(&tasks);
    fs::write(tasks.join("tiny.fab"), TASK).unwrap();
    fs::write(tasks.join("suites/tiny.toml"), suite).unwrap();
    folder
}

/// Runs the suite and returns its JSON document.
fn bench(folder: &Path, arguments: &[&str]) -> Value {
    let said = finish(
        fabc(folder)
            .args(["bench", "tiny", "--json"])
            .args(arguments),
    );
    assert_eq!(said.code, 0, "{}", said.stderr);
    serde_json::from_str(&said.stdout).unwrap()
}

/// The rows without values that depend on a clock.
fn timeless(document: &Value) -> Vec<Value> {
    let mut rows = document["rows"].as_array().unwrap().clone();
    for row in &mut rows {
        row.as_object_mut().unwrap().remove("s_per_action");
        row.as_object_mut().unwrap().remove("planning_s");
    }
    rows
}

fn row<'d>(document: &'d Value, method: &str, metric: &str) -> &'d Value {
    let rows = document["rows"].as_array().unwrap();
    let found = rows
        .iter()
        .find(|row| row["method"] == method && row["metric"] == metric);
    found.unwrap_or_else(|| panic!("no row {method}, {metric} in {document:#}"))
}

#[test]
#[ignore = "long"]
fn a_suite_gives_the_same_figures_on_any_number_of_threads_and_is_not_run_twice() {
    let folder = project(SUITE);
    let first = bench(folder.path(), &["--out", "one", "--jobs", "1"]);
    let second = bench(folder.path(), &["--out", "two", "--jobs", "2"]);
    assert_eq!(timeless(&first), timeless(&second));
    assert_eq!(first["rollouts"]["planned"], 6);
    assert_eq!(first["rollouts"]["found"], 0);

    // A rollout that was cut off is run again, a finished one is not.
    let cut_off = folder
        .path()
        .join("one/tiny/random/start-001-2/rollout.jsonl");
    let journal = fs::read_to_string(&cut_off).unwrap();
    let header = journal.lines().next().unwrap();
    fs::write(&cut_off, format!("{header}\n")).unwrap();
    let again = bench(folder.path(), &["--out", "one", "--jobs", "2"]);
    assert_eq!(timeless(&again), timeless(&first));
    assert_eq!(again["rollouts"]["found"], 5);
    assert_eq!(again["spent"]["experts_simulated"], 0);

    let ours = row(&first, "plain", "mean_particle_distance_mm");
    assert_eq!((&ours["n"], &ours["repeats"]), (&2.into(), &1.into()));
    assert!(ours["value"].as_f64().unwrap() < 15.0, "{ours}");
    assert_eq!(ours["note"], "plumbing only");
    let random = row(&first, "random", "mean_particle_distance_mm");
    assert_eq!(random["repeats"], 2);
    let counted = random["outcomes"].as_object().unwrap().values();
    assert_eq!(counted.filter_map(Value::as_u64).sum::<u64>(), 4);
    let gap = row(&first, "plain over random", "mean_particle_distance_mm");
    let difference = ours["value"].as_f64().unwrap() - random["value"].as_f64().unwrap();
    assert!((gap["value"].as_f64().unwrap() - difference).abs() < 1e-9);
    let more = ours["queries"].as_f64().unwrap() - random["queries"].as_f64().unwrap();
    assert_eq!(gap["queries"], more);
    let theirs = row(&first, "somebody", "mean_particle_distance_mm");
    assert_eq!(
        (
            &theirs["quoted"],
            &theirs["value"],
            &theirs["source"],
            &theirs["n"]
        ),
        (&true.into(), &12.5.into(), &"a paper".into(), &Value::Null)
    );
    for name in ["table.csv", "table.json", "table.md"] {
        let text = fs::read_to_string(folder.path().join("one").join(name)).unwrap();
        assert!(
            text.contains("somebody") && text.contains("random"),
            "{name}: {text}"
        );
    }
}

/// Pulls at a small crumpled cloth; the goal is so near that random pulls sometimes reach it.
const PULLS: &str = r#"
task tiny {
    cloth   grid(20, 20, start: crumpled)
    camera  top_down(height: 500mm, fov: 45deg, image: 240px, up: x)
    goal    normalized_improvement > 0.1
    horizon 4
    keypoints {
        cloth   = mask(depth < 499mm)
        corners = shi_tomasi(cloth, max: 15, quality: 0.1, spacing: 8px)
    }
    actions {
        pick:      one of corners
        direction: one of 0deg, 90deg, 180deg, 270deg
        distance:  one of 0.25edge, 0.5edge
    }
    stage act {
        model vision
        show  scene
        say   "Pull a corner, one of {{ corners }}. {{ actions.format }}"
        read  action
    }
    verify { attempts 3 }
}
"#;

const PULLS_SUITE: &str = r#"
about = "Pulls."
statistic = "median"
metrics = ["normalized_improvement_source", "normalized_improvement_true", "goal_reached", "normalized_improvement_source_without_stop"]
horizons = [1, 2, 4]
repeats = 2
tasks = ["../tiny.fab"]
[starts]
lie = "crumpled"
sides = [20, 21]
count = 3
first_seed = 7
[[method]]
name = "random"
model = "random:3"
"#;

#[test]
#[ignore = "long"]
fn figures_with_the_stop_are_those_of_rollouts_that_stopped() {
    let folder = project(PULLS_SUITE);
    fs::write(folder.path().join("tasks/tiny.fab"), PULLS).unwrap();
    let on = bench(folder.path(), &["--out", "on"]);
    let suite = PULLS_SUITE.replace(", \"normalized_improvement_source_without_stop\"", "");
    assert_ne!(suite, PULLS_SUITE);
    fs::write(folder.path().join("tasks/suites/tiny.toml"), suite).unwrap();
    let stopped = bench(folder.path(), &["--out", "stopped"]);
    let with_stop: Vec<Value> = timeless(&on)
        .into_iter()
        .filter(|row| row["metric"] != "normalized_improvement_source_without_stop")
        .collect();
    assert_eq!(with_stop, timeless(&stopped));
    assert_eq!(with_stop.len(), 9);
    // Some rollouts stop and some do not, otherwise the test would prove nothing.
    let last = &with_stop[6]["outcomes"];
    assert!(last["goal_reached"].as_u64() > Some(0), "{last}");
    let steps = |out: &str| {
        let journal = folder.path().join(out).join("tiny/random");
        let lines = fs::read_dir(journal).unwrap().map(|run| {
            let text = fs::read_to_string(run.unwrap().path().join("rollout.jsonl")).unwrap();
            text.lines().count()
        });
        lines.sum::<usize>()
    };
    assert!(steps("stopped") < steps("on"));
}

#[test]
fn the_table_says_what_its_figures_are() {
    let folder = project(SUITE);
    let said = finish(fabc(folder.path()).args(["bench", "tiny", "--limit", "1"]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    for wanted in [
        "geometric (stand-in)",
        "quoted: somebody",
        "a comparison and not a ranking",
        "the last state of the cloth is measured",
        "nothing about any vision-language model",
    ] {
        assert!(said.stdout.contains(wanted), "{wanted}: {}", said.stdout);
    }
    for wanted in ["3 rollouts in `runs/bench-tiny-0001`", "per action"] {
        assert!(said.stderr.contains(wanted), "{wanted}: {}", said.stderr);
    }
}

#[test]
#[ignore = "long"]
fn shards_of_one_folder_add_up_to_the_whole() {
    let folder = project(SUITE);
    let arguments = |shard| ["--out", "out", "--shard", shard];
    let first = bench(folder.path(), &arguments("1/2"));
    let second = bench(folder.path(), &arguments("2/2"));
    assert_eq!(first["rollouts"]["planned"], 3);
    assert_eq!(second["rollouts"]["found"], 0);
    let whole = bench(folder.path(), &["--out", "out"]);
    assert_eq!(whole["rollouts"]["found"], 6);
    let at_once = bench(folder.path(), &["--out", "elsewhere"]);
    assert_eq!(timeless(&whole), timeless(&at_once));
}

/// One start by turns, in four kinds of worlds.
const VARIED_SUITE: &str = r#"
about = "One small fold in varied worlds."
statistic = "mean"
metrics = ["mean_particle_distance_mm", "goal_reached"]
tasks = ["../tiny.fab"]
[starts]
lie = "flat"
sides = [28]
turns_deg = [0, 20]
[vary]
seed = 4
size = [1.4, 1.5]
hue_deg = [60, 120]
[[method]]
name = "plain"
"#;

#[test]
#[ignore = "long"]
fn a_suite_is_run_in_varied_worlds_which_equal_seeds_make_equal() {
    let folder = project(VARIED_SUITE);
    let suite = folder.path().join("tasks/suites/tiny.toml");
    let part = bench(folder.path(), &["--out", "varied", "--shard", "2/2"]);
    assert_eq!(part["rollouts"]["planned"], 4);
    let whole = bench(folder.path(), &["--out", "varied"]);
    assert_eq!(
        whole["rollouts"],
        json!({"planned": 8, "finished": 8, "found": 4})
    );
    assert_eq!(
        whole["vary"],
        json!({"seed": 4, "size": [1.4, 1.5], "hue_deg": [60.0, 120.0]})
    );

    let read = |out: &str, run: &str| {
        let path = folder.path().join(out).join("tiny/plain").join(run);
        let record = fs::read_to_string(path.join("rollout.jsonl")).unwrap();
        let header: Value = serde_json::from_str(record.lines().next().unwrap()).unwrap();
        let seen = fs::read(path.join("step_1/before.png")).unwrap();
        (record, header, seen)
    };
    for start in ["start-000-1", "start-001-1"] {
        let (_, own, seen) = read("varied", start);
        let [size, hue, all] =
            ["size", "hue_deg", "all"].map(|varied| read("varied", &format!("{varied}/{start}")));
        assert_eq!(own["vary"], Value::Null);
        let drawn = |header: &Value, axis: &str| header["vary"][axis].as_f64().unwrap();
        assert!((1.4..=1.5).contains(&drawn(&size.1, "size")));
        assert!((60.0..=120.0).contains(&drawn(&hue.1, "hue_deg")));
        // Each axis draws by itself what it draws among others.
        let both = json!({"size": size.1["vary"]["size"], "hue_deg": hue.1["vary"]["hue_deg"]});
        assert_eq!(all.1["vary"], both);
        let spacing_m = |header: &Value| header["start"]["grid"]["spacing_m"].as_f64().unwrap();
        assert_eq!(spacing_m(&size.1), 0.00625 * drawn(&size.1, "size"));
        assert_eq!(all.1["start"], size.1["start"]);
        // Colours alone differ, so that the cloth lies as before.
        assert_eq!(hue.1["start"], own["start"]);
        assert!(hue.2 != seen && all.2 != size.2 && size.2 != seen);
    }
    assert_ne!(
        read("varied", "size/start-000-1").1["vary"],
        read("varied", "size/start-001-1").1["vary"]
    );

    let figure = |varied: Value, statistic: &str| {
        let rows = whole["rows"].as_array().unwrap();
        let row = rows.iter().find(|row| {
            row["metric"] == "mean_particle_distance_mm"
                && row["vary"] == varied
                && row["statistic"] == statistic
        });
        row.unwrap()["value"].as_f64().unwrap()
    };
    let own = figure(Value::Null, "mean");
    let size = figure("size".into(), "mean");
    // Ends of the unvaried cloth would lie tens of millimetres away from those of one that is larger by a half.
    assert!(size < 15.0, "{size} against {own}");
    assert_eq!(figure("size".into(), "change of means"), size - own);
    // The stand-in finds the cloth by its depth.
    assert_eq!(figure("hue_deg".into(), "change of means"), 0.0);
    let table = fs::read_to_string(folder.path().join("varied/table.md")).unwrap();
    for wanted in [
        "| method | policy | varied | actions | starts | distance, mm | change |",
        "| plain | geometric (stand-in) | nothing | 1 | 2 |",
        "| plain | geometric (stand-in) | all | 1 | 2 |",
        "Varied worlds: size from 1.4 to 1.5, hue_deg from 60 to 120; drawn evenly for each start by seed 4",
        "Change: the difference to the task's own world",
    ] {
        assert!(table.contains(wanted), "{wanted}: {table}");
    }

    // A rollout in the task's own world has the same bytes in a suite without the table.
    let (before, after) = VARIED_SUITE.split_once("[vary]").unwrap();
    let after = &after[after.find("[[").unwrap()..];
    fs::write(&suite, [before, after].concat()).unwrap();
    let plain = bench(folder.path(), &["--out", "plain"]);
    assert_eq!(
        (&plain["vary"], &plain["rollouts"]["planned"]),
        (&Value::Null, &2.into())
    );
    assert_eq!(
        read("plain", "start-001-1").0,
        read("varied", "start-001-1").0
    );

    fs::write(&suite, VARIED_SUITE.replace("seed = 4", "seed = 5")).unwrap();
    let said = finish(fabc(folder.path()).args(["bench", "tiny", "--out", "varied"]));
    assert_eq!(said.code, 2, "{}", said.stdout);
    assert!(
        said.stderr
            .contains("it differs in `vary.size` (recorded 1.4"),
        "{}",
        said.stderr
    );
}

#[test]
fn an_estimate_counts_rollouts_in_varied_worlds_even_if_they_show_no_cloth() {
    let most_calls = |vary: &str| {
        let varied = "size = [1.4, 1.5]\nhue_deg = [60, 120]";
        assert!(VARIED_SUITE.contains(varied));
        let folder = project(&VARIED_SUITE.replace(varied, vary));
        let arguments =
            "bench tiny --estimate --json --model openai:gpt-6.2-sol --omit temperature";
        let said = finish(fabc(folder.path()).args(arguments.split(' ')));
        assert_eq!(said.code, 0, "{}", said.stderr);
        let document: Value = serde_json::from_str(&said.stdout).unwrap();
        document["at_most"]["calls"].as_u64().unwrap()
    };
    // Each kind of worlds has two starts; the task's mask finds nothing under a camera at 700 mm.
    let two = most_calls("hue_deg = [0, 0]");
    assert_eq!(
        most_calls("hue_deg = [0, 0]\ncamera_height_mm = [700, 700]"),
        two * 2
    );
    assert_eq!(
        most_calls("hue_deg = [0, 0]\ncamera_height_mm = [700, 700]\nsize = [1, 1]"),
        two / 2 * 5
    );
}

#[test]
fn a_folder_of_other_rollouts_is_left_alone() {
    let folder = project(SUITE);
    bench(folder.path(), &["--out", "out", "--limit", "1"]);
    let changed = TASK.replace(
        "goal  particle_distance < 8mm",
        "goal  particle_distance < 9mm",
    );
    fs::write(folder.path().join("tasks/tiny.fab"), changed).unwrap();
    let said = finish(fabc(folder.path()).args(["bench", "tiny", "--out", "out", "--limit", "1"]));
    assert_eq!(said.code, 2, "{}", said.stdout);
    assert!(
        said.stderr.contains(
            "holds another rollout: it is not what the suite asks for: it differs in `program`"
        ),
        "{}",
        said.stderr
    );
}

/// It is not taken for a cap that was reached.
#[cfg(unix)]
#[test]
fn a_record_that_vanishes_while_it_is_written_is_named() {
    let folder = project(SUITE);
    let takes_it = "exec:sh -c 'read step; rm -r out/tiny/plain'";
    let arguments = [
        "bench", "tiny", "--out", "out", "--limit", "1", "--jobs", "1", "--policy", takes_it,
    ];
    let said = finish(fabc(folder.path()).args(arguments));
    assert_eq!(said.code, 2, "{}", said.stdout);
    for part in [
        "` has lost the record of the rollout",
        "the same `--out` continues",
    ] {
        assert!(said.stderr.contains(part), "{}", said.stderr);
    }
}

#[cfg(unix)]
#[test]
#[ignore = "long"]
fn an_interrupt_ends_with_what_has_finished_and_130() {
    use std::process::{Command, Stdio};
    let folder = project(&SUITE.replace(
        "turns_deg = [0]",
        "turns_deg = [0, 10, 20, 30, 40, 50, 60, 70]",
    ));
    let mut child = fabc(folder.path())
        .args(["bench", "tiny", "--json", "--out", "out", "--jobs", "1"])
        .process()
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let done = folder
        .path()
        .join("out/tiny/plain/start-001-1/rollout.jsonl");
    while !done.is_file() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["interrupted"], true);
    let finished = document["rollouts"]["finished"].as_u64().unwrap();
    assert!((1..48).contains(&finished), "{finished}");
    assert!(
        stderr.contains("run again with the same `--out`"),
        "{stderr}"
    );
    let again = bench(folder.path(), &["--out", "out"]);
    assert_eq!(again["rollouts"]["found"], finished);
    assert_eq!(again["rollouts"]["finished"], 48);
}
