//! Tests of `typing`.

#![allow(clippy::unwrap_used)]

use super::*;
use fab_arm::calibration::LIMIT_MM;
use fab_arm::settings::Settings;

/// Types these lines while an arm is guided to these places, and returns the points.
fn guided(typed: &str, mut places: Vec<Result<[f64; 3], String>>) -> (Vec<Pair>, usize) {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("tasks/real/simulated.toml");
    let settings = Settings::load(&shipped).unwrap();
    let terms = Terms::of(&settings, [720, 720], LIMIT_MM);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lab.toml");
    places.reverse();
    let mut n_looks = 0;
    let tool = || {
        n_looks += 1;
        places.pop().unwrap()
    };
    let setup = TypingSetup {
        grid: None,
        path: &path,
        window: Window::from([0, 0, 720]),
        seen: &RgbImage::new(720, 720),
        tags: Ok(&[]),
    };
    let mut lines = typed.as_bytes();
    let pairs = type_points(
        &terms,
        Vec::new(),
        Some(Box::new(tool)),
        &setup,
        &mut lines,
        &Io::in_memory(),
    );
    let pairs = pairs.unwrap();
    let kept = fab_arm::calibration::read_pairs(&path.with_extension("pairs.csv"), Ok(&[]));
    assert_eq!(kept.unwrap_or_default(), pairs);
    (pairs, n_looks)
}

#[test]
fn the_arm_is_looked_at_when_a_pixel_is_entered_and_at_no_other_line() {
    let (a, b) = ([0.3, 0.1, 0.02], [0.5, -0.1, 0.021]);
    let typed = "360,360\n\nlist\nwhat\nundo\n100 , 200\n500,200\n3,4,5,6,7\ndone\n9,9\n";
    let (pairs, n_looks) = guided(typed, vec![Ok([0.4, 0.0, 0.02]), Ok(a), Ok(b)]);
    let found: Vec<_> = pairs.iter().map(|pair| (pair.pixel, pair.base_m)).collect();
    assert_eq!(found, [([100.0, 200.0], a), ([500.0, 200.0], b)]);
    assert_eq!(n_looks, 3);
}

#[test]
fn a_place_that_the_arm_does_not_give_is_no_point() {
    let moves = || Err("the arm still moves".to_owned());
    let place = [0.3, 0.1, 0.02];
    let (pairs, n_looks) = guided(
        "100,200\n100,200\n100,200\n",
        vec![moves(), moves(), Ok(place)],
    );
    assert_eq!((pairs.len(), n_looks), (1, 3));
    assert_eq!(pairs[0].base_m, place);
}
