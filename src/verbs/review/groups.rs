//! Groups pending snapshots: an edit that changes forty snapshots is one thing to look at.
//!
//! In: pending snapshots. Out: groups, whose ids are stable from run to run. Each edit is one group, so it is reviewed
//! once; a text with several edits is in the group of each. [`super::decide`] applies the decisions.

use super::edits::{self, Cause, Edit};
use super::find::Pending;
use crate::snapshots::Contents;
use fab_base::digest;
use fab_program::tokens;
use serde::Serialize;

/// The kind of change of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Changed prompt texts.
    Edit,
    /// Changed scenes.
    Scene,
    /// Changed pictures, and snapshots that changed between picture and text.
    Picture,
    /// New snapshots.
    New,
}

/// Pending snapshots with the same change.
#[derive(Debug)]
pub struct Group {
    /// The first eight characters of a hash of what defines the group.
    pub id: String,
    /// The kind of change.
    pub kind: Kind,
    /// What is the same for its snapshots.
    key: String,
    /// The causes, in order and without duplicates.
    pub causes: Vec<Cause>,
    /// The edits: one for texts, all of a scene, none for pictures and new snapshots.
    pub edits: Vec<Edit>,
    /// The indices of its pending snapshots.
    pub members: Vec<usize>,
    /// Estimated tokens before and after, for each prompt text for which they are known.
    pub tokens: Vec<[u64; 2]>,
}

impl Group {
    /// Returns the sums of the tokens before and after; `None` if they are not known.
    pub fn all_tokens(&self) -> Option<[u64; 2]> {
        let sum = |side: usize| self.tokens.iter().map(|question| question[side]).sum();
        (!self.tokens.is_empty()).then(|| [sum(0), sum(1)])
    }
}

/// Groups pending snapshots: edits first, then scenes, pictures and new snapshots.
pub fn group(pending: &[Pending]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (number, one) in pending.iter().enumerate() {
        let (kind, edits) = change(one);
        let tokens = tokens_of(one);
        // Each edit of a text alone; all of a scene together.
        let parts: Vec<&[Edit]> = match kind {
            Kind::Edit if edits.len() > 1 => edits.chunks(1).collect(),
            _ => vec![&edits],
        };
        for part in &parts {
            let key = key(one, kind, part);
            let known = groups.iter().position(|group| group.key == key);
            let group = known.unwrap_or_else(|| {
                groups.push(Group {
                    id: digest::of(&key)[..8].to_owned(),
                    kind,
                    key,
                    causes: Vec::new(),
                    edits: part.to_vec(),
                    members: Vec::new(),
                    tokens: Vec::new(),
                });
                groups.len() - 1
            });
            let group = &mut groups[group];
            group.members.push(number);
            let causes = part.iter().flat_map(|edit| edit.causes.clone());
            for cause in causes.chain(other_inputs(one, kind)) {
                if !group.causes.contains(&cause) {
                    group.causes.push(cause);
                }
            }
            group
                .tokens
                .extend(tokens.map(|[before, after]| match part {
                    [edit] if parts.len() > 1 => {
                        [before, before.saturating_add_signed(weight(edit))]
                    }
                    _ => [before, after],
                }));
        }
    }
    groups.sort_by_key(|group| group.kind);
    groups
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

/// Returns a key that is equal for snapshots with the same change.
fn key(one: &Pending, kind: Kind, edits: &[Edit]) -> String {
    let what = match (kind, one.pictures()) {
        (Kind::New, _) => serde_json::json!([one.info.task, one.proposed.metadata.source]),
        (_, Some(pictures)) => serde_json::json!(pictures.map(digest::of)),
        // A change between text and picture is a group of its own.
        (Kind::Picture, None) => serde_json::json!(one.name),
        _ => edits
            .iter()
            .map(|edit| serde_json::json!(edit.key()))
            .collect(),
    };
    serde_json::json!([kind, what]).to_string()
}

/// Returns a cause for changed inputs that are no text: those of a scene, and of a picture.
fn other_inputs(one: &Pending, kind: Kind) -> Option<Cause> {
    let accepted = one.accepted.as_ref()?;
    let words = match (kind, &accepted.contents, &one.proposed.contents) {
        (Kind::Scene, Contents::Text(old), Contents::Text(new)) => {
            let seen_of = |text: &str| {
                text.lines()
                    .find(|it| it.contains("\"seen_of\""))
                    .map(str::to_owned)
            };
            let is_other = seen_of(old) != seen_of(new);
            is_other.then_some("seen of another cloth, camera, picker or other keypoints")
        }
        (Kind::Picture, ..) => {
            let info = accepted.metadata.info.as_ref()?;
            let is_other = info.drawn_from != one.info.drawn_from;
            is_other.then_some("drawn from another scene, other layers or another fold")
        }
        _ => None,
    };
    words.map(|words| Cause {
        component: words.to_owned(),
        file: None,
        line: None,
    })
}

/// Returns the estimated tokens of a prompt text before and after, where both are known.
fn tokens_of(one: &Pending) -> Option<[u64; 2]> {
    one.info.stage.as_ref()?;
    let before = match &one.accepted {
        None => 0,
        Some(accepted) => accepted.metadata.info.as_ref()?.tokens?,
    };
    Some([before, one.info.tokens?])
}

/// Returns how many tokens an edit adds.
fn weight(edit: &Edit) -> i64 {
    let of = |lines: &[String]| tokens::of_text(&lines.join("\n")) as i64;
    of(&edit.added) - of(&edit.removed)
}
