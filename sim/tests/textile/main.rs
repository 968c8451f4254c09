//! Textile truth.
#![allow(clippy::unwrap_used)]
mod probe;
use fab_sim::measure::{self, Cut};
use fab_sim::{Directions, Material};

fn material(mm: f32) -> Material {
    Material {
        weight_kg_m2: 0.15,
        thickness_m: 0.0005,
        bending_length_m: Directions {
            warp: 0.001 * mm,
            weft: 0.001 * mm,
            bias: 0.0009 * mm,
        },
        crease_recovery_deg: 90.0,
        stretch: Directions {
            warp: 0.015,
            weft: 0.02,
            bias: 0.05,
        },
        table_friction: 0.5,
        self_friction: 0.5,
    }
}

#[test]
fn cantilevers() {
    for spacing in [0.00625, 0.004] {
        for mm in [10.0, 15.0, 20.0, 30.0, 40.0] {
            let cloth = material(mm);
            println!("{spacing} {mm} {:?}", cloth.check(spacing));
            for cut in [Cut::Bias] {
                let began = std::time::Instant::now();
                let got = measure::cantilever(&cloth, cut, spacing).unwrap();
                let want = cut.of(cloth.bending_length_m) as f64;
                println!(
                    "{spacing} {mm} {cut:?}: {:.2} mm, {:.3} of declared, {:.1} deg, {:?}",
                    1e3 * got.bending_length_m,
                    got.bending_length_m / want,
                    got.angle_rad.to_degrees(),
                    began.elapsed()
                );
            }
        }
    }
}
