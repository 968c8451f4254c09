//! Draws triangles with a depth buffer, one sample a pixel.
//!
//! In: vertices in pixels. Out: for each pixel, the nearest surface's colour
//! and inverse depth. Knows neither world nor camera.

use crate::camera::Look;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;
use std::ops::Range;

/// Colours of both sides at a vertex, 0 to 255 per channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shade {
    pub top: [f32; 3],
    pub underside: [f32; 3],
}

impl Shade {
    /// Returns the cloth's colours times the brightness of its top and of its underside.
    pub fn both(look: &Look, [top, underside]: [f32; 2]) -> Shade {
        let paint = |colour: [u8; 3], brightness: f32| colour.map(|c| f32::from(c) * brightness);
        Shade {
            top: paint(look.top, top),
            underside: paint(look.underside, underside),
        }
    }
}

/// A projected corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    /// Pixels from the image's left edge.
    pub column: f32,
    /// Pixels from the image's top edge.
    pub row: f32,
    /// One over the distance along the optical axis, 1/m; unlike the distance, linear across the image.
    pub inverse_depth: f32,
    pub shade: Shade,
}

/// The part of an image that something is drawn in: columns and rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Window {
    pub columns: Range<usize>,
    pub rows: Range<usize>,
}

impl Window {
    /// Returns the pixels that triangles can touch, of an image of `[width, height]`.
    pub fn around(triangles: &[[Vertex; 3]], [width, height]: [usize; 2]) -> Window {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for vertex in triangles.iter().flatten() {
            let point = [vertex.column, vertex.row];
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let range = |axis: usize, size: usize| {
            // Casts to an integer saturate, so far-away corners need no special care.
            let end = ((high[axis] + 1.0).max(0.0) as usize).min(size);
            (low[axis].floor().max(0.0) as usize).min(end)..end
        };
        Window {
            columns: range(0, width),
            rows: range(1, height),
        }
    }
}

/// One sample of every pixel of a window.
#[derive(Clone, Debug)]
pub(crate) struct Raster {
    window: Window,
    background: f32,
    offset: [f32; 2],
    inverse_depth: Vec<f32>,
    colours: Vec<Option<[u8; 3]>>,
}

impl Raster {
    /// Makes an empty window before a plane at the inverse depth `background`.
    pub fn new(background: f32) -> Raster {
        Raster {
            window: Window::default(),
            background,
            offset: [0.0; 2],
            inverse_depth: Vec::new(),
            colours: Vec::new(),
        }
    }

    /// Forgets all triangles, takes a window of an image, and puts the sample at `offset` from each pixel's top left, in
    /// pixels.
    pub fn clear(&mut self, window: &Window, offset: [f32; 2]) {
        let n_pixels = window.columns.len() * window.rows.len();
        self.window.clone_from(window);
        self.offset = offset;
        self.inverse_depth.clear();
        self.inverse_depth.resize(n_pixels, self.background);
        self.colours.clear();
        self.colours.resize(n_pixels, None);
    }

    /// Returns the pixels that show a triangle: column and row, colour, inverse depth in 1/m.
    pub fn drawn(&self) -> impl Iterator<Item = ([usize; 2], [u8; 3], f32)> {
        let width = self.window.columns.len();
        let pixels = self.colours.iter().zip(&self.inverse_depth).enumerate();
        pixels.filter_map(move |(pixel, (colour, inverse_depth))| {
            let column = self.window.columns.start + pixel % width;
            let row = self.window.rows.start + pixel / width;
            Some(([column, row], (*colour)?, *inverse_depth))
        })
    }

    /// Draws triangles where they are nearer than what is there.
    ///
    /// Corners in clockwise order on the image show the top side, otherwise the underside.
    pub fn draw(&mut self, triangles: &[[Vertex; 3]]) {
        draw_all(self, triangles);
    }

    #[inline(always)]
    fn draw_one(&mut self, triangle: &[Vertex; 3]) {
        let [a, b, c] = triangle;
        let twice_area = cross(a, b, c.column, c.row);
        if twice_area == 0.0 || !twice_area.is_finite() {
            return;
        }
        let side = twice_area.signum();
        let colours = if twice_area > 0.0 {
            triangle.map(|v| v.shade.top)
        } else {
            triangle.map(|v| v.shade.underside)
        };
        let [first_column, first_row] = [self.window.columns.start, self.window.rows.start];
        let width = self.window.columns.len();
        let columns = [a.column, b.column, c.column];
        let columns = covered(columns, self.offset[0], &self.window.columns);
        let rows = covered([a.row, b.row, c.row], self.offset[1], &self.window.rows);
        for row in rows {
            for column in columns.clone() {
                let u = column as f32 + self.offset[0];
                let v = row as f32 + self.offset[1];
                let parts = [cross(b, c, u, v), cross(c, a, u, v), cross(a, b, u, v)];
                // Signs first, and all at once: most pixels lie outside, and a branch for each side costs more.
                let [one, two, three] = parts.map(|part| part * side < 0.0);
                if one | two | three {
                    continue;
                }
                let weights = parts.map(|part| part / twice_area);
                let mix = |values: [f32; 3]| {
                    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
                };
                let inverse = mix(triangle.map(|vertex| vertex.inverse_depth));
                let pixel = (row - first_row) * width + column - first_column;
                if inverse > self.inverse_depth[pixel] {
                    self.inverse_depth[pixel] = inverse;
                    let channel = |index: usize| (mix(colours.map(|c| c[index])) + 0.5) as u8;
                    self.colours[pixel] = Some([channel(0), channel(1), channel(2)]);
                }
            }
        }
    }
}

/// Draws one triangle after another.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn draw_all(raster: &mut Raster, triangles: &[[Vertex; 3]]) {
    for triangle in triangles {
        raster.draw_one(triangle);
    }
}

/// Returns the pixels of a range whose sample lies between the least and greatest coordinate.
#[inline(always)]
fn covered(coordinates: [f32; 3], offset: f32, range: &Range<usize>) -> Range<usize> {
    let low = coordinates.iter().fold(f32::INFINITY, |low, &c| low.min(c));
    let high = coordinates
        .iter()
        .fold(f32::NEG_INFINITY, |high, &c| high.max(c));
    // Casts to an integer saturate, so far-away corners need no special care.
    let first = (low - offset).ceil().max(0.0) as usize;
    let last = (high - offset).floor() + 1.0;
    first.max(range.start)..(last.max(0.0) as usize).min(range.end)
}

/// Returns twice the signed area of the triangle `a`, `b`, (`u`, `v`); positive when clockwise on the image.
#[inline(always)]
fn cross(a: &Vertex, b: &Vertex, u: f32, v: f32) -> f32 {
    (b.column - a.column) * (v - a.row) - (b.row - a.row) * (u - a.column)
}
