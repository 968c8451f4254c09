//! Tests of pictures that arrive as messages.

#![allow(clippy::unwrap_used)]

use super::*;

const MS: i64 = 1_000_000;

fn pictures(stamps_ms: &[i64]) -> Pictures {
    let image = |stamp_ms: &i64| Image {
        stamp_ns: stamp_ms * MS,
        ..Image::default()
    };
    Pictures {
        kept: stamps_ms.iter().map(image).collect(),
        newest_ns: None,
    }
}

/// Returns the stamps of the pair found, milliseconds.
fn pair(colors_ms: &[i64], depths_ms: &[i64]) -> Option<(i64, i64)> {
    let arrived = Arrived {
        colors: pictures(colors_ms),
        depths: pictures(depths_ms),
        ..Arrived::default()
    };
    let (color, depth) = arrived.pair(0)?;
    Some((color.stamp_ns / MS, depth.stamp_ns / MS))
}

#[test]
fn colour_is_joined_with_the_depth_that_is_nearest() {
    assert_eq!(pair(&[100], &[100]), Some((100, 100)));
    assert_eq!(pair(&[100], &[80, 110]), Some((100, 110)));
    assert_eq!(pair(&[100], &[40, 160]), None);
    assert_eq!(pair(&[200, 133], &[150]), Some((200, 150)));
    assert_eq!(pair(&[210, 133], &[150]), Some((133, 150)));
    assert_eq!(pair(&[], &[150]), None);
    assert_eq!(pair(&[150], &[]), None);
}

#[test]
fn only_pictures_that_were_taken_since_count() {
    let inbox = Inbox::default();
    let shift = |by_ms: i64| Image {
        stamp_ns: now_ns() + by_ms * MS,
        ..Image::default()
    };
    let begun_ns = now_ns();
    let n_found = |inbox: &Inbox| inbox.lock().colors.since(begun_ns).count();
    // Before the request, and by a clock that is ahead.
    inbox.color(shift(-200));
    inbox.color(shift(500));
    assert_eq!(n_found(&inbox), 0);
    assert!(inbox.lock().colors.newest_ns.unwrap() >= begun_ns + 400 * MS);
    inbox.color(shift(0));
    assert_eq!(n_found(&inbox), 1);
}
