//! An arm's eyes: detectors of [`fab_vision`], and pictures of its plans and calibrations.

use fab_arm::calibration::{Calibration, Pair};
use fab_arm::kinematics::reach::Reach;
use fab_arm::plan::Plan;
use fab_arm::settings::Settings;
use fab_arm::sight::Sight;
use fab_picture::camera::Plane;
use fab_program::PixelPoint;
use fab_vision::{DrawnLayer, DrawnShape, VisionError, draw_layers, draw_residuals};
use image::RgbImage;
use nalgebra::Point3;
use std::f64::consts::TAU;

/// Finds marks again, and draws plans.
pub const SIGHT: Sight = Sight {
    marks: |picture| fab_vision::marks(picture).map_err(|error| error.to_string()),
    find_again: |first, marks, second| {
        fab_vision::find_again(first, marks, second).map_err(|error| error.to_string())
    },
    draw_plan,
};

/// Length of a drawn error as a multiple of the error.
const TIMES: f64 = 10.0;

const GRAY: [u8; 3] = [130; 3];
const GREEN: [u8; 3] = [0, 150, 60];
const RED: [u8; 3] = [215, 30, 30];
const BLUE: [u8; 3] = [20, 90, 220];
const PURPLE: [u8; 3] = [128, 0, 128];

/// Number of points on a rim.
const RIM: usize = 180;

/// Draws measured points with their errors: a ring and a number at each, and an arrow towards where the fit expects it.
/// Without a fit, only the points.
pub fn draw_errors(
    picture: &mut RgbImage,
    pairs: &[Pair],
    fit: Option<&Plane>,
) -> Result<(), VisionError> {
    let places = pairs.iter().map(|pair| {
        let expected = fit.and_then(|fit| fit.pixel_from_world(Point3::from(pair.base_m)));
        (pair.pixel, expected)
    });
    draw_residuals(picture, &places.collect::<Vec<_>>(), TIMES)
}

/// Draws a plan on the camera's own picture, from above.
///
/// Green is the workspace at the table's height, red the forbidden zones, grey the limit of the arm's reach there; the
/// arrow leads from pick to place.
fn draw_plan(
    plan: &Plan,
    picture: &RgbImage,
    calibration: &Calibration,
    settings: &Settings,
    reach: &Reach,
) -> Result<RgbImage, String> {
    let table_z = settings.table.center_m[2];
    let pixel = |x: f64, y: f64, z: f64| {
        let [column, row] = calibration.fit.pixel_from_world(Point3::new(x, y, z))?;
        let whole = |value: f64| value.clamp(-16_384.0, 16_384.0).floor() as i32;
        (column.is_finite() && row.is_finite()).then(|| PixelPoint::new(whole(column), whole(row)))
    };
    let outline = |points: Vec<PixelPoint>, rgb, width_px| DrawnLayer {
        rgb,
        shape: DrawnShape::Outline { points, width_px },
    };
    let area = |[left, front, _]: [f64; 3], [right, back, _]: [f64; 3]| -> Vec<PixelPoint> {
        let corners = [(left, front), (right, front), (right, back), (left, back)];
        let seen = corners.iter().filter_map(|&(x, y)| pixel(x, y, table_z));
        seen.collect()
    };
    let workspace = &settings.workspace;
    let mut layers = vec![outline(area(workspace.min_m, workspace.max_m), GREEN, 2)];
    if let Some(range) = reach.range(table_z) {
        for radius_m in [range.nearest_m, range.farthest_m] {
            let at = |step: usize| {
                let (sin, cos) = (TAU * step as f64 / RIM as f64).sin_cos();
                pixel(radius_m * cos, radius_m * sin, table_z)
            };
            layers.push(outline((0..RIM).filter_map(at).collect(), GRAY, 1));
        }
    }
    for zone in &workspace.keep_out {
        layers.push(outline(area(zone.min_m, zone.max_m), RED, 2));
    }
    let ring = |at, rgb| DrawnLayer {
        rgb,
        shape: DrawnShape::Rings {
            at: vec![at],
            radius_px: 7,
            width_px: 2,
        },
    };
    let ends = [plan.pick_m, plan.place_m].map(|[x, y, z]| pixel(x, y, z));
    if let [Some(from), Some(to)] = ends {
        let shape = DrawnShape::Arrow {
            from,
            to,
            width_px: 2,
        };
        layers.extend([
            DrawnLayer { rgb: BLUE, shape },
            ring(from, BLUE),
            ring(to, PURPLE),
        ]);
    }
    draw_layers(picture, &layers).map_err(|error| error.to_string())
}
