//! Points typed one per line, and saved at once.
//!
//! In: lines, and with an arm, its tool's position at each. Out: the points, and on stderr how well each fits the
//! earlier ones. The points are saved to a file after every line, so that an interrupted session loses none.

use super::backup;
use crate::exit::Failure;
use crate::io::{Io, write_file};
use fab_arm::calibration::{
    LineOutcome, Pair, SeenTags, Session, Terms, ToolReader, csv_line, grid,
};
use fab_picture::png;
use fab_program::PixelPoint;
use fab_vision::{DrawnLayer, DrawnShape, draw_layers};
use image::RgbImage;
use std::io::{BufRead, Read};
use std::path::{Path, PathBuf};

/// The longest line that is read, bytes.
const MAX_LINE: u64 = 1000;

/// The setup of a typing session.
pub struct TypingSetup<'a> {
    /// Columns and rows of the grid of points to touch.
    pub grid: Option<[u32; 2]>,
    /// The calibration file.
    pub path: &'a Path,
    /// The camera's own picture.
    pub seen: Option<&'a RgbImage>,
    /// The printed tags that it shows.
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
        Some([columns, rows]) => grid(&terms.window, columns, rows),
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
        ask(&session, &targets, io);
        let mut line = String::new();
        if Read::take(&mut *lines, MAX_LINE).read_line(&mut line)? == 0 {
            break;
        }
        match session.line(&line) {
            LineOutcome::Added(message) | LineOutcome::Undone(message) => {
                if std::mem::take(&mut is_first)
                    && let Some(earlier) = backup::copy(&saved_in)?
                {
                    say_earlier(&earlier, io);
                }
                save(&saved_in, session.pairs())?;
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

fn say_earlier(earlier: &Path, io: &Io) {
    io.talk(&format!(
        "note: the points of an earlier session are in `{}`",
        earlier.display()
    ));
}

fn save(path: &Path, pairs: &[Pair]) -> Result<(), Failure> {
    let lines: String = pairs.iter().map(|pair| csv_line(pair) + "\n").collect();
    write_file(path, format!("u,v,x,y,z\n{lines}").as_bytes())
}

/// Names the next place of the grid.
fn ask(session: &Session<'_>, targets: &[[f64; 2]], io: &Io) {
    let n = session.pairs().len();
    if let Some([u, v]) = targets.get(n) {
        let n_all = targets.len();
        io.talk(&format!(
            "point {} of {n_all}, best near the pixel {u}, {v}:",
            n + 1
        ));
    }
}

/// Draws the suggested points into the camera's picture.
fn show(targets: &[[f64; 2]], setup: &TypingSetup<'_>, io: &Io) -> Result<(), Failure> {
    let (Some(seen), false) = (setup.seen, targets.is_empty()) else {
        return Ok(());
    };
    let at: Vec<PixelPoint> = targets
        .iter()
        .map(|[u, v]| PixelPoint::new(*u as i32, *v as i32))
        .collect();
    let dots = DrawnShape::Dots {
        at: at.clone(),
        radius_px: 3,
    };
    let numbers = DrawnShape::Numbers { at };
    let layers = [([255, 220, 0], dots), ([255; 3], numbers)];
    let layers = layers.map(|(rgb, shape)| DrawnLayer { rgb, shape });
    let drawn = draw_layers(seen, &layers).map_err(Failure::environment)?;
    let path: PathBuf = setup.path.with_extension("grid.png");
    write_file(&path, &png::encode(&drawn))?;
    io.talk(&format!(
        "`{}` shows where points are best touched",
        path.display()
    ));
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use fab_arm::calibration::LIMIT_MM;
    use fab_arm::settings::Settings;

    /// Types these lines while an arm is guided to these places, and returns the points.
    fn guided(typed: &str, mut places: Vec<Result<[f64; 3], String>>) -> (Vec<Pair>, usize) {
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("tasks/real/simulated.toml");
        let settings = Settings::load(&shipped).unwrap();
        let terms = Terms::of(&settings, [720, 720], LIMIT_MM);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lab.toml");
        places.reverse();
        let mut n_looks = 0;
        let tool = || {
            n_looks += 1;
            places.pop().unwrap()
        };
        let setup = TypingSetup {
            grid: None,
            path: &path,
            seen: None,
            tags: Ok(&[]),
        };
        let mut lines = typed.as_bytes();
        let pairs = type_points(
            &terms,
            Vec::new(),
            Some(Box::new(tool)),
            &setup,
            &mut lines,
            &Io::in_memory(),
        );
        let pairs = pairs.unwrap();
        let kept = fab_arm::calibration::read_pairs(&path.with_extension("pairs.csv"), Ok(&[]));
        assert_eq!(kept.unwrap_or_default(), pairs);
        (pairs, n_looks)
    }

    #[test]
    fn the_arm_is_looked_at_when_a_pixel_is_entered_and_at_no_other_line() {
        let (a, b) = ([0.3, 0.1, 0.02], [0.5, -0.1, 0.021]);
        let typed = "360,360\n\nlist\nwhat\nundo\n100 , 200\n500,200\n3,4,5,6,7\ndone\n9,9\n";
        let (pairs, n_looks) = guided(typed, vec![Ok([0.4, 0.0, 0.02]), Ok(a), Ok(b)]);
        let found: Vec<_> = pairs.iter().map(|pair| (pair.pixel, pair.base_m)).collect();
        assert_eq!(found, [([100.0, 200.0], a), ([500.0, 200.0], b)]);
        assert_eq!(n_looks, 3);
    }

    #[test]
    fn a_place_that_the_arm_does_not_give_is_no_point() {
        let moves = || Err("the arm still moves".to_owned());
        let place = [0.3, 0.1, 0.02];
        let (pairs, n_looks) = guided(
            "100,200\n100,200\n100,200\n",
            vec![moves(), moves(), Ok(place)],
        );
        assert_eq!((pairs.len(), n_looks), (1, 3));
        assert_eq!(pairs[0].base_m, place);
    }
}
