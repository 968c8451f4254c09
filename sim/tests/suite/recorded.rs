//! Reads recorded folding demonstrations for tests.
//!
//! In: the folder named by `FABC_REFERENCE_DATA`. Out: starts, actions and ends
//! in this crate's world frame; without the folder a test counts as skipped.
//! Recorded points are y-up: `world = (x, -z, y)`.

#[path = "../../../tests/recorded_data.rs"]
pub mod data;

use fab_sim::{Grid, Params, RestShortcut, Simulator};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// One recorded demonstration.
pub struct Demonstration {
    pub task: String,
    pub id: u64,
    pub folder: PathBuf,
    pub grid: Grid,
    pub start: Vec<[f32; 3]>,
    pub end: Vec<[f32; 3]>,
    /// Pick and place points of every step, table coordinates.
    pub actions: Vec<([f32; 2], [f32; 2])>,
}

/// Reads all demonstrations; `None` if the data is missing, and the test then counts as skipped.
pub fn demonstrations(test: &str) -> Option<Vec<Demonstration>> {
    data::recorded_data(test).map(|root| read_all(&root))
}

/// Simulates a demonstration from its recorded start; returns the cloth and the grasped particles.
pub fn replay(
    demo: &Demonstration,
    params: &Params,
    shortcut: RestShortcut,
) -> (Simulator, Vec<Option<usize>>) {
    let mut cloth = Simulator::from_positions(demo.grid, &demo.start, params).unwrap();
    cloth.set_rest_shortcut(shortcut);
    let grasped = demo
        .actions
        .iter()
        .map(|&(pick, place)| {
            cloth
                .pick_and_place(pick, place, &|| false)
                .unwrap()
                .grasped
        })
        .collect();
    (cloth, grasped)
}

/// Returns the mean distance between particles of the same index, millimetres.
pub fn mean_distance_mm(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let distance = |(p, q): (&[f32; 3], &[f32; 3])| {
        (0..3)
            .map(|axis| f64::from(p[axis] - q[axis]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    1000.0 * a.iter().zip(b).map(distance).sum::<f64>() / a.len() as f64
}

/// Reads all demonstrations in manifest order.
fn read_all(root: &Path) -> Vec<Demonstration> {
    let text = std::fs::read_to_string(root.join("folding120/manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    let entries = manifest["entries"].as_array().unwrap();
    entries.iter().map(|entry| read(root, entry)).collect()
}

fn read(root: &Path, entry: &Value) -> Demonstration {
    let whole = |name: &str| entry[name].as_u64().unwrap() as usize;
    let folder = root.join(entry["dir"].as_str().unwrap());
    let (dimx, dimy) = (whole("dimx"), whole("dimy"));
    let steps = entry["steps"].as_array().unwrap();
    let point = |value: &Value| {
        let coordinate = |axis: usize| value[axis].as_f64().unwrap() as f32;
        [coordinate(0), -coordinate(2)]
    };
    Demonstration {
        task: entry["task"].as_str().unwrap().to_owned(),
        id: entry["id"].as_u64().unwrap(),
        grid: Grid::new(dimx, dimy, entry["spacing_m"].as_f64().unwrap() as f32).unwrap(),
        start: read_points(&folder.join("init_pos.npy")),
        end: read_points(&folder.join("final_pos.npy")),
        actions: steps
            .iter()
            .map(|step| (point(&step["pick_world_m"]), point(&step["place_world_m"])))
            .collect(),
        folder,
    }
}

/// Reads a float32 `[n, 3]` array in NumPy's format 1.0 and turns it z-up.
pub fn read_points(path: &Path) -> Vec<[f32; 3]> {
    let bytes = std::fs::read(path).unwrap();
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let values: Vec<f32> = bytes[header..]
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    values
        .chunks_exact(3)
        .map(|p| [p[0], -p[2], p[1]])
        .collect()
}
