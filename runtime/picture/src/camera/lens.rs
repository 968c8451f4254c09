//! Maps between rays and pixels: focal lengths, principal point, distortion.
//!
//! In: points of the camera's own frame (x image right, y image down, z the optical axis; metres), or pixels. Out: the
//! other. Distortion is `plumb_bob` (Brown 1966), as in `sensor_msgs/CameraInfo` and OpenCV.

use nalgebra::Point3;

/// Most iterations of undistorting; five suffice for the lenses of depth cameras.
const MAX_STEPS: usize = 30;
/// How close the distorted result must come to the given pixel, in focal lengths.
const CLOSE: f64 = 1e-12;

/// Focal lengths, principal point and distortion of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Distance of the image plane along columns and rows, pixels.
    pub focal_px: [f64; 2],
    /// Where the optical axis meets the image, pixels.
    pub middle_px: [f64; 2],
    /// Coefficients k1, k2, t1, t2, k3 of `plumb_bob`; zeros for none.
    pub distortion: [f64; 5],
}

impl Lens {
    /// Makes a lens without distortion.
    pub fn undistorted(focal_px: [f64; 2], middle_px: [f64; 2]) -> Lens {
        Lens {
            focal_px,
            middle_px,
            distortion: [0.0; 5],
        }
    }

    /// Returns the same lens for a crop of the picture whose top left is at `origin_px`, enlarged `scale` times.
    pub fn cut(&self, origin_px: [f64; 2], scale: f64) -> Lens {
        Lens {
            focal_px: self.focal_px.map(|focal| focal * scale),
            middle_px: [0, 1].map(|axis| (self.middle_px[axis] - origin_px[axis]) * scale),
            distortion: self.distortion,
        }
    }

    /// Returns the pixel that shows a point of the camera's frame; `None` for points that are not in front of it.
    pub fn pixel_from_camera(&self, seen: Point3<f64>) -> Option<[f64; 2]> {
        if seen.z <= 0.0 {
            return None;
        }
        if self.is_distorted() {
            let ray = [seen.x, seen.y].map(|at| at / seen.z);
            return all_finite(self.on_image(self.distorted(ray)));
        }
        // Multiply before dividing: the simulator's digests depend on the rounding.
        all_finite(
            [0, 1].map(|axis| self.middle_px[axis] + self.focal_px[axis] * seen[axis] / seen.z),
        )
    }

    /// Returns the point of the camera's frame that a pixel shows at a depth, metres along the optical axis.
    ///
    /// `None` if the depth is not a reading (zero, negative, not finite) or no ray leads to the pixel.
    pub fn camera_from_pixel(&self, pixel: [f64; 2], depth_m: f64) -> Option<Point3<f64>> {
        if !(depth_m.is_finite() && depth_m > 0.0) {
            return None;
        }
        let [u, v] = self.straightened(pixel)?;
        Some(Point3::new(
            (u - self.middle_px[0]) * depth_m / self.focal_px[0],
            (v - self.middle_px[1]) * depth_m / self.focal_px[1],
            depth_m,
        ))
    }

    /// Returns where a pixel would be without distortion; `None` if no ray leads to it.
    pub fn straightened(&self, pixel: [f64; 2]) -> Option<[f64; 2]> {
        if !self.is_distorted() {
            return all_finite(pixel);
        }
        let wanted = self.ray(pixel);
        let mut place = wanted;
        for _ in 0..MAX_STEPS {
            let [x, y] = self.distorted(place);
            let (off_x, off_y) = (wanted[0] - x, wanted[1] - y);
            place = [place[0] + off_x, place[1] + off_y];
            if off_x.hypot(off_y) < CLOSE {
                return all_finite(self.on_image(place));
            }
        }
        None
    }

    /// Returns where the lens draws what an undistorted lens would draw at a pixel.
    pub fn bent(&self, pixel: [f64; 2]) -> Option<[f64; 2]> {
        all_finite(self.on_image(self.distorted(self.ray(pixel))))
    }

    pub(super) fn is_distorted(&self) -> bool {
        self.distortion != [0.0; 5]
    }

    fn on_image(&self, ray: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| self.middle_px[axis] + self.focal_px[axis] * ray[axis])
    }

    fn ray(&self, pixel: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| (pixel[axis] - self.middle_px[axis]) / self.focal_px[axis])
    }

    fn distorted(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [k1, k2, t1, t2, k3] = self.distortion;
        let square = x * x + y * y;
        let radial = 1.0 + square * (k1 + square * (k2 + square * k3));
        [
            x * radial + 2.0 * t1 * x * y + t2 * (square + 2.0 * x * x),
            y * radial + t1 * (square + 2.0 * y * y) + 2.0 * t2 * x * y,
        ]
    }
}

/// Returns a pixel or point, if it has finite coordinates.
pub(super) fn all_finite(pixel: [f64; 2]) -> Option<[f64; 2]> {
    pixel.iter().all(|value| value.is_finite()).then_some(pixel)
}
