//! A scene whose points come from a file instead of a camera.

use crate::exit::Failure;
use crate::sources;
use fab_program::scene::SceneView;
use fab_program::{KeypointShape, PixelPoint, Program};
use std::collections::BTreeMap;
use std::path::Path;

/// A scene with points from a file; its masks and boxes are unknown.
pub struct SceneFile {
    points: BTreeMap<String, Vec<PixelPoint>>,
}

impl SceneFile {
    pub fn read(program: &Program, path: &Path) -> Result<SceneFile, Failure> {
        let wrong = |why: String| {
            Failure::environment(format!(
                "the scene `{}` cannot be used: {why}",
                path.display()
            ))
        };
        let text = sources::read_text(path).map_err(wrong)?;
        let points: BTreeMap<String, Vec<PixelPoint>> = serde_json::from_str(&text)
            .map_err(|error| wrong(format!("{error}; right would be {{\"corners\": [[12, 34], [56, 78]], \"center\": [[40, 50]]}}")))?;
        for keypoint in &program.keypoints {
            let name = keypoint.name.as_str();
            let found = points.get(name).map_or(0, Vec::len);
            match keypoint.extractor.shape() {
                KeypointShape::Point if found != 1 => {
                    return Err(wrong(format!(
                        "`{name}` needs exactly one point, but has {found}"
                    )));
                }
                KeypointShape::Points if found == 0 => {
                    return Err(wrong(format!("`{name}` needs at least one point")));
                }
                _ => {}
            }
        }
        Ok(SceneFile { points })
    }
}

impl SceneView for SceneFile {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        self.points.get(keypoint).cloned()
    }

    fn distance_px(&self, _: &str, _: PixelPoint) -> Option<f64> {
        None
    }

    fn area_px(&self, _: &str) -> Option<f64> {
        None
    }
}
