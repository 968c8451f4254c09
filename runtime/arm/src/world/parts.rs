//! The parts of an arm's world: its files, supervisor and watchdog.

use super::flat_picture;
use crate::calibration::Calibration;
use crate::guard::{Guard, Surface};
use crate::settings::{DriverKind, Settings};
use crate::sight::Sight;
use crate::supervisor::{Supervisor, Watchdog};
use crate::table::ClothTable;
use fab_base::digest;
use fab_program::Material;
use fab_world::About;
use image::RgbImage;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Everything that an arm's world consists of.
pub struct Parts {
    /// The settings.
    pub settings: Settings,
    /// The hash of the settings' text.
    pub settings_hash: String,
    /// The calibration of the camera.
    pub calibration: Calibration,
    /// The vision functions.
    pub sight: Sight,
    /// Side of the square picture that the task's camera takes, pixels.
    pub image_px: u32,
    /// What a simulated cloth is made of, if the task says so; a real one is what it is.
    pub material: Option<Material>,
    /// Who confirms motion.
    pub supervisor: Box<dyn Supervisor>,
    /// Stops the arm if this program hangs.
    pub watchdog: Box<dyn Watchdog>,
    /// The run folder, for the arm's journal; without one nothing moves.
    pub folder: Option<PathBuf>,
}

/// Returns the guard of an arm's motions over a calibrated table.
pub fn guard(settings: &Settings, calibration: &Calibration) -> Guard {
    Guard::new(settings, Surface::of(calibration))
}

/// Returns the pose of the world frame, whose origin is the middle of the table.
pub fn base_from_world(settings: &Settings) -> Isometry3<f64> {
    let [x, y, z] = settings.table.center_m;
    Isometry3::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), settings.table.turn_deg.to_radians()),
    )
}

/// Reads the settings and the calibration of a world; the error says what is wrong with either.
pub fn load(path: &Path) -> Result<(Settings, String, Calibration), String> {
    let settings = Settings::load(path).map_err(|error| error.to_string())?;
    let text = fab_base::files::read(path, 1 << 20)
        .map_err(|why| format!("`{}`: {why}", path.display()))?;
    let mut hash = Sha256::new();
    hash.update(&text);
    if settings.arm.is_some() {
        // The URDF and its meshes are part of the settings.
        hash.update(format!("{:?}", settings.chain()));
    }
    let hash = digest::hex(&hash.finalize());
    let beside = path.parent().unwrap_or(Path::new("."));
    let calibration = Calibration::load(&beside.join(&settings.calibration))?;
    Ok((settings, hash, calibration))
}

/// Returns the identity of the world of a settings file; the error says which file is wrong.
pub fn about(path: &Path) -> Result<About, String> {
    let (settings, settings_hash, calibration) = load(path)?;
    let flat = flat_picture(path, &settings, &calibration)?;
    Ok(About {
        name: name(&settings).to_owned(),
        parameters: parameters(&settings_hash, &calibration, flat.as_ref()),
        code: code(settings.driver),
    })
}

pub(super) fn name(settings: &Settings) -> &'static str {
    match (settings.driver, &settings.arm) {
        (DriverKind::Simulated, _) => "simulated_arm",
        (_, None) => "jaco",
        (_, Some(_)) => "arm",
    }
}

pub(super) fn code(driver: DriverKind) -> String {
    let version = env!("CARGO_PKG_VERSION");
    match driver {
        DriverKind::Simulated => format!("{version} {}", ClothTable::code()),
        DriverKind::Kinova | DriverKind::Trajectory | DriverKind::Ros2 => version.to_owned(),
    }
}

pub(super) fn parameters(
    settings_hash: &str,
    calibration: &Calibration,
    flat: Option<&RgbImage>,
) -> String {
    let mut hash = Sha256::new();
    hash.update(settings_hash);
    hash.update(calibration.to_toml());
    if let Some(flat) = flat {
        hash.update(flat.as_raw());
    }
    digest::hex(&hash.finalize())[..16].to_owned()
}
