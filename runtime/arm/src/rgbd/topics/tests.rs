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
        pending: stamps_ms.iter().map(image).collect(),
        off_ns: None,
    }
}

/// Returns the stamps of the pair found, milliseconds.
fn pair(colors_ms: &[i64], depths_ms: &[i64]) -> Option<(i64, i64)> {
    let arrived = Arrived {
        colors: pictures(colors_ms),
        depths: pictures(depths_ms),
        ..Arrived::default()
    };
    let (color, depth) = arrived.pair(true)?;
    Some((color.stamp_ns / MS, depth.unwrap().stamp_ns / MS))
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
fn only_pictures_that_were_taken_since_are_kept() {
    let inbox = Inbox::default();
    let shift = |by_ms: i64| Image {
        stamp_ns: now_ns() + by_ms * MS,
        ..Image::default()
    };
    let kept = |inbox: &Inbox| {
        let arrived = inbox.lock();
        (arrived.colors.pending.len(), arrived.colors.off_ns)
    };
    inbox.color(shift(0));
    assert_eq!(kept(&inbox), (0, None));
    inbox.request(Some(now_ns()));
    inbox.color(shift(-200));
    assert!(kept(&inbox).1.unwrap() <= -199 * MS);
    inbox.color(shift(500));
    assert!(kept(&inbox).1.unwrap() >= 400 * MS);
    inbox.color(shift(0));
    assert_eq!(kept(&inbox).0, 1);
    inbox.request(None);
    assert_eq!(kept(&inbox), (0, None));
}
