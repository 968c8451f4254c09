//! Tests of the stand-in on painted pictures and on written prompts.
//!
//! This file paints cloths and asks questions; the tests are in the files beside it.
#![allow(clippy::unwrap_used)]

mod centers;
mod frames;
mod missing;
mod planning;
mod shortcuts;
mod smoothing;
mod vocabulary;

use super::{Geometric, prompt};
use fab_model::calls::{Budget, Ledger};
use fab_model::{Message, Model, ModelRole, Part, Png, Request, Speaker};
use fab_picture::hull;
use fab_program::PixelPoint;
use image::{Rgb, RgbImage};

type Point = [f64; 2];

const ORANGE: [u8; 3] = [255, 113, 0];
const LIGHT_TILES: [[u8; 3]; 2] = [[213, 213, 216], [243, 243, 246]];

/// A cloth before and after one fold, with the arrow; `[right, up]` around the cloth's middle, in cloth widths.
struct Fold {
    before: Vec<Point>,
    after: Vec<Point>,
    tail: Point,
    tip: Point,
}

/// A 5:4 rectangle whose upper left corner is folded onto the lower left one.
fn rectangle_fold() -> Fold {
    Fold {
        before: vec![[-0.5, -0.4], [0.5, -0.4], [0.5, 0.4], [-0.5, 0.4]],
        after: vec![[-0.5, -0.4], [0.5, -0.4], [0.5, 0.4], [-0.5, 0.0]],
        tail: [-0.5, 0.4],
        tip: [-0.5, -0.4],
    }
}

/// A square whose upper right corner is folded onto the lower left one.
fn square_fold() -> Fold {
    Fold {
        before: vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]],
        after: vec![[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5]],
        tail: [0.5, 0.5],
        tip: [-0.5, -0.5],
    }
}

/// The triangle that [`square_fold`] leaves, its lower right corner folded onto its upper left one.
fn triangle_fold() -> Fold {
    Fold {
        before: vec![[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5]],
        after: vec![[-0.5, -0.5], [0.0, 0.0], [-0.5, 0.5]],
        tail: [0.5, -0.5],
        tip: [-0.5, 0.5],
    }
}

/// The view of a cloth.
#[derive(Clone, Copy)]
struct View {
    side_px: u32,
    /// Width of the cloth, pixels.
    cloth_px: f64,
    /// Counter-clockwise.
    turn_deg: f64,
    handedness: Handedness,
    cloth: [u8; 3],
    tiles: [[u8; 3]; 2],
}

#[derive(Clone, Copy, PartialEq)]
enum Handedness {
    AsIs,
    Mirrored,
}

const VIEW: View = View {
    side_px: 224,
    cloth_px: 140.0,
    turn_deg: 0.0,
    handedness: Handedness::AsIs,
    cloth: ORANGE,
    tiles: LIGHT_TILES,
};

impl View {
    /// Where a cloth point appears, `[column, row]`.
    fn pixel(&self, [right, up]: Point) -> [f64; 2] {
        let right = if self.handedness == Handedness::Mirrored {
            -right
        } else {
            right
        };
        let (sin, cos) = self.turn_deg.to_radians().sin_cos();
        let middle = f64::from(self.side_px) / 2.0;
        [
            middle + self.cloth_px * (right * cos - up * sin),
            middle - self.cloth_px * (right * sin + up * cos),
        ]
    }

    fn whole_pixel(&self, point: Point) -> PixelPoint {
        let [u, v] = self.pixel(point).map(|value| value.round() as i32);
        PixelPoint::new(u, v)
    }

    fn paint(&self, outline: &[Point]) -> RgbImage {
        let outline: Vec<Point> = outline.iter().map(|&point| self.pixel(point)).collect();
        let tile_px = self.side_px / 4;
        RgbImage::from_fn(self.side_px, self.side_px, |column, row| {
            let is_cloth = encloses(&outline, [f64::from(column) + 0.5, f64::from(row) + 0.5]);
            let tile = self.tiles[((column / tile_px + row / tile_px) % 2) as usize];
            Rgb(if is_cloth { self.cloth } else { tile })
        })
    }

    /// The two pictures of a fold, the arrow on the first.
    fn pictures(&self, fold: &Fold) -> [RgbImage; 2] {
        let mut first = self.paint(&fold.before);
        draw_arrow(&mut first, self.pixel(fold.tail), self.pixel(fold.tip));
        [first, self.paint(&fold.after)]
    }
}

/// Draws a ring of radius 3 and an arrow of width 2 in black; both grow with pictures above 224 px.
fn draw_arrow(picture: &mut RgbImage, tail: Point, tip: Point) {
    let scale = (f64::from(picture.width()) / 224.0).max(1.0);
    let back = |turn: f64| {
        let [x, y] = [tail[0] - tip[0], tail[1] - tip[1]].map(|part| part * 0.1);
        [tip[0] + x - turn * y, tip[1] + y + turn * x]
    };
    let strokes = [[tail, tip], [tip, back(1.0)], [tip, back(-1.0)]];
    for (column, row, pixel) in picture.enumerate_pixels_mut() {
        let at = [f64::from(column) + 0.5, f64::from(row) + 0.5];
        let off_line_px = strokes.map(|stroke| hull::distance_to_outline(&stroke, at));
        let off_ring_px = (hull::distance(at, tail) - 3.0 * scale).abs();
        if off_line_px
            .iter()
            .chain([&off_ring_px])
            .any(|&off_px| off_px <= scale)
            && hull::distance(at, tail) > 2.0 * scale
        {
            *pixel = Rgb([0; 3]);
        }
    }
}

/// Even-odd rule.
fn encloses(outline: &[Point], [x, y]: Point) -> bool {
    let edges = outline.iter().zip(outline.iter().cycle().skip(1));
    let crossed = edges.filter(|(a, b)| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    });
    crossed.count() % 2 == 1
}

fn png(picture: &RgbImage) -> Part {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    Part::Image(Png::new(bytes.into_inner()))
}

fn user(parts: Vec<Part>) -> Message {
    Message {
        speaker: Speaker::User,
        parts,
    }
}

fn ask(role: ModelRole, messages: Vec<Message>) -> String {
    let request = Request::new(role, messages);
    Geometric
        .ask(&request, &mut Ledger::unwritten(&Budget::default()))
        .unwrap()
        .text
}

/// Asks for the step between pictures in words.
fn described(pictures: &[RgbImage]) -> String {
    let text = Part::Text("What is done here?".to_owned());
    let parts = std::iter::once(text)
        .chain(pictures.iter().map(png))
        .collect();
    ask(ModelRole::Vision, vec![user(parts)])
}

/// The instruction that pictures lead to.
fn instruction(pictures: &[RgbImage]) -> String {
    let reply = described(pictures);
    let line = reply
        .lines()
        .find_map(|line| line.strip_prefix("Instructions: "));
    let sentence = line.and_then(|line| line.strip_suffix('.'));
    sentence
        .unwrap_or_else(|| panic!("no instruction in: {reply}"))
        .to_owned()
}

/// A planning prompt in the wording of the task library.
fn planning_prompt(instruction: &str, corners: &[PixelPoint], center: PixelPoint) -> String {
    let listed: Vec<String> = corners.iter().map(ToString::to_string).collect();
    format!(
        "- Method of folding: {instruction}\n- Cloth corners: {}\n- Cloth center: {center}",
        listed.join(", ")
    )
}

/// Pick and place of an answer in the paper's form.
fn points_of(reply: &str) -> [PixelPoint; 2] {
    ["Pick Point = ", "Place Point = "].map(|label| {
        let line = reply.lines().find_map(|line| line.strip_prefix(label));
        prompt::points(line.unwrap_or_else(|| panic!("no points in: {reply}")))[0]
    })
}

/// The pick and the place that an instruction leads to on listed points.
fn planned(instruction: &str, corners: &[PixelPoint], center: PixelPoint) -> [PixelPoint; 2] {
    let text = planning_prompt(instruction, corners, center);
    points_of(&ask(
        ModelRole::Text,
        vec![Message::text(Speaker::User, text)],
    ))
}
