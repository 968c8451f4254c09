//! Unit tests of `animation`.

#![allow(clippy::unwrap_used)]

use super::*;
use image::Rgb;
use std::fs;

const RED: [u8; 3] = [200, 0, 0];
const WHITE: [u8; 3] = [250, 250, 250];

/// A white picture with a red pixel.
fn spot(column: u32, row: u32) -> RgbImage {
    let mut picture = RgbImage::from_pixel(20, 12, Rgb(WHITE));
    picture.put_pixel(column, row, Rgb(RED));
    picture
}

fn palette() -> Palette {
    Palette::new([RED, WHITE])
}

/// Decodes a file: rectangle and delay of each frame, and the pictures as a viewer composes them.
fn decoded(path: &Path) -> (Vec<[u16; 5]>, Vec<Vec<u8>>) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(fs::File::open(path).unwrap()).unwrap();
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
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let mut animation = Animation::create(&path, [20, 12], palette()).unwrap();
    let pictures = [spot(3, 4), spot(5, 4), spot(5, 9)];
    for picture in &pictures {
        assert!(animation.show(picture).unwrap());
        animation.hold(8);
        assert!(!animation.show(picture).unwrap());
        animation.hold(5);
    }
    assert!(!path.exists());
    let written = animation.finish().unwrap().unwrap();
    assert_eq!((written.pictures, written.shown_cs), (3, 39));
    assert_eq!(written.bytes, fs::metadata(&path).unwrap().len());
    let (frames, found) = decoded(&path);
    assert_eq!(frames, [[0, 0, 20, 12, 13]; 3]);
    assert_eq!(found, pictures.map(RgbImage::into_raw));
}

#[test]
fn a_colour_becomes_the_nearest_of_the_palette() {
    let mut palette = Palette::new([[0, 0, 0], [100, 0, 0], [100, 0, 0], [0, 200, 0]]);
    let numbers = [[10, 10, 10], [90, 9, 9], [60, 150, 0]].map(|colour| palette.number(colour));
    assert_eq!(numbers, [0, 1, 3]);
    assert_eq!(Palette::new([[7; 3]; 300]).colours.len(), MAX_COLOURS);
}

#[test]
fn an_animation_without_pictures_or_without_an_end_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let empty = Animation::create(&path, [20, 12], palette()).unwrap();
    assert_eq!(empty.finish().unwrap(), None);
    let mut dropped = Animation::create(&path, [20, 12], palette()).unwrap();
    dropped.show(&spot(1, 1)).unwrap();
    drop(dropped);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    let nowhere = folder.path().join("absent/a.gif");
    let refused = Animation::create(&nowhere, [20, 12], palette())
        .err()
        .unwrap();
    assert!(refused.to_string().contains("absent/a.gif"), "{refused}");
    let mut narrow = Animation::create(&path, [19, 12], palette()).unwrap();
    let refused = narrow.show(&spot(1, 1)).unwrap_err().to_string();
    assert_eq!(
        refused,
        "a picture of [20, 12] pixels does not fit an animation of [19, 12]"
    );
}
