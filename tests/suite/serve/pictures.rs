//! Pictures of a request: PNG and JPEG, each given to the model as PNG, and bounded before they are decoded.

use super::server::Server;
use super::{CHAT, RESPONSES, blank, changed};
use crate::suite::support::Scripted;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fab_model::Part;
use image::codecs::jpeg::JpegEncoder;
use image::{Rgb, RgbImage};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

/// A picture that is red on the left and blue on the right, as JPEG.
fn jpeg(width: u32, height: u32) -> Vec<u8> {
    let picture = RgbImage::from_fn(width, height, |column, _| {
        if column < width / 2 {
            Rgb([255, 0, 0])
        } else {
            Rgb([0, 0, 255])
        }
    });
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, 100)
        .encode_image(&picture)
        .unwrap();
    bytes
}

/// The same with an Exif orientation.
fn turned(bytes: &[u8], orientation: u8) -> Vec<u8> {
    let mut exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0".to_vec();
    exif.extend([orientation, 0, 0, 0, 0, 0, 0]);
    let length = (exif.len() + 2) as u16;
    let mut whole = bytes[..2].to_vec();
    whole.extend([0xff, 0xe1]);
    whole.extend(length.to_be_bytes());
    whole.extend(exif);
    whole.extend(&bytes[2..]);
    whole
}

fn showing(path: &str, urls: &[String]) -> Value {
    let parts: Vec<Value> = urls
        .iter()
        .map(|url| match path {
            CHAT => json!({ "type": "image_url", "image_url": { "url": url } }),
            _ => json!({ "type": "input_image", "image_url": url }),
        })
        .collect();
    let turns = json!([{ "role": "user", "content": parts }]);
    changed(path, if path == CHAT { "messages" } else { "input" }, turns)
}

fn url(kind: &str, bytes: &[u8]) -> String {
    format!("data:image/{kind};base64,{}", STANDARD.encode(bytes))
}

#[test]
fn a_jpeg_reaches_the_model_as_png_and_turned_as_it_is_shown() {
    let bytes = jpeg(40, 20);
    for (kind, bytes, size, red, blue) in [
        ("jpeg", bytes.clone(), (40, 20), (5, 10), (35, 10)),
        ("jpg", bytes.clone(), (40, 20), (5, 10), (35, 10)),
        // Turned by a quarter clockwise: what was left is on top.
        ("JPEG", turned(&bytes, 6), (20, 40), (10, 5), (10, 35)),
    ] {
        for path in [CHAT, RESPONSES] {
            let model = Arc::new(Scripted::new(&["seen"]));
            let server = Server::of(model.clone());
            let (status, answer) = server.post(path, &showing(path, &[url(kind, &bytes)]));
            assert_eq!(status, 200, "{answer}");
            let asked = model.asked.lock().unwrap();
            let Part::Image(png) = &asked[0].messages[0].parts[0] else {
                panic!("no picture")
            };
            let seen = fab_picture::png::decode(png.bytes(), Path::new("seen")).unwrap();
            assert_eq!(seen.dimensions(), size);
            let [r, b] = [red, blue].map(|(column, row)| *seen.get_pixel(column, row));
            assert!(r.0[0] > 200 && r.0[2] < 50, "{r:?}");
            assert!(b.0[2] > 200 && b.0[0] < 50, "{b:?}");
        }
    }
}

#[test]
fn pictures_that_are_broken_or_too_large_are_refused_with_the_reason() {
    let model = Arc::new(Scripted::new(&[]));
    let server = Server::of(model.clone());
    let whole = jpeg(40, 20);
    let mut wide = whole.clone();
    // The height and the width are in the frame's header.
    let frame = wide.windows(2).position(|it| it == [0xff, 0xc0]).unwrap();
    wide[frame + 5..frame + 9].copy_from_slice(&[0xff, 0xff, 0xff, 0xff]);
    let tiny = url("png", blank(4096).bytes());
    for (urls, why) in [
        (vec![url("jpeg", &whole[..20])], "is not a JPEG picture"),
        (vec![url("jpeg", blank(8).bytes())], "is not a JPEG picture"),
        (vec![url("png", &whole)], "is not a PNG picture"),
        (
            vec![url("gif", b"GIF89a")],
            "is neither a PNG nor a JPEG in base64",
        ),
        (
            vec![url("jpeg", &wide)],
            "is 65535 by 65535 pixels; at most 4096 by 4096",
        ),
        (
            vec![tiny.clone(), tiny.clone(), url("jpeg", &whole)],
            "is one too many",
        ),
    ] {
        let last = urls.len() - 1;
        let (status, answer) = server.post(CHAT, &showing(CHAT, &urls));
        let param = format!("messages[0].content[{last}].image_url");
        assert_eq!(
            (status, &answer["error"]["param"]),
            (400, &json!(param)),
            "{answer}"
        );
        let message = answer["error"]["message"].as_str().unwrap();
        assert!(message.contains(why), "{message}");
    }
    assert!(model.asked.lock().unwrap().is_empty());
}
