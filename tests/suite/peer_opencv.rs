//! OpenCV finds in pictures of simulated cloths what is found without it: corners, outlines, rectangles.
//!
//! The cloths are flat, folded and crumpled; each is turned, moved, seen by cameras of several sizes, and blurred by noise.

use fab_program::{PixelPoint, Response, Sight};
use fab_sim::{Grid, Look, Params, Simulator, TopDownCamera, diagonal_fold};
use fab_vision::primitives::{by_opencv, own};
use fab_vision::{CornerSearch, bounding_box, largest};
use image::{GrayImage, Luma};

/// Scenes: cloths times the views of each.
const N_SCENES: usize = 2000;
const N_CLOTHS: usize = 20;

/// Numbers from 0 to 1 that a seed begins (Steele, Lea and Flood 2014).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn cloth(index: usize) -> (Grid, Vec<[f32; 3]>) {
    let side = 24 + index % 5 * 4;
    let grid = Grid::new(side, side + index % 3 * 4, 0.00625).unwrap();
    let params = Params::default();
    let positions = match index % 4 {
        0 => Simulator::flat(grid, &params).positions(),
        1 => diagonal_fold(grid, &params, &|| false).unwrap().positions(),
        _ => {
            let mut cloth = Simulator::flat(grid, &params);
            cloth.crumple(index as u64, &|| false).unwrap();
            cloth.positions()
        }
    };
    (grid, positions)
}

/// Turns a cloth about the table's middle, and moves it.
fn moved(positions: &[[f32; 3]], chance: &mut Chance) -> Vec<[f32; 3]> {
    let (sin, cos) = (chance.next() * std::f64::consts::TAU).sin_cos();
    let [right, up] = [(); 2].map(|()| (chance.next() - 0.5) * 0.06);
    let point = |&[x, y, z]: &[f32; 3]| {
        let (x, y) = (f64::from(x), f64::from(y));
        [
            (x * cos - y * sin + right) as f32,
            (x * sin + y * cos + up) as f32,
            z,
        ]
    };
    positions.iter().map(point).collect()
}

#[test]
#[ignore = "needs OpenCV, long"]
fn peer_opencv_finds_the_same_corners_outlines_and_rectangles_in_generated_scenes() {
    let (mut n_corners, mut n_vertices) = (0, 0);
    for index in 0..N_CLOTHS {
        let (grid, lying) = cloth(index);
        for view in 0..N_SCENES / N_CLOTHS {
            let mut chance = Chance((index * 1000 + view) as u64);
            let side = [128, 224, 360, 720][view % 4];
            let camera = TopDownCamera::new(0.65, 0.785, side).unwrap();
            let frame = camera.render(grid, &moved(&lying, &mut chance), &Look::default());
            let table = frame.depth_m.iter().copied().fold(0.0, f32::max);
            let noise = chance.next() * 6.0 * f64::from(u8::from(view % 3 > 0));
            let mut level = |index: usize, level: f32| {
                let is_cloth = frame.depth_m[index] < table - 0.001;
                let noisy = f64::from(level) + noise * (chance.next() - 0.5);
                if is_cloth {
                    noisy.round().clamp(1.0, 255.0) as u8
                } else {
                    0
                }
            };
            let at = |column: u32, row: u32| (row * side + column) as usize;
            let depth = GrayImage::from_fn(side, side, |column, row| {
                Luma([level(
                    at(column, row),
                    frame.depth_m[at(column, row)] * 100.0,
                )])
            });
            let grey = GrayImage::from_fn(side, side, |column, row| {
                let index = at(column, row);
                Luma([level(index, f32::from(frame.rgb[3 * index + 1]))])
            });
            let scene = format!("cloth {index}, view {view}");
            for (picture, response, quality) in [
                (&depth, Response::Harris { k: 0.04 }, 0.04),
                (&grey, Response::Harris { k: 0.04 }, 0.01),
                (&depth, Response::ShiTomasi, 0.1),
                (&grey, Response::ShiTomasi, 0.05),
            ] {
                let search = CornerSearch {
                    of: Sight::Depth,
                    image_px: side,
                    max: 60,
                    quality,
                    spacing_px: 2.0 + (view % 10) as f64,
                    block_px: 3,
                    response,
                };
                let found = own::strong_corners(picture, &search).unwrap();
                assert_eq!(
                    found,
                    by_opencv::strong_corners(picture, &search).unwrap(),
                    "{scene}"
                );
                n_corners += found.len();
                let half = 2 + view as u32 % 4;
                let refined = own::refine_corners(picture, &found, half).unwrap();
                let theirs = by_opencv::refine_corners(picture, &found, half).unwrap();
                assert_eq!(refined, theirs, "{scene}");
            }
            let mask = fab_picture::Mask::from_fn(side, side, |column, row| {
                depth.get_pixel(column, row).0[0] > 0
            });
            if bounding_box(&mask).is_none() {
                continue;
            }
            let piece = largest(&mask);
            let outline = own::outer_outline(&piece).unwrap();
            assert_eq!(
                outline,
                by_opencv::outer_outline(&piece).unwrap(),
                "{scene}"
            );
            for tolerance_px in [1.0, 3.0, 10.0] {
                let polygon: Vec<PixelPoint> = own::simplified(&outline, tolerance_px).unwrap();
                assert_eq!(
                    polygon,
                    by_opencv::simplified(&outline, tolerance_px).unwrap(),
                    "{scene}"
                );
                n_vertices += polygon.len();
            }
            let [ours, theirs] = [own::smallest_rectangle, by_opencv::smallest_rectangle]
                .map(|find| find(&outline).unwrap());
            let off_px = (0..2).map(|axis| (ours.center[axis] - theirs.center[axis]).abs());
            let sides = |mut sides: [f64; 2]| {
                sides.sort_by(f64::total_cmp);
                sides
            };
            let (ours_px, theirs_px) = (sides(ours.sides), sides(theirs.sides));
            let longer_px = (0..2).map(|axis| (ours_px[axis] - theirs_px[axis]).abs());
            let worst_px = off_px.chain(longer_px).fold(0.0, f64::max);
            assert!(
                worst_px < 1.0,
                "{scene}: {worst_px} px, {ours:?}, {theirs:?}"
            );
        }
    }
    println!("{n_corners} corners and {n_vertices} vertices");
    assert!(n_corners > 10 * N_SCENES && n_vertices > 10 * N_SCENES);
}
