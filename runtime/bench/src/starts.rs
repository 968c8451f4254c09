//! The starts of a suite.
//!
//! In: a suite's [`Starts`] and a task's cloth, or a folder of recorded positions. Out: [`StartPoint`]s in a fixed
//! order, which [`StartPoint::lay`] converts to positions. Generated starts are the same on every machine.

use super::suite::Starts;
use fab_base::cache::Cache;
use fab_base::files;
use fab_base::interrupt::Interrupt;
use fab_program::{Cloth, ClothStart};
use fab_world::start::{Start, StartError};
use fab_world::{World, WorldError, crumple};
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};

/// The largest manifest accepted, bytes.
const MAX_BYTES: u64 = 64 << 20;
/// The most starts in one folder.
const MOST: usize = 1000;

/// Additional turn of each flat cloth that stands for a hand-laid one, relative to the one before: about the precision
/// of a person.
const ASKEW_DEG: f64 = 2.0;

/// A start that is not laid yet.
#[derive(Clone, Debug, PartialEq)]
pub struct StartPoint {
    /// Its number in the suite or the recorded data.
    pub number: u64,
    /// The cloth, with its own size.
    pub cloth: Cloth,
    lie: Arrangement,
}

#[derive(Clone, Debug, PartialEq)]
enum Arrangement {
    Turned { deg: f64 },
    Crumpled { seed: u64 },
    Recorded(Start),
    ByHand,
}

/// Why a folder of recorded starts cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RecordedError {
    /// The folder or its manifest cannot be read.
    #[error("the recorded starts `{path}` cannot be used: {why}")]
    Folder {
        /// The folder or the manifest.
        path: PathBuf,
        /// What is wrong, and what would be right.
        why: String,
    },
    /// A file of positions cannot be used.
    #[error(transparent)]
    Start(#[from] StartError),
}

/// Returns the generated starts of a task's cloth.
pub fn generated(starts: &Starts, cloth: &Cloth) -> Vec<StartPoint> {
    let point = |number: usize, [dimx, dimy]: [u32; 2], lie: Arrangement| StartPoint {
        number: number as u64,
        cloth: Cloth {
            dimx,
            dimy,
            ..cloth.clone()
        },
        lie,
    };
    match starts {
        Starts::Flat { sides, turns_deg } => {
            let turned = |side: &u32| {
                // Rounded down, like the paper's rectangles: int(0.8 n) for a task of 55 by 44.
                let sides = [*side, (side * cloth.dimy / cloth.dimx).max(2)];
                turns_deg.iter().map(move |deg| (sides, *deg))
            };
            let both = sides.iter().flat_map(turned).enumerate();
            both.map(|(number, (sides, deg))| point(number, sides, Arrangement::Turned { deg }))
                .collect()
        }
        Starts::Crumpled {
            sides,
            count,
            first_seed,
        } => {
            let crumpled = |number: usize| {
                let of = |at: usize| sides[at % sides.len()];
                let seed = first_seed + number as u64;
                let sides = [of(number), of(number / sides.len())];
                point(number, sides, Arrangement::Crumpled { seed })
            };
            (0..*count as usize).map(crumpled).collect()
        }
        Starts::Operator { count } => {
            let own = [cloth.dimx, cloth.dimy];
            let by_hand = |number| point(number, own, Arrangement::ByHand);
            (0..*count as usize).map(by_hand).collect()
        }
    }
}

/// Reads the recorded starts of a folder for a task; `None` if its manifest lists only other tasks.
///
/// A `manifest.json` in the folder lists them, with paths relative to the parent folder: `entries` with `task`, `id`
/// and `dir` (the start is `init_pos.npy` there), or `states` with `index` and `pos`. Without a manifest, every `.npy`
/// file of the folder is a start, in the order of names, with its description beside it.
pub fn recorded(folder: &Path, task: &str) -> Result<Vec<StartPoint>, RecordedError> {
    let wrong = |path: &Path, why: String| RecordedError::Folder {
        path: path.to_owned(),
        why,
    };
    let manifest = folder.join("manifest.json");
    let files = if manifest.is_file() {
        let listed = files::read_json(&manifest, MAX_BYTES);
        listed
            .and_then(|listed| below(folder, listed, task))
            .map_err(|why| wrong(&manifest, why))?
    } else {
        let files = positions_in(folder).map_err(|why| wrong(folder, why))?;
        (0..).zip(files).collect()
    };
    if files.len() > MOST {
        let why = format!(
            "it holds {} starts of `{task}`, more than {MOST}",
            files.len()
        );
        return Err(wrong(folder, why));
    }
    let points = files.into_iter().map(|(number, file)| {
        let start = Start::load(&file, None)?;
        Ok(StartPoint {
            number,
            cloth: Cloth {
                dimx: start.grid.dimx,
                dimy: start.grid.dimy,
                spacing_m: start.grid.spacing_m,
                start: ClothStart::Flat,
                material: None,
            },
            lie: Arrangement::Recorded(start),
        })
    });
    points.collect()
}

/// The starts that a manifest lists.
#[derive(Deserialize)]
struct Manifest {
    #[serde(default)]
    entries: Vec<RecordedFold>,
    #[serde(default)]
    states: Vec<RecordedState>,
}

/// A demonstrated fold; its start is a file of its folder.
#[derive(Deserialize)]
struct RecordedFold {
    task: String,
    id: u64,
    dir: PathBuf,
}

/// A crumpled cloth.
#[derive(Deserialize)]
struct RecordedState {
    index: u64,
    pos: PathBuf,
}

/// Returns number and real path of each start that a manifest lists for a task; all must be below the folder.
fn below(folder: &Path, listed: Manifest, task: &str) -> Result<Vec<(u64, PathBuf)>, String> {
    if listed.entries.is_empty() && listed.states.is_empty() {
        return Err("it lists neither `entries` nor `states`".to_owned());
    }
    let folds = listed.entries.into_iter();
    let folds = folds.filter(|fold| snake_case(&fold.task) == task);
    let folds = folds.map(|fold| (fold.id, fold.dir.join("init_pos.npy")));
    let states = listed.states.into_iter();
    let files = folds.chain(states.map(|state| (state.index, state.pos)));
    let real = fs::canonicalize(folder).map_err(|error| error.to_string())?;
    let above = real.parent().unwrap_or(&real);
    let found = files.map(|(number, file)| {
        let path = fs::canonicalize(above.join(&file))
            .map_err(|error| format!("cannot find `{}`: {error}", file.display()))?;
        if path.starts_with(&real) {
            Ok((number, path))
        } else {
            Err(format!("`{}` leads out of the folder", file.display()))
        }
    });
    found.collect()
}

fn positions_in(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|error| error.to_string())?;
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| error.to_string())?.path();
        if path.extension().is_some_and(|ending| ending == "npy") {
            files.push(path);
        }
    }
    if files.is_empty() {
        return Err(
            "it has no manifest.json and no .npy file; expected a folder of recorded starts, or of those that `fabc \
             sim crumple -o` writes"
                .to_owned(),
        );
    }
    files.sort();
    Ok(files)
}

/// Converts a task name of recorded data, such as `DoubleStraight`, to the form `double_straight`.
fn snake_case(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && !text.is_empty() {
            text.push('_');
        }
        text.push(letter.to_ascii_lowercase());
    }
    text
}

impl StartPoint {
    /// Returns the particles along both sides.
    pub fn grid(&self) -> [u32; 2] {
        [self.cloth.dimx, self.cloth.dimy]
    }

    /// Returns the same start of a cloth whose sides are longer by a factor.
    pub fn scaled(&self, factor: f64) -> StartPoint {
        let mut scaled = self.clone();
        scaled.cloth.spacing_m *= factor;
        scaled
    }

    /// Describes how a person is to lay the cloth.
    pub fn in_words(&self) -> String {
        let number = self.number + 1;
        match &self.lie {
            Arrangement::Turned { deg } => format!("flat, turned by {deg:.0} degrees"),
            Arrangement::Recorded(start) => format!("as `{}` was recorded", start.name),
            Arrangement::ByHand if self.cloth.start != ClothStart::Crumpled => {
                format!("flat, {number}")
            }
            Arrangement::Crumpled { .. } | Arrangement::ByHand => {
                format!("crumpled by hand, {number}")
            }
        }
    }

    /// Lays the cloth; a crumpled one comes from the cache or is crumpled in `world`.
    ///
    /// A start that a person lays is crumpled there too, if the world can do that. If not, its positions are
    /// placeholders, those of the flat cloth, and the world asks the person to lay it.
    pub fn lay(
        &self,
        world: &dyn World,
        cache: &Cache,
        interrupt: &Interrupt,
    ) -> Result<Start, WorldError> {
        match &self.lie {
            Arrangement::Turned { deg } => Ok(Start::turned_by(&self.cloth, deg.to_radians())),
            Arrangement::Recorded(start) if start.grid.spacing_m != self.cloth.spacing_m => {
                Err(WorldError::Start {
                    start: start.name.clone(),
                    why: "it was recorded with its cloth, whose size cannot be varied; leave out `vary.size`, or `--starts`".to_owned(),
                })
            }
            Arrangement::Recorded(start) => Ok(start.clone()),
            Arrangement::Crumpled { seed } => self.crumpled(*seed, world, cache, interrupt),
            Arrangement::ByHand => {
                let seed = self.number;
                let askew_rad = (ASKEW_DEG * seed as f64).to_radians();
                let laid = match self.cloth.start {
                    ClothStart::Crumpled => self.crumpled(seed, world, cache, interrupt),
                    _ => Ok(Start::turned_by(&self.cloth, askew_rad)),
                };
                let start = match laid {
                    Err(WorldError::CannotCrumple { .. }) => Start::flat(&self.cloth),
                    laid => laid?,
                };
                Ok(Start {
                    name: format!("laid by hand, {}", seed + 1),
                    seed: Some(seed),
                    ..start
                })
            }
        }
    }

    fn crumpled(
        &self,
        seed: u64,
        world: &dyn World,
        cache: &Cache,
        interrupt: &Interrupt,
    ) -> Result<Start, WorldError> {
        let flat = Start::flat(&self.cloth);
        crumple::start(&flat, seed, world, cache, interrupt, &mut || {})
            .map(|crumpled| crumpled.start)
    }
}
