//! The `sim` verbs through the command itself, on small cloths; `sim_replay` tests `replay`.

use super::bad_starts::write_npy;
use super::sim_replay::flat;
use super::support::{Captured, fabc, finish, project};
use fab_world::corner_fold::CARRIED_MM;
use fab_world::metrics;
use fab_world::start::Start;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// A material `mine` with a green face, as light as the shipped silk.
pub(super) const MATERIAL: &str = "material mine {
    weight    35g/m2                               from \"scales\"
    thickness 0.1mm                                from \"a gauge\"
    bending   warp: 15mm, weft: 12mm, bias: 11mm   from \"a cantilever\"
    recovery  125deg                               from \"a protractor\"
    stretch   warp: 0.01, weft: 0.02, bias: 0.08   from \"a weight\"
    friction  table: 0.25, itself: 0.3             from \"a slope\"
    upper     green \"#20c040\"
}
";

/// Runs a verb of `sim` to its end.
fn said(folder: &Path, arguments: &[&str]) -> Captured {
    finish(fabc(folder).arg("sim").args(arguments))
}

/// Runs a verb of `sim` that succeeds, and returns its JSON.
pub(super) fn told(folder: &Path, arguments: &[&str]) -> Value {
    let said = said(folder, &[arguments, &["--json"]].concat());
    assert_eq!(said.code, 0, "{arguments:?}\n{}", said.stderr);
    let value: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(
        value["params"],
        fab_sim::Params::default().hash(),
        "{value}"
    );
    value
}

#[test]
fn time_counts_steps_springs_and_memory_and_gives_equal_bits() {
    let folder = tempfile::tempdir().unwrap();
    let value = told(folder.path(), &["time", "--size", "25"]);
    // 10 steps up, 43 along a diagonal of 0.212 m, 10 down, 50 to settle.
    for (field, expected) in [
        ("particles", json!(625)),
        ("steps", json!(113)),
        ("substeps", json!(fab_sim::Params::default().substeps)),
        ("constraints", json!(3502)),
        ("self_contact", json!(true)),
    ] {
        assert_eq!(value[field], expected, "`{field}` of {value}");
    }
    for field in ["cpu_ms_per_step", "wall_ms_per_step"] {
        assert!(value[field].as_f64().unwrap() > 0.0, "`{field}` of {value}");
    }
    let two = told(folder.path(), &["time", "--size", "25", "--threads", "2"]);
    assert_eq!(two["digest"], value["digest"]);
    assert_eq!(value["digest"].as_str().unwrap().len(), 64);
    assert_eq!(value["material"], Value::Null);
    let call = ["time", "--size", "25", "--material", "denim", "--json"];
    let denim: Value = serde_json::from_str(&said(folder.path(), &call).stdout).unwrap();
    assert_eq!(denim["material"], "denim");
    assert!(denim["substeps"].as_u64() > value["substeps"].as_u64());
    assert_ne!(denim["digest"], value["digest"]);
}

#[test]
fn crumpled_cloths_are_starts_and_the_same_again() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let call = [
        "crumple", "--dims", "12x10", "--seed", "5", "--count", "3", "-o", "starts",
    ];
    let value = told(here, &call);
    let starts = value["starts"].as_array().unwrap();
    let seeds: Vec<u64> = starts
        .iter()
        .map(|it| it["seed"].as_u64().unwrap())
        .collect();
    assert_eq!(seeds, [5, 6, 7]);
    let truly = |start: &Value| start["true_coverage"].as_f64().unwrap();
    // Loads like any start, with the description beside it.
    for start in starts {
        let read = Start::load(&here.join(start["file"].as_str().unwrap()), None).unwrap();
        assert_eq!((read.grid.dimx, read.grid.dimy), (12, 10));
        assert_eq!(start["digest"], read.digest());
        let mask = fab_sim::Mask::full(fab_sim::Grid::new(12, 10, 0.00625).unwrap());
        let triangles = fab_sim::mesh::triangles(&mask);
        let under_m2 = metrics::true_covered_area_m2(&read.positions, &triangles).unwrap();
        let flat_m2 = 11.0 * 9.0 * 0.00625 * 0.00625;
        assert!((truly(start) - under_m2 / flat_m2).abs() < 1e-6, "{start}");
        assert_eq!(
            metrics::coverage(&read.positions, &read.grid),
            start["coverage"].as_f64()
        );
    }
    let bytes = fs::read(here.join("starts/crumpled_12x10_6.npy")).unwrap();
    assert_eq!(told(here, &call), value);
    assert_eq!(
        fs::read(here.join("starts/crumpled_12x10_6.npy")).unwrap(),
        bytes
    );
    // A single seed, with nothing written.
    let alone = told(here, &["crumple", "--dims", "12,10", "--seed", "6"]);
    assert_eq!(alone["starts"][0]["digest"], starts[1]["digest"]);
    assert_eq!(alone["starts"][0]["file"], Value::Null);
}

/// Writes a flat cloth of 40 by 30 particles, centred on the table, as positions with z up.
fn flat_state(folder: &Path) {
    let positions: Vec<u8> = (0..1200)
        .flat_map(|index| {
            let (ix, iy) = (index % 40, index / 40);
            [
                0.00625 * (ix as f32 - 19.5),
                0.00625 * (14.5 - iy as f32),
                0.005,
            ]
        })
        .flat_map(f32::to_le_bytes)
        .collect();
    write_npy(&folder.join("state.npy"), "<f4", "(1200, 3)", &positions);
    let frame = json!({ "dimx": 40, "dimy": 30, "spacing_m": 0.00625, "up": "z" });
    fs::write(folder.join("state.json"), frame.to_string()).unwrap();
}

#[test]
fn the_cameras_draw_colour_and_depth() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    flat_state(here);
    let value = told(here, &["render", "state.npy", "-o", "state.png"]);
    assert_eq!(
        (&value["file"], &value["size_px"]),
        (&json!("state.png"), &json!(224))
    );
    let picture = fab_picture::png::load(&here.join("state.png")).unwrap();
    let top = fab_sim::Look::default().top;
    // 39 by 29 spacings, 6.25 mm each, seen from 0.645 m: 102.2 by 76.0 pixels.
    let orange = |picture: &image::RgbImage, at: [u32; 2]| picture.get_pixel(at[0], at[1]).0 == top;
    assert!(
        orange(&picture, [112, 112]) && orange(&picture, [63, 112]) && orange(&picture, [112, 76])
    );
    assert!(!orange(&picture, [59, 112]) && !orange(&picture, [112, 72]));
    let cloth_px = value["cloth_px"].as_f64().unwrap();
    assert!((cloth_px / (102.2 * 76.0) - 1.0).abs() < 0.02, "{cloth_px}");

    // In the smoothing camera's picture the cloth's long side is vertical.
    let value = told(
        here,
        &[
            "render",
            "state.npy",
            "--camera",
            "smoothing",
            "-o",
            "s.png",
        ],
    );
    assert_eq!(value["size_px"], 720);
    let picture = fab_picture::png::load(&here.join("s.png")).unwrap();
    assert!(orange(&picture, [360, 270]) && !orange(&picture, [270, 360]));

    told(
        here,
        &[
            "render",
            "state.npy",
            "--depth",
            "--size",
            "64",
            "-o",
            "d.png",
        ],
    );
    let picture = fab_picture::png::load(&here.join("d.png")).unwrap();
    assert_eq!(picture.dimensions(), (64, 64));
    // The integer part of 255 times 0.65 m, and times 0.645 m.
    assert_eq!(
        (picture.get_pixel(0, 0).0, picture.get_pixel(32, 32).0),
        ([165; 3], [164; 3])
    );
}

#[test]
fn exported_positions_are_a_start_in_the_world_frame() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    write_npy(&here.join("recorded.npy"), "<f4", "(80, 3)", &flat(10, 8));
    let call = [
        "export",
        "recorded.npy",
        "--dims",
        "10x8",
        "--up",
        "y",
        "-o",
        "world.npy",
    ];
    let value = told(here, &call);
    assert_eq!(value["files"], json!(["world.npy", "world.json"]));
    let read = Start::load(&here.join("world.npy"), None).unwrap();
    assert_eq!((read.grid.dimx, read.grid.dimy), (10, 8));
    assert_eq!(read.positions[0], [0.0, 0.0, 0.005]);
    assert_eq!(read.positions[79], [9.0 * 0.00625, -7.0 * 0.00625, 0.005]);
    // Its own files are replaced, but not those of others.
    told(here, &call);
    fs::write(here.join("world.json"), "{}").unwrap();
    let refused = said(here, &call);
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains("`world.json` is there"),
        "{}",
        refused.stderr
    );
    assert_eq!(fs::read(here.join("world.json")).unwrap(), b"{}");
}

#[test]
fn an_outline_cuts_the_cloth_in_pictures_and_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    flat_state(here);
    // The right half of the 40 columns is missing.
    let row = format!("{}{}", "#".repeat(20), ".".repeat(20));
    let frame = json!({
        "dimx": 40, "dimy": 30, "spacing_m": 0.00625, "up": "z", "outline": vec![row; 30],
    });
    fs::copy(here.join("state.npy"), here.join("left.npy")).unwrap();
    fs::write(here.join("left.json"), frame.to_string()).unwrap();
    told(here, &["render", "left.npy", "-o", "left.png"]);
    let picture = fab_picture::png::load(&here.join("left.png")).unwrap();
    let top = fab_sim::Look::default().top;
    assert_eq!(picture.get_pixel(100, 112).0, top);
    assert_ne!(picture.get_pixel(124, 112).0, top);

    let counts = |name: &str| {
        let text = fs::read_to_string(here.join(name)).unwrap();
        ["v ", "vt ", "f "].map(|kind| text.lines().filter(|line| line.starts_with(kind)).count())
    };
    let value = told(here, &["export", "state.npy", "-o", "whole.obj"]);
    assert_eq!(
        (&value["files"], &value["particles"]),
        (&json!(["whole.obj"]), &json!(1200))
    );
    assert_eq!(counts("whole.obj"), [1200, 1200, 2 * 39 * 29]);
    let value = told(here, &["export", "left.npy", "-o", "left.obj"]);
    assert_eq!(value["particles"], 600);
    assert_eq!(counts("left.obj"), [600, 600, 2 * 19 * 29]);
}

#[test]
fn a_material_is_measured_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("own.fab"), MATERIAL).unwrap();
    for (name, bending_mm, friction) in [("silk", 13.0, 0.2), ("own.fab:mine", 15.0, 0.25)] {
        // Far between, so that the specimens have few particles.
        let said = said(
            folder.path(),
            &["measure", name, "--spacing", "20", "--json"],
        );
        assert_eq!(said.code, 0, "{}", said.stderr);
        let value: Value = serde_json::from_str(&said.stdout).unwrap();
        let readings = value["readings"].as_array().unwrap();
        let of = |what: &str| {
            let found = readings.iter().find(|it| it["what"] == what);
            let found = found.unwrap_or_else(|| panic!("no `{what}` in {value}"));
            ["declared", "measured"].map(|field| found[field].as_f64().unwrap())
        };
        let [declared, measured] = of("bending length, warp");
        assert!((declared - bending_mm).abs() < 1e-4, "{name}: {declared}");
        // A bend of 15 mm has hardly a particle at this spacing.
        assert!(measured > bending_mm, "{name}: {measured}");
        let [declared, measured] = of("friction on the table");
        assert!((declared - friction).abs() < 1e-6, "{name}: {declared}");
        assert!((measured - friction).abs() < 0.02, "{name}: {measured}");
        // Nothing declares it, and the elastica says what it should be.
        let ring = readings
            .iter()
            .find(|it| it["what"] == "depth of a ring loop");
        let ring = ring.unwrap();
        let expected = ring["expected"].as_f64().unwrap();
        assert!(ring["declared"].is_null(), "{ring}");
        assert!((1.9..2.6).contains(&(expected / bending_mm)), "{ring}");
        assert_ne!(value["params"], fab_sim::Params::default().hash());
        // The bounds hold at another spacing.
        assert!(readings.iter().all(|it| it["within"].is_null()), "{value}");
        let last = readings.last().unwrap();
        assert_eq!(last["what"], format!("corner carried {CARRIED_MM} mm"));
        assert!(last["measured"].is_f64(), "{value}");
        // What so few particles cannot show is null, and said.
        let without = readings.iter().filter(|it| it["measured"].is_null());
        let names: Vec<&str> = without.map(|it| it["what"].as_str().unwrap()).collect();
        assert!(names.contains(&"gap between layers"), "{names:?}");
        for name in names {
            let words = format!("{name} has no reading at this spacing");
            assert!(said.stderr.contains(&words), "{}", said.stderr);
        }
    }
    for (name, why) in [
        (
            "own.fab:min",
            "there is no material `min`; did you mean `mine`; `own.fab` declares `mine`",
        ),
        ("pyflex", "there is no material `pyflex`"),
    ] {
        let said = said(folder.path(), &["measure", name]);
        assert_eq!(said.code, 64);
        assert!(said.stderr.contains(why), "{}", said.stderr);
    }
}

#[test]
fn a_smallest_fold_is_searched_only_if_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let call = [
        "measure",
        "cotton",
        "--spacing",
        "20",
        "--smallest-fold",
        "--json",
    ];
    let said = said(folder.path(), &call);
    assert_eq!(said.code, 0, "{}", said.stderr);
    let value: Value = serde_json::from_str(&said.stdout).unwrap();
    let smallest = value["readings"].as_array().unwrap().last().unwrap();
    assert_eq!(smallest["what"], "smallest corner fold");
    assert!(smallest["measured"].as_f64().unwrap() > 40.0, "{value}");
}

#[test]
fn the_page_of_materials_states_the_bounds_of_the_readings() {
    let page = fs::read_to_string(project("docs/materials.md")).unwrap();
    for bound in fab_sim::measure::bounds::BOUNDS {
        let within = match bound.share > 0.0 {
            true => format!("{:.0} %", 100.0 * bound.share),
            false => format!("{}", bound.plain),
        };
        let line = format!("| {} | {} | {within} |", bound.readings, bound.of);
        let line = line.replace("|  |", "| |");
        assert!(page.contains(&line), "docs/materials.md lacks `{line}`");
    }
}

#[test]
fn every_verb_of_the_simulator_is_in_its_guide_and_in_the_readme() {
    let folder = tempfile::tempdir().unwrap();
    let help = said(folder.path(), &["--help"]).stdout;
    let guide = fs::read_to_string(project("docs/simulator.md")).unwrap();
    let readme = fs::read_to_string(project("README.md")).unwrap();
    for verb in [
        "replay", "time", "crumple", "measure", "render", "record", "export",
    ] {
        assert!(
            help.contains(&format!("\n  {verb} ")),
            "no `{verb}` in\n{help}"
        );
        let heading = format!("\n## `fabc sim {verb}");
        assert!(guide.contains(&heading), "no `{verb}` in docs/simulator.md");
        assert!(
            readme.contains(&format!("`fabc sim {verb}")),
            "no `{verb}` in README.md"
        );
    }
}
