//! A scene as text, and back.

use super::*;

fn scene() -> PinnedScene {
    PinnedScene {
        seen_of: "0123456789abcdef".to_owned(),
        start: (),
        step: 2,
        last: Some(PinnedAction {
            fields: BTreeMap::from([
                ("direction".to_owned(), Value::Word("up".to_owned())),
                ("pick".to_owned(), Value::Point(PixelPoint::new(1, 2))),
            ]),
            pick: PixelPoint::new(1, 2),
            place: PixelPoint::new(3, -4),
        }),
        points: BTreeMap::from([
            ("center".to_owned(), vec![PixelPoint::new(5, 6)]),
            ("corners".to_owned(), Vec::new()),
        ]),
        areas: BTreeMap::from([("cloth".to_owned(), 12.0)]),
    }
}

#[test]
fn a_scene_is_read_as_it_was_written() {
    let scene = scene();
    assert_eq!(PinnedScene::parse(&scene.text()), Ok(scene.clone()));
    assert_eq!(scene.text().lines().count(), 13);
    let bare = PinnedScene {
        last: None,
        points: BTreeMap::new(),
        areas: BTreeMap::new(),
        ..scene
    };
    assert_eq!(PinnedScene::parse(&bare.text()), Ok(bare));
}

#[test]
fn what_is_no_scene_is_refused_with_words() {
    let wrong = [
        ("", "EOF"),
        ("[]", "invalid"),
        (r#"{"step": 1}"#, "missing field"),
    ];
    for (text, words) in wrong {
        let why = PinnedScene::parse(text).err();
        assert!(why.is_some_and(|why| why.contains(words)), "{text}");
    }
    let zeroth = PinnedScene { step: 0, ..scene() };
    assert!(PinnedScene::parse(&zeroth.text()).is_err());
}
