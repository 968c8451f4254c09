//! Draws a plan: from above in the camera's own picture, and below it the height along the path.
//!
//! In: a plan, a picture, the calibration, the settings. Out: a picture. Green is the workspace at the table's height,
//! red the forbidden zones, grey the limit of the arm's reach there; the arrow leads from pick to place.

use fab_arm::calibration::Calibration;
use fab_arm::kinematics::reach::Reach;
use fab_arm::plan::Plan;
use fab_arm::settings::Settings;
use fab_program::PixelPoint;
use fab_vision::{DrawnLayer, DrawnShape, VisionError, draw_label, draw_layers};
use image::{RgbImage, imageops};
use nalgebra::Point3;
use std::f64::consts::TAU;

const PAPER: [u8; 3] = [255; 3];
const INK: [u8; 3] = [30; 3];
const GRAY: [u8; 3] = [130; 3];
const FAINT: [u8; 3] = [215; 3];
const GREEN: [u8; 3] = [0, 150, 60];
const RED: [u8; 3] = [215, 30, 30];
const BLUE: [u8; 3] = [20, 90, 220];
const PURPLE: [u8; 3] = [128, 0, 128];

/// The least width of the drawing, pixels: enough for the names of thirteen segments.
const MIN_WIDTH_PX: u32 = 900;

/// Height of the lower part, and of its margins, pixels.
const PANEL_PX: u32 = 230;
const TOP_PX: f64 = 30.0;
const BOTTOM_PX: f64 = 56.0;
const LEFT_PX: f64 = 52.0;

/// Number of points on a rim.
const RIM: usize = 180;

/// Draws a plan.
///
/// - `picture`: the camera's own picture, of the calibration's size.
pub fn draw(
    plan: &Plan,
    picture: &RgbImage,
    calibration: &Calibration,
    settings: &Settings,
    reach: &Reach,
) -> Result<RgbImage, VisionError> {
    let above = from_above(plan, picture, calibration, settings, reach)?;
    let width = above.width().max(MIN_WIDTH_PX);
    let mut sheet = RgbImage::from_pixel(width, above.height() + PANEL_PX, image::Rgb(PAPER));
    let aside = i64::from((width - above.width()) / 2);
    imageops::replace(&mut sheet, &above, aside, 0);
    let panel = along(plan, settings, width)?;
    imageops::replace(&mut sheet, &panel, 0, i64::from(above.height()));
    Ok(sheet)
}

fn from_above(
    plan: &Plan,
    picture: &RgbImage,
    calibration: &Calibration,
    settings: &Settings,
    reach: &Reach,
) -> Result<RgbImage, VisionError> {
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
    let area = |min_m: &[f64; 3], max_m: &[f64; 3]| -> Vec<PixelPoint> {
        let corners = [
            (min_m[0], min_m[1]),
            (max_m[0], min_m[1]),
            (max_m[0], max_m[1]),
            (min_m[0], max_m[1]),
        ];
        let seen = corners.iter().filter_map(|&(x, y)| pixel(x, y, table_z));
        seen.collect()
    };
    let workspace = &settings.workspace;
    let mut layers = vec![outline(area(&workspace.min_m, &workspace.max_m), GREEN, 2)];
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
        layers.push(outline(area(&zone.min_m, &zone.max_m), RED, 2));
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
        layers.push(DrawnLayer {
            rgb: BLUE,
            shape: DrawnShape::Arrow {
                from,
                to,
                width_px: 2,
            },
        });
        layers.extend([ring(from, BLUE), ring(to, PURPLE)]);
    }
    draw_layers(picture, &layers)
}

/// Draws the tool's height over the table, a column for each segment.
fn along(plan: &Plan, settings: &Settings, width: u32) -> Result<RgbImage, VisionError> {
    let panel = RgbImage::from_pixel(width, PANEL_PX, image::Rgb(PAPER));
    let table_z = settings.table.center_m[2];
    let over = |at_m: &[f64; 3]| (at_m[2] - table_z) * 1000.0;
    let heights: Vec<f64> = std::iter::once(over(&plan.from_m))
        .chain(plan.segments.iter().map(|segment| over(&segment.to_m)))
        .collect();
    let top_mm = heights.iter().copied().fold(50.0, f64::max);
    let bottom_px = f64::from(PANEL_PX) - BOTTOM_PX;
    let row = |mm: f64| (bottom_px - (bottom_px - TOP_PX) * (mm / top_mm)) as i32;
    let column_px = (f64::from(width) - 2.0 * LEFT_PX) / plan.segments.len().max(1) as f64;
    let column = |index: usize| (LEFT_PX + column_px * index as f64) as i32;
    let line = |from: PixelPoint, to: PixelPoint, rgb, width_px| DrawnLayer {
        rgb,
        shape: DrawnShape::Outline {
            points: vec![from, to],
            width_px,
        },
    };
    let right = width as i32 - 8;
    let level = |mm: f64, rgb| {
        let (from, to) = (column(0), right);
        line(
            PixelPoint::new(from, row(mm)),
            PixelPoint::new(to, row(mm)),
            rgb,
            1,
        )
    };
    let mut layers = vec![level(0.0, GRAY), level(top_mm, FAINT)];
    for (index, segment) in plan.segments.iter().enumerate() {
        let (from, to) = (
            PixelPoint::new(column(index), row(heights[index])),
            PixelPoint::new(column(index + 1), row(heights[index + 1])),
        );
        let is_last = index + 1 == plan.segments.len();
        let rgb = match (
            plan.refused.is_some() && is_last,
            segment.name.may_hold_cloth(),
        ) {
            (true, _) => RED,
            (false, true) => BLUE,
            (false, false) => INK,
        };
        layers.push(line(from, to, rgb, 2));
        layers.push(DrawnLayer {
            rgb,
            shape: DrawnShape::Dots {
                at: vec![to],
                radius_px: 3,
            },
        });
    }
    let mut panel = draw_layers(&panel, &layers)?;
    let mut label = |text: &str, at: [i32; 2], rgb, height_px| {
        draw_label(
            &mut panel,
            text,
            PixelPoint::new(at[0], at[1]),
            rgb,
            height_px,
        )
    };
    label("the tool's height over the table, mm", [8, 16], INK, 9)?;
    label("0", [30, row(0.0) + 4], INK, 8)?;
    label(&format!("{top_mm:.0}"), [8, row(top_mm) + 4], INK, 8)?;
    for (index, segment) in plan.segments.iter().enumerate() {
        // On one line, neighbouring names would run into each other.
        let down = 16 + 16 * (index as i32 % 2);
        let at = [column(index) + 2, bottom_px as i32 + down];
        let is_refused = plan.refused.is_some() && index + 1 == plan.segments.len();
        let rgb = if is_refused { RED } else { INK };
        label(segment.name.text(), at, rgb, 7)?;
    }
    Ok(panel)
}
