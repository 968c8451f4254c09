//! Sine, cosine and numbers as text with the same bits on every machine.
//!
//! A platform's own trigonometry differs in the last bit between systems. Verdicts and artefacts must not.

/// Returns an angle as `0 <= deg < 360`.
pub fn normalised_deg(deg: f64) -> f64 {
    let rest = deg % 360.0;
    let turned = if rest < 0.0 { rest + 360.0 } else { rest };
    // A tiny negative angle rounds up to a whole turn; -0 becomes 0.
    if turned >= 360.0 { 0.0 } else { turned + 0.0 }
}

/// Returns the cosine of an angle; exact if it is 0, a half or 1.
pub fn cos_deg(deg: f64) -> f64 {
    let deg = normalised_deg(deg);
    // Folded into the first quadrant, so opposite angles have exactly opposite values.
    let (sign, deg) = match deg {
        deg if deg <= 90.0 => (1.0, deg),
        deg if deg <= 180.0 => (-1.0, 180.0 - deg),
        deg if deg <= 270.0 => (-1.0, deg - 180.0),
        deg => (1.0, 360.0 - deg),
    };
    let cosine = if deg == 90.0 {
        return 0.0;
    } else if deg == 60.0 {
        0.5
    } else if deg > 45.0 {
        libm::sin((90.0 - deg).to_radians())
    } else {
        libm::cos(deg.to_radians())
    };
    sign * cosine
}

/// Returns a direction as a vector in the image, right and down: 90 degrees is `[0, -1]`.
pub fn vector_of(deg: f64) -> [f64; 2] {
    // -sin(deg) is cos(deg + 90). Adding 0 makes a negative zero positive, so it is written as 0.
    [cos_deg(deg) + 0.0, cos_deg(deg + 90.0) + 0.0]
}

/// Writes a number with at most `decimals` digits after the decimal point and without trailing zeros.
pub fn written(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}
