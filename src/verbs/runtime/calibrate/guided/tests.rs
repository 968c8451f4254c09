//! Tests of `guided`.

#![allow(clippy::unwrap_used)]

use super::*;
use fab_arm::calibration::{LIMIT_MM, read_pairs};

/// Types these lines while an arm is guided to these places; returns the points, and how often the arm was looked at.
fn guided(typed: &str, mut places: Vec<Result<[f64; 3], String>>) -> (Vec<Pair>, usize) {
    let terms = Terms {
        limit_mm: LIMIT_MM,
        size_px: [720, 720],
        intrinsics: None,
    };
    let folder = tempfile::tempdir().unwrap();
    let saved = folder.path().join("lab.pairs.csv");
    places.reverse();
    let mut n_looks = 0;
    let mut tool = || {
        n_looks += 1;
        places.pop().unwrap()
    };
    let (mut lines, io) = (typed.as_bytes(), Io::in_memory());
    let pairs = points(
        &terms,
        Vec::new(),
        &mut tool,
        Ok(&[]),
        &saved,
        &mut lines,
        &io,
    )
    .unwrap();
    assert_eq!(read_pairs(&saved, Ok(&[])).unwrap_or_default(), pairs);
    (pairs, n_looks)
}

#[test]
fn the_arm_is_looked_at_when_a_pixel_is_entered_and_at_no_other_line() {
    let (a, b) = ([0.3, 0.1, 0.02], [0.5, -0.1, 0.021]);
    let typed = "360,360\n\nwhat\nundo\n100 , 200\n500,200\n3,4,5,6,7\ndone\n9,9\n";
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

#[test]
fn the_points_of_an_earlier_session_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let saved = folder.path().join("lab.pairs.csv");
    std::fs::write(&saved, "u,v,x,y,z\n1,2,0.3,0.1,0.02\n").unwrap();
    let given = read_pairs(&saved, Ok(&[])).unwrap();
    let terms = Terms {
        limit_mm: LIMIT_MM,
        size_px: [720, 720],
        intrinsics: None,
    };
    let again = |given: Vec<Pair>| {
        let mut tool = || Ok([0.4, 0.0, 0.02]);
        let (mut lines, io) = (&b"5,6\n"[..], Io::in_memory());
        points(&terms, given, &mut tool, Ok(&[]), &saved, &mut lines, &io).map(|it| it.len())
    };
    assert!(again(Vec::new()).is_err());
    assert_eq!(again(given).unwrap(), 2);
    assert_eq!(read_pairs(&saved, Ok(&[])).unwrap().len(), 2);
}
