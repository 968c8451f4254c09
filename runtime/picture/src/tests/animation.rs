//! Unit tests of `animation`.

#![allow(clippy::unwrap_used)]

use super::*;
use image::Rgb;

const RED: [u8; 3] = [200, 0, 0];
const WHITE: [u8; 3] = [250, 250, 250];

/// A white picture with a red pixel.
fn spot(column: u32, row: u32) -> RgbImage {
    let mut picture = RgbImage::from_pixel(20, 12, Rgb(WHITE));
    picture.put_pixel(column, row, Rgb(RED));
    picture
}

fn animation() -> Animation {
    Animation::new([20, 12], vec![RED, WHITE])
}

/// Decodes a file: rectangle and delay of each frame, and the pictures as a viewer composes them.
fn decoded(bytes: &[u8]) -> (Vec<[u16; 5]>, Vec<Vec<u8>>) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).unwrap();
    let (width, height) = (usize::from(decoder.width()), usize::from(decoder.height()));
    let (mut frames, mut pictures) = (Vec::new(), Vec::new());
    let mut canvas = vec![0; 3 * width * height];
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        for (number, pixel) in frame.buffer.chunks(4).enumerate() {
            let column = usize::from(frame.left) + number % usize::from(frame.width);
            let row = usize::from(frame.top) + number / usize::from(frame.width);
            if pixel[3] > 0 {
                let at = 3 * (row * width + column);
                canvas[at..at + 3].copy_from_slice(&pixel[..3]);
            }
        }
        frames.push([
            frame.left,
            frame.top,
            frame.width,
            frame.height,
            frame.delay,
        ]);
        pictures.push(canvas.clone());
    }
    (frames, pictures)
}

#[test]
fn pictures_come_back_whole() {
    let mut animation = animation();
    let pictures = [spot(3, 4), spot(5, 4), spot(5, 9)];
    for picture in &pictures {
        assert!(animation.show(picture));
        animation.hold(8);
        assert!(!animation.show(picture));
        animation.hold(5);
    }
    let written = animation.finish().unwrap();
    assert_eq!((written.pictures, written.shown_cs), (3, 39));
    let (frames, found) = decoded(&written.bytes);
    assert_eq!(frames, [[0, 0, 20, 12, 13]; 3]);
    assert_eq!(found, pictures.map(RgbImage::into_raw));
    assert_eq!(super::tests::animation().finish(), None);
}

#[test]
fn a_colour_becomes_the_nearest_of_the_list() {
    let colours = vec![[0, 0, 0], [100, 0, 0], [100, 0, 0], [0, 200, 0]];
    let mut animation = Animation::new([1, 1], colours);
    let numbers = [[10, 10, 10], [90, 9, 9], [60, 150, 0]].map(|colour| animation.number(colour));
    assert_eq!(numbers, [0, 1, 3]);
    let many = Animation::new([1, 1], vec![[7; 3]; 300]);
    assert_eq!(many.colours.len(), MAX_COLOURS);
}
