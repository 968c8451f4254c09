//! Points typed one a line, kept as they come.
//!
//! In: lines of stdin. Out: the points, and on stderr how each fits those before it. After every line the points so far
//! are in a file, so that an interrupted session loses none.

use super::{kept, write};
use crate::exit::Failure;
use crate::output;
use compiler::program::PixelPoint;
use image::RgbImage;
use runtime::arm::calibration::{Pair, Said, Session, Terms, ToolReader, csv_line, grid};
use runtime::picture;
use runtime::vision::{draw_numbers, draw_points};
use std::io::{BufRead, Read};
use std::path::{Path, PathBuf};

/// The longest line that is read, bytes.
const MAX_LINE: u64 = 1000;

/// What is asked for beside the points.
pub struct Asked<'a> {
    /// Columns and rows of the grid at which points are asked for.
    pub grid: Option<[u32; 2]>,
    /// The calibration's file.
    pub path: &'a Path,
    /// The camera's own picture.
    pub seen: Option<&'a RgbImage>,
}

/// Asks for points after those given until there are no more.
pub fn type_points(
    terms: &Terms,
    given: Vec<Pair>,
    tool: Option<Box<ToolReader<'_>>>,
    asked: &Asked<'_>,
) -> Result<Vec<Pair>, Failure> {
    let targets = match asked.grid {
        Some([columns, rows]) => grid(&terms.window, columns, rows),
        None => Vec::new(),
    };
    show(&targets, asked)?;
    let kept_in = asked.path.with_extension("pairs.csv");
    let mut session = Session::new(terms, given, tool);
    output::talk(&format!(
        "type {}, one point a line; `undo`, `list`, `done`",
        session.form()
    ));
    let mut is_first = true;
    let mut stdin = std::io::stdin().lock();
    loop {
        ask(&session, &targets);
        let mut line = String::new();
        if stdin.by_ref().take(MAX_LINE).read_line(&mut line)? == 0 {
            break;
        }
        match session.line(&line) {
            Said::Added(said) | Said::TakenBack(said) => {
                if std::mem::take(&mut is_first)
                    && let Some(earlier) = kept::keep(&kept_in)?
                {
                    say_earlier(&earlier);
                }
                keep(&kept_in, session.pairs())?;
                output::talk(&said);
            }
            Said::Nothing(said) if said.is_empty() => {}
            Said::Nothing(said) => output::talk(&said),
            Said::Wrong(why) => output::talk(&format!("error: {why}")),
            Said::Over => break,
        }
    }
    Ok(session.pairs().to_vec())
}

fn say_earlier(earlier: &Path) {
    output::talk(&format!(
        "note: the points of an earlier session are in `{}`",
        earlier.display()
    ));
}

fn keep(path: &Path, pairs: &[Pair]) -> Result<(), Failure> {
    let lines: String = pairs.iter().map(|pair| csv_line(pair) + "\n").collect();
    write(path, format!("u,v,x,y,z,depth\n{lines}").as_bytes())
}

/// Names the place of the grid that comes next.
fn ask(session: &Session<'_>, targets: &[[f64; 2]]) {
    let n = session.pairs().len();
    if let Some([u, v]) = targets.get(n) {
        let n_all = targets.len();
        output::talk(&format!(
            "point {} of {n_all}, best near the pixel {u}, {v}:",
            n + 1
        ));
    }
}

/// Draws where points are best touched into the camera's picture.
fn show(targets: &[[f64; 2]], asked: &Asked<'_>) -> Result<(), Failure> {
    let (Some(seen), false) = (asked.seen, targets.is_empty()) else {
        return Ok(());
    };
    let mut drawn = seen.clone();
    let points: Vec<PixelPoint> = targets
        .iter()
        .map(|[u, v]| PixelPoint::new(*u as i32, *v as i32))
        .collect();
    draw_points(&mut drawn, &points, [255, 220, 0], 3).map_err(Failure::environment)?;
    draw_numbers(&mut drawn, targets);
    let path: PathBuf = asked.path.with_extension("grid.png");
    write(&path, &picture::encode(&drawn))?;
    output::talk(&format!(
        "`{}` shows where points are best touched",
        path.display()
    ));
    Ok(())
}
