//! Tasks that are named without a path: where they are searched, and what is not written beside them.

use super::support::{Captured, Fabc, fabc, finish, root, task};
use fab_agent::record::RECORD_FILE;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const NAMES: [&str; 14] = [
    "all_corners_inward",
    "corners_edges_inward",
    "cupboard",
    "double_straight",
    "double_triangle",
    "hem",
    "house",
    "open_envelope",
    "paper_plane",
    "pocket_envelope",
    "sash",
    "shop_fold",
    "smoothing",
    "thirds",
];

/// Folds of small flaps of a material.
const NAPKINS: [&str; 3] = ["hem", "pocket_envelope", "paper_plane"];

/// A user with an empty working folder and an empty cache.
struct User(TempDir);

impl User {
    fn new() -> User {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("work")).unwrap();
        User(folder)
    }

    fn path(&self, path: &str) -> PathBuf {
        self.0.path().join(path)
    }

    fn command(&self, words: &str) -> Fabc {
        let mut command = fabc(&self.path("work"));
        command.args(words.split(' '));
        command.env("FABC_CACHE_DIR", self.path("cache"));
        command
    }

    fn run(&self, words: &str) -> Captured {
        finish(&mut self.command(words))
    }

    /// Returns the folder in the cache that holds the embedded tasks.
    fn unpacked(&self) -> PathBuf {
        let mut folders = fs::read_dir(self.path("cache/tasks")).unwrap();
        let folder = folders.next().unwrap().unwrap().path();
        assert!(folders.next().is_none(), "one version, one folder");
        folder
    }

    /// Writes a task with this name and its own goal, and the libraries, into a folder.
    fn bring_task(&self, folder: &str, goal: &str) {
        let folder = self.path(folder);
        fs::create_dir_all(folder.join("lib")).unwrap();
        for library in ["folding.fab", "experts.fab"] {
            let from = root().join("tasks/lib").join(library);
            fs::copy(from, folder.join("lib").join(library)).unwrap();
        }
        for files in ["double_straight.subgoals", "demos"] {
            fs::create_dir_all(folder.join(files)).unwrap();
            for file in fs::read_dir(root().join("tasks").join(files)).unwrap() {
                let file = file.unwrap();
                fs::copy(file.path(), folder.join(files).join(file.file_name())).unwrap();
            }
        }
        let task = fs::read_to_string(root().join("tasks/double_straight.fab")).unwrap();
        let own = task.replace("< 40mm", goal);
        fs::write(folder.join("double_straight.fab"), own).unwrap();
    }
}

fn assert_found(said: &Captured, whose: &str, path: &Path) {
    let expected = format!("task: double_straight, {whose} ({})\n", path.display());
    assert_eq!((said.code, &said.stderr), (0, &expected));
}

#[test]
fn every_shipped_task_can_be_named_in_an_empty_folder() {
    let user = User::new();
    let said = user.run(&format!("check {}", NAMES.join(" ")));
    assert_eq!(said.code, 0, "{}", said.stderr);
    for name in NAMES {
        let path = user.unpacked().join(format!("{name}.fab"));
        let told = format!("task: {name}, shipped with fabc ({})\n", path.display());
        assert!(said.stderr.contains(&told), "{}", said.stderr);
        let shipped = fs::read(root().join(format!("tasks/{name}.fab"))).unwrap();
        assert_eq!(fs::read(path).unwrap(), shipped);
    }
    let found = user.run("test double_straight");
    assert_eq!(found.code, 0, "{}", found.stderr);
}

#[test]
fn small_flaps_of_napkins_compile_without_a_warning() {
    for name in NAPKINS {
        let program = task(name);
        assert_eq!(program.cloth.material.unwrap().name, "cotton", "{name}");
        assert_eq!(program.manner.speed_m_s, Some(0.1), "{name}");
    }
}

/// Each fold is a goal that the expert reaches, and that a cloth that nobody touched does not.
#[test]
#[ignore = "long"]
fn folds_stay_where_an_expert_folds_them() {
    let user = User::new();
    for (name, goal_mm) in [
        ("hem", 10.0),
        ("paper_plane", 15.0),
        ("pocket_envelope", 10.0),
        ("shop_fold", 10.0),
        ("thirds", 10.0),
    ] {
        let file = root().join(format!("tasks/{name}.fab"));
        let call = format!("run {} --policy expert --out {name} --json", file.display());
        let said = user.run(&call);
        assert_eq!(said.code, 0, "{name}: {}", said.stderr);
        let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
        assert_eq!(report["goal_reached"], true, "{name}: {report}");
        let positions = |path: &str| {
            let bytes = fs::read(user.path(&format!("work/{name}/{path}"))).unwrap();
            let (_, numbers) = fab_base::npy::decode_floats(&bytes).unwrap();
            let points = numbers.chunks_exact(3);
            points
                .map(|it| [it[0] as f32, it[1] as f32, it[2] as f32])
                .collect::<Vec<_>>()
        };
        let (start, end) = (positions("start.npy"), positions("experts/1.npy"));
        let untouched_m = fab_world::metrics::mean_particle_distance_m(&start, &end).unwrap();
        assert!(
            untouched_m * 1000.0 > 1.5 * goal_mm,
            "{name}: {untouched_m}"
        );
    }
}

/// What a newcomer runs first. Smoothing is judged by its suite.
#[test]
#[ignore = "long"]
fn every_shipped_fold_reaches_its_goal_with_the_default_command_and_with_the_expert() {
    let user = User::new();
    for name in NAMES.into_iter().filter(|name| *name != "smoothing") {
        for policy in ["", " --policy expert"] {
            let said = user.run(&format!("run {name}{policy} --json"));
            assert_eq!(said.code, 0, "{name}{policy}: {}", said.stderr);
            let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
            assert_eq!(
                report["outcome"], "goal_reached",
                "{name}{policy}: {report}"
            );
        }
    }
}

#[test]
fn the_nearest_place_wins() {
    let user = User::new();
    let check = |variable: Option<&str>| {
        let mut command = user.command("check double_straight");
        if let Some(folder) = variable {
            command.env("FABC_TASKS", user.path(folder));
        }
        finish(command.program(user.path("installed/bin/fabc")))
    };
    fs::create_dir_all(user.path("installed/bin")).unwrap();
    let program = env!("CARGO_BIN_EXE_fabc");
    let linked = fs::hard_link(program, user.path("installed/bin/fabc"));
    linked
        .or_else(|_| fs::copy(program, user.path("installed/bin/fabc")).map(drop))
        .unwrap();
    let said = check(None);
    let embedded = user.unpacked().join("double_straight.fab");
    assert_found(&said, "shipped with fabc", &embedded);

    user.bring_task("installed/share/fabc/tasks", "< 41mm");
    let installed = user.path("installed").canonicalize().unwrap();
    let installed = installed.join("share/fabc/tasks/double_straight.fab");
    assert_found(&check(None), "shipped with fabc", &installed);

    user.bring_task("own", "< 42mm");
    let own = user.path("own/double_straight.fab");
    assert_found(&check(Some("own")), "of FABC_TASKS", &own);
    assert_found(&check(Some("nowhere")), "shipped with fabc", &installed);

    user.bring_task("work", "< 43mm");
    let here = Path::new("double_straight.fab");
    assert_found(&check(Some("own")), "a file of this folder", here);

    // A file of exactly this name needs no search, and a folder is not a task.
    let task = user.path("work/double_straight");
    fs::create_dir(&task).unwrap();
    assert_found(&check(None), "a file of this folder", here);
    fs::remove_dir(&task).unwrap();
    fs::copy(user.path("work/double_straight.fab"), &task).unwrap();
    let said = check(None);
    assert_eq!((said.code, said.stderr.as_str()), (0, ""));
}

#[test]
fn a_name_that_is_nowhere_gets_the_list_of_names() {
    let user = User::new();
    for verb in ["check", "render", "run", "snap --check"] {
        let said = user.run(&format!("{verb} double_strait"));
        assert_eq!(said.code, 2, "{}", said.stderr);
        let words = "there is no file `double_strait.fab`, and fabc ships no task `double_strait`; did you mean `double_straight`? It ships";
        assert!(said.stderr.contains(words), "{}", said.stderr);
        for name in NAMES {
            assert!(
                said.stderr.contains(&format!("`{name}`")),
                "{}",
                said.stderr
            );
        }
    }
    // A word with an extension or a folder is a path.
    for word in ["double_straight.fab", "./double_straight"] {
        let said = user.run(&format!("check {word}"));
        assert_eq!(said.code, 2);
        let words = format!("cannot read `{word}`");
        assert!(said.stderr.contains(&words), "{}", said.stderr);
    }
}

#[test]
fn a_suite_may_name_a_shipped_task() {
    let user = User::new();
    let suite = fs::read_to_string(root().join("tasks/suites/folding.toml")).unwrap();
    let named = suite.replace("\"../double_triangle.fab\"", "\"double_strait\"");
    assert_ne!(named, suite);
    fs::write(user.path("work/suite.toml"), named).unwrap();
    let said = user.run("bench suite.toml --estimate");
    assert_eq!(said.code, 2);
    assert!(
        said.stderr.contains("ships no task `double_strait`"),
        "{}",
        said.stderr
    );
}

#[test]
fn a_shipped_task_is_as_shipped_whatever_the_cache_holds() {
    let user = User::new();
    user.run("check house");
    let path = user.unpacked().join("house.fab");
    fs::write(&path, "task house { }").unwrap();
    assert_eq!(user.run("check house").code, 0);
    let shipped = fs::read(root().join("tasks/house.fab")).unwrap();
    assert_eq!(fs::read(path).unwrap(), shipped);
    // A file blocks the path of the cache.
    let mut command = user.command("check house");
    command.env("FABC_CACHE_DIR", user.unpacked().join("house.fab"));
    let said = finish(&mut command);
    assert_eq!(said.code, 2);
    assert!(said.stderr.contains("FABC_CACHE_DIR"), "{}", said.stderr);
}

#[test]
fn nothing_is_written_beside_a_shipped_task() {
    let user = User::new();
    for verb in [
        "subgoals double_straight",
        "snap double_straight",
        "demos double_straight --variant in_context",
    ] {
        let said = user.run(verb);
        assert_eq!(said.code, 2, "{verb}: {}", said.stderr);
        let advice = format!("cp -r {} my_tasks", user.unpacked().display());
        assert!(said.stderr.contains("is shipped with fabc"), "{verb}");
        assert!(said.stderr.contains(&advice), "{}", said.stderr);
    }
    let pins = user.unpacked().join("house.subgoals/pins.json");
    let before = fs::metadata(&pins).unwrap().modified().unwrap();
    let said = user.run("subgoals house --sheet house.png");
    assert_eq!((said.code, said.stdout.as_str()), (0, "house.png\n"));
    assert_eq!(fs::metadata(&pins).unwrap().modified().unwrap(), before);
    let copied = user.path("work/my_tasks");
    fs::create_dir(&copied).unwrap();
    fs::rename(user.unpacked(), copied.join("all")).unwrap();
    assert_eq!(user.run("subgoals my_tasks/all/house.fab").code, 0);
}

#[test]
fn a_run_of_a_shipped_task_is_resumed_without_the_cache() {
    let user = User::new();
    let begun = user.run("run house --out run");
    assert_eq!(begun.code, 0, "{}", begun.stderr);
    assert!(
        begun.stderr.starts_with("task: house, shipped with fabc"),
        "{}",
        begun.stderr
    );
    let record = user.path("work/run").join(RECORD_FILE);
    let whole = fs::read_to_string(&record).unwrap();
    let first_two: String = whole.split_inclusive('\n').take(2).collect();
    fs::write(&record, first_two).unwrap();
    fs::remove_dir_all(user.path("cache/tasks")).unwrap();
    let resumed = user.run("resume run");
    assert_eq!(resumed.code, 0, "{}", resumed.stderr);
    assert_eq!(fs::read_to_string(&record).unwrap(), whole);
}
