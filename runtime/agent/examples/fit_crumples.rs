//! Fits simulated heaps to pictures of crumpled cloths, and measures what the fits are worth.
//!
//! `cargo run -p fab-agent --example fit_crumples -- FIRST_SEED COUNT PULLS`
//!
//! In: seeds of crumpled starts of 42 by 42 particles. Each one is known by its picture with depth alone, and compared with all other
//! ones, mirrored or not, in all turns. Out: a table of how far the nearest heap is from the truth, and of how well heaps predict what
//! PULLS pulls of each start gain, drawn among those that the task offers and accepts. Without other work, 40 starts take some minutes.

use fab_agent::action::Action;
use fab_agent::scene::Scene;
use fab_base::cache::Cache;
use fab_base::chance::Chance;
use fab_base::interrupt::Interrupt;
use fab_base::parallel::in_parallel;
use fab_compiler::{LoadError, Loader};
use fab_picture::observation::Observation;
use fab_program::facts::Facts;
use fab_program::pointing::Pointing;
use fab_program::verify::{self, Strictness, Verdict};
use fab_program::{Program, Proposal};
use fab_world::start::Start;
use fab_world::{Grasp, Motion, SimulatedWorld, World, WorldPoint, crumple, metrics};
use std::collections::BTreeMap;
use std::error::Error;

type Failure = Box<dyn Error + Send + Sync>;
type Points = Vec<[f32; 3]>;

const TASK: &str = "tasks/smoothing.fab";
/// Particles along a side.
const SIDE: usize = 42;
/// Heaps whose predictions are averaged.
const NEAREST: usize = 3;
/// A pick farther from every particle of a heap than this is moved to the nearest one, metres.
const BESIDE_M: f32 = 0.004;

/// Side of a cell of the table, metres, and cells along a side.
const CELL_M: f32 = 0.004;
const CELLS: usize = 120;
/// Cells lower than this show the table, metres.
const TABLE_M: f32 = 0.001;
/// A difference of heights that counts in full, metres.
const HEIGHT_M: f32 = 0.02;
/// What heights and faces count beside a cell of cloth on which only one shows cloth.
const WEIGHT: f32 = 0.4;

/// A heap as seen from above: in each cell the height, 0 for the table, and whether the underside shows.
struct Relief(Vec<(f32, bool)>);

fn cell(at_m: f32) -> Option<usize> {
    let index = (at_m / CELL_M + CELLS as f32 / 2.0).floor();
    (0.0..CELLS as f32)
        .contains(&index)
        .then_some(index as usize)
}

fn middle_m(index: usize) -> f32 {
    (index as f32 + 0.5 - CELLS as f32 / 2.0) * CELL_M
}

impl Relief {
    /// Reads a picture with depth; cells of which less than half show cloth are table.
    fn seen(observation: &Observation) -> Relief {
        let mut cells = vec![[0.0_f32; 4]; CELLS * CELLS];
        for (column, row, depth) in observation.depth_m.enumerate_pixels() {
            let at = [f64::from(column) + 0.5, f64::from(row) + 0.5];
            let camera = &observation.camera;
            let point = camera.world_from_pixel(at, f64::from(depth.0[0]));
            let Some([x, y, z]) = point.map(|it| [it.x, it.y, it.z].map(|it| it as f32)) else {
                continue;
            };
            let (Some(cell_column), Some(cell_row)) = (cell(x), cell(y)) else {
                continue;
            };
            let [pixels, cloth, height, under] = &mut cells[cell_row * CELLS + cell_column];
            *pixels += 1.0;
            if z > TABLE_M {
                *cloth += 1.0;
                *height += z;
                let [red, _, blue] = observation.rgb.get_pixel(column, row).0;
                // The recorded cloth is orange above and pink below.
                *under += f32::from(u8::from(u16::from(blue) * 2 > u16::from(red)));
            }
        }
        let relief =
            cells.iter().map(
                |[pixels, cloth, height, under]| match cloth * 2.0 > *pixels {
                    true => (height / cloth, under * 2.0 > *cloth),
                    false => (0.0, false),
                },
            );
        Relief(relief.collect())
    }

    /// Looks at a heap from straight above.
    fn of(points: &[[f32; 3]], triangles: &[[usize; 3]]) -> Relief {
        let mut relief = vec![(0.0, false); CELLS * CELLS];
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| points[corner]);
            let twice_m2 = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            if twice_m2.abs() < 1e-12 {
                continue;
            }
            let range = |axis: usize| {
                let at = [a, b, c].map(|corner| corner[axis] / CELL_M + CELLS as f32 / 2.0 - 0.5);
                let low = at.into_iter().fold(f32::INFINITY, f32::min).ceil();
                let high = at.into_iter().fold(f32::NEG_INFINITY, f32::max) + 1.0;
                low.max(0.0) as usize..(high.max(0.0) as usize).min(CELLS)
            };
            for row in range(1) {
                for column in range(0) {
                    let (x, y) = (middle_m(column) - a[0], middle_m(row) - a[1]);
                    let to_b = (x * (c[1] - a[1]) - y * (c[0] - a[0])) / twice_m2;
                    let to_c = ((b[0] - a[0]) * y - (b[1] - a[1]) * x) / twice_m2;
                    let z = a[2] + to_b * (b[2] - a[2]) + to_c * (c[2] - a[2]);
                    let at = &mut relief[row * CELLS + column];
                    if to_b >= 0.0 && to_c >= 0.0 && to_b + to_c <= 1.0 && z > at.0 {
                        *at = (z, twice_m2 < 0.0);
                    }
                }
            }
        }
        Relief(relief)
    }

    /// Returns the centroid of the cells that show cloth, metres.
    fn center_m(&self) -> [f32; 2] {
        let cloth = self.0.iter().enumerate().filter(|(_, it)| it.0 > 0.0);
        let mut sum = [0.0; 3];
        for (index, _) in cloth {
            let at = [middle_m(index % CELLS), middle_m(index / CELLS), 1.0];
            (0..3).for_each(|axis| sum[axis] += at[axis]);
        }
        [sum[0], sum[1]].map(|it| it / f32::max(sum[2], 1.0))
    }

    /// Compares what both show.
    fn compared(&self, other: &Relief) -> Comparison {
        let (mut either, mut both, mut squares, mut faces, mut heights) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (a, b) in self.0.iter().zip(&other.0) {
            either += f32::from(u8::from(a.0 > 0.0 || b.0 > 0.0));
            if a.0 > 0.0 && b.0 > 0.0 {
                both += 1.0;
                squares += (a.0 - b.0).powi(2);
                heights += ((a.0 - b.0).abs() / HEIGHT_M).min(1.0);
                faces += f32::from(u8::from(a.1 != b.1));
            }
        }
        Comparison {
            difference: (either - both + WEIGHT * (heights + faces)) / either,
            overlap: f64::from(both / either),
            height_mm: f64::from((squares / both).sqrt()) * 1000.0,
        }
    }
}

/// How alike two heaps look.
struct Comparison {
    /// 0 if they are equal, 1 if they do not overlap.
    difference: f32,
    /// Intersection over union of the cells that show cloth.
    overlap: f64,
    /// Root mean square of the heights' difference where both show cloth.
    height_mm: f64,
}

/// Returns the heaps that look most like what a picture shows, the best one first, each laid where it does.
fn fitted(picture: &Observation, heaps: &[Points], triangles: &[[usize; 3]]) -> Vec<Points> {
    let seen = Relief::seen(picture);
    let mirrored = heaps.iter().map(|heap| {
        let point = |index: usize| {
            let [x, y, z] = heap[index / SIDE * SIDE + SIDE - 1 - index % SIDE];
            [-x, y, z]
        };
        (0..SIDE * SIDE).map(point).collect::<Points>()
    });
    let mut found: Vec<(f32, Points)> = Vec::new();
    for heap in heaps.iter().cloned().chain(mirrored) {
        let lay = |degrees: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let turned = heap
                .iter()
                .map(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, *z]);
            let laid = laid_on(&turned.collect::<Points>(), &seen, triangles);
            (
                Relief::of(&laid, triangles).compared(&seen).difference,
                degrees,
                laid,
            )
        };
        let best = |turns: &[f32]| {
            let all = turns.iter().map(|turn| lay(*turn));
            all.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let coarse: Vec<f32> = (0..24).map(|turn| turn as f32 * 15.0).collect();
        let about = best(&coarse).map_or(0.0, |it| it.1);
        let finer = [-8.0, -4.0, 0.0, 4.0, 8.0].map(|off| about + off);
        found.extend(best(&finer).map(|(difference, _, laid)| (difference, laid)));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, laid)| laid).collect()
}

/// Shifts a heap so that its silhouette has the same centroid as what is seen.
fn laid_on(heap: &[[f32; 3]], seen: &Relief, triangles: &[[usize; 3]]) -> Points {
    let [from, to] = [&Relief::of(heap, triangles), seen].map(Relief::center_m);
    let [right, back] = [to[0] - from[0], to[1] - from[1]];
    let shifted = heap.iter().map(|[x, y, z]| [x + right, y + back, *z]);
    shifted.collect()
}

/// What the starts share.
struct Bench {
    program: Program,
    triangles: Vec<[usize; 3]>,
    heaps: Vec<Start>,
}

impl Bench {
    /// Returns the coverage that a pull of a heap gains.
    fn gain(
        &self,
        heap: &[[f32; 3]],
        motion: &Motion,
        world: &mut SimulatedWorld,
    ) -> Result<f64, Failure> {
        let away = |[x, y, _]: &[f32; 3]| {
            let pick = [motion.pick.x, motion.pick.y].map(|at| at as f32);
            (x - pick[0]).hypot(y - pick[1])
        };
        let near = heap.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        let moved = near.filter(|it| away(it) > BESIDE_M).map(|it| {
            let [x, y, z] = it.map(f64::from);
            Motion::new(WorldPoint::new(x, y, z), motion.place)
        });
        world.reset(&Start {
            positions: heap.to_vec(),
            ..self.heaps[0].clone()
        })?;
        let executed = world.act(&moved.unwrap_or(*motion), &Interrupt::default())?;
        if executed.grasp == Grasp::Missed {
            return Ok(0.0);
        }
        let after = world.particles().ok_or("the world knows its cloth")?;
        Ok(self.coverage(&after)? - self.coverage(heap)?)
    }

    fn coverage(&self, points: &[[f32; 3]]) -> Result<f64, Failure> {
        let area_m2 = metrics::whole_area_m2(&self.heaps[0].grid);
        let coverage = metrics::true_coverage(points, &self.triangles, area_m2);
        Ok(coverage.ok_or("a coverage that is a number")?)
    }

    /// Returns the mean distance of equal particles, millimetres, for the best of the cloth's four turns.
    fn distance_mm(&self, a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
        let turned = |turns: usize| {
            let point = |index: usize| {
                let turn = |[i, j]: [usize; 2], _| [j, SIDE - 1 - i];
                let [i, j] = (0..turns).fold([index % SIDE, index / SIDE], turn);
                b[j * SIDE + i]
            };
            let turned: Points = (0..SIDE * SIDE).map(point).collect();
            metrics::mean_particle_distance_m(a, &turned).unwrap_or(f64::INFINITY)
        };
        (0..4).map(turned).fold(f64::INFINITY, f64::min) * 1000.0
    }

    /// Fits a start, and returns a line per pull.
    fn measure(&self, index: usize, first: u64, pulls: usize) -> Result<Vec<Line>, Failure> {
        let mut world = SimulatedWorld::of(&self.program)?;
        let start = &self.heaps[index];
        let others = self.heaps.iter().enumerate().filter(|(it, _)| *it != index);
        let heaps: Vec<Points> = others.map(|(_, it)| it.positions.clone()).collect();
        world.reset(start)?;
        let picture = world.observe()?;
        let scene = Scene::of(&self.program, &picture, None)?;
        let mut chance = Chance::seeded(first + index as u64);
        let motions = accepted(&self.program, &scene, &picture, pulls, &mut chance);
        let fits = fitted(&picture, &heaps, &self.triangles);
        let any = &heaps[chance.below(heaps.len())];
        let any = laid_on(any, &Relief::seen(&picture), &self.triangles);
        let truth = Relief::of(&start.positions, &self.triangles);
        let seen = Relief::of(&fits[0], &self.triangles).compared(&truth);
        let fit = [
            self.distance_mm(&start.positions, &fits[0]),
            self.distance_mm(&start.positions, &any),
            seen.overlap,
            seen.height_mm,
        ];
        let lines = motions.iter().map(|motion| {
            let mut gain = |heap: &[[f32; 3]]| self.gain(heap, motion, &mut world);
            let nearest = fits.iter().take(NEAREST).map(|it| gain(it));
            let nearest: Vec<f64> = nearest.collect::<Result<_, Failure>>()?;
            Ok(Line {
                fit,
                truth: gain(&start.positions)?,
                predicted: [
                    0.0,
                    f64::NAN, // known when all starts are measured
                    gain(&any)?,
                    nearest[0],
                    nearest.iter().sum::<f64>() / nearest.len() as f64,
                ],
            })
        });
        lines.collect()
    }
}

/// Predictions of a pull's gain.
const PREDICTIONS: [&str; 5] = [
    "no change",
    "the other starts' mean gain",
    "any heap",
    "the nearest heap",
    "the mean of the nearest heaps",
];

/// A pull of a start.
struct Line {
    /// Distance of the nearest heap's particles and of any heap's, mm; the nearest one's overlap, and error of its heights, mm.
    fit: [f64; 4],
    /// The coverage gained.
    truth: f64,
    /// By [`PREDICTIONS`].
    predicted: [f64; PREDICTIONS.len()],
}

/// Draws some of the pulls that the task offers and accepts.
fn accepted(
    program: &Program,
    scene: &Scene,
    picture: &Observation,
    count: usize,
    chance: &mut Chance,
) -> Vec<Motion> {
    let texts = BTreeMap::new();
    let facts = Facts {
        scene,
        texts: &texts,
        step: 1,
        last: None,
        proposal: None,
        pointing: Pointing::of_camera(&program.camera),
    };
    let mut proposals = vec![Proposal { fields: Vec::new() }];
    for field in &program.actions {
        let offered = verify::offered(program, scene, &field.name);
        let with = |proposal: &Proposal| {
            let longer = offered.iter().map(|value| {
                let mut longer = proposal.clone();
                longer.fields.push((field.name.clone(), value.clone()));
                longer
            });
            longer.collect::<Vec<_>>()
        };
        proposals = proposals.iter().flat_map(with).collect();
    }
    proposals.retain(|it| {
        matches!(
            verify::verdict(program, facts, it, Strictness::Full),
            Ok(Verdict::Accept)
        )
    });
    let drawn = (0..count.min(proposals.len()))
        .map(|_| proposals.swap_remove(chance.below(proposals.len())));
    let motion = |it: Proposal| Some(Action::lower(program, &it, scene, picture)?.motion);
    drawn.filter_map(motion).collect()
}

/// The working directory's files.
struct Here;

impl Loader for Here {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        std::fs::read_to_string(name).map_err(|error| LoadError {
            message: format!("{name}: {error}"),
        })
    }
}

fn main() -> Result<(), Failure> {
    let numbers: Result<Vec<u64>, _> = std::env::args().skip(1).map(|it| it.parse()).collect();
    let [first, count, pulls] = numbers?[..] else {
        return Err("give FIRST_SEED COUNT PULLS".into());
    };
    if count <= NEAREST as u64 {
        return Err(format!("`{count}` starts are too few: each needs {NEAREST} others").into());
    }
    let compiled = fab_compiler::compile_for(TASK, &Here, Some([SIDE as u32; 2]))?;
    let mut programs = compiled.programs.into_iter();
    let program = programs.find(|program| program.variant.is_none());
    let program = program.ok_or("the task does not compile")?;
    let flat = Start::flat(&program.cloth);
    let world = SimulatedWorld::of(&program)?;
    let (count, threads) = (count as usize, std::thread::available_parallelism()?.get());
    let heap = |index: usize| {
        let seed = first + index as u64;
        let (cache, interrupt) = (Cache::none(), Interrupt::default());
        let heap = crumple::start(&flat, seed, &world, &cache, &interrupt, &mut || {})?;
        Ok::<_, Failure>(Some(heap.start))
    };
    let heaps = in_parallel(count, threads, heap, |_| {})?;
    let bench = Bench {
        triangles: metrics::whole_triangles(&flat.grid),
        program,
        heaps: heaps.into_iter().flatten().collect(),
    };
    let measured = in_parallel(
        count,
        threads,
        |index| bench.measure(index, first, pulls as usize).map(Some),
        |_| {},
    )?;
    let mut starts: Vec<Vec<Line>> = measured.into_iter().flatten().collect();
    starts.retain(|lines| !lines.is_empty());
    let gains: Vec<f64> = starts.iter().map(|lines| mean_gain(lines)).collect();
    let all: f64 = gains.iter().sum();
    for (lines, gain) in starts.iter_mut().zip(&gains) {
        let others = (all - gain) / gains.len().saturating_sub(1).max(1) as f64;
        lines.iter_mut().for_each(|line| line.predicted[1] = others);
    }
    print(&starts);
    Ok(())
}

/// Prints means over starts with their 95 % intervals.
fn print(starts: &[Vec<Line>]) {
    let show = |name: &str, value: &dyn Fn(&[Line]) -> f64| {
        let values: Vec<f64> = starts.iter().map(|lines| value(lines)).collect();
        let mut chance = Chance::seeded(0);
        let mut means: Vec<f64> = (0..2000)
            .map(|_| mean(values.iter().map(|_| values[chance.below(values.len())])))
            .collect();
        means.sort_by(f64::total_cmp);
        let [low, high] = [50, 1949].map(|at| means[at]);
        println!(
            "| {name} | {:.4} [{low:.4}, {high:.4}] |",
            mean(values.into_iter())
        );
    };
    println!("{} starts", starts.len());
    show("distance of the nearest heap, mm", &|it| it[0].fit[0]);
    show("distance of any heap, mm", &|it| it[0].fit[1]);
    show("overlap", &|it| it[0].fit[2]);
    show("error of heights, mm", &|it| it[0].fit[3]);
    show("gain", &mean_gain);
    let error = |lines: &[Line], number: usize| {
        let errors = lines
            .iter()
            .map(|it| (it.predicted[number] - it.truth).abs());
        mean(errors)
    };
    for (number, name) in PREDICTIONS.iter().enumerate() {
        show(&format!("error of {name}"), &|it| error(it, number));
        let more = format!("more than no change: {name}");
        show(&more, &|it| error(it, number) - error(it, 0));
        show(&format!("gain of the pull chosen by {name}"), &|it| {
            let best =
                (it.iter()).max_by(|a, b| a.predicted[number].total_cmp(&b.predicted[number]));
            best.map_or(0.0, |line| line.truth)
        });
    }
}

fn mean_gain(lines: &[Line]) -> f64 {
    mean(lines.iter().map(|line| line.truth))
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.sum::<f64>() / count
}
