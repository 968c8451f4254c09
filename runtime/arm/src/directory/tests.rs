//! Tests of a folder of pictures.

#![allow(clippy::unwrap_used)]
use super::*;
use image::{Rgb, RgbImage};
use std::sync::mpsc::channel;

fn encoded(level: u8) -> Vec<u8> {
    png::encode(&RgbImage::from_pixel(4, 3, Rgb([level; 3])))
}

fn level(camera: &mut DirectoryCamera) -> u8 {
    camera.shoot().unwrap().rgb.get_pixel(0, 0).0[0]
}

#[test]
fn a_picture_of_before_is_never_taken_for_a_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes);
    put("b.png", &encoded(2)).unwrap();
    let short = PictureSelection::Fresh { timeout_s: 0.2 };
    let mut camera = DirectoryCamera::of(folder.path(), None, short);
    let why = camera.shoot().unwrap_err();
    assert!(why.contains("no new picture came"), "{why}");

    // Where the newest is removed, the one before it does not become new.
    put("c.png", &encoded(3)).unwrap();
    let newest = folder.path().join("c.png");
    let removing = std::thread::spawn(move || {
        std::thread::sleep(2 * LOOK);
        std::fs::remove_file(newest).unwrap();
    });
    let why = camera.shoot().unwrap_err();
    removing.join().unwrap();
    assert!(why.contains("no new picture came"), "{why}");

    let long = PictureSelection::Fresh { timeout_s: 60.0 };
    let mut camera = DirectoryCamera::of(folder.path(), None, long);
    let (send, taken) = channel();
    let waiting = std::thread::spawn(move || {
        for _ in 0..2 {
            send.send(level(&mut camera)).unwrap();
        }
    });
    // A name that sorts before the old one, half written at first; then the old name with another picture.
    let whole = encoded(7);
    put("a.png", &whole[..20]).unwrap();
    std::thread::sleep(4 * LOOK);
    let mut levels = [(0_u8, 0_u8); 2];
    for (index, name) in ["a.png", "b.png"].into_iter().enumerate() {
        let mut sent = 7 + 100 * index as u8;
        // Written repeatedly until it is seen, because the test cannot tell when the camera starts polling.
        levels[index] = loop {
            sent += 1;
            put(name, &encoded(sent)).unwrap();
            if let Ok(seen) = taken.recv_timeout(20 * LOOK) {
                break (seen, sent);
            }
        };
    }
    waiting.join().unwrap();
    for ((seen, sent), least) in levels.into_iter().zip([8, 108]) {
        assert!((least..=sent).contains(&seen), "{levels:?}");
    }
}

#[test]
fn where_nothing_moves_the_newest_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let mut camera = DirectoryCamera::of(folder.path(), None, PictureSelection::Newest);
    let why = camera.shoot().unwrap_err();
    assert!(why.contains("holds no picture"), "{why}");
    let hour = Duration::from_secs(3600);
    for (name, level, ago) in [("b.png", 2, 0), ("c.png", 3, 1), ("a.png", 1, 0)] {
        let path = folder.path().join(name);
        std::fs::write(&path, encoded(level)).unwrap();
        let file = std::fs::File::options().append(true).open(&path).unwrap();
        file.set_modified(SystemTime::UNIX_EPOCH + (10 - ago) * hour)
            .unwrap();
    }
    assert_eq!((level(&mut camera), level(&mut camera)), (2, 2));
}

#[test]
fn a_depth_of_another_size_and_a_missing_folder_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: Vec<u8>| {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    };
    write("a.png", png::encode(&RgbImage::new(4, 3)));
    write("a.depth.png", png::encode(&image::GrayImage::new(5, 3)));
    let mut camera = DirectoryCamera::of(folder.path(), None, PictureSelection::Newest);
    let why = camera.shoot().unwrap_err();
    assert!(why.contains("4 x 3 px and its depth 5 x 3"), "{why}");
    for selection in [
        PictureSelection::Newest,
        PictureSelection::Fresh { timeout_s: 0.2 },
    ] {
        let none = folder.path().join("none");
        assert!(DirectoryCamera::of(&none, None, selection).shoot().is_err());
    }
}
