//! Unit tests of `crumple`.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::SimulatedWorld;
use crate::start::Outline;
use fab_program::{Camera, Cloth, ClothStart, ImageUp};

const CLOTH: Cloth = Cloth {
    dimx: 12,
    dimy: 10,
    spacing_m: 0.00625,
    start: ClothStart::Crumpled,
    material: None,
};

fn world() -> SimulatedWorld {
    let camera = Camera {
        height_m: 0.65,
        fov_rad: 0.785,
        image_px: 64,
        up: ImageUp::Y,
    };
    SimulatedWorld::new(&camera, fab_program::Picker::default()).unwrap()
}

#[test]
fn a_start_that_lies_open_is_told() {
    let said = unlike_recorded(&Start::flat(&CLOTH)).unwrap();
    assert!(said.contains("recorded ones cover 32 to 63 %"), "{said}");
}

/// Returns the start, and whether it had to be crumpled.
fn crumpled(seed: u64, cache: &Cache) -> (Start, bool) {
    let mut anew = false;
    let mut announce = || anew = true;
    let interrupt = Interrupt::default();
    let crumpled = start(
        &Start::flat(&CLOTH),
        seed,
        &world(),
        cache,
        &interrupt,
        &mut announce,
    );
    (crumpled.unwrap().start, anew)
}

#[test]
fn a_start_is_crumpled_once_and_has_the_same_bits_from_the_cache() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::at(folder.path().to_owned());
    let (bare, _) = crumpled(7, &Cache::none());
    assert_eq!(crumpled(7, &cache), (bare.clone(), true));
    assert_eq!(crumpled(7, &cache), (bare.clone(), false));
    let (other, anew) = crumpled(8, &cache);
    assert!(anew && other.digest() != bare.digest());
}

#[test]
fn heaps_outside_of_the_recorded_spread_are_no_starts() {
    let flat = Start::flat(&Cloth {
        dimx: 40,
        dimy: 40,
        ..CLOTH
    });
    let grid = flat.grid;
    // A flat cloth covers 0.95 by this measure; drawn together to a share of its width, about that share.
    let drawn = |share: f32| -> Vec<[f32; 3]> {
        (0..1600)
            .map(|index| {
                [(index % 40) as f32 * share, (index / 40) as f32, 0.8].map(|at| at * 0.00625)
            })
            .collect()
    };
    for (share, expected) in [(1.0, false), (0.75, false), (0.45, true), (0.2, false)] {
        let covered = metrics::coverage(&drawn(share), &grid);
        assert_eq!(is_start(&drawn(share), &flat), expected, "{covered:?}");
    }
    assert!(!is_start(&[], &flat));
    // If half of the cloth is missing, its own area counts: it covers 0.86 of that, but 0.43 of the grid's.
    let half = Outline::new(&(("#".repeat(20) + &".".repeat(20) + "\n").repeat(40)));
    let halved = Start {
        outline: Some(half),
        ..flat
    };
    // The missing ones are where the world has them.
    let left = |share: f32| -> Vec<[f32; 3]> {
        let there = |(index, point)| if index % 40 < 20 { point } else { [0.0; 3] };
        drawn(share).into_iter().enumerate().map(there).collect()
    };
    assert!(is_start(&left(0.45), &halved));
    assert!(!is_start(&left(0.9), &halved));
}

#[test]
fn a_damaged_entry_is_crumpled_again() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::at(folder.path().to_owned());
    let (first, _) = crumpled(3, &cache);
    let entry = std::fs::read_dir(folder.path()).unwrap().next().unwrap();
    let path = entry.unwrap().path();
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    assert_eq!(crumpled(3, &cache), (first, true));
}

#[test]
fn a_raised_interrupt_keeps_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let interrupt = Interrupt::default();
    interrupt.raise();
    let cache = Cache::at(folder.path().to_owned());
    let crumpled = start(
        &Start::flat(&CLOTH),
        1,
        &world(),
        &cache,
        &interrupt,
        &mut || {},
    );
    assert!(matches!(crumpled, Err(WorldError::Interrupted)));
    let kept = std::fs::read_dir(folder.path()).unwrap();
    assert_eq!(kept.count(), 0);
}
