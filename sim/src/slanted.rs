//! A camera that looks at the table from one side, for people: folds, heights and the picker are visible.
//!
//! In: particle positions in grid order, colours, the picker's marker. Out: a colour and a depth image with light and
//! shadow. No model sees these pictures, so nothing here has a recorded counterpart.

use crate::camera::{CameraError, Frame, Look, MAX_SIZE_PX, MIN_SIZE_PX, NEAR_M};
use crate::mask::Mask;
use crate::raster::{Raster, Shade, Window};
use crate::scene::{self, LIGHT, Marker, Seen, cross, dot};

/// A pinhole camera that looks down at a point from one side; world +Z is up in its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlantedCamera {
    position_m: [f32; 3],
    target_m: [f32; 3],
    fov_rad: f32,
    size_px: [u32; 2],
}

// The samples of a pixel. Four are enough for pictures of at most 256 colours, and cost half of the nine of the camera
// over the table.
const SAMPLES: [[f32; 2]; 4] = [
    [0.375, 0.125],
    [0.875, 0.375],
    [0.125, 0.625],
    [0.625, 0.875],
];
// How much the brightness of cloth follows its slope to the light.
const RELIEF: f32 = 0.85;
// The least and the greatest brightness of cloth; 1 when it lies flat.
const BRIGHTNESS: [f32; 2] = [0.42, 1.12];
// Brightness of the cloth's rim, so that one layer stands out on another of the same colour.
const RIM: f32 = 0.66;
/// Brightness of the table in the shadow of cloth and picker.
const SHADOW: f32 = 0.8;

/// A slanted camera over a table of which it keeps the picture.
#[derive(Clone, Debug)]
pub struct SlantedView {
    camera: SlantedCamera,
    look: Look,
    /// For each sample: the bare table's colours, row by row.
    table: [Vec<[u8; 3]>; SAMPLES.len()],
    /// Distance from the camera's plane to the table at each pixel's centre, metres.
    depth_m: Vec<f32>,
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
        SlantedView {
            camera,
            look: look.clone(),
            table: SAMPLES.map(|sample| pixels().map(|pixel| colour(at(pixel, sample))).collect()),
            depth_m: pixels()
                .map(|pixel| at(pixel, [0.5, 0.5]).map_or(f32::INFINITY, |(_, depth_m)| depth_m))
                .collect(),
        }
    }

    /// Draws the table, the cloth and the picker's marker.
    ///
    /// - `cloth`, `positions`: as for [`TopDownCamera::render`](crate::TopDownCamera::render).
    ///
    /// The depth of a pixel is that of its first sample on the cloth or the marker, else of the table at its centre;
    /// infinite above the horizon.
    pub fn render(
        &self,
        cloth: impl Into<Mask>,
        positions: &[[f32; 3]],
        marker: Option<&Marker>,
    ) -> Frame {
        let mask = &cloth.into();
        let size = self.camera.size_px.map(|side| side as usize);
        let project = self.camera.projector();
        // A point's shadow lies on the table, away from the light.
        let shadow = |[x, y, z]: [f32; 3]| {
            let along = z / LIGHT[2];
            project([x - along * LIGHT[0], y - along * LIGHT[1], 0.0])
        };
        let dark = Shade {
            top: [0.0; 3],
            underside: [0.0; 3],
        };
        let mut shadows = scene::cloth(mask, positions, &shadow, &|_| dark);
        let mut triangles = scene::cloth(mask, positions, &project, &|index| {
            self.shade(mask, positions, index)
        });
        if let Some(marker) = marker {
            shadows.extend(marker.triangles(&shadow));
            triangles.extend(marker.triangles(&project));
        }
        // Cloth and marker are above the table, so nothing hides behind it.
        let [mut shadows_seen, mut seen] =
            [&shadows, &triangles].map(|of| Raster::new(Window::around(of, size), 0.0));
        let n_pixels = size[0] * size[1];
        let mut sums = vec![[0_u16; 3]; n_pixels];
        let mut depth_m = self.depth_m.clone();
        let mut is_cloth = vec![false; n_pixels];
        let mut colours = Vec::with_capacity(n_pixels);
        for (offset, table) in SAMPLES.iter().zip(&self.table) {
            colours.clone_from(table);
            for (raster, triangles) in [(&mut shadows_seen, &shadows), (&mut seen, &triangles)] {
                raster.clear(*offset);
                for triangle in triangles {
                    raster.draw(triangle);
                }
            }
            for ([column, row], _, _) in shadows_seen.drawn() {
                let colour = &mut colours[row * size[0] + column];
                *colour = colour.map(|channel| (f32::from(channel) * SHADOW) as u8);
            }
            for ([column, row], colour, inverse_depth) in seen.drawn() {
                let pixel = row * size[0] + column;
                colours[pixel] = colour;
                if !is_cloth[pixel] {
                    is_cloth[pixel] = true;
                    depth_m[pixel] = 1.0 / inverse_depth;
                }
            }
            for (sum, colour) in sums.iter_mut().zip(&colours) {
                for channel in 0..3 {
                    sum[channel] += u16::from(colour[channel]);
                }
            }
        }
        let samples = SAMPLES.len() as u16;
        Frame {
            width: self.camera.size_px[0],
            height: self.camera.size_px[1],
            rgb: sums
                .iter()
                .flatten()
                .map(|sum| ((sum + samples / 2) / samples) as u8)
                .collect(),
            depth_m,
        }
    }

    /// Returns the colours at a particle in the light; the rim is darker.
    fn shade(&self, mask: &Mask, positions: &[[f32; 3]], index: usize) -> Shade {
        let (normal, length) = scene::normal(mask, positions, index);
        let facing = match length > 0.0 {
            true => dot(normal, LIGHT) / length,
            false => LIGHT[2],
        };
        let [least, greatest] = BRIGHTNESS;
        let rim = if is_rim(mask, index) { RIM } else { 1.0 };
        let brightness = |facing: f32| {
            rim * (1.0 + RELIEF * (facing.max(0.0) - LIGHT[2])).clamp(least, greatest)
        };
        let shade = Shade::both(&self.look, [brightness(facing), brightness(-facing)]);
        Shade {
            top: shade.top.map(|channel| channel.min(255.0)),
            underside: shade.underside.map(|channel| channel.min(255.0)),
        }
    }
}

/// Tells whether a particle lies at an edge of the cloth.
fn is_rim(mask: &Mask, index: usize) -> bool {
    let (dimx, dimy) = (mask.grid().dimx, mask.grid().dimy);
    let (column, row) = (index % dimx, index / dimx);
    let inside = column > 0 && row > 0 && column + 1 < dimx && row + 1 < dimy;
    !inside
        || [index - 1, index + 1, index - dimx, index + dimx]
            .iter()
            .any(|&it| !mask.has(it))
}
