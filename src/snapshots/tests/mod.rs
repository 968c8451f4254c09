//! The format of snapshot files, and what remains of a change that is stopped at any point.
#![allow(clippy::unwrap_used)]

mod files;
mod stops;

use super::{Contents, Info, Metadata, Name, Origin, Snapshot};

fn name(name: &str) -> Name {
    Name::new(name).unwrap()
}

fn text(contents: &str) -> Snapshot {
    Snapshot {
        metadata: Metadata {
            source: Some("half.fab".to_owned()),
            description: Some("what `half` asks: first, with a colon".to_owned()),
            info: Some(Info {
                task: "half".to_owned(),
                variant: Some("without_layers".to_owned()),
                stage: Some("describe".to_owned()),
                scene: Some("start".to_owned()),
                tokens: Some(812),
                origin: vec![
                    origin(1, 2, "describe.say", Some(("half.fab", 12))),
                    origin(3, 3, "frame", None),
                    origin(4, 6, "check.near", Some(("my lib/folding: all.fab", 28))),
                ],
                ..Info::default()
            }),
            ..Metadata::default()
        },
        contents: Contents::Text(contents.to_owned()),
    }
}

fn picture(bytes: &[u8]) -> Snapshot {
    let mut snapshot = text("");
    let info = snapshot.metadata.info.as_mut().unwrap();
    info.picture = Some("subgoal 1 with arrow".to_owned());
    // YAML reads digits with one `e` as a number unless they are quoted.
    info.drawn_from = Some("12345e67".to_owned());
    snapshot.contents = Contents::Picture(bytes.to_vec());
    snapshot
}

fn origin(from: u32, to: u32, component: &str, place: Option<(&str, u32)>) -> Origin {
    Origin {
        from,
        to,
        component: component.to_owned(),
        place: place.map(|(file, line)| (file.to_owned(), line)),
    }
}
