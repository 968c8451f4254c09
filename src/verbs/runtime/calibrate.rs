//! `fabc calibrate`: from points that the arm touched to a file that maps the camera's pixels to the arm's frame.
//!
//! In: the arm's settings; points from a file, or touched by an arm that a person guides; the camera's picture. Out: the
//! calibration file that the settings name, its picture, a drawing of the errors, and their summary. An existing file is replaced.

mod guided;
pub mod report;

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::verbs::runtime::robot::connect;
use crate::verbs::runtime::setting::catalogue;
use clap::{Args, ValueHint};
use fab_agent::arm_sight::{SIGHT, draw_errors};
use fab_arm::calibration::{
    Calibration, LIMIT_MM, SeenTags, Terms, check_window, place_at_rest, read_pairs,
};
use fab_arm::directory::PictureSelection;
use fab_arm::rgbd::Intrinsics;
use fab_arm::settings::{CameraSource, Settings};
use fab_arm::world;
use fab_picture::png;
use image::RgbImage;
use std::path::PathBuf;

const POINTS: &str = "\
Points are lines `u,v,x,y,z`: a pixel of the camera's own picture, then the tool's position in metres in the arm's \
base frame when the fingertips touch what the pixel shows. If the picture shows printed AprilTags (family 36h11), the middle of \
tag 7 is the pixel of `tag7,x,y,z`. With --jog only the pixel is typed, one a line, while the fingertips are there: the tool's \
position is read from the arm, once it is at rest with its hand straight down; `undo` takes the last point back, `done` or the \
end of input ends it. These points are kept beside the file, as NAME.pairs.csv; with --pairs they follow those of a file.

Exit codes: 0 written, 2 refused or a file cannot be used, 64 wrong usage.";

#[derive(Args)]
#[command(after_help = POINTS)]
pub struct CalibrateArguments {
    /// The arm's settings.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub robot: PathBuf,
    /// Points, one a line, commas between; a first line may name the columns.
    #[arg(long, value_name = "CSV", value_hint = ValueHint::FilePath, required_unless_present = "jog")]
    pub pairs: Option<PathBuf>,
    /// Read the tool's position from the arm, which a person guides by hand or by the vendor's joystick; fabc moves nothing.
    #[arg(long)]
    pub jog: bool,
    /// The largest error of a point that the others predict, root mean square, millimetres; default: 4.
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub limit: Option<f64>,
    /// The camera's own picture of the table, by which a moved camera is noticed; default: one from the camera itself, or
    /// the newest of its folder.
    #[arg(long, value_name = "PNG", value_hint = ValueHint::FilePath)]
    pub image: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Calibrates from points of a file, or ones to which a person guides the arm; fabc never moves it.
pub fn run(arguments: &CalibrateArguments, io: &Io) -> Result<Exit, Failure> {
    let settings = if arguments.jog {
        let nobody = "nobody can guide it to a point; give points with `--pairs`";
        connect::settings_of_real(&arguments.robot, nobody)?
    } else {
        Settings::load(&arguments.robot)?
    };
    let (seen, reported) = seen(arguments, &settings)?;
    let terms = Terms {
        limit_mm: arguments.limit.unwrap_or(LIMIT_MM),
        size_px: [seen.width(), seen.height()],
        // Intrinsics in the settings were chosen by the user, so they override the camera's own.
        intrinsics: settings.camera.intrinsics.clone().or(reported),
    };
    // Before anybody touches points in vain.
    terms
        .lens()
        .and_then(|_| check_window(settings.camera.window_px, terms.size_px))
        .map_err(Failure::environment)?;
    let path = arguments.robot.with_file_name(&settings.calibration);
    let tags = fab_vision::tags(&seen).map_err(|why| why.to_string());
    // It matters only to points that name a tag.
    let tags: SeenTags<'_> = tags.as_deref().map_err(String::as_str);
    let mut pairs = Vec::new();
    if let Some(file) = &arguments.pairs {
        pairs = read_pairs(file, tags).map_err(|why| {
            let file = file.display();
            Failure::environment(format!("the points in `{file}` cannot be used: {why}"))
        })?;
    }
    if arguments.jog {
        let mut arm = connect::arm(&settings).map_err(Failure::environment)?;
        let mut tool = || place_at_rest(&mut arm);
        let saved = path.with_extension("pairs.csv");
        pairs =
            io.read(|stdin| guided::points(&terms, pairs, &mut tool, tags, &saved, stdin, io))?;
    }
    let mut picture = seen.clone();
    draw_errors(&mut picture, &pairs, terms.fit(&pairs).ok().as_ref())?;
    let drawn = path.with_extension("points.png");
    write_file(&drawn, &png::encode(&picture))?;
    let refused = |why: String| {
        let drawn = drawn.display();
        Failure::environment(format!(
            "the points are refused and no calibration is written\n{why}\n`{drawn}` shows the points"
        ))
    };
    let (day, reference) = (catalogue::today(io), image::imageops::grayscale(&seen));
    let calibration = Calibration::make(terms, pairs, &day.to_string(), Some(reference));
    let calibration = calibration.map_err(refused)?;
    let corners = calibration.over_table(&settings).map_err(refused)?;
    calibration.save(&path).map_err(Failure::environment)?;
    // A picture in which nothing can be found again would stop every run.
    if let Err(why) = calibration.check_camera(&seen, &SIGHT) {
        io.talk(&format!(
            "note: a moved camera could not be noticed by this picture: {why}"
        ));
    }
    let calibrated = report::Calibrated {
        quality: report::Quality::of(&calibration, corners),
        points: &calibration.pairs,
        reference: Calibration::picture_beside(&path),
        file: path,
        drawn,
    };
    io.either(arguments.json, &calibrated, || calibrated.text());
    Ok(Exit::Done)
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
    let mut camera = camera.map_err(Failure::environment)?;
    let shot = camera.shoot().map_err(|why| {
        let name = camera.name();
        Failure::environment(format!(
            "the camera `{name}` gave no picture: {why}; or give a picture with `--image PNG`"
        ))
    })?;
    Ok((shot.rgb, shot.intrinsics))
}
