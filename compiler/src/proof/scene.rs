//! Scenes for the proof: points that are easy to confuse, at the picture's edges and beyond.

use fab_program::scene::SceneView;
use fab_program::space;
use fab_program::{ActionField, Choices, Extractor, KeypointShape, PixelPoint, Program, Value};

/// The number of points in the larger scene.
const N_POINTS: usize = 30;

/// A generated scene.
pub(super) struct Generated {
    points: Vec<PixelPoint>,
    /// Keypoints that are a single point.
    single: Vec<String>,
    /// Keypoints whose points are always the same.
    fixed: Vec<(String, Vec<PixelPoint>)>,
    /// The last pixel of a row; every mask is the whole picture.
    far: i32,
}

impl Generated {
    /// Returns a scene where every keypoint is one point.
    pub fn one(program: &Program) -> Generated {
        let far = edge(program);
        Generated::of(program, vec![PixelPoint::new(0, far)])
    }

    /// Returns a scene with points that share digits, lie on the edges, or are negative.
    pub fn many(program: &Program) -> Generated {
        let far = edge(program);
        let mut points: Vec<PixelPoint> = [
            [1, 11],
            [11, 1],
            [1, 1],
            [11, 11],
            [111, 1],
            [1, 111],
            [12, 3],
            [1, 23],
            [123, 4],
            [12, 34],
            [34, 12],
            [0, 0],
            [0, far],
            [far, 0],
            [far, far],
            [-1, 0],
            [0, -1],
            [-12, -34],
        ]
        .map(PixelPoint::from)
        .to_vec();
        let side = i64::from(program.camera.image_px.max(1));
        for index in points.len()..N_POINTS {
            // Steps without a common factor spread over the picture.
            let along = |step: i64| i32::try_from(index as i64 * step % side).unwrap_or(0);
            points.push(PixelPoint::new(along(37), along(53)));
        }
        Generated::of(program, points)
    }

    fn of(program: &Program, points: Vec<PixelPoint>) -> Generated {
        let mut single = Vec::new();
        let mut fixed = Vec::new();
        for keypoint in &program.keypoints {
            if let Extractor::Fixed { points } = &keypoint.extractor {
                fixed.push((keypoint.name.clone(), points.clone()));
            } else if keypoint.extractor.shape() == KeypointShape::Point {
                single.push(keypoint.name.clone());
            }
        }
        Generated {
            points,
            single,
            fixed,
            far: edge(program),
        }
    }

    /// Returns the values of a field; for a region, the points in it.
    pub fn offered(&self, field: &ActionField) -> Vec<Value> {
        match &field.choices {
            Choices::Region { .. } => {
                let inside = self.points.iter().filter(|point| self.shows(**point));
                inside.copied().map(Value::Point).collect()
            }
            _ => space::choices(field, self),
        }
    }

    fn shows(&self, point: PixelPoint) -> bool {
        [point.u, point.v]
            .iter()
            .all(|at| (0..=self.far).contains(at))
    }
}

/// Returns the last pixel of a row, at most the largest that the reader accepts.
fn edge(program: &Program) -> i32 {
    i32::try_from(program.camera.image_px.saturating_sub(1)).unwrap_or(i32::MAX)
}

impl SceneView for Generated {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        if let Some((_, points)) = self.fixed.iter().find(|(name, _)| name == keypoint) {
            return Some(points.clone());
        }
        let is_single = self.single.iter().any(|name| name == keypoint);
        let n_points = if is_single { 1 } else { self.points.len() };
        Some(self.points[..n_points].to_vec())
    }

    fn distance_px(&self, _: &str, point: PixelPoint) -> Option<f64> {
        Some(if self.shows(point) { 0.0 } else { 1.0 })
    }

    fn area_px(&self, _: &str) -> Option<f64> {
        let side = f64::from(self.far) + 1.0;
        Some(side * side)
    }

    fn region_pixel(&self, _: &str, number: u64) -> Option<PixelPoint> {
        let side = u64::try_from(self.far).ok()? + 1;
        let at = |part: u64| i32::try_from(part).ok();
        Some(PixelPoint::new(at(number % side)?, at(number / side)?))
    }
}
