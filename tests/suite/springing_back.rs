//! Steps after which the cloth springs back, and steps that no answer can make: what a run says, and what `subgoals` and
//! `check` warn of.

use super::support::{Captured, fabc, finish, root};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A corner of the default cloth carried `share` of its diagonal of 477 mm, and what is needed to run that.
fn task(share: &str) -> String {
    format!(
        "use \"half.fab\"

task pocket extends half {{
    cloth grid(55, 55)
    keypoints {{
        aim = center()
    }}
    actions {{
        pick:  any of cloth
        place: any of cloth
    }}
    subgoals {{
        demonstrate {{
            fold corner(back_left) -> corner(front_right) at {share}
        }}
    }}
}}
"
    )
}

fn said(folder: &Path, words: &[&str]) -> Captured {
    finish(fabc(folder).args(words))
}

fn folder_with(share: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("half.fab"), fab_compiler::explain::HALF).unwrap();
    fs::write(folder.path().join("pocket.fab"), task(share)).unwrap();
    folder
}

fn json(said: &Captured) -> Value {
    serde_json::from_str(&said.stdout).unwrap_or_else(|_| panic!("{said:?}"))
}

/// The messages and helps of warnings about steps that fold nothing.
fn warned(document: &Value) -> Vec<[String; 2]> {
    warned_of("F0510", document)
}

fn warned_of(code: &str, document: &Value) -> Vec<[String; 2]> {
    let all = document["diagnostics"].as_array().unwrap().iter();
    let warned = all.filter(|it| it["code"] == code);
    warned
        .map(|it| [it["message"].to_string(), it["help"].to_string()])
        .collect()
}

#[test]
fn a_step_that_springs_back_is_warned_of_with_the_smallest_fold_that_stays() {
    let folder = folder_with("0.1");
    let check = || json(&said(folder.path(), &["check", "pocket.fab", "--json"]));
    assert_eq!(warned(&check()), Vec::<[String; 2]>::new());
    // Text and JSON say the same of a demonstration that nobody has judged.
    let unjudged = || {
        let text = said(folder.path(), &["check", "pocket.fab"]).stdout;
        let checked = check();
        let note = checked["tasks"][0]["demonstration"].as_str()?;
        assert!(text.contains(&format!("\n  {note}")), "{text}");
        Some(note.to_owned())
    };
    let begins = |start: &str| unjudged().unwrap().starts_with(start);
    assert!(begins("its demonstration was never tried: `fabc subgoals`"));
    let drawn = json(&said(folder.path(), &["subgoals", "pocket.fab", "--json"]));
    let found = warned(&drawn);
    let [[message, help]] = found.as_slice() else {
        panic!("{drawn}");
    };
    assert!(
        message.contains("carried 48 mm and springs back to 0 mm"),
        "{message}"
    );
    // From 80 mm on it stays, and at 70 mm it does not.
    let (_, from) = help.split_once("that this cloth keeps is ").unwrap();
    let (mm, cure) = from.split_once(" mm; write `at ").unwrap();
    let mm: u32 = mm.parse().unwrap();
    assert!((71..=82).contains(&mm), "{help}");
    assert_eq!(warned(&check()), found);
    assert_eq!(unjudged(), None);
    // What it advises stays, and so has no warning.
    let (share, _) = cure.split_once('`').unwrap();
    fs::write(folder.path().join("pocket.fab"), task(share)).unwrap();
    assert!(warned(&check()).is_empty(), "an old result is used");
    assert!(begins(
        "its pictures are of another cloth, picker or demonstration"
    ));
    let drawn = json(&said(folder.path(), &["subgoals", "pocket.fab", "--json"]));
    assert!(warned(&drawn).is_empty(), "{drawn}");
    assert_eq!(unjudged(), None);
}

/// A cloth folded in thirds, of which half the points are no corners; `place` is what may be answered.
fn thirds(place: &str) -> String {
    format!(
        "use \"half.fab\"

task thirds extends half {{
    actions {{
        pick:  one of corners
        place: {place}
    }}
    subgoals {{
        demonstrate {{
            fold corner(back_left)  -> point(0.67, 0)
            fold corner(front_left) -> point(0.67, 1)
        }}
    }}
}}
"
    )
}

#[test]
fn a_step_that_no_answer_can_make_is_warned_of_with_the_line_that_offers_it() {
    let folder = folder_with("0.3");
    let write = |place: &str| fs::write(folder.path().join("thirds.fab"), thirds(place)).unwrap();
    let check = || json(&said(folder.path(), &["check", "thirds.fab", "--json"]));
    let subgoals = || json(&said(folder.path(), &["subgoals", "thirds.fab", "--json"]));
    write("one of corners, center");
    let found = warned_of("F0513", &subgoals());
    assert_eq!(found.len(), 2, "{found:?}");
    let line = "any of cloth";
    for [message, help] in &found {
        assert!(
            message.contains("the nearest place offered is "),
            "{message}"
        );
        assert!(
            help.contains(&format!(
                "write `pick: one of corners` and `place: {line}` in `actions`"
            )),
            "{help}"
        );
    }
    assert_eq!(warned_of("F0513", &check()), found);
    let denied = said(folder.path(), &["check", "thirds.fab", "--deny-warnings"]);
    assert_eq!(denied.code, 1, "{denied:?}");
    // What was found of other actions is not used, and `check` says so.
    write(line);
    let unjudged = check();
    assert!(warned_of("F0513", &unjudged).is_empty(), "{unjudged}");
    let note = unjudged["tasks"][0]["demonstration"].as_str().unwrap();
    assert!(
        note.starts_with("its camera, keypoints or actions have changed"),
        "{note}"
    );
    assert!(warned_of("F0513", &subgoals()).is_empty());
    assert!(check()["tasks"][0]["demonstration"].is_null());
}

/// Returns the record of a run's first step.
fn first_step(folder: &Path) -> Value {
    let record = fs::read_to_string(folder.join("run/rollout.jsonl")).unwrap();
    serde_json::from_str(record.lines().nth(1).unwrap()).unwrap()
}

#[test]
fn a_run_says_how_far_the_cloth_moved_and_how_much_of_that_stayed() {
    for (share, sentence, stays) in [
        ("0.1", "mm, sprang back to 0", false),
        ("0.3", "mm, rests 1", true),
    ] {
        let folder = folder_with(share);
        let words = ["run", "pocket.fab", "--policy", "expert", "--out", "run"];
        let ended = said(folder.path(), &words);
        assert!(ended.stderr.contains(sentence), "{}", ended.stderr);
        let cloth = &first_step(folder.path())["cloth"];
        let carried_mm = cloth["held"]["carried_mm"].as_f64().unwrap();
        let stayed_mm = cloth["held"]["stayed_mm"].as_f64().unwrap();
        let planned_mm = share.parse::<f64>().unwrap() * 477.0;
        assert!((carried_mm - planned_mm).abs() < 15.0, "{cloth}");
        assert_eq!(stayed_mm > planned_mm / 2.0, stays, "{cloth}");
        assert!(
            cloth["farthest_mm"].as_f64().unwrap() >= stayed_mm,
            "{cloth}"
        );
    }
}

/// A cloth of a material is dragged a little by each fold, so it rests elsewhere even where it opened.
#[test]
fn a_run_says_where_a_fold_of_cotton_that_opened_rests() {
    let folder = folder_with("0.2");
    let task = task("0.2").replace("grid(55, 55)", "square(170mm, material: cotton)");
    let task = format!("use \"materials.fab\"\n{task}");
    let materials = root().join("tasks/lib/materials.fab");
    fs::copy(materials, folder.path().join("materials.fab")).unwrap();
    let task = task.replace(
        "    keypoints {\n",
        "    keypoints {\n        cloth = mask(depth < 649.6mm)\n",
    );
    fs::write(folder.path().join("pocket.fab"), task).unwrap();
    let words = ["run", "pocket.fab", "--policy", "expert", "--out", "run"];
    let ended = said(folder.path(), &words);
    let cloth = &first_step(folder.path())["cloth"];
    assert_eq!(cloth["held"]["sprang_back"], true, "{cloth}");
    let [carried_mm, stayed_mm] =
        ["carried_mm", "stayed_mm"].map(|it| cloth["held"][it].as_f64().unwrap());
    let slid_mm = cloth["slid_mm"].as_f64().unwrap();
    assert!((5.0..30.0).contains(&slid_mm), "{cloth}");
    assert!((stayed_mm - slid_mm).abs() < 3.0, "{cloth}");
    let sentence = format!(
        "cloth moved {carried_mm:.0} mm, opened again, rests {stayed_mm:.0} mm away, slid {slid_mm:.0} mm"
    );
    assert!(ended.stderr.contains(&sentence), "{}", ended.stderr);
}

/// Their pictures are not pinned, so they are drawn here.
#[test]
#[ignore = "long"]
fn no_step_of_a_shipped_fold_of_a_textile_springs_back() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = root().join("tasks");
    for part in ["", "lib", "textiles"] {
        fs::create_dir_all(folder.path().join(part)).unwrap();
        for entry in fs::read_dir(shipped.join(part)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|it| it == "fab") {
                let name = path.file_name().unwrap();
                fs::copy(&path, folder.path().join(part).join(name)).unwrap();
            }
        }
    }
    let mut n_steps = 0;
    for entry in fs::read_dir(folder.path().join("textiles")).unwrap() {
        let path = entry.unwrap().path();
        let drawn = said(
            folder.path(),
            &["subgoals", path.to_str().unwrap(), "--json"],
        );
        assert!(warned(&json(&drawn)).is_empty(), "{drawn:?}");
        let pins = fs::read_to_string(path.with_extension("subgoals").join("pins.json"));
        let pins: Value = serde_json::from_str(&pins.unwrap()).unwrap();
        for step in pins["tried"]["steps"].as_array().unwrap() {
            assert_eq!(step["effect"], "changed", "{pins}");
            n_steps += 1;
        }
    }
    assert!(n_steps > 25, "{n_steps}");
}

#[test]
fn no_step_of_a_shipped_task_springs_back() {
    let mut n_steps = 0;
    let folders = ["tasks", "tasks/real"].map(|it| fs::read_dir(root().join(it)).unwrap());
    for entry in folders.into_iter().flatten() {
        let pins = entry.unwrap().path().join("pins.json");
        let Ok(text) = fs::read_to_string(&pins) else {
            continue;
        };
        let pins: Value = serde_json::from_str(&text).unwrap();
        for step in pins["tried"]["steps"].as_array().unwrap() {
            assert_eq!(step["effect"], "changed", "{pins}");
            n_steps += 1;
        }
    }
    assert!(n_steps > 38, "{n_steps}");
}
