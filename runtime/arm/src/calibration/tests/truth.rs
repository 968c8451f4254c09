//! A camera over a table and an arm that touches it, both simulated; `super` brings the calibration into scope.

use super::{Fit, Intrinsics, Method, Pair, Terms, Window};
use fab_picture::camera::Lens;
use nalgebra::{Isometry3, Point3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// A camera with a known pose above a table of known height.
pub struct Truth {
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
            base_from_camera: Isometry3::translation(0.45, 0.02, 1.0) * turned * down * tilted,
            lens: Lens::undistorted([600.0, 602.0], [322.0, 238.0]),
            height: [0.02, 0.005, -0.003],
        }
    }

    pub fn fit(&self) -> Fit {
        Fit::Rigid {
            base_from_camera: self.base_from_camera,
            lens: self.lens,
            height: self.height,
            scale: 1.0,
        }
    }

    /// The touched point at the place that a pixel shows.
    pub fn pair(&self, pixel: [f64; 2]) -> Pair {
        let touched = self.fit().table_from_pixel(pixel).unwrap();
        Pair {
            pixel,
            base_m: touched.coords.into(),
            depth_m: Some(self.depth(touched)),
        }
    }

    pub fn depth(&self, point: Point3<f64>) -> f64 {
        self.base_from_camera.inverse_transform_point(&point).z
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
            .map(|(column, row)| self.pair(window().pixel_at([at(column), at(row)])))
            .collect()
    }
}

pub fn window() -> Window {
    Window::from([80, 0, 480])
}

pub fn terms(method: Method) -> Terms {
    Terms {
        method,
        camera: "simulated".to_owned(),
        size_px: [640, 480],
        intrinsics: match method {
            Method::Plane => None,
            Method::Rigid => Some(Truth::usual().intrinsics()),
        },
        window: window(),
        reach_m: [[0.15, -0.525], [0.75, 0.525]],
        limit_mm: method.limit_mm(),
    }
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
