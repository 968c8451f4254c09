//! Measures a picture in which a mask finds nothing, in words that end a message.

use fab_picture::depth_mask;
use fab_picture::observation::Observation;
use fab_program::Extractor;

/// Describes how the pixels of a picture differ from those that a mask selects.
pub(super) fn measured(extractor: &Extractor, observation: &Observation) -> String {
    match extractor {
        Extractor::DepthMask { below_m } => {
            let depth_m = &observation.depth_m;
            // Beyond any camera's range, so this counts everything with a reading.
            let readings = depth_mask(depth_m, f64::INFINITY);
            let depths = readings.columns_and_rows();
            let depths = depths.map(|(column, row)| f64::from(depth_m.get_pixel(column, row).0[0]));
            let [nearest_m, farthest_m] = depths.fold([f64::INFINITY, 0.0], |[least, most], m| {
                [m.min(least), m.max(most)]
            });
            if readings.is_empty() {
                return "; the depth picture has no reading".to_owned();
            }
            format!(
                "; its {} readings are {:.1} to {:.1} mm from the camera, and the mask takes what is nearer than {:.1} mm",
                readings.area_px(),
                1000.0 * nearest_m,
                1000.0 * farthest_m,
                1000.0 * below_m
            )
        }
        Extractor::ColorMask {
            hue_deg,
            saturation,
            value,
        } => {
            let (any_hue, any) = ([0.0, 360.0], [0.0, 1.0]);
            let count = |hue, saturation, value| {
                fab_vision::color_mask(&observation.rgb, hue, saturation, value).area_px()
            };
            format!(
                "; of {} pixels {} have its hue, {} its saturation and {} its value ({} to {}), and none all three",
                count(any_hue, any, any),
                count(*hue_deg, any, any),
                count(any_hue, *saturation, any),
                count(any_hue, any, *value),
                value[0],
                value[1],
            )
        }
        _ => String::new(),
    }
}
