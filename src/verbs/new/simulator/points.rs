//! Writes folds and points of the cloth in the language's syntax.

use fab_program::{ClothPoint, Fold};

/// Writes a fold as a whole, ignoring its fraction.
pub fn fold_text(fold: &Fold) -> String {
    format!("{} -> {}", point_text(&fold.pick), point_text(&fold.place))
}

/// Writes a point of the cloth in the language's syntax.
pub fn point_text(point: &ClothPoint) -> String {
    let ClothPoint::Particle { right, front } = *point else {
        return "center".to_owned();
    };
    let name = |low: &'static str, high: &'static str, at: f64| match at {
        0.0 => Some(low),
        1.0 => Some(high),
        _ => None,
    };
    let (side, end) = (name("left", "right", right), name("back", "front", front));
    match (end, side) {
        (Some(end), Some(side)) => format!("corner({end}_{side})"),
        (None, Some(side)) if front == 0.5 => format!("middle({side})"),
        (Some(end), None) if right == 0.5 => format!("middle({end})"),
        _ => format!("point({right}, {front})"),
    }
}
