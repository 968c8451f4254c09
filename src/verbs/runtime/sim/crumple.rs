//! `fabc sim crumple`: starts for smoothing, by their seeds.
//!
//! The starts are the same as those of `fabc run --start SEED` with a crumpled cloth of the same size, and share its
//! cache. Cloths with an outline use that cache too, although `fabc run` does not support them.

use super::SPACING_M;
use super::files;
use super::parallel::{in_parallel, threads};
use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::verbs::runtime::setting;
use crate::verbs::runtime::sim::parallel::ThreadArguments;
use clap::Args;
use clap::ValueHint;
use fab_base::interrupt::Interrupt;
use fab_base::npy;
use fab_program::{self as program, Camera, ClothStart, ImageUp, Picker};
use fab_sim::{Mask, mesh};
use fab_world::start::Start;
use fab_world::{SimulatedWorld, WorldError};
use fab_world::{crumple, metrics};
use serde::Serialize;
use serde_json::{Value, json};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Arguments of `sim crumple`.
#[derive(Args)]
pub struct CrumpleArguments {
    /// Particles along each side of a square cloth, 6.25 mm apart; default: 40.
    #[arg(long, value_name = "N", conflicts_with = "dims")]
    pub size: Option<u32>,
    /// Particles along the two sides of a cloth that is not square.
    #[arg(long, value_name = "44x40")]
    pub dims: Option<String>,
    /// Which particles of the grid exist: rows of `#` and `.`, seen from above; its size is the cloth's.
    #[arg(long, value_name = "FILE.txt", value_hint = ValueHint::FilePath)]
    pub outline: Option<PathBuf>,
    /// The first cloth's seed; the others have the numbers after it.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    pub seed: u64,
    /// How many cloths are crumpled.
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub count: u32,
    /// The folder that gets positions (.npy) and what describes them (.json beside it).
    #[arg(short = 'o', long = "out", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub threads: ThreadArguments,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Marks a description as written by this verb, so that a later call may replace it.
const MADE_BY: &str = "fabc sim crumple";
/// Particles along each side if the command line does not say.
const DEFAULT_SIZE: u32 = 40;

/// The cloth to crumple.
struct Cloth {
    /// The flat cloth.
    flat: Start,
    /// Which particles of its grid exist.
    mask: Mask,
    /// The beginning of its file names, before `_SEED`.
    name: OsString,
}

/// One crumpled cloth.
#[derive(Serialize)]
struct Crumpled {
    seed: u64,
    /// The file of positions; `None` if no folder was named.
    file: Option<String>,
    /// Covered share of the flat cloth's area, with both measured as in SoftGym; may exceed 1.
    coverage: Option<f64>,
    /// Area of the table under the cloth, divided by the flat cloth's area; independent of rotation.
    true_coverage: Option<f64>,
    /// SHA-256 of grid and positions.
    digest: String,
}

/// Crumples, writes, and reports.
pub fn run(arguments: &CrumpleArguments, io: &Io) -> Result<Exit, Failure> {
    let cloth = cloth(arguments)?;
    let last = arguments.seed.checked_add(u64::from(arguments.count) - 1);
    if last.is_none() {
        return Err(Failure::usage(format!(
            "`--seed {}` and `--count {}` go beyond the largest seed, {}",
            arguments.seed,
            arguments.count,
            u64::MAX
        )));
    }
    let seeds: Vec<u64> = (0..u64::from(arguments.count))
        .map(|number| arguments.seed + number)
        .collect();
    if let Some(folder) = &arguments.out {
        prepare(folder, &cloth, &seeds)?;
    }
    let interrupt = io.interrupt()?;
    io.progress(&format!("0 of {} crumpled", seeds.len()));
    let results = in_parallel(
        seeds.len(),
        threads(&arguments.threads),
        |index| {
            one(
                &cloth,
                seeds[index],
                arguments.out.as_deref(),
                &interrupt,
                io,
            )
        },
        |done| io.progress(&format!("{done} of {} crumpled", seeds.len())),
    );
    io.progress("");
    let starts: Vec<Crumpled> = results?.into_iter().flatten().collect();
    io.report(
        arguments.json,
        || {
            json!({
                "params": fab_sim::Params::default().hash(),
                "dimx": cloth.flat.grid.dimx,
                "dimy": cloth.flat.grid.dimy,
                "spacing_m": cloth.flat.grid.spacing_m,
                "outline": cloth.flat.outline,
                "particles": cloth.mask.count(),
                "starts": starts,
                "coverage": spread(starts.iter().filter_map(|start| start.coverage)),
                "true_coverage": spread(starts.iter().filter_map(|start| start.true_coverage)),
            })
        },
        || table(&starts),
    );
    Ok(if starts.len() < seeds.len() {
        io.talk(&format!(
            "interrupted: {} of {} crumpled",
            starts.len(),
            seeds.len()
        ));
        Exit::Interrupted
    } else {
        Exit::Done
    })
}

fn cloth(arguments: &CrumpleArguments) -> Result<Cloth, Failure> {
    let stated = stated_grid(arguments)?;
    let mut name = OsString::from("crumpled_");
    let mask = match &arguments.outline {
        Some(path) => {
            let mask = files::read_outline(path, SPACING_M as f32)?;
            not_against(&stated, path, mask.grid())?;
            name.push(path.file_stem().unwrap_or_default());
            name.push("_");
            mask
        }
        None => Mask::full(match stated {
            Some((grid, _)) => grid,
            None => grid_of([DEFAULT_SIZE; 2], &format!("--size {DEFAULT_SIZE}"))?,
        }),
    };
    let fab_sim::Grid { dimx, dimy, .. } = mask.grid();
    name.push(format!("{dimx}x{dimy}"));
    let declared = program::Cloth {
        dimx: dimx as u32,
        dimy: dimy as u32,
        spacing_m: SPACING_M,
        start: ClothStart::Crumpled,
        material: None,
    };
    let flat = Start {
        outline: files::outline_of(&mask),
        ..Start::flat(&declared)
    };
    Ok(Cloth { flat, mask, name })
}

/// Returns the grid stated on the command line, and the words that state it.
fn stated_grid(arguments: &CrumpleArguments) -> Result<Option<(fab_sim::Grid, String)>, Failure> {
    let ([dimx, dimy], shown) = match (&arguments.dims, arguments.size) {
        (Some(text), _) => (setting::dims_of(text)?, format!("--dims {text}")),
        (None, Some(size)) => ([size; 2], format!("--size {size}")),
        (None, None) => return Ok(None),
    };
    let grid = grid_of([dimx, dimy], &shown)?;
    Ok(Some((grid, shown)))
}

fn grid_of([dimx, dimy]: [u32; 2], shown: &str) -> Result<fab_sim::Grid, Failure> {
    fab_sim::Grid::new(dimx as usize, dimy as usize, SPACING_M as f32)
        .map_err(|error| Failure::usage(format!("`{shown}`: {error}")))
}

/// Rejects a stated grid that differs from the outline's.
fn not_against(
    stated: &Option<(fab_sim::Grid, String)>,
    outline: &Path,
    found: fab_sim::Grid,
) -> Result<(), Failure> {
    match stated {
        Some((grid, shown)) if *grid != found => Err(Failure::usage(format!(
            "`{shown}` and `--outline {}`, which has {}, contradict each other; the outline alone is enough",
            outline.display(),
            files::size(found)
        ))),
        _ => Ok(()),
    }
}

/// Crumples one cloth and writes it; `None` if it was interrupted.
fn one(
    cloth: &Cloth,
    seed: u64,
    folder: Option<&Path>,
    interrupt: &Interrupt,
    io: &Io,
) -> Result<Option<Crumpled>, Failure> {
    // A world needs a camera, which is not used here.
    let camera = Camera {
        height_m: 1.0,
        fov_rad: std::f64::consts::FRAC_PI_4,
        image_px: 64,
        up: ImageUp::X,
    };
    let world = SimulatedWorld::new(&camera, Picker::default()).map_err(Failure::environment)?;
    let cache = setting::cache(io);
    let start = match crumple::start(&cloth.flat, seed, &world, &cache, interrupt, &mut || {}) {
        Ok(crumpled) => crumpled.start,
        Err(WorldError::Interrupted) => return Ok(None),
        Err(error) => return Err(Failure::environment(format!("seed {seed}: {error}"))),
    };
    let mut crumpled = Crumpled {
        seed,
        file: None,
        coverage: metrics::outlined_coverage(&start.positions, &start.grid, start.outline.as_ref()),
        true_coverage: metrics::true_coverage(
            &start.positions,
            &mesh::triangles(&cloth.mask),
            mesh::flat_area_m2(&cloth.mask),
        ),
        digest: start.digest(),
    };
    if let Some(folder) = folder {
        crumpled.file = Some(write(folder, cloth, &start, &crumpled)?);
    }
    Ok(Some(crumpled))
}

/// Returns the paths of a seed's positions and their description.
fn paths(folder: &Path, cloth: &Cloth, seed: u64) -> [PathBuf; 2] {
    ["npy", "json"].map(|ending| {
        let mut name = cloth.name.clone();
        name.push(format!("_{seed}.{ending}"));
        folder.join(name)
    })
}

/// Creates the folder, and refuses to replace files that this verb did not write.
fn prepare(folder: &Path, cloth: &Cloth, seeds: &[u64]) -> Result<(), Failure> {
    for seed in seeds {
        let paths = paths(folder, cloth, *seed);
        if let Some(there) = paths.iter().find(|path| path.symlink_metadata().is_ok())
            && !files::is_made_by(MADE_BY, &paths[1])
        {
            return Err(Failure::environment(format!(
                "`{}` is there already and was not written by `{MADE_BY}`; name another folder",
                there.display()
            )));
        }
    }
    fs::create_dir_all(folder).map_err(|error| {
        Failure::environment(format!("cannot make `{}`: {error}", folder.display()))
    })
}

/// Writes positions and their description; returns the file's name.
fn write(
    folder: &Path,
    cloth: &Cloth,
    start: &Start,
    crumpled: &Crumpled,
) -> Result<String, Failure> {
    let [positions, beside] = paths(folder, cloth, crumpled.seed);
    let mut description = files::description(&start.grid, &cloth.mask, MADE_BY);
    description["params"] = json!(fab_sim::Params::default().hash());
    description["seed"] = json!(crumpled.seed);
    description["coverage"] = json!(crumpled.coverage);
    description["true_coverage"] = json!(crumpled.true_coverage);
    // The description comes first: positions without it would block the next call.
    write_file(&beside, &files::json_bytes(&description))?;
    write_file(&positions, &npy::encode(&start.positions))?;
    Ok(positions.display().to_string())
}

/// Returns mean, least and greatest value; null without values.
fn spread(values: impl Iterator<Item = f64>) -> Value {
    let values: Vec<f64> = values.collect();
    if values.is_empty() {
        return Value::Null;
    }
    json!({
        "mean": values.iter().sum::<f64>() / values.len() as f64,
        "min": values.iter().copied().fold(f64::INFINITY, f64::min),
        "max": values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    })
}

fn table(starts: &[Crumpled]) -> String {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    let mut lines = vec![format!(
        "{:>8}  {:>8}  {:>8}  file",
        "seed", "coverage", "true"
    )];
    lines.extend(starts.iter().map(|start| {
        let file = start
            .file
            .as_deref()
            .unwrap_or("(not kept; `-o DIR` writes it)");
        let [covered, truly] = [start.coverage, start.true_coverage].map(number);
        format!("{:>8}  {covered:>8}  {truly:>8}  {file}", start.seed)
    }));
    let covered = spread(starts.iter().filter_map(|start| start.coverage));
    let truly = spread(starts.iter().filter_map(|start| start.true_coverage));
    for name in ["mean", "min", "max"] {
        let [covered, truly] = [&covered, &truly].map(|all| number(all[name].as_f64()));
        lines.push(format!("{name:>8}  {covered:>8}  {truly:>8}"));
    }
    lines.join("\n")
}
