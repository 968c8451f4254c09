//! `fabc sim crumple`: starts for smoothing, by their seeds.
//!
//! The starts are the same as those of `fabc run --start SEED` with a crumpled cloth of the same size, and share its
//! cache. Cloths with an outline use that cache too, although `fabc run` does not support them.

use super::{SPACING_M, ThreadArguments, each, files};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources;
use crate::verbs::runtime::setting;
use clap::{Args, ValueHint};
use fab_base::table::{Align, aligned};
use fab_program::{Cloth, ClothStart, Picker};
use fab_sim::{Grid, Mask, Params, mesh};
use fab_world::conformance::camera;
use fab_world::start::{Outline, Start};
use fab_world::{SimulatedWorld, crumple, metrics};
use serde::Serialize;
use serde_json::json;
use std::fs;
use std::path::PathBuf;

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

#[derive(Serialize)]
struct Crumpled {
    seed: u64,
    /// The file of positions; `None` if no folder was named.
    file: Option<PathBuf>,
    /// Covered share of the flat cloth's area, with both measured as in SoftGym; may exceed 1.
    coverage: Option<f64>,
    /// Area of the table under the cloth, divided by the flat cloth's area; independent of rotation.
    true_coverage: Option<f64>,
    digest: String,
}

pub fn run(arguments: &CrumpleArguments, io: &Io) -> Result<Exit, Failure> {
    let (mask, name) = cloth(arguments)?;
    let (first, count) = (arguments.seed, arguments.count);
    // After the largest seed comes 0.
    let seeds = (0..u64::from(count)).map(|number| first.wrapping_add(number));
    let seeds: Vec<u64> = seeds.collect();
    let file = |seed: u64| {
        let folder = arguments.out.as_ref()?;
        Some(folder.join(format!("{name}_{seed}.npy")))
    };
    for path in seeds.iter().filter_map(|seed| file(*seed)) {
        files::description_of(&path)?;
    }
    if let Some(folder) = &arguments.out {
        fs::create_dir_all(folder).map_err(|error| Failure::unwritable(folder, error))?;
    }
    let (interrupt, cache) = (io.interrupt()?, setting::cache(io));
    let flat = Start {
        outline: (!mask.is_full()).then(|| Outline::new(&mask.to_string())),
        ..Start::flat(&Cloth {
            dimx: mask.grid().dimx as u32,
            dimy: mask.grid().dimy as u32,
            spacing_m: SPACING_M,
            start: ClothStart::Crumpled,
            material: None,
        })
    };
    let (triangles, flat_m2) = (mesh::triangles(&mask), mesh::flat_area_m2(&mask));
    let starts = each(seeds.len(), &arguments.threads, "crumpled", io, |index| {
        let seed = seeds[index];
        // A world needs a camera; this one takes no picture.
        let world = SimulatedWorld::new(&camera(), Picker::default())?;
        let start = crumple::start(&flat, seed, &world, &cache, &interrupt, &mut || {})
            .map_err(|error| Failure::from(error).saying(&format!("seed {seed}")))?
            .start;
        let file = file(seed);
        if let Some(file) = &file {
            files::write_state(file, &start)?;
        }
        let (positions, outline) = (&start.positions, start.outline.as_ref());
        Ok(Crumpled {
            seed,
            file,
            coverage: metrics::outlined_coverage(positions, &start.grid, outline),
            true_coverage: metrics::true_coverage(positions, &triangles, flat_m2),
            digest: start.digest(),
        })
    })?;
    let document = json!({ "params": Params::default().hash(), "starts": starts });
    io.either(arguments.json, &document, || text(&starts));
    Ok(Exit::Done)
}

/// Returns which particles the cloth has, and the beginning of its files' names, before `_SEED`.
fn cloth(arguments: &CrumpleArguments) -> Result<(Mask, String), Failure> {
    let (mask, prefix) = match &arguments.outline {
        Some(path) => {
            let outline = path.file_stem().unwrap_or_default().to_string_lossy();
            let wrong = |why: String| {
                Failure::environment(format!("the outline `{}`: {why}", path.display()))
            };
            let text = sources::read_text(path).map_err(wrong)?;
            let mask = Mask::parse(&text, SPACING_M as f32);
            let mask = mask.map_err(|error| wrong(error.to_string()))?;
            (mask, format!("{outline}_"))
        }
        None => {
            let dims = &arguments.dims;
            let grid = super::grid(setting::dims_of(dims)?, &format!("--dims {dims}"))?;
            (Mask::full(grid), String::new())
        }
    };
    let Grid { dimx, dimy, .. } = mask.grid();
    Ok((mask, format!("crumpled_{prefix}{dimx}x{dimy}")))
}

fn text(starts: &[Crumpled]) -> String {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |it| format!("{it:.3}"));
    let mut table = vec![["seed", "coverage", "true", "file"].map(str::to_owned)];
    table.extend(starts.iter().map(|start| {
        let file = start.file.as_ref().map(|file| file.display().to_string());
        let [coverage, truly] = [start.coverage, start.true_coverage].map(number);
        let file = file.unwrap_or_else(|| "(not kept; `-o DIR` writes it)".to_owned());
        [start.seed.to_string(), coverage, truly, file]
    }));
    aligned(&[Align::Right; 3], &table).join("\n")
}
