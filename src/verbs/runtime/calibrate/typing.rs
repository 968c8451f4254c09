//! Points typed one per line, and saved at once.
//!
//! In: lines, and with an arm, its tool's position at each. Out: the points, and on stderr how well each fits the
//! earlier ones. The points are saved to a file after every line, so that an interrupted session loses none.

use super::keep_copy;
use crate::exit::Failure;
use crate::io::{Io, write_file};
use fab_arm::calibration::{
    LineOutcome, Pair, SeenTags, Session, Terms, ToolReader, Window, csv_line, grid,
};
use fab_picture::png;
use fab_program::PixelPoint;
use fab_vision::{DrawnLayer, DrawnShape, draw_layers};
use image::RgbImage;
use std::io::{BufRead, Read};
use std::path::Path;

const MAX_LINE: u64 = 1000;

pub struct TypingSetup<'a> {
    /// The square of the picture that tasks see.
    pub window: Window,
    /// Columns and rows of the grid of points to touch.
    pub grid: Option<[u32; 2]>,
    pub path: &'a Path,
    pub seen: &'a RgbImage,
    pub tags: SeenTags<'a>,
}

/// Asks for points after the given ones until `done` or the end of input.
pub fn type_points(
    terms: &Terms,
    given: Vec<Pair>,
    tool: Option<Box<ToolReader<'_>>>,
    setup: &TypingSetup<'_>,
    lines: &mut dyn BufRead,
    io: &Io,
) -> Result<Vec<Pair>, Failure> {
    let targets = match setup.grid {
        Some([columns, rows]) => grid(&setup.window, columns, rows),
        None => Vec::new(),
    };
    show(&targets, setup, io)?;
    let saved_in = setup.path.with_extension("pairs.csv");
    let mut session = Session::new(terms, given, setup.tags, tool);
    io.talk(&format!(
        "type {}, one point a line; `undo`, `list`, `done`",
        session.form()
    ));
    let mut is_first = true;
    loop {
        let n = session.pairs().len();
        if let Some([u, v]) = targets.get(n) {
            let (next, n_all) = (n + 1, targets.len());
            let place = format!("best near the pixel {u}, {v}:");
            io.talk(&format!("point {next} of {n_all}, {place}"));
        }
        let mut line = String::new();
        if Read::take(&mut *lines, MAX_LINE).read_line(&mut line)? == 0 {
            break;
        }
        match session.line(&line) {
            LineOutcome::Added(message) | LineOutcome::Undone(message) => {
                if std::mem::take(&mut is_first)
                    && let Some(earlier) = keep_copy(&saved_in)?
                {
                    let earlier = earlier.display();
                    io.talk(&format!(
                        "note: the points of an earlier session are in `{earlier}`"
                    ));
                }
                let points = session.pairs().iter();
                let points: String = points.map(|pair| csv_line(pair) + "\n").collect();
                write_file(&saved_in, format!("u,v,x,y,z\n{points}").as_bytes())?;
                io.talk(&message);
            }
            LineOutcome::Unchanged(message) if message.is_empty() => {}
            LineOutcome::Unchanged(message) => io.talk(&message),
            LineOutcome::Invalid(why) => io.talk(&format!("error: {why}")),
            LineOutcome::Finished => break,
        }
    }
    Ok(session.pairs().to_vec())
}

fn show(targets: &[[f64; 2]], setup: &TypingSetup<'_>, io: &Io) -> Result<(), Failure> {
    if targets.is_empty() {
        return Ok(());
    }
    let pixel = |[u, v]: &[f64; 2]| PixelPoint::new(*u as i32, *v as i32);
    let at: Vec<_> = targets.iter().map(pixel).collect();
    let dots = DrawnShape::Dots {
        at: at.clone(),
        radius_px: 3,
    };
    let numbers = DrawnShape::Numbers { at };
    let layers = [([255, 220, 0], dots), ([255; 3], numbers)];
    let layers = layers.map(|(rgb, shape)| DrawnLayer { rgb, shape });
    let drawn = draw_layers(setup.seen, &layers)?;
    let path = setup.path.with_extension("grid.png");
    write_file(&path, &png::encode(&drawn))?;
    let path = path.display();
    io.talk(&format!("`{path}` shows where points are best touched"));
    Ok(())
}

#[cfg(test)]
mod tests;
