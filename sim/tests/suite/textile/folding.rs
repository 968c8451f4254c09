//! Layers: gaps, folds, crumples, and the same bits everywhere.

use super::*;
use fab_sim::{Mask, Snapshot, crossings, diagonal_fold, measure};

/// Where layers lie flat on each other they are the thickness apart, from 1 to 3 mm.
#[test]
fn layers_keep_the_declared_thickness() {
    for (name, material) in materials() {
        let got = measure::free_fold(&material, SPACING_M).unwrap().gap_m;
        let gap = f64::from(material.gap_m());
        assert!((got / gap - 1.0).abs() < 0.1, "{name}: {got} m of {gap} m");
    }
}

/// Measured: no crossing after a fold, and threads give by at most 1 %.
#[test]
fn no_layer_passes_through_another_in_a_fold() {
    for (name, material) in materials() {
        let grid = Grid::new(30, 30, SPACING_M).unwrap();
        let cloth = diagonal_fold(grid, &params(&material), &|| false).unwrap();
        let points = cloth.positions();
        assert_eq!(crossings(&Mask::full(grid), &points), 0, "{name}");
        assert!(
            stretch(grid, &points) < 0.02,
            "{name}: {}",
            stretch(grid, &points)
        );
    }
}

/// Layers that meet at speed, sharply bent at the point that is held, are the hardest case. The recorded scene's cloth ends
/// with 9 and 43 crossings in the heaps of seeds 3 and 4.
///
/// One heap says little: what crosses is chance. Measured in all eight: silk 125, cotton 61, towel and denim none.
#[test]
#[ignore = "long"]
fn hardly_a_thread_passes_through_another_in_crumples() {
    for (name, material) in materials() {
        let grid = Grid::new(30, 30, SPACING_M).unwrap();
        let crossed = |seed| {
            let mut cloth = Simulator::flat(grid, &params(&material));
            cloth.crumple(seed, &|| false).unwrap();
            crossings(cloth.mask(), &cloth.positions())
        };
        let counts: Vec<usize> = (1..=8).map(crossed).collect();
        println!("{name}: crossings {counts:?}");
        let most = match name {
            "silk" => 160,
            "cotton" => 120,
            _ => 10,
        };
        assert!(counts.iter().sum::<usize>() <= most, "{name}: {counts:?}");
    }
}

/// A fold by hand, with creases, goes on from a snapshot with the same bits, also after being text.
#[test]
fn a_snapshot_of_a_material_goes_on_with_the_same_bits() {
    let [_, (_, cotton), ..] = materials();
    let mut cloth = square(16, &cotton);
    cloth.hold(&[0]).unwrap();
    for _ in 0..20 {
        cloth.step_held([0.002, -0.002, 0.002]).unwrap();
    }
    let text = serde_json::to_string(&cloth.snapshot()).unwrap();
    let snapshot: Snapshot = serde_json::from_str(&text).unwrap();
    let mut other = square(16, &cotton);
    other.restore(&snapshot).unwrap();
    for cloth in [&mut cloth, &mut other] {
        cloth.hold(&[]).unwrap();
        run(cloth, 30);
    }
    assert_eq!(cloth.digest(), other.digest());
    assert!(
        cloth
            .snapshot()
            .texture
            .unwrap()
            .rest
            .iter()
            .flatten()
            .any(|rest| *rest != 0.0)
    );
}

/// Equal on every machine and for every instruction set (`--features narrow` runs the baseline's); pin anew when results are meant to change.
#[test]
fn a_fold_of_cotton_has_the_pinned_bits() {
    let [_, (_, cotton), ..] = materials();
    let grid = Grid::new(14, 13, SPACING_M).unwrap();
    let cloth = diagonal_fold(grid, &params(&cotton), &|| false).unwrap();
    assert_eq!(&cloth.digest()[..16], "23003f32a53f6608");
}

/// Carries the end of a strip along the warp over it and lays it down; returns how far away the end is 1 s after it was let go, metres.
fn carried_end(material: &Material, carry_m: f32) -> f32 {
    const ROWS: usize = 70;
    let mut cloth = Simulator::flat(Grid::new(ROWS, 6, SPACING_M).unwrap(), &params(material));
    let start = cloth.positions();
    let end: Vec<usize> = (0..6).map(|line| line * ROWS).collect();
    cloth.hold(&end).unwrap();
    // 2 mm a step.
    let steps = (500.0 * carry_m) as u32;
    let place = |step: u32| {
        let share = step as f32 / steps as f32;
        let turn = share * std::f32::consts::PI;
        let (sin, cos) = turn.sin_cos();
        [
            0.5 * carry_m * (1.0 - cos),
            0.35 * carry_m * sin + share * material.gap_m(),
        ]
    };
    for step in 0..steps {
        let ([x, z], [to_x, to_z]) = (place(step), place(step + 1));
        cloth.step_held([to_x - x, 0.0, to_z - z]).unwrap();
    }
    run(&mut cloth, 20);
    cloth.hold(&[]).unwrap();
    run(&mut cloth, 100);
    cloth.positions()[2 * ROWS][0] - start[2 * ROWS][0]
}

/// The end of a strip stays where it is laid from 5.0 bending lengths on, by the elastica with a friction of 0.6 at the end; without
/// internal friction of bending.
///
/// Measured: of 18 mm it opens at 80 mm and stays at 90 mm; the elastica says 91 mm.
#[test]
fn a_flap_of_a_strip_stays_from_where_friction_holds_the_elastica() {
    for millimetres in [18.0, 25.0] {
        let material = Material {
            crease_recovery_deg: 180.0,
            ..of_length(millimetres)
        };
        let gap = f64::from(material.gap_m() / (0.001 * millimetres));
        let friction = f64::from(material.self_friction);
        let least = 0.001 * millimetres * elastica::least_carry(gap, friction) as f32;
        let (short, long) = (0.88 * least, 1.12 * least);
        let opened = carried_end(&material, short);
        assert!(
            opened.abs() < 0.002,
            "{millimetres} mm, carried {short} m: {opened} m"
        );
        let stayed = carried_end(&material, long);
        assert!(
            (stayed - long).abs() < 0.003,
            "{millimetres} mm, carried {long} m: {stayed} m"
        );
    }
}

/// A corner stays from 12 bending lengths on, by the elastica of a triangle with a friction of 0.6 on itself; without internal friction of bending.
///
/// The fold pushes its flap on until friction holds it, so one that is carried 0.9 of that may stay, too.
/// Measured, of what the elastica says: carried 0.8 it opens, carried 1.0 it ends 1.13 away, carried 1.12 1.27.
#[test]
#[ignore = "long"]
fn a_corner_stays_from_where_friction_holds_the_elastica() {
    let material = Material {
        crease_recovery_deg: 180.0,
        ..of_length(15.0)
    };
    let c = material.bending_length_m.bias;
    let gap = f64::from(material.gap_m() / c);
    let least = c * elastica::least_corner_carry(gap, f64::from(material.self_friction)) as f32;
    for share in [0.8, 1.0, 1.12] {
        let mut cloth = square(45, &material);
        let [x, y, _] = cloth.positions()[0];
        let by = share * least / 2f32.sqrt();
        cloth
            .pick_and_place([x, y], [x + by, y - by], &|| false)
            .unwrap();
        cloth.settle(200).unwrap();
        let end = cloth.positions()[0];
        let away = distance([end[0], end[1], 0.0], [x, y, 0.0]) / least;
        let (opens, stays) = (away < 0.1, (share..share + 0.2).contains(&away));
        assert!(
            if share < 0.9 { opens } else { stays },
            "carried {share} of {least} m: ends {away} of it away"
        );
    }
}

/// A corner of a 55 x 55 cloth that is carried 40 to 120 mm along the diagonal opens again, and then lies as far away as the whole cloth
/// was dragged: `docs/materials.md` has the figures. Carried 160 mm, it stays where the smallest fold of that page is less.
#[test]
#[ignore = "long"]
fn a_corner_opens_below_the_smallest_fold_and_stays_above_it() {
    for (name, material) in materials() {
        let (dragged_mm, smallest_m) = match name {
            "silk" => (18.0, 0.136),
            "cotton" => (10.3, 0.15),
            "towel" => (4.8, 0.188),
            _ => (10.9, 0.32),
        };
        for carried in [0.04f32, 0.08, 0.12, 0.16] {
            let mut cloth = square(55, &material);
            let flat = cloth.positions();
            let [x, y, _] = flat[0];
            let by = carried / 2f32.sqrt();
            cloth
                .pick_and_place([x, y], [x + by, y - by], &|| false)
                .unwrap();
            cloth.settle(300).unwrap();
            let points = cloth.positions();
            // The middle tells by how much the whole cloth was dragged.
            let dragged = distance(points[27 * 56], flat[27 * 56]);
            let stays = distance([points[0][0], points[0][1], 0.0], [x, y, 0.0]);
            println!(
                "{name}, carried {:.0} mm: ends {:.0} mm away at height {:.0} mm, the cloth dragged by {:.0} mm",
                1e3 * carried,
                1e3 * stays,
                1e3 * points[0][2],
                1e3 * dragged
            );
            assert_eq!(crossings(cloth.mask(), &points), 0, "{name} {carried}");
            assert!((1e3 * dragged - dragged_mm).abs() < 1.5, "{name} {carried}");
            let folded = stays - dragged;
            assert!(
                if carried > smallest_m {
                    folded > 0.8 * carried
                } else {
                    folded < 0.002
                },
                "{name}, carried {carried} m: {folded} m"
            );
        }
    }
}
