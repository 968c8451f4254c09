//! `fabc calibrate`: from points that the arm touched to a file that maps the camera's pixels to the arm's frame.
//!
//! In: the arm's settings; points from a file, typed, or touched by an arm that a person guides; the camera's picture.
//! Out: the calibration file, its picture, a drawing of the errors, and their summary. An existing file is kept under
//! another name.

pub mod report;
mod typing;

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::verbs::runtime::robot::connect;
use crate::verbs::runtime::setting::{self, catalogue};
use clap::{Args, ValueHint};
use fab_agent::arm_sight::{SIGHT, draw_errors};
use fab_arm::calibration::{
    Calibration, LIMIT_MM, Pair, Terms, ToolReader, Window, place_at_rest, read_pairs,
};
use fab_arm::directory::PictureSelection;
use fab_arm::rgbd::Intrinsics;
use fab_arm::settings::{CameraSource, Settings};
use fab_arm::world;
use fab_picture::png;
use image::RgbImage;
use std::path::{Path, PathBuf};

const POINTS: &str = "\
Points are lines `u,v,x,y,z`: a pixel of the camera's own picture, then the tool's position in metres in the arm's \
base frame when the fingertips touch what the pixel shows. If the picture shows printed AprilTags (family 36h11), the middle of \
tag 7 is the pixel of `tag7,x,y,z`. Without --pairs they are typed, one a \
line; `undo` takes the last one back, `list` shows them, `done` or the end of input ends it. What was typed is kept beside \
the file, as NAME.pairs.csv. With --jog only the pixel is typed, while the fingertips are there: the tool's position is read \
from the arm, once it is at rest with its hand straight down.

Exit codes: 0 written, 2 refused or a file cannot be used, 64 wrong usage.";

#[derive(Args)]
#[command(after_help = POINTS)]
pub struct CalibrateArguments {
    /// The arm's settings.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub robot: PathBuf,
    /// Points, one a line, commas between; a first line may name the columns.
    #[arg(long, value_name = "CSV", value_hint = ValueHint::FilePath)]
    pub pairs: Option<PathBuf>,
    /// Read the tool's position from the arm, which a person guides by hand or by the vendor's joystick; fabc moves nothing.
    #[arg(long)]
    pub jog: bool,
    /// Type further points after those of --pairs.
    #[arg(long, requires = "pairs")]
    pub more: bool,
    /// Print the pixels where points are best touched: a grid of this many columns and rows over the window.
    #[arg(long, value_name = "4x4", value_parser = columns_and_rows)]
    pub grid: Option<[u32; 2]>,
    /// The largest error of a point that the others predict, root mean square, millimetres; default: 4.
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub limit: Option<f64>,
    /// The camera's own picture of the table, by which a moved camera is noticed; default: one from the camera itself, or
    /// the newest of its folder.
    #[arg(long, value_name = "PNG", value_hint = ValueHint::FilePath)]
    pub image: Option<PathBuf>,
    /// The calibration file to write; default: the one that the settings name. An existing file is kept as FILE.before.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

fn columns_and_rows(text: &str) -> Result<[u32; 2], String> {
    setting::two_counts(text)
        .filter(|sides| sides.iter().all(|side| (2..=20).contains(side)))
        .ok_or_else(|| "write columns and rows, such as `4x4`; each 2 to 20".to_owned())
}

/// Calibrates from points of a file, typed ones, or ones to which a person guides the arm; fabc never moves it.
pub fn run(arguments: &CalibrateArguments, io: &Io) -> Result<Exit, Failure> {
    let mut tool: Option<Box<ToolReader<'_>>> = None;
    if arguments.jog {
        if arguments.pairs.is_some() && !arguments.more {
            return Err(Failure::usage(
                "`--pairs` alone takes its points from the file, and `--jog` from the arm; with `--more` those of the arm follow",
            ));
        }
        let nobody = "nobody can guide it to a point; type points, or give them with `--pairs`";
        let settings = connect::settings_of_real(&arguments.robot, nobody)?;
        let port = connect::port(&settings, settings.camera.timeout_s);
        let mut port = port.map_err(Failure::environment)?;
        let stale_s = settings.tolerance.stale_s;
        // Then only pixels are typed.
        tool = Some(Box::new(move || place_at_rest(port.as_mut(), stale_s)));
    }
    let settings = Settings::load(&arguments.robot)?;
    let (seen, reported) = seen(arguments, &settings)?;
    let limit_mm = arguments.limit.unwrap_or(LIMIT_MM);
    let mut terms = Terms::of(&settings, [seen.width(), seen.height()], limit_mm);
    // Intrinsics in the settings were chosen by the user, so they override the camera's own.
    terms.intrinsics = terms.intrinsics.or(reported);
    // Before anybody touches points in vain.
    let window = Window::from(settings.camera.window_px);
    terms
        .check()
        .and_then(|()| Ok(window.check_in(terms.size_px)?))
        .map_err(|refusal| Failure::environment(refusal.to_string()))?;
    let path = match &arguments.out {
        Some(path) => path.clone(),
        None => arguments
            .robot
            .parent()
            .unwrap_or(Path::new(""))
            .join(&settings.calibration),
    };
    let tags = fab_vision::tags(&seen).map_err(|why| why.to_string());
    let setup = typing::TypingSetup {
        window,
        grid: arguments.grid,
        path: &path,
        seen: &seen,
        // It matters only to points that name a tag.
        tags: tags.as_deref().map_err(String::as_str),
    };
    let pairs = pairs(arguments, &terms, tool, &setup, io)?;
    let day = catalogue::today(io).to_string();
    let reference = image::imageops::grayscale(&seen);
    let made = Calibration::make(terms, pairs.clone(), &day, Some(reference));
    let made = made.and_then(|made| {
        let corners = made.over_table(&settings)?;
        Ok((made, corners))
    });
    let fit = match &made {
        Ok((calibration, _)) => Some(&calibration.fit),
        Err(refusal) => refusal.fit.as_deref(),
    };
    let mut picture = seen.clone();
    draw_errors(&mut picture, &pairs, fit)?;
    let drawn = path.with_extension("points.png");
    write_file(&drawn, &png::encode(&picture))?;
    let (calibration, corners) = made.map_err(|refusal| {
        Failure::environment(format!(
            "the points are refused and no calibration is written\n{refusal}\n`{}` shows the points",
            drawn.display()
        ))
    })?;
    let earlier = keep_copy(&path)?;
    keep_copy(&Calibration::picture_beside(&path))?;
    calibration.save(&path).map_err(Failure::environment)?;
    // A picture in which nothing can be found again would stop every run.
    if let Err(why) = calibration.check_camera(&seen, &SIGHT) {
        io.talk(&format!(
            "note: a moved camera could not be noticed by this picture: {why}"
        ));
    }
    let calibrated = report::Calibrated::of(&calibration, corners, path, drawn, earlier);
    io.either(arguments.json, &calibrated, || calibrated.text());
    Ok(Exit::Done)
}

fn pairs(
    arguments: &CalibrateArguments,
    terms: &Terms,
    tool: Option<Box<ToolReader<'_>>>,
    setup: &typing::TypingSetup<'_>,
    io: &Io,
) -> Result<Vec<Pair>, Failure> {
    let mut given = Vec::new();
    if let Some(file) = &arguments.pairs {
        given = read_pairs(file, setup.tags).map_err(|why| {
            let file = file.display();
            Failure::environment(format!("the points in `{file}` cannot be used: {why}"))
        })?;
        if !arguments.more {
            return Ok(given);
        }
    }
    io.read(|stdin| typing::type_points(terms, given, tool, setup, stdin, io))
}

/// Returns the camera's picture: the given one, that of a simulated table, or one from the camera; and the camera's
/// intrinsics, if it reports them.
fn seen(
    arguments: &CalibrateArguments,
    settings: &Settings,
) -> Result<(RgbImage, Option<Intrinsics>), Failure> {
    if let Some(path) = &arguments.image {
        return Ok((png::load(path)?, None));
    }
    if settings.camera.source == CameraSource::Simulated {
        return Ok((world::simulated_table(settings)?, None));
    }
    let camera = connect::camera(settings, &arguments.robot, PictureSelection::Newest);
    let shot = camera
        .map_err(Failure::environment)?
        .shoot()
        .map_err(|error| {
            Failure::environment(format!("{error}; or give a picture with `--image PNG`"))
        })?;
    Ok((shot.rgb, shot.intrinsics))
}

/// Copies a file to `FILE.before`; returns that name, or `None` if there is no file.
fn keep_copy(path: &Path) -> Result<Option<PathBuf>, Failure> {
    if !path.exists() {
        return Ok(None);
    }
    let earlier = path.with_added_extension("before");
    std::fs::copy(path, &earlier).map_err(|error| {
        Failure::environment(format!(
            "cannot keep a copy of `{}`, so it is not replaced: {error}",
            path.display()
        ))
    })?;
    Ok(Some(earlier))
}
