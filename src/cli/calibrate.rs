//! Arguments of `calibrate`.

use clap::{Args, ValueEnum, ValueHint};
use fab_arm::calibration::Method;
use std::path::PathBuf;

/// How points are given.
const POINTS: &str = "\
Points are lines `u,v,x,y,z` or `u,v,x,y,z,depth`: a pixel of the camera's own picture, then the tool's position in \
metres in the arm's base frame when the fingertips touch what the pixel shows. Without --pairs they are typed, one a \
line; `undo` takes the last one back, `list` shows them, `done` or the end of input ends it. What was typed is kept beside \
the file, as NAME.pairs.csv. With --jog only the pixel is typed, while the fingertips are there: the tool's position is read \
from the arm, once it is at rest with its hand straight down.

Exit codes: 0 written, 2 refused or a file cannot be used, 64 wrong usage.";

/// Arguments of `calibrate`.
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
    /// Say at which pixels points are best touched: so many columns and rows over the window.
    #[arg(long, value_name = "4x4", value_parser = columns_and_rows)]
    pub grid: Option<[u32; 2]>,
    /// How pixels and the base are joined.
    #[arg(long, value_enum, default_value = "plane")]
    pub method: MethodArgument,
    /// The largest root mean square error that is accepted, millimetres; default: 3 by plane, 5 by rigid.
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
    /// The file; default: the one that the settings name. One that is there is kept as FILE.before-N.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// How pixels and the base are joined.
#[derive(Clone, Copy, ValueEnum)]
pub enum MethodArgument {
    /// A homography to the table's plane; needs no depth.
    Plane,
    /// The camera's pose; needs depth at every point, and the camera's intrinsics.
    Rigid,
}

impl From<MethodArgument> for Method {
    fn from(argument: MethodArgument) -> Method {
        match argument {
            MethodArgument::Plane => Method::Plane,
            MethodArgument::Rigid => Method::Rigid,
        }
    }
}

/// Reads `4x4`, columns and rows.
fn columns_and_rows(text: &str) -> Result<[u32; 2], String> {
    let read = || {
        let (columns, rows) = text.split_once('x')?;
        let sides = [columns.parse().ok()?, rows.parse().ok()?];
        sides
            .iter()
            .all(|side| (2..=20).contains(side))
            .then_some(sides)
    };
    read().ok_or_else(|| "write columns and rows, such as `4x4`; each 2 to 20".to_owned())
}
