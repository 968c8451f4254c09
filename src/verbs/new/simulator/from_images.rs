//! Drafts a fold from the user's pictures, as a task's text.
//!
//! In: files, and what `fab_agent::draft` finds in them. Out: a [`Draft`]; `page` writes its text.

use super::page::Page;
use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::new::{Draft, FOLDING, NewFoldArguments, shown};
use crate::verbs::runtime::setting;
use fab_agent::draft;
use fab_agent::draft::{NamedPicture, SIDE_PX};
use fab_picture::{observation, png};
use fab_program::{Camera, Picker};
use fab_world::{SimulatedWorld, World, WorldError};
use std::path::PathBuf;

/// The longest side of a picture that is cut, pixels; smaller ones are not enlarged.
const CUT_PX: u32 = 480;

/// Looks at the pictures and writes the task.
pub fn draft(arguments: &NewFoldArguments, io: &Io) -> Result<Draft, Failure> {
    let pictures = load(&arguments.pictures.from_images, io)?;
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
    let found = found.map_err(setting::unfit_usage)?;
    let name = &arguments.task.name;
    let page = Page {
        name,
        pictures: &pictures,
        found: &found,
    };
    let copies = pictures.iter().enumerate();
    let copies = copies.map(|(number, named)| {
        let place = PathBuf::from(page.place(number));
        (place, png::encode(&named.picture))
    });
    let file = arguments.task.file();
    let sheet = file.with_extension("png");
    let file = shown(&file);
    Ok(Draft {
        text: page.text(),
        library: FOLDING,
        pictures: copies.collect(),
        next: vec![
            format!("fabc subgoals {file} --sheet {}", shown(&sheet)),
            format!("fabc render {file}"),
            format!("fabc run {file}"),
        ],
    })
}

/// Reads pictures. If they are not squares of one size, as phones take none, the middle square of each is scaled.
fn load(paths: &[PathBuf], io: &Io) -> Result<Vec<NamedPicture>, Failure> {
    let mut pictures = Vec::with_capacity(paths.len());
    for path in paths {
        let (name, picture) = (shown(path), png::load(path)?);
        pictures.push(NamedPicture { name, picture });
    }
    let sides = pictures.iter().map(|named| named.picture.dimensions());
    let sides: Vec<u32> = sides.flat_map(|(width, height)| [width, height]).collect();
    let least = sides.iter().copied().min().unwrap_or(0);
    if least > *SIDE_PX.end() || sides.iter().any(|side| *side != least) {
        let side = least.min(CUT_PX);
        for NamedPicture { picture, .. } in &mut pictures {
            *picture = observation::cut_colours(
                picture,
                observation::middle_square(picture.dimensions()),
                side,
            );
        }
        io.talk(&format!(
            "note: the pictures are not squares of one size up to {} px: the middle square of each is taken, scaled \
             to {side} x {side} px",
            SIDE_PX.end()
        ));
    }
    Ok(pictures)
}
