//! Recorded crumpled starts stay in place once they have settled here.

use crate::recorded::{data::recorded_data, mean_distance_mm, read_points};
use fab_sim::{Grid, Params, RestShortcut, Simulator};

/// Steps in which a recorded heap may come to rest. After half as many, high heaps still sink by up to 5 mm in a
/// second.
const SETTLING_STEPS: u32 = 600;
/// Steps for which it must then stay: one second.
const STAYING_STEPS: u32 = 100;
/// Mean distance that its particles may drift in that time, millimetres.
const MOST_DRIFT_MM: f64 = 2.0;

/// Settles recorded states with their velocities, and checks that each one then stays.
///
/// - `wanted`: how many of the states to check, in the manifest's order.
fn settled_states_stay(test: &str, wanted: usize) {
    let Some(root) = recorded_data(test) else {
        return;
    };
    let text = std::fs::read_to_string(root.join("smoothing40/manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    let spacing_m = manifest["spacing_m"].as_f64().unwrap() as f32;
    let states = manifest["states"].as_array().unwrap().iter();
    let there: Vec<_> = states
        .filter(|state| root.join(state["pos"].as_str().unwrap()).exists())
        .take(wanted)
        .collect();
    assert!(!there.is_empty(), "no recorded state is there");
    let mut drifts_mm = Vec::new();
    for state in there {
        let whole = |name: &str| state[name].as_u64().unwrap() as usize;
        let points = |name: &str| read_points(&root.join(state[name].as_str().unwrap()));
        let grid = Grid::new(whole("dimx"), whole("dimy"), spacing_m).unwrap();
        let mut cloth =
            Simulator::from_positions(grid, &points("pos"), &Params::default()).unwrap();
        cloth.set_rest_shortcut(RestShortcut::Compute);
        cloth.set_velocities(&points("vel")).unwrap();
        let recorded = cloth.positions();
        let advance = |cloth: &mut Simulator, steps: u32| {
            for _ in 0..steps {
                cloth.step().unwrap();
            }
            cloth.positions()
        };
        let settled = advance(&mut cloth, SETTLING_STEPS);
        let after = advance(&mut cloth, STAYING_STEPS);
        let drift_mm = mean_distance_mm(&settled, &after);
        println!(
            "state {}: settling moves it by {:.2} mm, drift in the next second {drift_mm:.4} mm",
            state["index"],
            mean_distance_mm(&recorded, &settled),
        );
        drifts_mm.push((drift_mm, &state["index"]));
    }
    let mean = drifts_mm.iter().map(|(drift, _)| drift).sum::<f64>() / drifts_mm.len() as f64;
    println!("mean drift {mean:.4} mm, n {}", drifts_mm.len());
    for (drift_mm, index) in drifts_mm {
        assert!(drift_mm < MOST_DRIFT_MM, "state {index}: {drift_mm} mm");
    }
}

#[test]
#[ignore = "long"]
fn two_settled_recorded_heaps_stay_put() {
    settled_states_stay("two_settled_recorded_heaps_stay_put", 2);
}

#[test]
#[ignore = "long"]
fn all_settled_recorded_heaps_stay_put() {
    settled_states_stay("long_all_settled_recorded_heaps_stay_put", usize::MAX);
}
