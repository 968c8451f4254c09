//! The camera over the table: what it is, what it sees, and where points land in its image.
//!
//! In: particle positions in grid order, colours. Out: a colour and a depth
//! image. The camera looks straight down from above the table's centre; either
//! world axis may be up in its image. Drawing triangles is `raster`'s business.

use crate::mask::Mask;
use crate::raster::{Raster, Shade, Vertex, Window};
use crate::scene::{self, Seen};

/// Smallest image side, pixels.
pub const MIN_SIZE_PX: u32 = 16;
/// Largest image side, pixels.
pub const MAX_SIZE_PX: u32 = 2048;
// Surfaces nearer to the camera than this are not drawn, metres (PyFleX: 0.01).
pub(crate) const NEAR_M: f32 = 0.01;
// Colour samples along a pixel's side. The recorded images were rendered at 720 pixels and reduced to 224.
const OFFSETS: [f32; 3] = [0.5 / 3.0, 1.5 / 3.0, 2.5 / 3.0];

/// A pinhole camera above the table's centre, looking down.
///
/// Focal length in pixels: `f = size / (2 tan(fov / 2))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TopDownCamera {
    /// Height above the table, metres.
    pub height_m: f32,
    /// Field of view across the image, radians.
    pub fov_rad: f32,
    /// Side of the square image, pixels; rendering limits it to `MIN_SIZE_PX..=MAX_SIZE_PX`.
    pub size_px: u32,
    /// Which way of the table is up in the image.
    pub up: ImageUp,
}

/// Which way of the table is up in an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ImageUp {
    /// World +Y, so that image right is +X.
    #[default]
    Y,
    /// World +X, so that image right is -Y: the other picture, turned left by a right angle.
    X,
}

impl ImageUp {
    /// Returns where in this picture, row by row, a pixel of the picture with +Y up lies.
    ///
    /// Turning what was drawn keeps both equal to the last bit.
    fn pixel(self, column: usize, row: usize, size: usize) -> usize {
        match self {
            ImageUp::Y => row * size + column,
            ImageUp::X => (size - 1 - column) * size + row,
        }
    }
}

/// Says why a camera cannot exist.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// The camera is at or below the table, or out of sight.
    #[error("a camera `{0}` m above the table is outside `0.05` to `10` m")]
    Height(f32),
    /// The field of view is no angle of a pinhole camera.
    #[error("a field of view of `{0}` rad is outside `0.05` to `2.8` rad")]
    FieldOfView(f32),
    /// The image is too small or too large.
    #[error("an image side of `{0}` pixels is outside `{MIN_SIZE_PX}` to `{MAX_SIZE_PX}`")]
    Size(u32),
    /// A slanted camera does not look down at the table from one side.
    #[error(
        "a camera at `{position_m:?}` m that looks at `{target_m:?}` m does not look down from one side; put it at least \
         `0.05` m above what it looks at, and as far aside"
    )]
    Slant {
        /// Where it is, metres.
        position_m: [f32; 3],
        /// What it looks at, metres.
        target_m: [f32; 3],
    },
}

/// Colours of the scene, RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Side of the cloth that faces up when it lies flat as started.
    pub top: [u8; 3],
    /// The other side.
    pub underside: [u8; 3],
    /// The two colours of the checkered table; the first lies where X and Y are positive.
    pub tiles: [[u8; 3]; 2],
    /// Side of a tile, metres; a corner of four tiles lies at the table's centre.
    pub tile_m: f32,
    /// How much darker a vertical surface is than one facing up, 0 to 1.
    pub shading: f32,
}

impl Default for Look {
    /// The recorded images' colours. No recorded view shows a tile's far edge, so they are larger than 0.41 m.
    fn default() -> Look {
        Look {
            top: [255, 113, 0],
            underside: [248, 145, 201],
            tiles: [[246, 243, 243], [216, 213, 213]],
            tile_m: 0.5,
            shading: 0.3,
        }
    }
}

/// A colour and a depth image of the same size, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue of each pixel: `[height * width * 3]`.
    pub rgb: Vec<u8>,
    /// Distance from the camera's plane to the surface at each pixel's centre, along the optical axis,
    /// table included, metres: `[height * width]`.
    pub depth_m: Vec<f32>,
}

impl TopDownCamera {
    /// Checks the numbers and builds the camera, with world +Y up in its image.
    pub fn new(height_m: f32, fov_rad: f32, size_px: u32) -> Result<TopDownCamera, CameraError> {
        if !(0.05..=10.0).contains(&height_m) {
            return Err(CameraError::Height(height_m));
        }
        if !(0.05..=2.8).contains(&fov_rad) {
            return Err(CameraError::FieldOfView(fov_rad));
        }
        if !(MIN_SIZE_PX..=MAX_SIZE_PX).contains(&size_px) {
            return Err(CameraError::Size(size_px));
        }
        Ok(TopDownCamera {
            height_m,
            fov_rad,
            size_px,
            up: ImageUp::Y,
        })
    }

    /// Turns the camera about its optical axis.
    pub fn with_up(self, up: ImageUp) -> TopDownCamera {
        TopDownCamera { up, ..self }
    }

    /// Returns the focal length, pixels.
    pub fn focal_px(&self) -> f32 {
        self.size_px as f32 / (2.0 * (0.5 * self.fov_rad).tan())
    }

    /// Projects a point of the world frame, metres, to `[column, row]` in pixels.
    ///
    /// Pixel `[c, r]` covers columns `c` to `c + 1`, so its centre is at `c + 0.5`. The point must be
    /// below the camera.
    pub fn project(&self, point: [f32; 3]) -> [f32; 2] {
        let scale = self.focal_px() / (self.height_m - point[2]);
        let centre = 0.5 * self.size_px as f32;
        let [right, up] = match self.up {
            ImageUp::Y => [point[0], point[1]],
            ImageUp::X => [-point[1], point[0]],
        };
        [centre + scale * right, centre - scale * up]
    }

    /// Draws the table and the cloth.
    ///
    /// - `cloth`: a [`Grid`](crate::Grid) or a `&Mask`; cells with a missing corner are not drawn.
    /// - `positions`: `[dimy * dimx]` points in grid order, world frame, metres; those of missing particles are
    ///   not read. Cells with an absent or non-finite position are left out.
    ///
    /// Colour is the mean of 3 x 3 samples a pixel; depth is that of the pixel's centre alone, so no
    /// depth lies between two surfaces.
    pub fn render(&self, cloth: impl Into<Mask>, positions: &[[f32; 3]], look: &Look) -> Frame {
        let camera = self.drawing();
        let tiles = camera.tiles(look);
        let mut sums = tiles.sums(self.up);
        let size = camera.size_px as usize;
        let mut depth_m = vec![1.0 / (1.0 / camera.height_m); size * size];
        let triangles = camera.triangles(&cloth.into(), positions, look);
        let window = Window::around(&triangles, [size, size]);
        let mut raster = Raster::new(1.0 / camera.height_m);
        for [u, v] in (0..3).flat_map(|v| [0, 1, 2].map(|u| [u, v])) {
            let offset = [OFFSETS[u], OFFSETS[v]];
            raster.clear(&window, offset);
            raster.draw(&triangles);
            for ([column, row], colour, inverse_depth) in raster.drawn() {
                let pixel = self.up.pixel(column, row, size);
                let tile = tiles.colour(tiles.columns[u][column], tiles.rows[v][row]);
                for channel in 0..3 {
                    // The table's own part of this sample gives way.
                    let sum = &mut sums[3 * pixel + channel];
                    *sum = *sum - u16::from(tile[channel]) + u16::from(colour[channel]);
                }
                if offset == [0.5, 0.5] {
                    depth_m[pixel] = 1.0 / inverse_depth;
                }
            }
        }
        Frame {
            width: camera.size_px,
            height: camera.size_px,
            rgb: sums.into_iter().map(mean).collect(),
            depth_m,
        }
    }

    /// Returns the camera that draws: with +Y up, and of a size within the bounds.
    fn drawing(&self) -> TopDownCamera {
        TopDownCamera {
            up: ImageUp::Y,
            size_px: self.size_px.clamp(MIN_SIZE_PX, MAX_SIZE_PX),
            ..*self
        }
    }

    /// Finds the tile under each sample of the bare table.
    fn tiles(&self, look: &Look) -> Tiles {
        let size = self.size_px as usize;
        let metres_a_pixel = self.height_m / self.focal_px();
        let along = |offset: f32| -> Vec<i32> {
            let number = |pixel: usize| {
                let from_centre = pixel as f32 + offset - 0.5 * self.size_px as f32;
                (from_centre * metres_a_pixel / look.tile_m).floor() as i32
            };
            (0..size).map(number).collect()
        };
        let columns = OFFSETS.map(along);
        Tiles {
            colours: look.tiles,
            // Rows run down and the table's Y runs up.
            rows: columns
                .clone()
                .map(|numbers| numbers.into_iter().map(|number| -1 - number).collect()),
            columns,
        }
    }

    /// Projects the cloth's triangles, each vertex the darker the more its surface stands.
    fn triangles(&self, mask: &Mask, positions: &[[f32; 3]], look: &Look) -> Vec<[Vertex; 3]> {
        let shade_of = |index: usize| {
            let upright = match scene::normal(mask, positions, index) {
                ([_, _, up], length) if length > 0.0 => up.abs() / length,
                _ => 1.0,
            };
            let brightness = 1.0 - look.shading.clamp(0.0, 1.0) * (1.0 - upright);
            Shade::both(look, [brightness; 2])
        };
        let vertex_of = |index: usize, point| Some(self.see(point)?.vertex(shade_of(index)));
        let mut triangles = Vec::new();
        scene::add_cloth(&mut triangles, mask, positions, &|_| true, &vertex_of);
        triangles
    }

    /// Projects a point; `None` where it cannot be drawn.
    fn see(&self, point: [f32; 3]) -> Option<Seen> {
        let below_m = self.height_m - point[2];
        let [column, row] = self.project(point);
        let drawable = below_m >= NEAR_M && column.is_finite() && row.is_finite();
        drawable.then_some(Seen {
            column,
            row,
            inverse_depth: 1.0 / below_m,
        })
    }
}

/// Returns the mean of the samples of a pixel.
fn mean(sum: u16) -> u8 {
    const SAMPLES: u16 = (OFFSETS.len() * OFFSETS.len()) as u16;
    ((sum + SAMPLES / 2) / SAMPLES) as u8
}

/// The checkered table as the samples of a picture see it.
struct Tiles {
    colours: [[u8; 3]; 2],
    /// For each sample along a pixel's side: the number of the tile that a pixel's column shows.
    columns: [Vec<i32>; OFFSETS.len()],
    /// For each sample along a pixel's side: the number of the tile that a pixel's row shows.
    rows: [Vec<i32>; OFFSETS.len()],
}

impl Tiles {
    /// Returns the colour of a tile.
    fn colour(&self, column: i32, row: i32) -> [u8; 3] {
        self.colours[(column + row).rem_euclid(2) as usize]
    }

    /// Sums the colours over the samples of each pixel of a picture, row by row, RGB.
    fn sums(&self, up: ImageUp) -> Vec<u16> {
        let side = OFFSETS.len() as u16;
        // Of the samples along one side of a pixel, how many lie on tiles of even number.
        let even = |numbers: &[Vec<i32>; OFFSETS.len()]| -> Vec<u16> {
            let is_even = |pixel: usize| {
                let even = numbers.iter().filter(|it| it[pixel].rem_euclid(2) == 0);
                even.count() as u16
            };
            (0..numbers[0].len()).map(is_even).collect()
        };
        let (mut columns, mut rows) = (even(&self.columns), even(&self.rows));
        if up == ImageUp::X {
            columns.reverse();
            std::mem::swap(&mut columns, &mut rows);
        }
        let sum_of = |column: u16, row: u16| {
            let first = column * row + (side - column) * (side - row);
            let [a, b] = self.colours;
            [0, 1, 2].map(|channel| {
                first * u16::from(a[channel]) + (side * side - first) * u16::from(b[channel])
            })
        };
        // Few rows differ.
        let row_of = |row: u16| -> Vec<u16> {
            let sums = columns.iter().flat_map(|&column| sum_of(column, row));
            sums.collect()
        };
        let kinds: Vec<Vec<u16>> = (0..=side).map(row_of).collect();
        let rows = rows.iter().map(|&row| kinds[usize::from(row)].as_slice());
        rows.collect::<Vec<_>>().concat()
    }
}
