//! Times the detectors beside OpenCV's, on one core; compare figures only within one run.
//!
//! The picture has 720 x 720 pixels, and shows a cloth whose folds give as many corners as a recorded one.

use divan::{Bencher, black_box};
use fab_picture::Mask;
use fab_program::{Response, Sight};
use fab_vision::CornerSearch;
use fab_vision::primitives::{by_opencv, own};
use image::{GrayImage, Luma};

fn main() {
    // One core for both.
    by_opencv::use_one_thread();
    divan::main();
}

const SIDE_PX: u32 = 720;

/// A turned square with waves on black.
fn picture() -> GrayImage {
    GrayImage::from_fn(SIDE_PX, SIDE_PX, |column, row| {
        let [x, y] = [column, row].map(|at| f64::from(at) - 360.0);
        let (along, across) = (0.8 * x + 0.6 * y, 0.8 * y - 0.6 * x);
        let is_cloth = along.abs() < 220.0 && across.abs() < 180.0;
        let wave = (along / 19.0).sin() * (across / 23.0).cos();
        Luma([if is_cloth {
            (130.0 + 60.0 * wave) as u8
        } else {
            0
        }])
    })
}

fn search(response: Response) -> CornerSearch {
    CornerSearch {
        of: Sight::Depth,
        image_px: SIDE_PX,
        max: 27,
        quality: 0.04,
        spacing_px: 20.0,
        block_px: 3,
        response,
    }
}

fn mask() -> Mask {
    let picture = picture();
    Mask::from_fn(SIDE_PX, SIDE_PX, |column, row| {
        picture.get_pixel(column, row).0[0] > 0
    })
}

/// Whose detectors are timed.
#[derive(Clone, Copy, Debug)]
enum By {
    Ours,
    OpenCv,
}

const BOTH: [By; 2] = [By::Ours, By::OpenCv];

fn time_corners(bencher: Bencher, by: By, response: Response) {
    let find = match by {
        By::Ours => own::strong_corners,
        By::OpenCv => by_opencv::strong_corners,
    };
    let (picture, search) = (picture(), search(response));
    bencher.bench_local(|| black_box(find(&picture, &search)));
}

#[divan::bench(args = BOTH)]
fn harris(bencher: Bencher, by: By) {
    time_corners(bencher, by, Response::Harris { k: 0.04 });
}

#[divan::bench(args = BOTH)]
fn shi_tomasi(bencher: Bencher, by: By) {
    time_corners(bencher, by, Response::ShiTomasi);
}

#[divan::bench(args = BOTH)]
fn refined_corners(bencher: Bencher, by: By) {
    let refine = match by {
        By::Ours => own::refine_corners,
        By::OpenCv => by_opencv::refine_corners,
    };
    let picture = fab_picture::mask_picture(&mask());
    let search = search(Response::Harris { k: 0.04 });
    let corners = own::strong_corners(&picture, &search).unwrap_or_default();
    bencher.bench_local(|| black_box(refine(&picture, &corners, 12)));
}

#[divan::bench(args = BOTH)]
fn outline_polygon_and_rectangle(bencher: Bencher, by: By) {
    let mask = mask();
    bencher.bench_local(|| {
        let outline = match by {
            By::Ours => own::outer_outline(&mask),
            By::OpenCv => by_opencv::outer_outline(&mask),
        };
        let outline = black_box(outline).unwrap_or_default();
        match by {
            By::Ours => black_box((
                own::simplified(&outline, 3.0).ok(),
                own::smallest_rectangle(&outline).ok(),
            )),
            By::OpenCv => black_box((
                by_opencv::simplified(&outline, 3.0).ok(),
                by_opencv::smallest_rectangle(&outline).ok(),
            )),
        }
    });
}
