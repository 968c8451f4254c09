//! The same detectors by OpenCV: for those who want it, and as the peer that judges ours.

use crate::rectangle::Rectangle;
use crate::{CornerSearch, VisionError};
use fab_picture::{Mask, mask_picture};
use fab_program::{PixelPoint, Response};
use image::GrayImage;
use opencv::boxed_ref::BoxedRef;
use opencv::core::{Mat, Point, Point2f, Size, TermCriteria, TermCriteria_Type, Vector, no_array};
use opencv::imgproc;

impl From<opencv::Error> for VisionError {
    fn from(error: opencv::Error) -> Self {
        VisionError(format!("OpenCV failed: {}", error.message))
    }
}

/// Returns OpenCV's name and version.
pub fn version() -> Result<String, VisionError> {
    Ok(format!("OpenCV {}", opencv::core::get_version_string()?))
}

/// Keeps OpenCV to the calling thread; for benchmarks.
pub fn use_one_thread() {
    // It fails only for counts that it does not know.
    let _ = opencv::core::set_num_threads(1);
}

fn matrix(picture: &GrayImage) -> Result<BoxedRef<'_, Mat>, VisionError> {
    let (rows, columns) = (picture.height() as i32, picture.width() as i32);
    Ok(Mat::new_rows_cols_with_data::<u8>(
        rows,
        columns,
        picture.as_raw(),
    )?)
}

pub fn strong_corners(
    picture: &GrayImage,
    search: &CornerSearch,
) -> Result<Vec<[f32; 2]>, VisionError> {
    let (is_harris, k) = match search.response {
        Response::Harris { k } => (true, k),
        Response::ShiTomasi => (false, 0.0),
    };
    let mut found = Vector::<Point2f>::new();
    imgproc::good_features_to_track(
        &matrix(picture)?,
        &mut found,
        search.max as i32,
        search.quality,
        search.spacing_px,
        &no_array(),
        search.block_px as i32,
        is_harris,
        k,
    )?;
    Ok(found.iter().map(|point| [point.x, point.y]).collect())
}

pub fn refine_corners(
    picture: &GrayImage,
    corners: &[[f32; 2]],
    half_px: u32,
) -> Result<Vec<[f32; 2]>, VisionError> {
    if corners.is_empty() {
        return Ok(Vec::new());
    }
    let mut moved: Vector<Point2f> = corners.iter().map(|&[x, y]| Point2f::new(x, y)).collect();
    let kinds = TermCriteria_Type::COUNT as i32 | TermCriteria_Type::EPS as i32;
    let until = TermCriteria::new(kinds, 30, 0.01)?;
    let window = Size::new(half_px as i32, half_px as i32);
    imgproc::corner_sub_pix(
        &matrix(picture)?,
        &mut moved,
        window,
        Size::new(-1, -1),
        until,
    )?;
    Ok(moved.iter().map(|point| [point.x, point.y]).collect())
}

pub fn outer_outline(piece: &Mask) -> Result<Vec<PixelPoint>, VisionError> {
    let mut outlines = Vector::<Vector<Point>>::new();
    let (mode, method) = (imgproc::RETR_EXTERNAL, imgproc::CHAIN_APPROX_NONE);
    imgproc::find_contours(
        &matrix(&mask_picture(piece))?,
        &mut outlines,
        mode,
        method,
        Point::new(0, 0),
    )?;
    let outline = outlines.iter().next().unwrap_or_default();
    Ok(outline
        .iter()
        .map(|at| PixelPoint::new(at.x, at.y))
        .collect())
}

pub fn simplified(
    outline: &[PixelPoint],
    tolerance_px: f64,
) -> Result<Vec<PixelPoint>, VisionError> {
    let mut polygon = Vector::<Point>::new();
    imgproc::approx_poly_dp(&points(outline), &mut polygon, tolerance_px, true)?;
    Ok(polygon
        .iter()
        .map(|at| PixelPoint::new(at.x, at.y))
        .collect())
}

fn points(pixels: &[PixelPoint]) -> Vector<Point> {
    pixels.iter().map(|at| Point::new(at.u, at.v)).collect()
}

pub fn smallest_rectangle(pixels: &[PixelPoint]) -> Result<Rectangle, VisionError> {
    let found = imgproc::min_area_rect(&points(pixels))?;
    let angle = f64::from(found.angle).to_radians();
    Ok(Rectangle {
        center: [found.center.x, found.center.y].map(f64::from),
        along: [angle.cos(), angle.sin()],
        sides: [found.size.width, found.size.height].map(f64::from),
    })
}
