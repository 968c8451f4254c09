//! Loads the user's pictures for a draft, as squares of one size.
//!
//! In: files. Out: pictures with their names, and whether they differ from their files.

use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::new::shown;
use fab_agent::draft::{NamedPicture, SIDE_PX};
use fab_picture::{cut, png};
use std::path::PathBuf;

/// The longest side of a picture that is cut, pixels; smaller ones are not enlarged.
const CUT_PX: u32 = 480;

/// The user's pictures.
pub struct Brought {
    /// The pictures, in their order.
    pub pictures: Vec<NamedPicture>,
    /// Whether they were cut and scaled, so that the files do not hold them.
    pub are_cut: bool,
}

/// Reads pictures; if they are not squares of one size, as phones take none, the middle square of each is scaled.
pub fn load(paths: &[PathBuf], io: &Io) -> Result<Brought, Failure> {
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
    Ok(Brought { pictures, are_cut })
}
