//! `fabc calibrate`: from points that the arm touched to a file that maps the camera's pixels to the arm's frame.
//!
//! In: the arm's settings; points from a file, typed, or touched by an arm that a person guides; the camera's picture.
//! Out: the calibration file, its picture, a drawing of the errors, and their summary. Nothing is lost: an existing
//! file is kept under another name.

pub mod report;
mod typing;

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::verbs::runtime::robot::connect;
use crate::verbs::runtime::setting::{self, catalogue};
use clap::{Args, ValueHint};
use fab_agent::arm_sight::draw_errors;
use fab_arm::calibration::{
    Calibration, LIMIT_MM, Pair, Terms, ToolReader, place_at_rest, read_pairs,
};
use fab_arm::directory::{PictureSelection, last_picture};
use fab_arm::rgbd::Intrinsics;
use fab_arm::settings::{CameraSource, Settings};
use fab_arm::world;
use fab_picture::png;
use image::RgbImage;
use std::fs::File;
use std::io::{self, ErrorKind};
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
    /// Points, one a line, commas between; a first line may name the columns (`x_mm` is millimetres).
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
    /// The largest root mean square error that is accepted, millimetres; default: 3.
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub limit: Option<f64>,
    /// The camera's own picture of the table, by which a moved camera is noticed; default: the newest of its folder,
    /// where the settings name one.
    #[arg(long, value_name = "PNG", value_hint = ValueHint::FilePath)]
    pub image: Option<PathBuf>,
    /// Take that picture from the camera itself now, of topics or of its folder, and its intrinsics where the settings state
    /// none.
    #[arg(long, conflicts_with = "image")]
    pub shoot: bool,
    /// The calibration file to write; default: the one that the settings name. An existing file is kept as FILE.before-N.
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
    let (seen, told) = seen(arguments, &settings)?.unzip();
    let stated_px = settings.camera.intrinsics.as_ref().map(|it| it.size_px);
    let shown_px = seen.as_ref().map(|seen| [seen.width(), seen.height()]);
    let size_px = shown_px.or(stated_px).ok_or_else(|| {
        Failure::usage(
            "the size of the camera's picture is not known: give a picture with `--image PNG`, or state \
             `camera.intrinsics` in the settings",
        )
    })?;
    let limit_mm = arguments.limit.unwrap_or(LIMIT_MM);
    let mut terms = Terms::of(&settings, size_px, limit_mm);
    // Intrinsics in the settings were chosen by the user, so they override the camera's own.
    terms.intrinsics = terms.intrinsics.or(told.flatten());
    // Before anybody touches points in vain.
    terms.check()?;
    let named = || beside(&arguments.robot, &settings.calibration);
    let path = arguments.out.clone().unwrap_or_else(named);
    let pairs = pairs(arguments, &terms, tool, &path, seen.as_ref(), io)?;
    let day = catalogue::today(io).to_string();
    let reference = seen.as_ref().map(image::imageops::grayscale);
    let made = Calibration::make(terms, pairs.clone(), &day, reference);
    let fit = match &made {
        Ok(calibration) => Some(&calibration.fit),
        Err(refusal) => refusal.fit.as_deref(),
    };
    let mut drawn = None;
    if let Some(mut seen) = seen {
        draw_errors(&mut seen, &pairs, fit)?;
        let file = drawn.insert(path.with_extension("points.png"));
        write_file(file, &png::encode(&seen))?;
    }
    let calibration = made.map_err(|refusal| {
        let shown = drawn.iter();
        let shown = shown.map(|drawn| format!("\n`{}` shows the points", drawn.display()));
        let shown: String = shown.collect();
        Failure::environment(format!(
            "the points are refused and no calibration is written\n{refusal}{shown}"
        ))
    })?;
    let earlier = keep_copy(&path)?;
    keep_copy(&Calibration::picture_beside(&path))?;
    calibration.save(&path)?;
    report::say_doubts(&calibration, io);
    let calibrated = report::Calibrated::of(&calibration, &settings, path, drawn, earlier);
    io.either(arguments.json, &calibrated, || calibrated.text());
    Ok(Exit::Done)
}

fn pairs(
    arguments: &CalibrateArguments,
    terms: &Terms,
    tool: Option<Box<ToolReader<'_>>>,
    path: &Path,
    seen: Option<&RgbImage>,
    io: &Io,
) -> Result<Vec<Pair>, Failure> {
    let tags = match seen {
        Some(seen) => fab_vision::tags(seen).map_err(|why| why.to_string()),
        None => Ok(Vec::new()),
    };
    // It matters only to points that name a tag.
    let tags = tags.as_deref().map_err(String::as_str);
    let mut given = Vec::new();
    if let Some(file) = &arguments.pairs {
        given = read_pairs(file, tags).map_err(|why| {
            let file = file.display();
            Failure::environment(format!("the points in `{file}` cannot be used: {why}"))
        })?;
        if !arguments.more {
            return Ok(given);
        }
    }
    let asked = typing::TypingSetup {
        grid: arguments.grid,
        path,
        seen,
        tags,
    };
    io.read(|stdin| typing::type_points(terms, given, tool, &asked, stdin, io))
}

/// Returns the camera's picture: one given or taken now, the newest of its folder, or that of a simulated table. With
/// it come the camera's intrinsics, if it reports them.
fn seen(
    arguments: &CalibrateArguments,
    settings: &Settings,
) -> Result<Option<(RgbImage, Option<Intrinsics>)>, Failure> {
    if arguments.image.is_none() && settings.camera.source == CameraSource::Simulated {
        return Ok(Some((world::simulated_table(settings)?, None)));
    }
    if arguments.shoot {
        let timeout_s = settings.camera.timeout_s;
        let fresh = PictureSelection::Fresh { timeout_s };
        let camera = connect::camera(settings, &arguments.robot, fresh);
        let shot = camera.map_err(Failure::environment)?.shoot()?;
        return Ok(Some((shot.rgb, shot.intrinsics)));
    }
    let camera = &settings.camera;
    let path = match (&arguments.image, camera.source, &camera.folder) {
        (Some(path), _, _) => Some(path.clone()),
        (None, CameraSource::Directory, Some(folder)) => {
            let folder = beside(&arguments.robot, folder);
            last_picture(&folder).map_err(|why| {
                let folder = folder.display();
                Failure::environment(format!("cannot read the folder `{folder}`: {why}"))
            })?
        }
        _ => None,
    };
    let seen = path.map(|path| png::load(&path)).transpose()?;
    Ok(seen.map(|rgb| (rgb, None)))
}

/// Resolves a path that a settings file names, relative to it.
fn beside(robot: &Path, named: &Path) -> PathBuf {
    robot.parent().unwrap_or(Path::new("")).join(named)
}

const MAX_BACKUPS: u32 = 9999;

/// Copies a file to the first free `FILE.before-N`; returns that name, or `None` if there is no file.
fn keep_copy(path: &Path) -> Result<Option<PathBuf>, Failure> {
    copied(path).map_err(|error| {
        Failure::environment(format!(
            "cannot keep a copy of `{}`, so it is not replaced: {error}",
            path.display()
        ))
    })
}

fn copied(path: &Path) -> io::Result<Option<PathBuf>> {
    let mut old = match File::open(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        old => old?,
    };
    for number in 1..=MAX_BACKUPS {
        let earlier = path.with_added_extension(format!("before-{number}"));
        match File::create_new(&earlier) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            file => {
                let mut file = file?;
                io::copy(&mut old, &mut file)?;
                file.sync_all()?;
                return Ok(Some(earlier));
            }
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}
