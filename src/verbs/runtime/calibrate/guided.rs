//! Points to which a person guides the arm: their pixels are typed one per line, and they are saved at once.
//!
//! In: lines, and the arm's tool position at each. Out: the points, and on stderr how well each fits the earlier ones, so
//! that a mistake shows while the arm is still there. The points are saved to a file after every line, so that an
//! interrupted session loses none.

use crate::exit::Failure;
use crate::io::{Io, write_file};
use crate::verbs::runtime::robot::terminal::line_of;
use fab_arm::calibration::{Pair, SeenTags, Terms, csv_line, parse_pixel};
use std::io::BufRead;
use std::path::Path;

/// Asks for pixels until `done` or the end of input; returns the points, after the given ones.
///
/// - `tool`: reads the tool's position with the arm at rest, metres, base frame, or says why there is none.
/// - `saved`: the file of the points.
pub fn points(
    terms: &Terms,
    given: Vec<Pair>,
    tool: &mut dyn FnMut() -> Result<[f64; 3], String>,
    tags: SeenTags<'_>,
    saved: &Path,
    lines: &mut dyn BufRead,
    io: &Io,
) -> Result<Vec<Pair>, Failure> {
    if given.is_empty() && saved.exists() {
        let saved = saved.display();
        return Err(Failure::environment(format!(
            "the points of an earlier session are in `{saved}`: go on with `--pairs {saved} --jog`, or move the file away"
        )));
    }
    io.talk(
        "type `u,v`, or `tag7`, with the fingertips on that point, one point a line; `undo`, `done`",
    );
    let mut pairs = given;
    while let Some(line) = line_of(lines) {
        let n = pairs.len();
        let said = match line.trim() {
            "" => continue,
            "done" => break,
            "undo" => {
                pairs.pop();
                format!("{} points are left", pairs.len())
            }
            typed => {
                let pixel = parse_pixel(typed, tags);
                match pixel.and_then(|pixel| {
                    Ok(Pair {
                        pixel,
                        base_m: tool()?,
                    })
                }) {
                    Ok(pair) => {
                        let fit = terms.off_mm(&pairs, &pair).map_or(
                            "added; the points before it do not yet tell where it should be".to_owned(),
                            |off_mm| format!("{off_mm:.1} mm from where the {n} before it put it (`undo` removes it)"),
                        );
                        pairs.push(pair);
                        format!("point {}: {fit}", n + 1)
                    }
                    Err(why) => format!("error: {why}"),
                }
            }
        };
        if pairs.len() != n {
            let points: String = pairs.iter().map(|pair| csv_line(pair) + "\n").collect();
            write_file(saved, format!("u,v,x,y,z\n{points}").as_bytes())?;
        }
        io.talk(&said);
    }
    Ok(pairs)
}

#[cfg(test)]
mod tests;
