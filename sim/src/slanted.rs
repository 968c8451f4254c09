//! A camera that looks at the table from one side, for people: folds, heights and the picker are visible.
//!
//! In: particle positions in grid order, colours, the picker's marker. Out: a colour picture with light and shadow. No model sees these pictures, so nothing here has a recorded counterpart.

use crate::camera::{CameraError, Look, MAX_SIZE_PX, MIN_SIZE_PX, NEAR_M};
use crate::mask::Mask;
use crate::raster::{Raster, Shade, Vertex, Window};
use crate::scene::{self, LIGHT, Marker, Seen, cross, dot};

/// A pinhole camera that looks down at a point from one side; world +Z is up in its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlantedCamera {
    position_m: [f32; 3],
    target_m: [f32; 3],
    fov_rad: f32,
    size_px: [u32; 2],
}

// The samples of a pixel. Two are enough for pictures of at most 256 colours, and rasterising is most of what a film
// costs: a third one made it half as dear again.
const SAMPLES: [[f32; 2]; 2] = [[0.25, 0.25], [0.75, 0.75]];
// How much the brightness of cloth follows its slope to the light.
const RELIEF: f32 = 0.85;
// The least and the greatest brightness of cloth; 1 when it lies flat.
const BRIGHTNESS: [f32; 2] = [0.42, 1.12];
// Brightness of the cloth's rim, so that one layer stands out on another of the same colour.
const RIM: f32 = 0.66;
/// Brightness of the table in the shadow of cloth and picker.
const SHADOW: f32 = 0.8;

// Black stands for shadow while triangles are drawn; cloth and marker are never quite black.
const BLACK: Shade = Shade {
    top: [0.0; 3],
    underside: [0.0; 3],
};
/// Cloth below this height lies flat on the table, where half its thickness of 0.01 m is, metres.
const LYING_M: f32 = 0.0055;

/// A slanted camera over a table of which it keeps the picture.
#[derive(Clone, Debug)]
pub struct SlantedView {
    camera: SlantedCamera,
    look: Look,
    /// For each sample: the bare table's colours, row by row.
    table: [Vec<[u8; 3]>; SAMPLES.len()],
    /// The sums of these colours over the samples.
    sums: Vec<[u16; 3]>,
}

/// A colour picture, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue of each pixel: `[height * width * 3]`.
    pub rgb: Vec<u8>,
}

impl SlantedCamera {
    /// Checks the numbers and builds the camera.
    ///
    /// - `position_m`, `target_m`: where it is and what it looks at, world frame, metres.
    /// - `fov_rad`: field of view across the image, radians.
    /// - `size_px`: width and height, pixels.
    pub fn new(
        position_m: [f32; 3],
        target_m: [f32; 3],
        fov_rad: f32,
        size_px: [u32; 2],
    ) -> Result<SlantedCamera, CameraError> {
        let way = [0, 1, 2].map(|axis| position_m[axis] - target_m[axis]);
        // Written so that a NaN is refused too.
        let slanted = way[2] >= 0.05 && (way[0] * way[0] + way[1] * way[1]).sqrt() >= 0.05;
        let near = position_m.iter().all(|axis| axis.abs() <= 10.0) && target_m[2] >= 0.0;
        if !(slanted && near) {
            return Err(CameraError::Slant {
                position_m,
                target_m,
            });
        }
        if !(0.05..=2.8).contains(&fov_rad) {
            return Err(CameraError::FieldOfView(fov_rad));
        }
        if let Some(&side) = size_px
            .iter()
            .find(|side| !(MIN_SIZE_PX..=MAX_SIZE_PX).contains(*side))
        {
            return Err(CameraError::Size(side));
        }
        Ok(SlantedCamera {
            position_m,
            target_m,
            fov_rad,
            size_px,
        })
    }

    /// Returns the directions right, down and forward of its image, unit vectors of the world frame.
    fn axes(&self) -> [[f32; 3]; 3] {
        let unit = |vector: [f32; 3]| {
            let length = dot(vector, vector).sqrt();
            vector.map(|axis| axis / length)
        };
        let forward = unit([0, 1, 2].map(|axis| self.target_m[axis] - self.position_m[axis]));
        let right = unit(cross(forward, [0.0, 0.0, 1.0]));
        [right, cross(forward, right), forward]
    }

    /// Returns the focal length, pixels.
    pub fn focal_px(&self) -> f32 {
        self.size_px[0] as f32 / (2.0 * (0.5 * self.fov_rad).tan())
    }

    /// Projects a point of the world frame, metres, to `[column, row]` in pixels; `None` behind or at the camera.
    pub fn project(&self, point: [f32; 3]) -> Option<[f32; 2]> {
        self.projector()(point).map(|seen| [seen.column, seen.row])
    }

    fn projector(&self) -> impl Fn([f32; 3]) -> Option<Seen> + use<> {
        let ([right, down, forward], focal_px) = (self.axes(), self.focal_px());
        let (position_m, [width, height]) = (self.position_m, self.size_px);
        move |point| {
            let way = [0, 1, 2].map(|axis| point[axis] - position_m[axis]);
            let depth_m = dot(way, forward);
            let column = 0.5 * width as f32 + focal_px * dot(way, right) / depth_m;
            let row = 0.5 * height as f32 + focal_px * dot(way, down) / depth_m;
            let drawable = depth_m >= NEAR_M && column.is_finite() && row.is_finite();
            drawable.then_some(Seen {
                column,
                row,
                inverse_depth: 1.0 / depth_m,
            })
        }
    }

    /// Returns where the ray through a point of the image meets the table, and how deep that is; `None` above the
    /// horizon.
    fn table_at(&self, column: f32, row: f32) -> Option<([f32; 2], f32)> {
        let [right, down, forward] = self.axes();
        let focal_px = self.focal_px();
        let u = (column - 0.5 * self.size_px[0] as f32) / focal_px;
        let v = (row - 0.5 * self.size_px[1] as f32) / focal_px;
        let ray = [0, 1, 2].map(|axis| forward[axis] + u * right[axis] + v * down[axis]);
        let depth_m = -self.position_m[2] / ray[2];
        let on_table = [0, 1].map(|axis| self.position_m[axis] + depth_m * ray[axis]);
        (ray[2] < 0.0 && depth_m.is_finite()).then_some((on_table, depth_m))
    }
}

impl SlantedView {
    /// Draws the bare table, once for all pictures.
    pub fn new(camera: SlantedCamera, look: &Look) -> SlantedView {
        let [width, height] = camera.size_px;
        let pixels =
            || (0..height).flat_map(move |row| (0..width).map(move |column| [column, row]));
        let at = |[column, row]: [u32; 2], [u, v]: [f32; 2]| {
            camera.table_at(column as f32 + u, row as f32 + v)
        };
        let colour = |meets: Option<([f32; 2], f32)>| {
            // Above the horizon it goes on as the lighter tile.
            let number = meets.map_or(0, |(point, _)| {
                let [x, y] = point.map(|axis| (axis / look.tile_m).floor() as i64);
                (x + y).rem_euclid(2) as usize
            });
            look.tiles[number]
        };
        let table: [Vec<[u8; 3]>; SAMPLES.len()] =
            SAMPLES.map(|sample| pixels().map(|pixel| colour(at(pixel, sample))).collect());
        let sum = |pixel: usize| {
            [0, 1, 2].map(|channel| {
                table
                    .iter()
                    .map(|colours| u16::from(colours[pixel][channel]))
                    .sum()
            })
        };
        let sums: Vec<[u16; 3]> = (0..table[0].len()).map(sum).collect();
        SlantedView {
            camera,
            look: look.clone(),
            table,
            sums,
        }
    }

    /// Draws the table, the cloth and the picker's marker.
    ///
    /// - `cloth`, `positions`: as for [`TopDownCamera::render`](crate::TopDownCamera::render).
    pub fn render(
        &self,
        cloth: impl Into<Mask>,
        positions: &[[f32; 3]],
        marker: Option<&Marker>,
    ) -> Picture {
        let triangles = self.triangles(&cloth.into(), positions, marker);
        let [width, height] = self.camera.size_px;
        let window = Window::around(&triangles, self.camera.size_px.map(|side| side as usize));
        // Only what stands above the table is drawn, so anything is nearer than nothing.
        let mut raster = Raster::new(0.0);
        let mut sums = self.sums.clone();
        for (offset, table) in SAMPLES.iter().zip(&self.table) {
            raster.clear(&window, *offset);
            raster.draw(&triangles);
            for ([column, row], colour, _) in raster.drawn() {
                let pixel = row * width as usize + column;
                // The table's own part of this sample gives way.
                let tile = table[pixel];
                let colour = if colour == [0; 3] {
                    tile.map(|channel| (f32::from(channel) * SHADOW) as u8)
                } else {
                    colour
                };
                for channel in 0..3 {
                    let sum = &mut sums[pixel][channel];
                    *sum = *sum - u16::from(tile[channel]) + u16::from(colour[channel]);
                }
            }
        }
        Picture {
            width,
            height,
            rgb: sums.into_iter().flat_map(mean).collect(),
        }
    }

    /// Lists what stands above the table: cloth in the light, its shadow in black, and the marker with its shadow.
    fn triangles(
        &self,
        mask: &Mask,
        positions: &[[f32; 3]],
        marker: Option<&Marker>,
    ) -> Vec<[Vertex; 3]> {
        let mut triangles = Vec::new();
        let project = self.camera.projector();
        let lit =
            |index: usize, point| Some(project(point)?.vertex(self.shade(mask, positions, index)));
        let dark = |_: usize, point| Some(project(shadow_of(point))?.vertex(BLACK));
        // Cloth that lies on the table hides its shadow, except at its rim.
        let casts = |index: usize| positions[index][2] >= LYING_M || is_near_rim(mask, index, 2);
        let darkens = |corners: [usize; 3]| corners.into_iter().any(casts);
        scene::add_cloth(&mut triangles, mask, positions, &|_| true, &lit);
        scene::add_cloth(&mut triangles, mask, positions, &darkens, &dark);
        if let Some(marker) = marker {
            triangles.extend(marker.triangles(&project));
            let shadows = marker.triangles(&|point| project(shadow_of(point)));
            let black = |vertex: Vertex| Vertex {
                shade: BLACK,
                ..vertex
            };
            triangles.extend(shadows.into_iter().map(|corners| corners.map(black)));
        }
        triangles
    }

    /// Returns the colours at a particle in the light; the rim is darker.
    fn shade(&self, mask: &Mask, positions: &[[f32; 3]], index: usize) -> Shade {
        let (normal, length) = scene::normal(mask, positions, index);
        let facing = if length > 0.0 {
            dot(normal, LIGHT) / length
        } else {
            LIGHT[2]
        };
        let [least, greatest] = BRIGHTNESS;
        let rim = if is_near_rim(mask, index, 1) {
            RIM
        } else {
            1.0
        };
        let brightness = |facing: f32| {
            rim * (1.0 + RELIEF * (facing.max(0.0) - LIGHT[2])).clamp(least, greatest)
        };
        let shade = Shade::both(&self.look, [brightness(facing), brightness(-facing)]);
        Shade {
            top: scene::in_light(shade.top),
            underside: scene::in_light(shade.underside),
        }
    }
}

/// Returns where a point's shadow lies on the table, which is behind cloth and marker.
fn shadow_of([x, y, z]: [f32; 3]) -> [f32; 3] {
    let along = z / LIGHT[2];
    [x - along * LIGHT[0], y - along * LIGHT[1], 0.0]
}

/// Returns the mean of a pixel's samples.
fn mean(sum: [u16; 3]) -> [u8; 3] {
    let samples = SAMPLES.len() as u16;
    sum.map(|channel| ((channel + samples / 2) / samples) as u8)
}

/// Tells whether a particle is less than `cells` from an edge of the cloth, along a row or a column.
fn is_near_rim(mask: &Mask, index: usize, cells: usize) -> bool {
    let (dimx, dimy) = (mask.grid().dimx, mask.grid().dimy);
    let (column, row) = (index % dimx, index / dimx);
    let inside = column.min(row) >= cells && column + cells < dimx && row + cells < dimy;
    let is_missing = |away: usize| {
        let around = [
            index - away,
            index + away,
            index - away * dimx,
            index + away * dimx,
        ];
        around.iter().any(|&it| !mask.has(it))
    };
    !inside || (1..=cells).any(is_missing)
}
