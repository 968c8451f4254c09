//! scratch
#[path = "../tests/recorded/mod.rs"]
mod recorded;
use sim::Params;
fn main() {
    let demos = recorded::demonstrations("probe").unwrap();
    let mut values = serde_json::to_value(Params::default()).unwrap();
    for a in std::env::args().skip(1) {
        if let Some((n, v)) = a.split_once('=') { values[n] = serde_json::from_str(v).unwrap(); }
    }
    let params: Params = serde_json::from_value(values).unwrap();
    for (task, act, next, kp) in [("CornersEdgesInward", 2usize, 3usize, 3usize), ("DoubleStraight", 0, 1, 2)] {
        let picked: Vec<_> = demos.iter().filter(|d| d.task == task && [0, 6, 10, 14, 18, 20, 26, 28, 32, 34].contains(&d.id)).collect();
        let idx = std::sync::atomic::AtomicUsize::new(0);
        let out = std::sync::Mutex::new(vec![]);
        std::thread::scope(|s| { for _ in 0..2 { s.spawn(|| loop {
            let i = idx.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            let Some(d) = picked.get(i) else { break };
            let mut cloth = sim::Simulator::from_positions(d.grid, &d.start, &params).unwrap();
            let (p, q) = d.actions[act];
            cloth.pick_and_place(p, q, &|| false).unwrap();
            let (dx, dy) = (d.grid.dimx, d.grid.dimy);
            let part = [0, dx * (dy - 1), dx - 1, dx * dy - 1][kp];
            let now = cloth.positions();
            let start = d.start[part];
            let rec = d.actions[next].0;
            // cloth frame
            let ax = [d.start[dx - 1][0] - d.start[0][0], d.start[dx - 1][1] - d.start[0][1]];
            let l = (ax[0] * ax[0] + ax[1] * ax[1]).sqrt();
            let ax = [ax[0] / l, ax[1] / l];
            let ay = [-ax[1], ax[0]];
            let f = |v: [f32; 2]| [1000. * (v[0] * ax[0] + v[1] * ax[1]), 1000. * (v[0] * ay[0] + v[1] * ay[1])];
            let ours = f([now[part][0] - start[0], now[part][1] - start[1]]);
            let recd = f([rec[0] - start[0], rec[1] - start[1]]);
            let over = f([now[[0, dx * (dy - 1)][usize::from(act == 2)]][0] - q[0], now[[0, dx * (dy - 1)][usize::from(act == 2)]][1] - q[1]]);
            out.lock().unwrap().push((ours, recd, over));
        }); } });
        let o = out.into_inner().unwrap();
        let n = o.len() as f32;
        let m = |g: &dyn Fn(&([f32; 2], [f32; 2], [f32; 2])) -> f32| o.iter().map(|v| g(v)).sum::<f32>() / n;
        print!("{} ours ({:.1},{:.1}) rec ({:.1},{:.1}) miss {:.1} placed ({:.1},{:.1})  ", &task[..2], m(&|v| v.0[0]), m(&|v| v.0[1]), m(&|v| v.1[0]), m(&|v| v.1[1]), m(&|v| ((v.0[0] - v.1[0]).powi(2) + (v.0[1] - v.1[1]).powi(2)).sqrt()), m(&|v| v.2[0]), m(&|v| v.2[1]));
    }
    println!();
}
