//! Tests of the stand-in's smoothing on painted pictures: change picture and words, and check that the answer follows.
#![allow(clippy::unwrap_used)]

mod corrections;
mod pictures;
mod words;

use super::prompt;
use crate::Geometric;
use fab_model::calls::Unrecorded;
use fab_model::{Message, Model, ModelRole, Part, Png, Request, Speaker};
use fab_program::PixelPoint;
use image::{Rgb, RgbImage};

const SIDE: u32 = 360;
const EDGE_PX: f64 = 110.0;

/// An axis-aligned cloth: left, top, right, bottom, of one colour; later ones cover earlier ones.
type Patch = ([u32; 4], [u8; 3]);

const ORANGE: [u8; 3] = [255, 113, 0];
const PINK: [u8; 3] = [250, 145, 205];

fn painted(patches: &[Patch]) -> RgbImage {
    RgbImage::from_fn(SIDE, SIDE, |column, row| {
        let covers = |&&([left, top, right, bottom], _): &&Patch| {
            (left..right).contains(&column) && (top..bottom).contains(&row)
        };
        let tile = [[213, 213, 216], [243, 243, 246]][((column / 90 + row / 90) % 2) as usize];
        Rgb(patches.iter().rfind(covers).map_or(tile, |patch| patch.1))
    })
}

/// The parts of a question.
struct Question {
    picture: RgbImage,
    corners: Vec<[i32; 2]>,
    center: [i32; 2],
    edge_px: f64,
    /// Text added at the end.
    more: String,
}

fn question(patches: &[Patch], corners: &[[i32; 2]], center: [i32; 2]) -> Question {
    Question {
        picture: painted(patches),
        corners: corners.to_vec(),
        center,
        edge_px: EDGE_PX,
        more: String::new(),
    }
}

impl Question {
    fn words(&self) -> String {
        let corners: Vec<String> = self
            .corners
            .iter()
            .map(|[u, v]| format!("({u}, {v})"))
            .collect();
        let [u, v] = self.center;
        format!(
            "One edge, the length of the cloth's side, is {} px in the picture. A corner must not be placed\n\
             farther than {} px from the middle of the picture, (180, 180).\n\
             Pick Point = (x, y)\nDirection = 0 deg | 45 deg | 90 deg | 135 deg | 180 deg | 225 deg | 270 deg | 315 deg\n\
             Distance = 0.1 edge | 0.25 edge | 0.5 edge | 0.75 edge | 1 edge\n\
             The corners are {}.\nThe center is ({u}, {v}).\n{}",
            self.edge_px,
            self.edge_px * 0.95,
            corners.join(", "),
            self.more,
        )
    }

    fn turn(&self) -> Message {
        let mut bytes = std::io::Cursor::new(Vec::new());
        self.picture
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        let parts = vec![
            Part::Text(self.words()),
            Part::Image(Png::new(bytes.into_inner())),
        ];
        Message {
            speaker: Speaker::User,
            parts,
        }
    }

    fn answer(&self) -> String {
        asked(vec![self.turn()])
    }

    /// The answer after a refused one and its correction.
    fn corrected(&self, answer: &str, correction: &str) -> String {
        asked(vec![
            self.turn(),
            Message::text(Speaker::Assistant, answer),
            Message::text(Speaker::User, correction),
        ])
    }
}

fn asked(messages: Vec<Message>) -> String {
    let request = Request::new(ModelRole::Vision, messages);
    Geometric.ask(&request, &mut Unrecorded).unwrap().text
}

/// Pick, direction in degrees, distance in edges.
fn pull_of(reply: &str) -> ([i32; 2], f64, f64) {
    let PixelPoint { u, v } = prompt::answered("pick", reply).unwrap_or_else(|| panic!("{reply}"));
    let number = |field: &str| super::parsed_prompt::choices(reply, field)[0].value;
    ([u, v], number("direction"), number("distance"))
}

/// A cloth that is too narrow on the right, with a piece missing at its lower right, so that no two corners are alike.
fn narrowed() -> Question {
    question(
        &[
            ([130, 121, 212, 200], ORANGE),
            ([130, 200, 180, 235], ORANGE),
        ],
        &[
            [130, 121],
            [211, 121],
            [211, 199],
            [179, 234],
            [130, 234],
            [211, 165],
            [170, 121],
        ],
        [170, 178],
    )
}
