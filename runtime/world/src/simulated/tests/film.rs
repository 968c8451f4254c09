//! Unit tests of `simulated::film`.

#![allow(clippy::unwrap_used)]

use super::*;
use fab_sim::{Grid, Params};
use std::fs;

fn plan(path: PathBuf, max_bytes: u64) -> FilmPlan {
    FilmPlan {
        path,
        camera: TopDownCamera::new(0.65, 45f32.to_radians(), 224).unwrap(),
        motions: 2,
        max_bytes,
    }
}

/// Folds a cloth twice; `interrupted` stops the second fold at its first step.
fn fold(recorder: Option<&Recorder>, interrupted: &[bool]) -> Simulator {
    let grid = Grid::new(24, 24, 0.00625).unwrap();
    let mut cloth = Simulator::flat(grid, &Params::default());
    if let Some(recorder) = recorder {
        recorder.begin(&cloth, &Look::default());
    }
    for (stop, side) in interrupted.iter().zip([-1.0_f32, 1.0]) {
        let interrupt = Interrupt::default();
        if *stop {
            interrupt.raise();
        }
        let [from, to] = [[side * 0.07, 0.07], [0.0, -0.05]];
        let done = pick_and_place(
            &mut cloth,
            &Manner::default(),
            from,
            to,
            recorder,
            &interrupt,
        );
        assert_eq!(done.is_err(), *stop);
    }
    cloth
}

#[test]
fn a_film_is_the_same_each_time_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let plain = fold(None, &[false, false]).digest();
    let mut bytes = Vec::new();
    for name in ["a.gif", "b.gif"] {
        let path = folder.path().join(name);
        let recorder = Recorder::new(plan(path.clone(), MAX_BYTES)).unwrap();
        assert_eq!(fold(Some(&recorder), &[false, false]).digest(), plain);
        assert!(!path.exists());
        let film = recorder.finish().unwrap().unwrap();
        assert_eq!(film.left_out, 0);
        // Two motions of about 4 s, a start and three holds; what stands still is shortened.
        assert!((7.0..11.0).contains(&film.shown_s), "{film}");
        assert!((40..120).contains(&film.pictures), "{film}");
        bytes.push(fs::read(path).unwrap());
        assert_eq!(recorder.finish().unwrap(), None);
    }
    assert_eq!(bytes[0], bytes[1]);
    fs::remove_file(folder.path().join("a.gif")).unwrap();
    fs::remove_file(folder.path().join("b.gif")).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn an_interrupted_motion_leaves_a_whole_film() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let recorder = Recorder::new(plan(path.clone(), MAX_BYTES)).unwrap();
    fold(Some(&recorder), &[false, true]);
    let film = recorder.finish().unwrap().unwrap();
    let bytes = fs::read(path).unwrap();
    assert_eq!(
        (film.bytes, bytes.last()),
        (bytes.len() as u64, Some(&b';'))
    );
    assert!(film.pictures > 20, "{film}");
}

#[test]
fn a_film_that_would_be_too_large_has_fewer_pictures_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let small = 60_000;
    let recorder = Recorder::new(plan(folder.path().join("a.gif"), small)).unwrap();
    fold(Some(&recorder), &[false, false]);
    let film = recorder.finish().unwrap().unwrap();
    assert!(
        film.bytes < small && film.left_out > 5 && film.pictures > 10,
        "{film:?}"
    );
    assert!(film.to_string().contains(" pictures left out"), "{film}");
}

#[test]
fn a_film_that_cannot_be_written_stops_no_motion_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("absent").join("a.gif");
    let recorder = Recorder::new(plan(path, MAX_BYTES)).unwrap();
    fold(Some(&recorder), &[false]);
    let refused = recorder.finish().unwrap_err().to_string();
    assert!(refused.contains("absent/a.gif"), "{refused}");
    let unused = Recorder::new(plan(folder.path().join("b.gif"), MAX_BYTES)).unwrap();
    assert_eq!(unused.finish().unwrap(), None);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
