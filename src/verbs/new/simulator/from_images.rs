//! Drafts a fold from the user's pictures, as a task's text.
//!
//! In: files, and what `fab_agent::draft` finds in them. Out: a [`Draft`]; `page` writes its text.

use super::page::Page;
use crate::exit::Failure;
use crate::io::Io;
use crate::sources;
use crate::verbs::new::{Draft, FOLDING, NewFoldArguments, shown};
use fab_agent::draft;
use fab_agent::draft::{DraftError, NamedPicture, SIDE_PX};
use fab_picture::{cut, png};
use fab_program::{Camera, Picker};
use fab_world::{SimulatedWorld, World, WorldError};
use std::path::{Path, PathBuf};

/// The longest side of a picture that is cut, pixels; smaller ones are not enlarged.
const CUT_PX: u32 = 480;

/// Looks at the pictures and writes the task.
pub fn draft(arguments: &NewFoldArguments, io: &Io) -> Result<Draft, Failure> {
    let (pictures, are_cut) = load(&arguments.pictures.from_images, io)?;
    let interrupt = io.interrupt()?;
    let make_world = |camera: &Camera| -> Result<Box<dyn World>, WorldError> {
        let world = SimulatedWorld::new(camera, Picker::PutDown)?;
        Ok(Box::new(world))
    };
    let announce = |step: usize| {
        let steps = pictures.len() - 1;
        io.progress(&format!("step {step}/{steps}: trying folds"));
    };
    let longer_m = arguments.pictures.cloth;
    let found = draft::draft(&pictures, longer_m, &make_world, &interrupt, &announce);
    io.progress("");
    let found = found.map_err(|error| match error {
        DraftError::World(WorldError::Interrupted) => Failure::interrupted(),
        DraftError::Count(_) => Failure::usage(error.to_string()),
        error => Failure::environment(error),
    })?;
    let (places, copies) = places(arguments, &pictures, are_cut);
    let page = Page {
        name: &arguments.task.name,
        pictures: &pictures,
        places: &places,
        found: &found,
    };
    let file = arguments.task.file();
    let sheet = file.with_extension("png");
    let file = shown(&file);
    Ok(Draft {
        text: page.text(),
        library: FOLDING,
        pictures: copies,
        next: vec![
            format!("fabc subgoals {file} --sheet {}", shown(&sheet)),
            format!("fabc render {file}"),
            format!("fabc run {file}"),
        ],
    })
}

/// Returns the path under which the task names each picture, and the pictures to copy beside it.
///
/// A picture that is already there is named in its place, unless it was cut.
fn places(
    arguments: &NewFoldArguments,
    pictures: &[NamedPicture],
    are_cut: bool,
) -> (Vec<String>, Vec<(PathBuf, Vec<u8>)>) {
    let folder = arguments.task.folder();
    let mut copies = Vec::new();
    let paths = arguments.pictures.from_images.iter();
    let numbered = paths.zip(pictures).enumerate();
    let places = numbered.map(|(number, (path, named))| {
        let there = beside(&folder, path).filter(|_| !are_cut);
        there.unwrap_or_else(|| {
            let place = format!("{}.images/{number}.png", arguments.task.name);
            copies.push((PathBuf::from(&place), png::encode(&named.picture)));
            place
        })
    });
    (places.collect(), copies)
}

/// Returns a picture's path relative to the task's folder, if it lies inside under a name that a task can state.
fn beside(folder: &Path, path: &Path) -> Option<String> {
    let real = sources::inside(folder, path).ok()?;
    let folder = Path::new(".").join(folder).canonicalize().ok()?;
    let below = real.strip_prefix(folder).ok()?;
    let parts = below.iter().map(|part| part.to_str());
    let path = parts.collect::<Option<Vec<&str>>>()?.join("/");
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "._-/".contains(letter);
    path.chars().all(is_plain).then_some(path)
}

/// Reads pictures, and returns whether they were cut and scaled, so that the files do not hold them: if they are not squares of one size, as phones take none, the middle square of each is scaled.
fn load(paths: &[PathBuf], io: &Io) -> Result<(Vec<NamedPicture>, bool), Failure> {
    let mut pictures = Vec::with_capacity(paths.len());
    for path in paths {
        let opened = png::open(path)?;
        if let Some(note) = opened.note {
            io.talk(&format!("note: {note}"));
        }
        let (name, picture) = (shown(path), opened.rgb);
        pictures.push(NamedPicture { name, picture });
    }
    let sides = pictures.iter().map(|named| named.picture.dimensions());
    let sides: Vec<u32> = sides.flat_map(|(width, height)| [width, height]).collect();
    let least = sides.iter().copied().min().unwrap_or(0);
    let are_cut = least > *SIDE_PX.end() || sides.iter().any(|side| *side != least);
    if are_cut {
        let side = least.min(CUT_PX);
        for NamedPicture { picture, .. } in &mut pictures {
            *picture = cut::colours(picture, cut::middle(picture.dimensions()), side);
        }
        io.talk(&format!(
            "note: the pictures are not squares of one size up to {CUT_PX} px: the middle square of each is taken, scaled \
             to {side} x {side} px"
        ));
    }
    Ok((pictures, are_cut))
}
