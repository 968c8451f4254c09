use super::material;
use fab_sim::*;

fn minus(a: [f32; 3], b: [f32; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] as f64 - b[k] as f64)
}
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Edges that pierce triangles of which they have no corner.
pub fn crossings(grid: Grid, p: &[[f32; 3]]) -> usize {
    let triangles = mesh::triangles(&Mask::full(grid));
    let mut cells: std::collections::BTreeMap<[i32; 3], Vec<usize>> = Default::default();
    let side = 2.0 * grid.spacing_m;
    for (t, c) in triangles.iter().enumerate() {
        let lo = [0, 1, 2].map(|k| {
            (c.iter().map(|&i| p[i][k]).fold(f32::INFINITY, f32::min) / side).floor() as i32
        });
        let hi = [0, 1, 2].map(|k| {
            (c.iter().map(|&i| p[i][k]).fold(f32::NEG_INFINITY, f32::max) / side).floor() as i32
        });
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                for z in lo[2]..=hi[2] {
                    cells.entry([x, y, z]).or_default().push(t);
                }
            }
        }
    }
    let mut count = 0;
    for i in 0..p.len() {
        for o in [1, grid.dimx] {
            if o == 1 && i % grid.dimx + 1 == grid.dimx || i + o >= p.len() {
                continue;
            }
            let j = i + o;
            let lo = [0, 1, 2].map(|k| (p[i][k].min(p[j][k]) / side).floor() as i32);
            let hi = [0, 1, 2].map(|k| (p[i][k].max(p[j][k]) / side).floor() as i32);
            let mut near = std::collections::BTreeSet::new();
            for x in lo[0]..=hi[0] {
                for y in lo[1]..=hi[1] {
                    for z in lo[2]..=hi[2] {
                        if let Some(c) = cells.get(&[x, y, z]) {
                            near.extend(c.iter().copied());
                        }
                    }
                }
            }
            for t in near {
                let [a, b, c] = triangles[t];
                if [a, b, c].contains(&i) || [a, b, c].contains(&j) {
                    continue;
                }
                let d = minus(p[j], p[i]);
                let (e1, e2) = (minus(p[b], p[a]), minus(p[c], p[a]));
                let h = cross(d, e2);
                let det = dot(e1, h);
                if det.abs() < 1e-18 {
                    continue;
                }
                let s = minus(p[i], p[a]);
                let u = dot(s, h) / det;
                let q = cross(s, e1);
                let v = dot(d, q) / det;
                let w = dot(e2, q) / det;
                if u > 0.0 && v > 0.0 && u + v < 1.0 && w > 0.0 && w < 1.0 {
                    count += 1;
                }
            }
        }
    }
    count
}

fn height_profile(p: &[[f32; 3]]) -> String {
    let mut z: Vec<f32> = p.iter().map(|p| p[2] * 1e3).collect();
    z.sort_by(f32::total_cmp);
    let n = z.len();
    format!(
        "z mm min {:.2} 25% {:.2} med {:.2} 75% {:.2} 95% {:.2} max {:.2}",
        z[0],
        z[n / 4],
        z[n / 2],
        z[3 * n / 4],
        z[n * 95 / 100],
        z[n - 1]
    )
}
pub fn stretch(grid: Grid, p: &[[f32; 3]]) -> (f32, f32) {
    let mut worst: f32 = 0.0;
    let mut least: f32 = 0.0;
    for i in 0..p.len() {
        for o in [1, grid.dimx] {
            if o == 1 && i % grid.dimx + 1 == grid.dimx || i + o >= p.len() {
                continue;
            }
            let d = (0..3)
                .map(|a| (p[i][a] - p[i + o][a]).powi(2))
                .sum::<f32>()
                .sqrt()
                / grid.spacing_m
                - 1.0;
            worst = worst.max(d);
            least = least.min(d);
        }
    }
    (least, worst)
}
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
    let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    (f[11].parse::<f64>().unwrap() + f[12].parse::<f64>().unwrap()) * 0.01
}
fn far(a: &[[f32; 3]], b: &[[f32; 3]]) -> (f32, usize) {
    let d = a
        .iter()
        .zip(b)
        .map(|(p, q)| (0..3).map(|a| (p[a] - q[a]).powi(2)).sum::<f32>().sqrt());
    d.enumerate()
        .fold((0.0, 0), |m, (i, d)| if d > m.0 { (d, i) } else { m })
}

fn run(name: &str, params: &Params, n: usize) {
    let grid = Grid::new(n, n, 0.00625).unwrap();
    let began = cpu();
    let mut cloth = diagonal_fold(grid, params, &|| false).unwrap();
    let steps = cloth.steps();
    println!(
        "{name}: fold {:.3} ms cpu per step; {}; stretch {:?} crossings {}",
        1e3 * (cpu() - began) / steps as f64,
        height_profile(&cloth.positions()),
        stretch(grid, &cloth.positions()),
        crossings(grid, &cloth.positions())
    );
    let before = cloth.positions();
    let taken = cloth.settle(400).unwrap();
    println!(
        "  settles in {taken} more steps, moving {:?}; {}",
        far(&before, &cloth.positions()),
        height_profile(&cloth.positions())
    );
    let mut cloth = Simulator::flat(grid, params);
    let flat = cloth.positions();
    let a = flat[0];
    for mm in [40.0f32, 60.0, 80.0] {
        let mut cloth = Simulator::flat(grid, params);
        let s = 0.001 * mm / 2f32.sqrt();
        cloth
            .pick_and_place([a[0], a[1]], [a[0] + s, a[1] - s], &|| false)
            .unwrap();
        let t = cloth.settle(300).unwrap();
        let e = cloth.positions()[0];
        let before = cloth.positions();
        if t == 300 {
            for _ in 0..20 {
                cloth.step().unwrap();
            }
        }
        let (d, i) = far(&before, &cloth.positions());
        println!(
            "  corner carried {mm}: ends at {:.1} mm, z {:.1}, settle {t}, crossings {}, still {d} at {i} {:?}",
            1e3 * ((e[0] - a[0]).powi(2) + (e[1] - a[1]).powi(2)).sqrt(),
            1e3 * e[2],
            crossings(grid, &cloth.positions()),
            cloth.positions()[i]
        );
    }
    for seed in [3, 4] {
        let began = cpu();
        let done = cloth.crumple(seed, &|| false).unwrap();
        println!(
            "  crumple {:.3} ms cpu per step, {} steps; {}; stretch {:?} crossings {}",
            1e3 * (cpu() - began) / done.steps as f64,
            done.steps,
            height_profile(&cloth.positions()),
            stretch(grid, &cloth.positions()),
            crossings(grid, &cloth.positions())
        );
    }
}

#[test]
fn trace() {
    let n = 30;
    let grid = Grid::new(n, n, 0.00625).unwrap();
    for (rise, gap) in [(0.02f32, 0.001f32), (0.005, 0.001), (0.02, 0.003)] {
        let mut m = material(15.0);
        m.thickness_m = gap;
        let params = Params {
            material: Some(m),
            ..Params::default()
        };
        let mut cloth = Simulator::flat(grid, &params);
        cloth.hold(&[11 * 30 + 8]).unwrap();
        let up = (0.6 / rise) as usize;
        let mut k = 0;
        let mut tell = |cloth: &Simulator, what: &str| {
            k += 1;
            if k % 10 == 0 {
                println!(
                    "{rise} {what} {k}: crossings {} stretch {:?} top {:.3}",
                    crossings(grid, &cloth.positions()),
                    stretch(grid, &cloth.positions()),
                    cloth.positions().iter().map(|p| p[2]).fold(0.0, f32::max)
                );
            }
        };
        for _ in 0..up {
            cloth.step_held([0.0, 0.0, rise]).unwrap();
            tell(&cloth, "up");
        }
        for _ in 0..60 {
            cloth.step().unwrap();
            tell(&cloth, "hang");
        }
        cloth.hold(&[]).unwrap();
        for _ in 0..80 {
            cloth.step().unwrap();
            tell(&cloth, "fall");
        }
    }
}

#[test]
fn probe() {
    let n = std::env::var("N").map_or(30, |n| n.parse().unwrap());
    run("pyflex", &Params::default(), n);
    let mut soft = material(20.0);
    soft.thickness_m = 0.002;
    run(
        "c20 t2",
        &Params {
            material: Some(soft),
            ..Params::default()
        },
        n,
    );
    run(
        "c15 t1",
        &Params {
            material: Some(material(15.0)),
            ..Params::default()
        },
        n,
    );
    let mut stiff = material(32.0);
    stiff.weight_kg_m2 = 0.4;
    run(
        "c32",
        &Params {
            material: Some(stiff),
            ..Params::default()
        },
        n,
    );
}
