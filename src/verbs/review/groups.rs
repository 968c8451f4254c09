//! Groups pending snapshots: an edit that changes forty snapshots is one thing to look at.
//!
//! In: pending snapshots. Out: groups, whose ids are stable from run to run. Each edit is one group, so it is reviewed
//! once; a text with several edits is in the group of each. The module `decide` applies the decisions.

use super::edits::{self, Cause, Edit};
use super::find::Pending;
use crate::snapshots::Contents;
use fab_base::digest;
use serde::Serialize;
use serde_json::json;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    Edit,
    Scene,
    /// Changed pictures, and snapshots that changed between picture and text.
    Picture,
    New,
}

/// Pending snapshots with the same change.
#[derive(Debug, Serialize)]
pub struct Group {
    /// The first eight characters of a hash of the change.
    pub id: String,
    pub kind: Kind,
    #[serde(rename = "cause")]
    pub causes: Vec<Cause>,
    /// The edits: one for texts, all of a scene, none for pictures and new snapshots.
    pub edits: Vec<Edit>,
    /// The indices of its pending snapshots.
    #[serde(skip)]
    pub members: Vec<usize>,
    /// The estimated tokens of its prompt texts, if there are any.
    pub tokens: Option<Tokens>,
}

/// Estimated tokens of prompt texts, with all of their edits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tokens {
    pub before: u64,
    pub after: u64,
}

/// Groups pending snapshots: edits first, then scenes, pictures and new snapshots.
pub fn group(pending: &[Pending]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (number, one) in pending.iter().enumerate() {
        let (kind, edits) = change(one);
        // Each edit of a text alone; all of a scene together.
        let parts: Vec<&[Edit]> = match kind {
            Kind::Edit if edits.len() > 1 => edits.chunks(1).collect(),
            _ => vec![&edits],
        };
        for part in parts {
            let id = id(one, kind, part);
            let at = groups.iter().position(|group| group.id == id);
            let at = at.unwrap_or_else(|| {
                groups.push(Group {
                    id,
                    kind,
                    causes: Vec::new(),
                    edits: part.to_vec(),
                    members: Vec::new(),
                    tokens: None,
                });
                groups.len() - 1
            });
            groups[at].add(number, one, part);
        }
    }
    groups.sort_by_key(|group| group.kind);
    groups
}

impl Group {
    fn add(&mut self, number: usize, one: &Pending, edits: &[Edit]) {
        self.members.push(number);
        for cause in edits.iter().flat_map(|edit| &edit.causes) {
            if !self.causes.contains(cause) {
                self.causes.push(cause.clone());
            }
        }
        if let Some(after) = one.info.tokens {
            let accepted = one.accepted.as_ref();
            let before = accepted.and_then(|it| it.metadata.info.as_ref()?.tokens);
            let sum = self.tokens.get_or_insert_default();
            sum.before += before.unwrap_or_default();
            sum.after += after;
        }
    }
}

/// Returns the kind of a change and its edits; a picture and a new snapshot have none.
fn change(one: &Pending) -> (Kind, Vec<Edit>) {
    let Some(accepted) = &one.accepted else {
        return (Kind::New, Vec::new());
    };
    let kind = match (&accepted.contents, &one.proposed.contents) {
        (Contents::Text(_), Contents::Text(_)) if one.info.stage.is_none() => Kind::Scene,
        (Contents::Text(_), Contents::Text(_)) => Kind::Edit,
        _ => return (Kind::Picture, Vec::new()),
    };
    (kind, edits::between(accepted, &one.proposed))
}

/// Returns an id that is equal for snapshots with the same change.
fn id(one: &Pending, kind: Kind, edits: &[Edit]) -> String {
    let what = match (kind, one.pictures()) {
        (Kind::New, _) => json!([one.info.task, one.proposed.metadata.source]),
        (_, Some(pictures)) => json!(pictures.map(digest::of)),
        // A change between text and picture is a group of its own.
        (Kind::Picture, None) => json!(one.name),
        _ => edits.iter().map(|edit| json!(edit.key())).collect(),
    };
    digest::of(json!([kind, what]).to_string())[..8].to_owned()
}
