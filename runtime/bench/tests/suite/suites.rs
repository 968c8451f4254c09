//! Tests of suites as data: what is rejected, and the positions of generated and recorded starts.
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_bench::starts;
use fab_bench::starts::StartPoint;
use fab_bench::suite::{Starts, Suite};
use fab_program::{Camera, Cloth, ClothStart, ImageUp, Picker};
use fab_world::start::Start;
use fab_world::{SimulatedWorld, WorldError};
use std::path::Path;

#[path = "../../../../tests/recorded_data.rs"]
mod recorded;

const SUITE: &str = r#"
about = "Two folds."
statistic = "mean"
metrics = ["mean_particle_distance_mm", "goal_reached"]
tasks = ["../a.fab", "b.fab"]
[starts]
lie = "flat"
sides = [50, 51]
turns_deg = [0, 30, 45]
[[method]]
name = "plain"
[[method]]
name = "bare"
variant = "without_checks"
"#;

fn fault(change: impl Fn(&str) -> String) -> String {
    Suite::parse(&change(SUITE)).unwrap_err().to_string()
}

#[test]
fn a_suite_is_read() {
    let suite = Suite::parse(SUITE).unwrap();
    assert_eq!(suite.repeats, 1);
    assert_eq!(suite.methods[1].variant.as_deref(), Some("without_checks"));
    assert!(suite.horizons.is_empty() && suite.quotes.is_empty());
}

#[test]
fn what_is_wrong_with_a_suite_is_named_with_what_would_be_right() {
    let cases: [(&str, &str, &str); 14] = [
        ("about =", "abuot =", "unknown field `abuot`"),
        ("\"mean\"", "\"average\"", "unknown variant `average`"),
        (
            "\"goal_reached\"",
            "\"success\"",
            "there is no metric `success`",
        ),
        ("[50, 51]", "[50, 51", "TOML parse error at line"),
        ("[50, 51]", "[]", "`starts.sides`: the list is empty"),
        ("[50, 51]", "[1]", "`starts.sides`: 1 is not from 2 to 1000"),
        (
            "[0, 30, 45]",
            "[nan]",
            "`starts.turns_deg`: NaN is not from",
        ),
        (
            "name = \"bare\"",
            "name = \"plain\"",
            "`plain` is there twice",
        ),
        (
            "name = \"bare\"",
            "name = \"../bare\"",
            "is not 1 to 64 letters",
        ),
        (
            "statistic",
            "repeats = 0\nstatistic",
            "`repeats`: 0 is not from 1",
        ),
        (
            "statistic",
            "horizons = [5, 5]\nstatistic",
            "`horizons`: [5, 5] do not grow",
        ),
        (
            "[starts]",
            "gap = [{ name = \"g\", of = \"plain\", over = \"none\" }]\n[starts]",
            "names no method `none`",
        ),
        (
            "[[method]]\nname = \"plain\"",
            "[vary]\nfricton = [0.5, 1.2]\n[[method]]\nname = \"plain\"",
            "`[vary]` has no axis `fricton`; did you mean `friction`?",
        ),
        (
            "[[method]]\nname = \"plain\"",
            "[vary]\nhue_deg = [-20, 20]\n[starts_of.fold]\nlie = \"operator\"\ncount = 1\n[[method]]\nname = \"plain\"",
            "`vary`: a cloth laid by hand lies on a table",
        ),
    ];
    for (from, to, wanted) in cases {
        assert!(SUITE.contains(from));
        let said = fault(|suite| suite.replace(from, to));
        assert!(said.contains(wanted), "{to}: {said}");
    }
    let said = fault(|suite| {
        suite
            .replace("repeats", "")
            .replace("about =", "\nabout = 3\nx =")
    });
    assert!(said.contains("line 3"), "{said}");
    assert!(fault(|_| String::new()).contains("missing field"));
}

fn cloth(dimx: u32, dimy: u32) -> Cloth {
    Cloth {
        dimx,
        dimy,
        spacing_m: 0.00625,
        start: ClothStart::Flat,
        material: None,
    }
}

fn lay(point: &StartPoint) -> Start {
    try_to_lay(point).unwrap()
}

fn try_to_lay(point: &StartPoint) -> Result<Start, WorldError> {
    let camera = Camera {
        height_m: 0.65,
        fov_rad: std::f64::consts::FRAC_PI_4,
        image_px: 64,
        up: ImageUp::Y,
    };
    let world = SimulatedWorld::new(&camera, Picker::default()).unwrap();
    point.lay(&world, &Cache::none(), &Interrupt::default())
}

fn folding() -> Starts {
    Starts::Flat {
        sides: (50..60).collect(),
        turns_deg: vec![0.0, -30.0, -45.0, -60.0],
    }
}

#[test]
fn rectangles_keep_the_tasks_ratio_rounded_down() {
    let points = starts::generated(&folding(), &cloth(55, 44));
    assert_eq!(points.len(), 40);
    for (index, point) in points.iter().enumerate() {
        let side = 50 + index as u32 / 4;
        assert_eq!(point.number, index as u64);
        assert_eq!(point.grid(), [side, side * 4 / 5]);
    }
}

#[test]
#[ignore = "long"]
fn crumpled_starts_have_all_sizes_and_their_own_seeds() {
    let starts = Starts::Crumpled {
        sides: (40..45).collect(),
        count: 40,
        first_seed: 4000,
    };
    let points = starts::generated(&starts, &cloth(42, 42));
    let mut grids: Vec<_> = points.iter().map(StartPoint::grid).collect();
    grids.sort_unstable();
    grids.dedup();
    assert_eq!((points.len(), grids.len()), (40, 25));
    let small = Starts::Crumpled {
        sides: vec![12],
        count: 2,
        first_seed: 7,
    };
    let [a, b] = &starts::generated(&small, &cloth(42, 42))[..] else {
        panic!("two starts");
    };
    assert_eq!((lay(a).seed, lay(b).seed), (Some(7), Some(8)));
    assert_eq!(lay(a), lay(a));
    assert_ne!(lay(a).positions, lay(b).positions);
}

#[test]
fn generated_flat_starts_are_the_recorded_ones() {
    let Some(data) = recorded::recorded_data("generated_flat_starts_are_the_recorded_ones") else {
        return;
    };
    for (task, cloth) in [
        ("double_straight", cloth(55, 44)),
        ("all_corners_inward", cloth(55, 55)),
    ] {
        let recorded = starts::recorded(&data.join("folding120"), task).unwrap();
        let generated = starts::generated(&folding(), &cloth);
        assert!(!recorded.is_empty());
        for point in recorded {
            let (theirs, ours) = (lay(&point), lay(&generated[point.number as usize]));
            assert_eq!(theirs.grid, ours.grid);
            let pairs = theirs
                .positions
                .iter()
                .flatten()
                .zip(ours.positions.iter().flatten());
            let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off < 1e-5, "{task} {}: {off} m apart", point.number);
        }
    }
}

#[test]
fn recorded_crumpled_starts_are_for_any_task() {
    let Some(data) = recorded::recorded_data("recorded_crumpled_starts_are_for_any_task") else {
        return;
    };
    let points = starts::recorded(&data.join("smoothing40"), "smoothing").unwrap();
    assert!(
        points
            .iter()
            .all(|point| (40..45).contains(&point.grid()[0]))
    );
    assert!(points.len() >= 20);
    assert!(
        starts::recorded(&data.join("folding120"), "smoothing")
            .unwrap()
            .is_empty()
    );
}

#[test]
fn a_start_of_another_size_is_laid_with_a_longer_cloth_but_not_if_it_was_recorded() {
    let starts = Starts::Flat {
        sides: vec![12],
        turns_deg: vec![30.0],
    };
    let point = &starts::generated(&starts, &cloth(12, 10))[0];
    let (own, larger) = (lay(point), lay(&point.scaled(1.25)));
    assert_eq!(lay(&point.scaled(1.0)), own);
    assert_eq!(larger.grid.spacing_m, 0.00625 * 1.25);
    for (own, larger) in own.positions.iter().zip(&larger.positions) {
        let off = (0..2).map(|axis| (own[axis] * 1.25 - larger[axis]).abs());
        assert!(off.sum::<f32>() < 1e-6 && own[2] == larger[2]);
    }

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("laid.npy");
    std::fs::write(&file, fab_base::npy::encode(&own.positions)).unwrap();
    let frame = r#"{"dimx": 12, "dimy": 10, "spacing_m": 0.00625, "up": "z"}"#;
    std::fs::write(file.with_extension("json"), frame).unwrap();
    let recorded = &starts::recorded(folder.path(), "fold").unwrap()[0];
    assert_eq!(lay(&recorded.scaled(1.0)).positions, own.positions);
    let said = try_to_lay(&recorded.scaled(1.25)).unwrap_err().to_string();
    assert!(said.contains("whose size cannot be varied"), "{said}");
}

#[test]
fn folders_without_starts_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let said = |folder: &Path| starts::recorded(folder, "fold").unwrap_err().to_string();
    assert!(said(folder.path()).contains("it has no manifest.json and no .npy file"));
    assert!(said(&folder.path().join("absent")).contains("cannot be used"));
    for (manifest, wanted) in [
        ("{", "EOF while parsing"),
        ("{}", "it lists neither `entries` nor `states`"),
        (
            r#"{"states": []}"#,
            "it lists neither `entries` nor `states`",
        ),
        (r#"{"states": [{"index": 1}]}"#, "missing field `pos`"),
        (
            r#"{"states": [{"index": 1, "pos": "a.npy"}]}"#,
            "cannot find `a.npy`",
        ),
        (
            r#"{"states": [{"index": 1, "pos": "../.."}]}"#,
            "leads out of the folder",
        ),
    ] {
        std::fs::write(folder.path().join("manifest.json"), manifest).unwrap();
        assert!(
            said(folder.path()).contains(wanted),
            "{manifest}: {}",
            said(folder.path())
        );
    }
}
