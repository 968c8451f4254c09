//! scratch
#[path = "../tests/recorded/mod.rs"]
mod recorded;
use sim::{Params, RestShortcut};
fn main() {
    let demos = recorded::demonstrations("dump").unwrap();
    let mut values = serde_json::to_value(Params::default()).unwrap();
    let mut wanted = vec![];
    for a in std::env::args().skip(1) {
        if let Some((n, v)) = a.split_once('=') { values[n] = serde_json::from_str(v).unwrap(); } else { wanted.push(a); }
    }
    let params: Params = serde_json::from_value(values).unwrap();
    for d in demos.iter().filter(|d| wanted.contains(&format!("{}/{:02}", d.task, d.id))) {
        let mut cloth = sim::Simulator::from_positions(d.grid, &d.start, &params).unwrap();
        cloth.set_rest_shortcut(RestShortcut::Skip);
        for (k, &(p, q)) in d.actions.iter().enumerate() {
            let g = cloth.pick_and_place(p, q, &|| false).unwrap().grasped;
            let bytes: Vec<u8> = cloth.positions().iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
            std::fs::write(format!("/tmp/dump/{}_{:02}_{}.bin", d.task, d.id, k), bytes).unwrap();
            println!("{} {} step {k} grasped {g:?} recorded {}", d.task, d.id, d.picked[k]);
        }
    }
}
