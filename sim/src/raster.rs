//! Draws triangles with a depth buffer, one sample a pixel.
//!
//! In: vertices in pixels. Out: for each pixel, the nearest surface's colour
//! and inverse depth. Knows neither world nor camera.

/// Colours of both sides at a vertex, 0 to 255 per channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shade {
    pub top: [f32; 3],
    pub underside: [f32; 3],
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

/// One sample of every pixel of a square image.
pub(crate) struct Raster {
    size: usize,
    background: f32,
    offset: [f32; 2],
    inverse_depth: Vec<f32>,
    colours: Vec<Option<[u8; 3]>>,
}

impl Raster {
    /// Makes an image of `size` x `size` pixels before a plane at the inverse depth `background`.
    pub fn new(size: usize, background: f32) -> Raster {
        Raster {
            size,
            background,
            offset: [0.5, 0.5],
            inverse_depth: vec![background; size * size],
            colours: vec![None; size * size],
        }
    }

    /// Forgets all triangles, and puts the sample at `offset` from each pixel's top left, in pixels.
    pub fn clear(&mut self, offset: [f32; 2]) {
        self.offset = offset;
        self.inverse_depth.fill(self.background);
        self.colours.fill(None);
    }

    /// Returns every pixel's inverse depth, 1/m, row by row.
    pub fn inverse_depth(&self) -> &[f32] {
        &self.inverse_depth
    }

    /// Returns a pixel's colour, or `None` where only the background shows.
    pub fn colour(&self, pixel: usize) -> Option<[u8; 3]> {
        self.colours[pixel]
    }

    /// Draws a triangle where it is nearer than what is there.
    ///
    /// Corners in clockwise order on the image show the top side, otherwise the underside.
    pub fn draw(&mut self, triangle: &[Vertex; 3]) {
        let [a, b, c] = triangle;
        let twice_area = cross(a, b, c.column, c.row);
        if twice_area == 0.0 || !twice_area.is_finite() {
            return;
        }
        let colours = if twice_area > 0.0 {
            triangle.map(|v| v.shade.top)
        } else {
            triangle.map(|v| v.shade.underside)
        };
        let columns = self.covered([a.column, b.column, c.column], self.offset[0]);
        let rows = self.covered([a.row, b.row, c.row], self.offset[1]);
        for row in rows {
            for column in columns.clone() {
                let u = column as f32 + self.offset[0];
                let v = row as f32 + self.offset[1];
                let weights = [
                    cross(b, c, u, v) / twice_area,
                    cross(c, a, u, v) / twice_area,
                    cross(a, b, u, v) / twice_area,
                ];
                if weights.iter().any(|&weight| weight < 0.0) {
                    continue;
                }
                let mix = |values: [f32; 3]| {
                    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
                };
                let inverse = mix(triangle.map(|vertex| vertex.inverse_depth));
                let pixel = row * self.size + column;
                if inverse > self.inverse_depth[pixel] {
                    self.inverse_depth[pixel] = inverse;
                    let channel = |index: usize| (mix(colours.map(|c| c[index])) + 0.5) as u8;
                    self.colours[pixel] = Some([channel(0), channel(1), channel(2)]);
                }
            }
        }
    }

    /// Returns the pixels whose sample lies between the least and greatest coordinate.
    fn covered(&self, coordinates: [f32; 3], offset: f32) -> std::ops::Range<usize> {
        let low = coordinates.iter().fold(f32::INFINITY, |low, &c| low.min(c));
        let high = coordinates
            .iter()
            .fold(f32::NEG_INFINITY, |high, &c| high.max(c));
        // Casts to an integer saturate, so far-away corners need no special care.
        let first = (low - offset).ceil().max(0.0) as usize;
        let last = (high - offset).floor() + 1.0;
        first..(last.max(0.0) as usize).min(self.size)
    }
}

/// Returns twice the signed area of the triangle `a`, `b`, (`u`, `v`); positive when clockwise on the image.
fn cross(a: &Vertex, b: &Vertex, u: f32, v: f32) -> f32 {
    (b.column - a.column) * (v - a.row) - (b.row - a.row) * (u - a.column)
}
