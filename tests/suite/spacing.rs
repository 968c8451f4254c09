//! A task that states how far apart its cloth's particles are.

use super::support::{bring_library, fabc, finish};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Writes `silk.fab`: a napkin of silk whose back edge is folded to the middle.
fn bring_task(folder: &Path, cloth: &str) {
    bring_library(folder);
    let text = format!(
        r#"
use "lib/napkins.fab"
use "lib/materials.fab"

task silk_hem extends napkin {{
    cloth {cloth}
    goal  particle_distance < 10mm

    subgoals {{ demonstrate {{ fold middle(back) -> center }} }}
}}
"#
    );
    fs::write(folder.join("silk.fab"), text).unwrap();
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn silk_folds_at_4_mm_and_its_bends_are_met_there() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let checked = |cloth: &str| {
        bring_task(here, cloth);
        finish(fabc(here).args(["check", "silk.fab"])).stdout
    };
    let coarse = checked("square(120mm, material: silk)");
    let fine = checked("square(120mm, spacing: 4mm, material: silk)");
    for checked in [&coarse, &fine] {
        assert!(
            !checked.contains("a bending length of `11` mm"),
            "{checked}"
        );
    }
    assert!(coarse.contains("loops and folds"), "{coarse}");
    assert!(!fine.contains("loops and folds"), "{fine}");
    assert!(!fine.contains("on the bias the cloth gives"), "{fine}");
    let run = [
        "run", "silk.fab", "--policy", "expert", "--out", "run", "--json",
    ];
    let said = finish(fabc(here).args(run));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let report = json(&said.stdout);
    assert_eq!(report["outcome"], "goal_reached", "{report}");
    let moved_mm = report["mean_particle_distance_mm"].as_f64().unwrap();
    assert!(moved_mm < 2.0, "{moved_mm}");
    let program = json(&fs::read_to_string(here.join("run/program.json")).unwrap());
    let cloth = &program["cloth"];
    assert_eq!([&cloth["dimx"], &cloth["dimy"]], [31, 31]);
    assert_eq!(cloth["spacing_m"], 0.004);

    // The start that the run left is one of 31 by 31 particles that are 4 mm apart.
    fs::copy(here.join("run/start.npy"), here.join("start.npy")).unwrap();
    let again = [
        "run",
        "silk.fab",
        "--policy",
        "expert",
        "--start",
        "start.npy",
    ];
    let described = |spacing_m: f64| {
        let description =
            serde_json::json!({ "dimx": 31, "dimy": 31, "spacing_m": spacing_m, "up": "z" });
        fs::write(here.join("start.json"), description.to_string()).unwrap();
        finish(fabc(here).args(again))
    };
    let said = described(0.004);
    assert_eq!(said.code, 0, "{}", said.stderr);
    let said = described(0.0044);
    assert_eq!(said.code, 2, "{}", said.stdout);
    let words = "the particles of the start `start.npy` are 4.4 mm apart, and those of the task's cloth 4 mm; the task would state `spacing: 4.4mm`";
    assert!(said.stderr.contains(words), "{}", said.stderr);
}

#[test]
fn a_crumpled_cloth_has_the_stated_spacing() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    bring_task(
        here,
        "square(60mm, spacing: 5mm, start: crumpled, material: silk)",
    );
    let run = [
        "run", "silk.fab", "--policy", "expert", "--out", "run", "--json",
    ];
    let said = finish(fabc(here).args(run));
    assert!([0, 3].contains(&said.code), "{}", said.stderr);
    let record = fs::read_to_string(here.join("run/rollout.jsonl")).unwrap();
    let grid = r#""grid":{"dimx":13,"dimy":13,"spacing_m":0.005}"#;
    assert!(record.contains(grid), "{record}");
}
