//! `fabc sim crumple`: starts for smoothing, by their seeds.
//!
//! The starts are the same as those of `fabc run --start SEED` with a crumpled cloth of the same size, and share its
//! cache. Cloths with an outline use that cache too, although `fabc run` does not support them.

use super::parallel::{ThreadArguments, in_parallel, threads};
use super::{SPACING_M, files};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use crate::verbs::runtime::setting;
use clap::{Args, ValueHint};
use fab_base::interrupt::Interrupt;
use fab_base::table::{Align, aligned};
use fab_program::{self as program, ClothStart, Picker};
use fab_sim::{Mask, Params, mesh};
use fab_world::conformance::camera;
use fab_world::start::{Grid, Outline, Start};
use fab_world::{SimulatedWorld, WorldError, crumple, metrics};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `sim crumple`.
#[derive(Args)]
pub struct CrumpleArguments {
    /// Particles along the two sides of the cloth, 6.25 mm apart.
    #[arg(long, value_name = "44x40", default_value = "40x40")]
    pub dims: String,
    /// Which particles of the grid exist: rows of `#` and `.`, seen from above; its size is the cloth's.
    #[arg(long, value_name = "FILE.txt", value_hint = ValueHint::FilePath, conflicts_with = "dims")]
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

/// The crumpled cloths.
#[derive(Serialize)]
struct CrumpledCloths {
    params: String,
    #[serde(flatten)]
    grid: Grid,
    outline: Option<Outline>,
    particles: usize,
    starts: Vec<Crumpled>,
}

/// One crumpled cloth.
#[derive(Serialize)]
struct Crumpled {
    seed: u64,
    /// The file of positions; `None` if no folder was named.
    file: Option<String>,
    #[serde(flatten)]
    covered: Covered,
    /// SHA-256 of grid and positions.
    digest: String,
}

#[derive(Clone, Copy, Serialize)]
struct Covered {
    /// Covered share of the flat cloth's area, with both measured as in SoftGym; may exceed 1.
    coverage: Option<f64>,
    /// Area of the table under the cloth, divided by the flat cloth's area; independent of rotation.
    true_coverage: Option<f64>,
}

/// What a start's description has besides.
#[derive(Serialize)]
struct Origin {
    params: String,
    seed: u64,
    #[serde(flatten)]
    covered: Covered,
}

/// Crumples, writes, and reports.
pub fn run(arguments: &CrumpleArguments, io: &Io) -> Result<Exit, Failure> {
    let (mask, name) = cloth(arguments)?;
    let seeds: Vec<u64> = setting::seeds(arguments.seed, arguments.count)?.collect();
    let path = |seed: u64| {
        let folder = arguments.out.as_ref()?;
        Some(folder.join(format!("{name}_{seed}.npy")))
    };
    if let Some(folder) = &arguments.out {
        for path in seeds.iter().filter_map(|seed| path(*seed)) {
            files::check_replaceable(&path, MADE_BY)?;
        }
        std::fs::create_dir_all(folder).map_err(|error| Failure::unwritable(folder, error))?;
    }
    let interrupt = io.interrupt()?;
    io.progress(&format!("0 of {} crumpled", seeds.len()));
    let results = in_parallel(
        seeds.len(),
        threads(&arguments.threads),
        |index| {
            one(
                &mask,
                seeds[index],
                path(seeds[index]).as_deref(),
                &interrupt,
                io,
            )
        },
        |done| io.progress(&format!("{done} of {} crumpled", seeds.len())),
    );
    io.progress("");
    let starts: Vec<Crumpled> = results?.into_iter().flatten().collect();
    let cloths = CrumpledCloths {
        params: Params::default().hash(),
        grid: flat(&mask).grid,
        outline: files::outline_of(&mask),
        particles: mask.count(),
        starts,
    };
    io.result(arguments.json, &cloths);
    let (n_done, n_all) = (cloths.starts.len(), seeds.len());
    if n_done < n_all {
        io.talk(&format!("interrupted: {n_done} of {n_all} crumpled"));
        return Ok(Exit::Interrupted);
    }
    Ok(Exit::Done)
}

/// Returns which particles the cloth has, and the beginning of its files' names, before `_SEED`.
fn cloth(arguments: &CrumpleArguments) -> Result<(Mask, String), Failure> {
    let (mask, prefix) = match &arguments.outline {
        Some(path) => {
            let outline = path.file_stem().unwrap_or_default().to_string_lossy();
            let mask = files::read_outline(path, SPACING_M as f32)?;
            (mask, format!("{outline}_"))
        }
        None => {
            let dims = &arguments.dims;
            let grid = super::grid(setting::dims_of(dims)?, &format!("--dims {dims}"))?;
            (Mask::full(grid), String::new())
        }
    };
    let fab_sim::Grid { dimx, dimy, .. } = mask.grid();
    Ok((mask, format!("crumpled_{prefix}{dimx}x{dimy}")))
}

/// Lays the cloth flat.
fn flat(mask: &Mask) -> Start {
    let declared = program::Cloth {
        dimx: mask.grid().dimx as u32,
        dimy: mask.grid().dimy as u32,
        spacing_m: SPACING_M,
        start: ClothStart::Crumpled,
        material: None,
    };
    Start {
        outline: files::outline_of(mask),
        ..Start::flat(&declared)
    }
}

/// Crumples one cloth, and writes it if there is a path; `None` if it was interrupted.
fn one(
    mask: &Mask,
    seed: u64,
    path: Option<&Path>,
    interrupt: &Interrupt,
    io: &Io,
) -> Result<Option<Crumpled>, Failure> {
    // A world needs a camera; this one takes no picture.
    let world = SimulatedWorld::new(&camera(), Picker::default())?;
    let (flat, cache) = (flat(mask), setting::cache(io));
    let start = match crumple::start(&flat, seed, &world, &cache, interrupt, &mut || {}) {
        Ok(crumpled) => crumpled.start,
        Err(WorldError::Interrupted) => return Ok(None),
        Err(error) => return Err(Failure::environment(format!("seed {seed}: {error}"))),
    };
    let Start {
        positions, grid, ..
    } = &start;
    let (triangles, flat_m2) = (mesh::triangles(mask), mesh::flat_area_m2(mask));
    let covered = Covered {
        coverage: metrics::outlined_coverage(positions, grid, start.outline.as_ref()),
        true_coverage: metrics::true_coverage(positions, &triangles, flat_m2),
    };
    if let Some(path) = path {
        let params = Params::default().hash();
        let origin = Origin {
            params,
            seed,
            covered,
        };
        let description = files::Description::of(grid, mask, MADE_BY, origin);
        files::write_positions(path, positions, &description)?;
    }
    Ok(Some(Crumpled {
        seed,
        file: path.map(|path| path.display().to_string()),
        covered,
        digest: start.digest(),
    }))
}

impl Report for CrumpledCloths {
    fn text(&self) -> String {
        let number = |value: Option<f64>| value.map_or("-".to_owned(), |it| format!("{it:.3}"));
        let mut table = vec![["seed", "coverage", "true", "file"].map(str::to_owned)];
        table.extend(self.starts.iter().map(|start| {
            let Covered {
                coverage,
                true_coverage,
            } = start.covered;
            let file = start.file.as_deref();
            let file = file.unwrap_or("(not kept; `-o DIR` writes it)").to_owned();
            [
                start.seed.to_string(),
                number(coverage),
                number(true_coverage),
                file,
            ]
        }));
        let columns = [Align::Right, Align::Right, Align::Right, Align::Left];
        aligned(&columns, &table).join("\n")
    }
}
