//! Pairs of a pixel and a position, as a person measures them with an arm, and `fabc calibrate`.
//!
//! In: a lab. Out: a calibration with the errors of a careful person: pixels are read to half a pixel, the tool's
//! position to a millimetre, and the fingertips are slightly off from where the arm assumes them. `fabc` is told none
//! of these errors.

use super::lab::Lab;
use fab_arm::guard::Guard;
use fab_arm::kinematics::tool_down::tool_down;
use fab_arm::limits::Limited;
use fab_base::chance::Chance;
use nalgebra::Point3;
use serde_json::json;

/// Largest error of a pixel.
const PIXEL: f64 = 0.5;

/// Largest error of a position, metres.
const PLACE_M: f64 = 0.001;

/// Offset of the touching point from where the arm assumes it, metres.
const TIP_M: [f64; 3] = [0.0010, -0.0008, 0.0003];

/// How points are touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touching {
    /// The arm moves to each, over ROS.
    Driven,
    /// The reached position is computed, which takes no time.
    Reckoned,
}

/// Measures 16 points, and calibrates with them.
pub fn calibrate(lab: &mut Lab, touching: Touching) {
    let mut lines = "u,v,x,y,z\n".to_owned();
    let places = places();
    let reached = match touching {
        Touching::Reckoned => places,
        Touching::Driven => drive(lab, &places),
    };
    for at_m in reached {
        let told = lab.ask(&json!({ "ask": "pixel", "position": at_m }));
        let [u, v]: [f64; 2] = serde_json::from_value(told["pixel"].clone()).unwrap();
        let chance = &mut lab.chance;
        let (u, v) = (u + within(chance, PIXEL), v + within(chance, PIXEL));
        let [x, y, z] = [0, 1, 2].map(|axis| at_m[axis] + TIP_M[axis] + within(chance, PLACE_M));
        lines += &format!("{u:.1},{v:.1},{x:.4},{y:.4},{z:.4}\n");
    }
    std::fs::write(lab.folder().join("pairs.csv"), lines).unwrap();
    let output = lab
        .fabc()
        .args(["calibrate", "--robot", "robot.toml"])
        .args(["--pairs", "pairs.csv"])
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

/// How far above each position the tool is moved, metres: between two of them it may leave its line by a millimetre.
const ABOVE_M: f64 = 0.003;

/// Moves the tool above each position and returns what is below where it arrived; then moves it back to rest.
fn drive(lab: &mut Lab, places: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let settings = lab.settings();
    let arm = lab.ros.arm(&settings);
    let mut arm = Limited::new(arm, Guard::level(&settings));
    let mut go = |[x, y, z]: [f64; 3]| {
        let to = tool_down(&Point3::new(x, y, z), 0.0);
        let speed_m_s = settings.motion.speed_m_s;
        let state = arm
            .move_tool(&to, speed_m_s, &mut |_| Ok(()))
            .unwrap_or_else(|error| panic!("({x:.3}, {y:.3}, {z:.3}): {error}"));
        state.tool.translation.vector.into()
    };
    let touch = |[x, y, z]: &[f64; 3]| {
        let [x, y, z] = go([*x, *y, z + ABOVE_M]);
        [x, y, z - ABOVE_M]
    };
    let reached = places.iter().map(touch).collect();
    go(settings.workspace.rest_m);
    reached
}

/// A grid of 4 x 4 over the table, shrunk to the arm's reach.
fn places() -> Vec<[f64; 3]> {
    let shares = [-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0];
    let at = |row: usize, column: usize| {
        // Alternating directions, so that every move is short.
        let column = if row.is_multiple_of(2) {
            column
        } else {
            3 - column
        };
        let (x, y) = (0.45 + 0.22 * shares[row], 0.27 * shares[column]);
        let drawn_in = (0.67 / f64::hypot(x, y)).min(1.0);
        [x * drawn_in, y * drawn_in, 0.02]
    };
    let all = (0..16).map(|index| at(index / 4, index % 4));
    all.collect()
}

fn within(chance: &mut Chance, most: f64) -> f64 {
    (2.0 * chance.fraction() - 1.0) * most
}
