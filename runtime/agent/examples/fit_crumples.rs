//! Fits simulated heaps to pictures of crumpled cloths, and says what the fits are worth.

use fab_agent::action::Action;
use fab_agent::scene::Scene;
use fab_base::cache::Cache;
use fab_base::chance::Chance;
use fab_base::interrupt::Interrupt;
use fab_compiler::{LoadError, Loader};
use fab_picture::observation::Observation;
use fab_program::facts::Facts;
use fab_program::verify::{self, Strictness, Verdict};
use fab_program::pointing::Pointing;
use fab_program::{Program, Proposal};
use fab_sim::{Aim, Grid, Params, Simulator};
use fab_world::start::Start;
use fab_world::{Motion, SimulatedWorld, World, crumple, metrics};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::PathBuf;

type Failure = Box<dyn Error + Send + Sync>;
type Points = Vec<[f32; 3]>;

const TASK: &str = "tasks/smoothing.fab";
const FIRST_START: u64 = 700;
const FIRST_OF_BANK: u64 = 10_000;

const CELL_M: f32 = 0.004;
const CELLS: usize = 120;
const HALF_M: f32 = CELL_M * CELLS as f32 / 2.0;

/// What a camera above sees of a heap.
#[derive(Clone)]
struct Relief {
    height: Vec<f32>,
    under: Vec<bool>,
}

fn cell(at: f32) -> Option<usize> {
    let index = ((at + HALF_M) / CELL_M).floor();
    (0.0..CELLS as f32).contains(&index).then_some(index as usize)
}
fn middle(index: usize) -> f32 {
    (index as f32 + 0.5) * CELL_M - HALF_M
}

impl Relief {
    fn empty() -> Relief {
        Relief { height: vec![0.0; CELLS * CELLS], under: vec![false; CELLS * CELLS] }
    }

    fn seen(observation: &Observation) -> Relief {
        let mut relief = Relief::empty();
        let (mut sum, mut pink, mut count) = (
            vec![0f32; CELLS * CELLS],
            vec![0u32; CELLS * CELLS],
            vec![0u32; CELLS * CELLS],
        );
        let mut all = vec![0u32; CELLS * CELLS];
        for (column, row, depth) in observation.depth_m.enumerate_pixels() {
            let at = [f64::from(column) + 0.5, f64::from(row) + 0.5];
            let Some(point) = observation.camera.world_from_pixel(at, f64::from(depth.0[0])) else {
                continue;
            };
            let (Some(x), Some(y)) = (cell(point.x as f32), cell(point.y as f32)) else { continue };
            let index = y * CELLS + x;
            all[index] += 1;
            if point.z > 0.001 {
                let [red, _, blue] = observation.rgb.get_pixel(column, row).0;
                sum[index] += point.z as f32;
                count[index] += 1;
                pink[index] += u32::from(2 * u32::from(blue) > u32::from(red));
            }
        }
        for index in 0..CELLS * CELLS {
            if count[index] * 2 > all[index] {
                relief.height[index] = sum[index] / count[index] as f32;
                relief.under[index] = pink[index] * 2 > count[index];
            }
        }
        relief
    }

    fn of(points: &[[f32; 3]], triangles: &[[usize; 3]]) -> Relief {
        let mut relief = Relief::empty();
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| points[corner]);
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            if area.abs() < 1e-12 {
                continue;
            }
            let range = |axis: usize| {
                let low = a[axis].min(b[axis]).min(c[axis]);
                let high = a[axis].max(b[axis]).max(c[axis]);
                let from = ((low + HALF_M) / CELL_M - 0.5).ceil().max(0.0) as usize;
                let to = ((high + HALF_M) / CELL_M - 0.5).floor().min(CELLS as f32 - 1.0);
                (from, to)
            };
            let ((x0, x1), (y0, y1)) = (range(0), range(1));
            if x1 < 0.0 || y1 < 0.0 {
                continue;
            }
            for row in y0..=y1 as usize {
                for column in x0..=x1 as usize {
                    let (x, y) = (middle(column), middle(row));
                    let u = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
                    let v = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
                    if u < 0.0 || v < 0.0 || u + v > 1.0 {
                        continue;
                    }
                    let z = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]);
                    let index = row * CELLS + column;
                    if z > relief.height[index] {
                        relief.height[index] = z;
                        relief.under[index] = area < 0.0;
                    }
                }
            }
        }
        relief
    }

    fn centre(&self) -> [f32; 2] {
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        for index in (0..CELLS * CELLS).filter(|&index| self.height[index] > 0.0) {
            sum[0] += middle(index % CELLS);
            sum[1] += middle(index / CELLS);
            count += 1.0;
        }
        sum.map(|it| it / f32::max(count, 1.0))
    }

    /// 0 to 1.
    fn differs(&self, other: &Relief) -> f32 {
        let (mut sum, mut either) = (0.0, 0.0);
        for index in 0..CELLS * CELLS {
            let (a, b) = (self.height[index], other.height[index]);
            if a == 0.0 && b == 0.0 {
                continue;
            }
            either += 1.0;
            sum += if a == 0.0 || b == 0.0 {
                1.0
            } else {
                0.4 * ((a - b).abs() / 0.02).min(1.0)
                    + 0.4 * f32::from(u8::from(self.under[index] != other.under[index]))
            };
        }
        sum / f32::max(either, 1.0)
    }

    /// Intersection over union; root mean square of heights where both have cloth, metres; share of equal faces there.
    fn agreement(&self, other: &Relief) -> [f64; 3] {
        let (mut both, mut either, mut squares, mut same) = (0.0, 0.0, 0.0, 0.0);
        for index in 0..CELLS * CELLS {
            let (a, b) = (self.height[index], other.height[index]);
            if a > 0.0 || b > 0.0 {
                either += 1.0;
            }
            if a > 0.0 && b > 0.0 {
                both += 1.0;
                squares += f64::from(a - b).powi(2);
                same += f64::from(u8::from(self.under[index] == other.under[index]));
            }
        }
        [both / either, (squares / both).sqrt(), same / both]
    }
}

struct Cloth {
    grid: Grid,
    side: usize,
    triangles: Vec<[usize; 3]>,
    area_m2: f64,
}

impl Cloth {
    fn mirrored(&self, points: &[[f32; 3]]) -> Points {
        let side = self.side;
        (0..side * side)
            .map(|index| {
                let [x, y, z] = points[index / side * side + side - 1 - index % side];
                [-x, y, z]
            })
            .collect()
    }
    fn coverage(&self, points: &[[f32; 3]]) -> f64 {
        metrics::true_coverage(points, &self.triangles, self.area_m2).unwrap_or(0.0)
    }
    /// Mean distance of particles over the best of the eight symmetries (faces up: four turns), metres.
    fn distance_m(&self, a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
        let side = self.side;
        let turned = |turns: usize, index: usize| {
            let (mut i, mut j) = (index % side, index / side);
            for _ in 0..turns {
                (i, j) = (j, side - 1 - i);
            }
            j * side + i
        };
        (0..4)
            .map(|turns| {
                let permuted: Points = (0..side * side).map(|it| b[turned(turns, it)]).collect();
                metrics::mean_particle_distance_m(a, &permuted).unwrap_or(f64::INFINITY)
            })
            .fold(f64::INFINITY, f64::min)
    }
}

fn turned(points: &[[f32; 3]], angle: f32) -> Points {
    let (sin, cos) = angle.sin_cos();
    points.iter().map(|&[x, y, z]| [cos * x - sin * y, sin * x + cos * y, z]).collect()
}
fn shifted(points: &mut [[f32; 3]], by: [f32; 2]) {
    for point in points {
        point[0] += by[0];
        point[1] += by[1];
    }
}

/// The best heaps of the bank, laid as they fit the relief best.
fn nearest(target: &Relief, bank: &[Points], cloth: &Cloth, count: usize) -> Vec<(f32, Points)> {
    let centre = target.centre();
    let lay = |points: &[[f32; 3]], degrees: f32| {
        let mut laid = turned(points, degrees.to_radians());
        let from = Relief::of(&laid, &cloth.triangles).centre();
        shifted(&mut laid, [centre[0] - from[0], centre[1] - from[1]]);
        let score = Relief::of(&laid, &cloth.triangles).differs(target);
        (score, laid)
    };
    let mut found: Vec<(f32, Points)> = Vec::new();
    for heap in bank {
        for points in [heap.clone(), cloth.mirrored(heap)] {
            let best = (0..24)
                .map(|turn| (lay(&points, turn as f32 * 15.0).0, turn as f32 * 15.0))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let (_, about) = best.expect("24 turns");
            let finer = [-8.0, -4.0, 0.0, 4.0, 8.0].map(|off| lay(&points, about + off));
            let best = finer.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
            found.push(best.expect("5 turns"));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(count);
    found
}

struct Guide {
    steps: usize,
    gain: f32,
    reach_m: f32,
}

/// Pulls a heap towards what is seen.
fn guided(points: &[[f32; 3]], target: &Relief, cloth: &Cloth, params: &Params, guide: &Guide) -> Option<Points> {
    let mut sim = Simulator::from_positions(cloth.grid, points, params).ok()?;
    let seen: Vec<([f32; 3], bool)> = (0..CELLS * CELLS)
        .filter(|&index| target.height[index] > 0.0)
        .map(|index| {
            let at = [middle(index % CELLS), middle(index / CELLS), target.height[index]];
            (at, target.under[index])
        })
        .collect();
    let side = cloth.side;
    let count = side * side;
    let mut field = vec![[0f32; 3]; count];
    for step in 0..guide.steps {
        if step % 4 == 0 {
            let now = sim.positions();
            let relief = Relief::of(&now, &cloth.triangles);
            let visible: Vec<Option<bool>> = now
                .iter()
                .map(|p| {
                    let index = cell(p[1])? * CELLS + cell(p[0])?;
                    (p[2] > relief.height[index] - 0.002).then_some(relief.under[index])
                })
                .collect();
            let mut sum = vec![[0f32; 3]; count];
            let mut weight = vec![0f32; count];
            let cost = |p: [f32; 3], t: [f32; 3], differs: bool| {
                let d = [t[0] - p[0], t[1] - p[1], t[2] - p[2]];
                d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + if differs { 0.012f32.powi(2) } else { 0.0 }
            };
            let reach = guide.reach_m.powi(2);
            for index in 0..count {
                let p = now[index];
                let near = match visible[index] {
                    Some(under) => seen
                        .iter()
                        .map(|(t, u)| (cost(p, *t, *u != under), *t))
                        .min_by(|a, b| a.0.total_cmp(&b.0)),
                    None => {
                        let inside = cell(p[1]).zip(cell(p[0])).is_some_and(|(y, x)| target.height[y * CELLS + x] > 0.0);
                        if inside {
                            None
                        } else {
                            seen.iter()
                                .map(|(t, _)| (cost([p[0], p[1], 0.0], [t[0], t[1], 0.0], false), [t[0], t[1], p[2]]))
                                .min_by(|a, b| a.0.total_cmp(&b.0))
                        }
                    }
                };
                if let Some((far, t)) = near.filter(|(far, _)| *far < reach) {
                    let _ = far;
                    for axis in 0..3 {
                        sum[index][axis] += t[axis] - p[axis];
                    }
                    weight[index] += 1.0;
                }
            }
            for (t, u) in &seen {
                let near = (0..count)
                    .filter_map(|index| Some((cost(now[index], *t, visible[index]? != *u), index)))
                    .min_by(|a, b| a.0.total_cmp(&b.0));
                if let Some((_, index)) = near.filter(|(far, _)| *far < reach) {
                    for axis in 0..3 {
                        sum[index][axis] += t[axis] - now[index][axis];
                    }
                    weight[index] += 1.0;
                }
            }
            let wanted = sum.clone();
            field = vec![[0f32; 3]; count];
            for _ in 0..12 {
                let before = field.clone();
                for index in 0..count {
                    let (i, j) = (index % side, index / side);
                    let mut total = wanted[index];
                    let mut all = weight[index];
                    let mut add = |other: usize| {
                        for axis in 0..3 {
                            total[axis] += 0.5 * before[other][axis];
                        }
                        all += 0.5;
                    };
                    if i > 0 { add(index - 1) }
                    if i + 1 < side { add(index + 1) }
                    if j > 0 { add(index - side) }
                    if j + 1 < side { add(index + side) }
                    field[index] = total.map(|it| it / all);
                }
            }
        }
        let velocities: Points = field
            .iter()
            .map(|d| {
                let v = d.map(|it| it * guide.gain);
                let fast = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
                v.map(|it| it * (0.4 / fast.max(0.4)))
            })
            .collect();
        sim.set_velocities(&velocities).ok()?;
        sim.step().ok()?;
    }
    for _ in 0..3 {
        sim = Simulator::from_positions(cloth.grid, &sim.positions(), params).ok()?;
        sim.settle(20).ok()?;
    }
    Some(sim.positions())
}

struct Here;
impl Loader for Here {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        std::fs::read_to_string(name).map_err(|error| LoadError { message: format!("{name}: {error}") })
    }
}

/// Pulls that the task offers and accepts.
fn pulls(program: &Program, scene: &Scene, observation: &Observation, chance: &mut Chance, count: usize) -> Vec<Motion> {
    let offered = |field: &str| verify::offered(program, scene, field);
    let texts = BTreeMap::new();
    let facts = Facts {
        scene,
        texts: &texts,
        step: 1,
        last: None,
        proposal: None,
        pointing: Pointing::of_camera(&program.camera),
    };
    let mut all = Vec::new();
    for pick in offered("pick") {
        for direction in offered("direction") {
            for distance in offered("distance") {
                let value = |name: &str| match name {
                    "pick" => pick.clone(),
                    "direction" => direction.clone(),
                    _ => distance.clone(),
                };
                let fields = program.actions.iter().map(|it| (it.name.clone(), value(&it.name)));
                let proposal = Proposal { fields: fields.collect() };
                if let Ok(Verdict::Accept) = verify::verdict(program, facts, &proposal, Strictness::Full)
                    && let Some(action) = Action::lower(program, &proposal, scene, observation)
                {
                    all.push(action.motion);
                }
            }
        }
    }
    (0..count.min(all.len())).map(|_| all.swap_remove(chance.below(all.len()))).collect()
}

fn pulled(points: &[[f32; 3]], motion: &Motion, cloth: &Cloth, params: &Params) -> Option<(Points, bool)> {
    let mut sim = Simulator::from_positions(cloth.grid, points, params).ok()?;
    sim.set_aim(Aim::Uppermost);
    let [mut pick, place] = [&motion.pick, &motion.place].map(|it| [it.x as f32, it.y as f32]);
    let far = |p: &[f32; 3]| (p[0] - pick[0]).hypot(p[1] - pick[1]);
    let near = points.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
    if far(near) > 0.004 {
        pick = [near[0], near[1]];
    }
    let done = sim.pick_and_place(pick, place, &|| false).ok()?;
    Some((sim.positions(), done.grasped.is_some()))
}

fn main() -> Result<(), Failure> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<usize> = words.iter().take(6).map(|it| it.parse()).collect::<Result<_, _>>()?;
    let [first, starts, from, heaps, n_pulls, twins] = numbers[..] else {
        return Err("give FIRST STARTS FROM HEAPS PULLS TWINS FOLDER".into());
    };
    let folder = PathBuf::from(&words[6]);
    let cache = Cache::at(folder.join("heaps"));
    let compiled = fab_compiler::compile_for(TASK, &Here, Some([42, 42]))?;
    let program = compiled.programs.into_iter().find(|it| it.variant.is_none()).ok_or("no program")?;
    let mut world = SimulatedWorld::of(&program)?;
    let params = Params::with_dropping_picker();
    let flat = Start::flat(&program.cloth);
    let cloth = Cloth {
        grid: Grid::new(42, 42, flat.grid.spacing_m as f32)?,
        side: 42,
        triangles: metrics::whole_triangles(&flat.grid),
        area_m2: metrics::whole_area_m2(&flat.grid),
    };
    let interrupt = Interrupt::default();
    let begun = std::time::Instant::now();
    let make = |seed: u64, world: &SimulatedWorld| -> Result<Start, Failure> {
        Ok(crumple::start(&flat, seed, world, &cache, &interrupt, &mut || {})?.start)
    };
    let bank: Vec<Points> = (from as u64..(from + heaps) as u64)
        .map(|index| Ok(make(FIRST_OF_BANK + index, &world)?.positions))
        .collect::<Result<_, Failure>>()?;
    eprintln!("bank {:?}", begun.elapsed());
    println!("start,kind,rank,score,distance_mm,iou,rmse_mm,faces,cover_err,before,pull,truth_gain,gain,grasped");
    for number in first as u64..(first + starts) as u64 {
        let start = make(FIRST_START + number, &world)?;
        world.reset(&start)?;
        let observation = world.observe()?;
        let scene = Scene::of(&program, &observation, None)?;
        let truth = Relief::of(&start.positions, &cloth.triangles);
        let target = Relief::seen(&observation);
        let mut chance = Chance::seeded(number);
        let motions = pulls(&program, &scene, &observation, &mut chance, n_pulls);
        if n_pulls == 0 { continue }
        let t0 = std::time::Instant::now();
        let found = nearest(&target, &bank, &cloth, twins);
        let t1 = std::time::Instant::now();
        let guide = Guide { steps: 80, gain: 8.0, reach_m: 0.03 };
        let mut fits: Vec<(&str, usize, Points)> = Vec::new();
        fits.push(("random", 0, {
            let mut laid = bank[number as usize % bank.len()].clone();
            let (from, to) = (Relief::of(&laid, &cloth.triangles).centre(), target.centre());
            shifted(&mut laid, [to[0] - from[0], to[1] - from[1]]);
            laid
        }));
        for (rank, (_, points)) in found.iter().enumerate() {
            fits.push(("bank", rank, points.clone()));
            match guided(points, &target, &cloth, &params, &guide) {
                Some(better) => fits.push(("guided", rank, better)),
                None => eprintln!("start {number} rank {rank}: cannot be guided"),
            }
        }
        eprintln!("start {number}: search {:?}, guide {:?}", t1 - t0, t1.elapsed());
        let before = cloth.coverage(&start.positions);
        let truths: Vec<f64> = motions
            .iter()
            .map(|motion| pulled(&start.positions, motion, &cloth, &params).map_or(0.0, |it| cloth.coverage(&it.0) - before))
            .collect();
        for (kind, rank, points) in &fits {
            let relief = Relief::of(points, &cloth.triangles);
            let score = relief.differs(&target);
            let [iou, rmse, faces] = relief.agreement(&truth);
            let distance = cloth.distance_m(&start.positions, points) * 1000.0;
            let own = cloth.coverage(points);
            for (pull, motion) in motions.iter().enumerate() {
                if *kind == "bank" && *rank > 0 { continue }
                let Some((end, grasped)) = pulled(points, motion, &cloth, &params) else {
                    eprintln!("start {number} {kind} {rank}: cannot be pulled");
                    continue;
                };
                let gain = cloth.coverage(&end) - own;
                println!(
                    "{number},{kind},{rank},{score:.4},{distance:.2},{iou:.4},{:.2},{faces:.3},{:.4},{before:.4},{pull},{:.5},{gain:.5},{grasped}",
                    rmse * 1000.0, own - before, truths[pull]
                );
            }
        }
    }
    Ok(())
}
