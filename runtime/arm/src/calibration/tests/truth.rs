//! A camera over a table and an arm that touches it, both simulated; `super` brings the calibration into scope.

use super::{Intrinsics, LIMIT_MM, Pair, Terms};
use fab_picture::camera::Lens;
use nalgebra::{Isometry3, Point3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// A camera with a known pose above a table of known height.
pub struct Truth {
    /// Its frame has x image right, y image down, z the optical axis.
    pub base_from_camera: Isometry3<f64>,
    pub lens: Lens,
    pub height: [f64; 3],
}

impl Truth {
    /// A metre above a table in front of the arm, turned by a little more than a quarter, not quite looking straight
    /// down.
    pub fn usual() -> Truth {
        let down = Isometry3::rotation(Vector3::new(std::f64::consts::PI, 0.0, 0.0));
        let turned = Isometry3::rotation(Vector3::new(0.0, 0.0, -FRAC_PI_2 + 0.05));
        let tilted = Isometry3::rotation(Vector3::new(0.04, -0.03, 0.0));
        Truth {
            base_from_camera: Isometry3::translation(0.43, 0.02, 1.0) * turned * down * tilted,
            lens: Lens::undistorted([600.0, 602.0], [322.0, 238.0]),
            height: [0.02, 0.003, -0.003],
        }
    }

    /// The point of the table that a pixel shows.
    pub fn table(&self, pixel: [f64; 2]) -> Point3<f64> {
        let ray = self.lens.camera_from_pixel(pixel, 1.0).unwrap().coords;
        let way = self.base_from_camera.rotation * ray;
        let eye = self.base_from_camera.translation.vector;
        let [level, along_x, along_y] = self.height;
        let above = |point: Vector3<f64>| point.z - level - along_x * point.x - along_y * point.y;
        let far = above(eye) / (above(eye) - above(eye + way));
        assert!(far > 0.0, "{pixel:?}");
        Point3::from(eye + way * far)
    }

    /// The touched point at the place that a pixel shows.
    pub fn pair(&self, pixel: [f64; 2]) -> Pair {
        Pair {
            pixel,
            base_m: self.table(pixel).into(),
        }
    }

    pub fn intrinsics(&self) -> Intrinsics {
        Intrinsics {
            size_px: [640, 480],
            focal_px: self.lens.focal_px,
            middle_px: self.lens.middle_px,
            distortion: self.lens.distortion.to_vec(),
        }
    }

    /// A grid of this many points a side over a share of the window's sides.
    pub fn grid(&self, n: u32, share: f64) -> Vec<Pair> {
        let at = |index: u32| 0.5 + share * (f64::from(index) / f64::from(n - 1) - 0.5);
        let places = (0..n).flat_map(|row| (0..n).map(move |column| (column, row)));
        places
            .map(|(column, row)| self.pair(pixel_at(WINDOW, [at(column), at(row)])))
            .collect()
    }

    pub fn terms(&self) -> Terms {
        Terms {
            limit_mm: LIMIT_MM,
            size_px: [640, 480],
            intrinsics: Some(self.intrinsics()),
        }
    }
}

pub const WINDOW: [u32; 3] = [80, 0, 480];

/// The pixel at shares of the window's sides.
fn pixel_at([left, top, side]: [u32; 3], share: [f64; 2]) -> [f64; 2] {
    let [left, top, side] = [left, top, side].map(f64::from);
    [left + share[0] * side, top + share[1] * side]
}

/// Reproducible random numbers.
pub struct Noise(u64);

impl Noise {
    pub fn new(seed: u64) -> Noise {
        Noise(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Uniform between 0 and 1.
    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal with standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}
