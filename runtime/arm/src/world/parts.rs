//! The parts of an arm's world: its files, supervisor and watchdog.

use super::picture::flat_picture;
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
    /// The files.
    pub files: Files,
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

/// The settings of an arm, and the files that they name.
pub struct Files {
    /// The settings.
    pub settings: Settings,
    /// The calibration of the camera.
    pub calibration: Calibration,
    /// The camera's own picture of the flat cloth, against which coverage is measured, if the settings name one.
    pub flat: Option<RgbImage>,
    /// The identity of their world; each file counts into its parameters.
    pub about: About,
}

impl Files {
    /// Reads a settings file, and those that it names; the error says what is wrong with which.
    pub fn load(path: &Path) -> Result<Files, String> {
        let settings = Settings::load(path).map_err(|error| error.to_string())?;
        let text = fab_base::files::read(path, 1 << 20)
            .map_err(|why| format!("`{}`: {why}", path.display()))?;
        let beside = path.parent().unwrap_or(Path::new("."));
        let calibration = Calibration::load(&beside.join(&settings.calibration))?;
        let flat = flat_picture(beside, &settings, &calibration)?;
        let mut hash = Sha256::new();
        hash.update(&text);
        if settings.arm.is_some() {
            // The URDF and its meshes are part of the settings.
            hash.update(format!("{:?}", settings.chain()));
        }
        hash.update(calibration.to_toml());
        hash.update(flat.as_ref().map_or(&[][..], |flat| flat.as_raw()));
        let name = match (settings.driver, &settings.arm) {
            (DriverKind::Simulated, _) => "simulated_arm",
            (_, None) => "jaco",
            (_, Some(_)) => "arm",
        };
        let mut code = env!("CARGO_PKG_VERSION").to_owned();
        if settings.driver == DriverKind::Simulated {
            code += &format!(" {}", ClothTable::code());
        }
        let about = About {
            name: name.to_owned(),
            parameters: digest::hex(&hash.finalize())[..16].to_owned(),
            code,
        };
        Ok(Files {
            settings,
            calibration,
            flat,
            about,
        })
    }
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
