//! Runs one extractor on an observation.

use super::{Extracted, Scene, SceneError};
use fab_picture::camera::center_of;
use fab_picture::centroid;
use fab_picture::depth_mask;
use fab_picture::observation::Observation;
use fab_picture::{Mask, SubpixelPoint};
use fab_program::data::keypoints::PictureSide;
use fab_program::{ClothPoint, Extractor, Inside, PixelPoint};
use fab_vision::CornerSearch;
use std::borrow::Cow;

impl Scene {
    /// Finds one keypoint; those that it builds on have been found before.
    pub(super) fn extract(
        &self,
        name: &str,
        extractor: &Extractor,
        observation: &Observation,
    ) -> Result<Extracted, SceneError> {
        let out_of_view = |mask: &str| {
            SceneError::OutOfView(mask.to_owned(), format!("; `{name}` is taken from it"))
        };
        let found = match extractor {
            Extractor::DepthMask { below_m } => {
                Extracted::Mask(depth_mask(&observation.depth_m, *below_m))
            }
            Extractor::ColorMask {
                hue_deg,
                saturation,
                value,
            } => {
                let rgb = &observation.rgb;
                Extracted::Mask(fab_vision::color_mask(rgb, *hue_deg, *saturation, *value))
            }
            Extractor::SplitMask {
                of,
                keep,
                blur_px,
                contrast,
            } => {
                let rgb = &observation.rgb;
                Extracted::Mask(fab_vision::split_mask(rgb, *of, *keep, *blur_px, *contrast))
            }
            Extractor::Closed { mask, by_px } => {
                Extracted::Mask(fab_vision::closed(self.mask(mask)?, *by_px))
            }
            Extractor::Largest { mask } => Extracted::Mask(fab_vision::largest(self.mask(mask)?)),
            Extractor::Union { masks } => {
                let masks = masks.iter().map(|mask| self.mask(mask));
                let masks = masks.collect::<Result<Vec<_>, _>>()?;
                of_pixels(observation, |pixel| {
                    masks.iter().any(|mask| mask.contains(pixel))
                })
            }
            Extractor::Minus { mask, without } => {
                let (mask, without) = (self.mask(mask)?, self.mask(without)?);
                of_pixels(observation, |pixel| {
                    mask.contains(pixel) && !without.contains(pixel)
                })
            }
            Extractor::Corners {
                mask,
                of,
                white,
                inside,
                image_px,
                max,
                quality,
                spacing_px,
                block_px,
                response,
            } => {
                let search = CornerSearch {
                    of: *of,
                    image_px: *image_px,
                    max: *max,
                    quality: *quality,
                    spacing_px: *spacing_px,
                    block_px: *block_px,
                    response: *response,
                };
                let mask = self.mask(mask)?;
                let rgb = match white {
                    Some(white) => Cow::Owned(fab_vision::painted_white(
                        &observation.rgb,
                        self.mask(white)?,
                    )),
                    None => Cow::Borrowed(&observation.rgb),
                };
                let mut found = fab_vision::corners(&observation.depth_m, &rgb, mask, &search)?;
                if let Some(Inside { of, margin_px }) = inside {
                    let frame = self.corners_of(of)?;
                    found.retain(|corner| {
                        fab_vision::box_distance_px(corner.pixel, frame) <= *margin_px
                    });
                }
                Extracted::Points(found)
            }
            Extractor::Centroid { mask } => centroid(self.mask(mask)?)
                .map(Extracted::Point)
                .ok_or_else(|| out_of_view(mask))?,
            Extractor::BoundingBox { mask } => fab_vision::bounding_box(self.mask(mask)?)
                .map(Extracted::Box)
                .ok_or_else(|| out_of_view(mask))?,
            Extractor::BoxCenter { of } => {
                let center = fab_vision::box_center(self.corners_of(of)?);
                Extracted::Point(SubpixelPoint::at(center_of(center)))
            }
            Extractor::PictureCenter => {
                let [right, low] = [observation.rgb.width(), observation.rgb.height()]
                    .map(|side| side.saturating_sub(1) as i32);
                let around = [PixelPoint::new(0, 0), PixelPoint::new(right, low)];
                Extracted::Point(SubpixelPoint::at(center_of(fab_vision::box_center(around))))
            }
            Extractor::Contour { mask, tolerance_px } => {
                let around = fab_vision::contour(self.mask(mask)?, *tolerance_px)?;
                if around.is_empty() {
                    return Err(out_of_view(mask));
                }
                Extracted::Outline(around)
            }
            Extractor::EdgeMiddles { outline } => {
                Extracted::Points(fab_vision::edge_middles(self.outline(outline)?))
            }
            Extractor::PointsOf { outline, points } => {
                let found = points_of(self.outline(outline)?, points);
                Extracted::Points(found.unwrap_or_default())
            }
            Extractor::Along { outline, count } => {
                Extracted::Points(fab_vision::along(self.outline(outline)?, *count))
            }
            Extractor::Toward { points, to, share } => {
                let to = self.points_of(to).first().map(|point| point.at);
                let points = self.points_of(points).iter();
                let moved = points.filter_map(|point| Some(between(point.at, to?, *share)));
                let moved = moved.map(SubpixelPoint::at);
                Extracted::Points(moved.collect())
            }
            Extractor::Outermost { points, side } => outermost(self.points_of(points), *side)
                .map(Extracted::Point)
                .ok_or_else(|| {
                    let why = format!("; `{name}` is one of its points");
                    SceneError::NoCandidates(points.clone(), why)
                })?,
            Extractor::Fixed { points } => Extracted::Points(
                points
                    .iter()
                    .copied()
                    .map(|pixel| SubpixelPoint::at(center_of(pixel)))
                    .collect(),
            ),
        };
        // A colour may be out of sight, like the underside of a flat cloth; the cloth may not.
        if let Extracted::Mask(mask) = &found
            && mask.is_empty()
            && self.cloth().is_none()
        {
            let measured = measured(extractor, observation);
            return Err(SceneError::OutOfView(name.to_owned(), measured));
        }
        Ok(found)
    }
}

/// Collects the pixels of the picture for which `is_inside` holds.
fn of_pixels(observation: &Observation, is_inside: impl Fn(PixelPoint) -> bool) -> Extracted {
    let (width, height) = observation.rgb.dimensions();
    Extracted::Mask(Mask::from_fn(width, height, |column, row| {
        is_inside(PixelPoint::new(column as i32, row as i32))
    }))
}

/// Returns the point at a share of the way from one to another.
fn between(a: [f64; 2], b: [f64; 2], share: f64) -> [f64; 2] {
    [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis]))
}

/// Returns points of a cloth that lies with its back up in the picture; `None` for an empty outline.
///
/// Its corners are the vertices farthest towards the picture's corners.
fn points_of(outline: &[PixelPoint], points: &[ClothPoint]) -> Option<Vec<SubpixelPoint>> {
    let corner = |right: i64, down: i64| {
        let towards = |at: &PixelPoint| right * i64::from(at.u) + down * i64::from(at.v);
        let farthest = outline.iter().copied().max_by_key(towards);
        farthest.map(center_of)
    };
    let back = [corner(-1, -1)?, corner(1, -1)?];
    let front = [corner(-1, 1)?, corner(1, 1)?];
    let at = |point: &ClothPoint| {
        let [right, down] = match *point {
            ClothPoint::Particle { right, front } => [right, front],
            ClothPoint::Center => [0.5, 0.5],
        };
        let [a, b] = [back, front].map(|[left, end]| between(left, end, right));
        SubpixelPoint::at(between(a, b, down))
    };
    Some(points.iter().map(at).collect())
}

/// Returns the point closest to a side of the picture; of several, the first.
fn outermost(points: &[SubpixelPoint], side: PictureSide) -> Option<SubpixelPoint> {
    let inward = |point: &SubpixelPoint| match side {
        PictureSide::Left => point.at[0],
        PictureSide::Right => -point.at[0],
        PictureSide::Top => point.at[1],
        PictureSide::Bottom => -point.at[1],
    };
    let points = points.iter().copied();
    points.min_by(|a, b| inward(a).total_cmp(&inward(b)))
}

/// Describes how the pixels of a picture differ from those that a mask selects.
fn measured(extractor: &Extractor, observation: &Observation) -> String {
    match extractor {
        Extractor::DepthMask { below_m } => {
            let depth_m = &observation.depth_m;
            // Beyond any camera's range, so this counts everything with a reading.
            let readings = depth_mask(depth_m, f64::INFINITY);
            let depths = readings.pixels();
            let depths =
                depths.map(|at| f64::from(depth_m.get_pixel(at.u as u32, at.v as u32).0[0]));
            let [nearest_m, farthest_m] = depths.fold([f64::INFINITY, 0.0], |[least, most], m| {
                [m.min(least), m.max(most)]
            });
            if readings.is_empty() {
                return "; the depth picture has no reading".to_owned();
            }
            format!(
                "; its {} readings are {:.1} to {:.1} mm from the camera, and the mask takes what is nearer than {:.1} mm",
                readings.area_px(),
                1000.0 * nearest_m,
                1000.0 * farthest_m,
                1000.0 * below_m
            )
        }
        Extractor::ColorMask {
            hue_deg,
            saturation,
            value,
        } => {
            let (any_hue, any) = ([0.0, 360.0], [0.0, 1.0]);
            let count = |hue, saturation, value| {
                fab_vision::color_mask(&observation.rgb, hue, saturation, value).area_px()
            };
            format!(
                "; of {} pixels {} have its hue, {} its saturation and {} its value ({} to {}), and none all three",
                count(any_hue, any, any),
                count(*hue_deg, any, any),
                count(any_hue, *saturation, any),
                count(any_hue, any, *value),
                value[0],
                value[1],
            )
        }
        Extractor::SplitMask {
            of,
            blur_px,
            contrast,
            ..
        } => match fab_vision::contrast_of(&observation.rgb, *of, *blur_px) {
            Some(found) => format!(
                "; the two sides of its best split are {found:.2} apart, and the mask asks for {contrast:.2}"
            ),
            None => "; all its pixels are alike".to_owned(),
        },
        _ => String::new(),
    }
}
