//! Points typed one per line, and saved at once.
//!
//! In: lines, and with an arm, its tool's position at each. Out: the points, and on stderr how well each fits the
//! earlier ones, so that a mistake shows while the arm is still there. The points are saved to a file after every line, so
//! that an interrupted session loses none.

use super::keep_copy;
use crate::exit::Failure;
use crate::io::{Io, write_file};
use fab_arm::calibration::{
    MAX_PAIRS, Pair, SeenTags, Terms, ToolReader, Window, csv_line, typed_pair,
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
    mut tool: Option<Box<ToolReader<'_>>>,
    setup: &TypingSetup<'_>,
    lines: &mut dyn BufRead,
    io: &Io,
) -> Result<Vec<Pair>, Failure> {
    let targets = setup
        .grid
        .map_or(Vec::new(), |sides| setup.window.grid(sides));
    show(&targets, setup, io)?;
    let saved_in = setup.path.with_extension("pairs.csv");
    let form = if tool.is_some() {
        "`u,v`, or `tag7`, with the fingertips on that point"
    } else {
        "`u,v,x,y,z`: the pixel, or `tag7`, then the tool in metres"
    };
    io.talk(&format!(
        "type {form}, one point a line; `undo`, `list`, `done`"
    ));
    let (mut pairs, mut is_first) = (given, true);
    loop {
        let n = pairs.len();
        if let Some([u, v]) = targets.get(n) {
            let (next, n_all) = (n + 1, targets.len());
            io.talk(&format!(
                "point {next} of {n_all}, best near the pixel {u}, {v}:"
            ));
        }
        let mut line = String::new();
        if Read::take(&mut *lines, MAX_LINE).read_line(&mut line)? == 0 {
            break;
        }
        let said = match line.trim() {
            "" => continue,
            "done" => break,
            "list" => {
                let points = pairs.iter().zip(1..);
                let points = points.map(|(pair, point)| format!("{point}: {}", csv_line(pair)));
                io.talk(&points.collect::<Vec<String>>().join("\n"));
                continue;
            }
            "undo" if pairs.pop().is_some() => format!("point {n} is taken back"),
            "undo" => "error: there is no point to undo".to_owned(),
            _ if n >= MAX_PAIRS => format!("error: there are {MAX_PAIRS} points; type `done`"),
            typed => {
                let pair = typed_pair(typed, setup.tags, tool.as_deref_mut());
                let checked = pair.and_then(|pair| {
                    terms.check_point(n + 1, &pair)?;
                    Ok(pair)
                });
                match checked {
                    Ok(pair) => {
                        let fit = fit(terms, &pairs, &pair);
                        pairs.push(pair);
                        format!("point {}: {fit}", n + 1)
                    }
                    Err(why) => format!("error: {why}"),
                }
            }
        };
        if pairs.len() != n {
            let earlier = if is_first {
                keep_copy(&saved_in)?
            } else {
                None
            };
            is_first = false;
            if let Some(earlier) = earlier {
                let earlier = earlier.display();
                io.talk(&format!(
                    "note: the points of an earlier session are in `{earlier}`"
                ));
            }
            let points: String = pairs.iter().map(|pair| csv_line(pair) + "\n").collect();
            write_file(&saved_in, format!("u,v,x,y,z\n{points}").as_bytes())?;
        }
        io.talk(&said);
    }
    Ok(pairs)
}

/// Describes how a new point fits the earlier ones.
fn fit(terms: &Terms, earlier: &[Pair], pair: &Pair) -> String {
    let n = earlier.len();
    if n < Terms::MIN_PREDICTING {
        return format!(
            "added; from {} points on, the fit of each new one is shown",
            Terms::MIN_PREDICTING + 1
        );
    }
    match terms.off_mm(earlier, pair) {
        Some(off_mm) => {
            format!("{off_mm:.1} mm from where the {n} before it put it (`undo` removes it)")
        }
        None => format!("added; the {n} points before it do not yet determine where it should be"),
    }
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
