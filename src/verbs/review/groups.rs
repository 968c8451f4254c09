//! Groups pending snapshots: an edit that changes forty snapshots is one thing to look at.
//!
//! In: pending snapshots. Out: groups, whose ids are stable from run to run. Each edit is one group, so it is reviewed
//! once; a text with several edits is in the group of each. [`super::decide`] applies the decisions.

use super::edits::{self, Cause, Edit};
use super::find::Pending;
use super::words;
use crate::snapshots::Contents;
use fab_base::digest;
use fab_program::tokens;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

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
    /// The causes, in order and without duplicates.
    pub causes: Vec<Cause>,
    /// The edits: one for texts, all of a scene, none for pictures and new snapshots.
    pub edits: Vec<Edit>,
    /// The indices of its pending snapshots.
    pub members: Vec<usize>,
    /// Estimated tokens of its prompt texts.
    pub tokens: Tokens,
}

/// Estimated tokens of the prompt texts of a group, where they are known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tokens {
    /// Before and after, for each question.
    pub questions: Vec<[u64; 2]>,
}

impl Tokens {
    /// Returns the sums before and after; `None` if the group has no question.
    pub fn sums(&self) -> Option<[u64; 2]> {
        let sum = |side: usize| {
            let questions = self.questions.iter().map(|question| question[side]);
            questions.fold(0, u64::saturating_add)
        };
        (!self.questions.is_empty()).then(|| [sum(0), sum(1)])
    }

    /// Returns the smallest and the largest change of a question.
    pub fn range(&self) -> Option<[i64; 2]> {
        let changes = self.questions.iter().map(|[before, after]| {
            let change = i128::from(*after) - i128::from(*before);
            // Clamped to the range of an i64, so the cast keeps the value.
            change.clamp(i64::MIN.into(), i64::MAX.into()) as i64
        });
        Some([changes.clone().min()?, changes.max()?])
    }
}

/// Groups pending snapshots: edits first, then scenes, pictures and new snapshots.
pub fn group(pending: &[Pending]) -> Vec<Group> {
    let mut groups: BTreeMap<(Kind, String), Group> = BTreeMap::new();
    let mut order = Vec::new();
    for (number, one) in pending.iter().enumerate() {
        let kind = kind(one);
        let found = match kind {
            Kind::Edit | Kind::Scene => edits::edits(one),
            Kind::Picture | Kind::New => Vec::new(),
        };
        let each = once(&found);
        let parts: Vec<&[Edit]> = match kind {
            Kind::Edit if each.len() > 1 => each.chunks(1).collect(),
            _ => vec![&each],
        };
        for part in &parts {
            let key = (kind, key(one, kind, part));
            let group = groups.entry(key.clone()).or_insert_with(|| {
                order.push(key.clone());
                Group {
                    id: id(&key.1),
                    kind,
                    causes: Vec::new(),
                    edits: part.to_vec(),
                    members: Vec::new(),
                    tokens: Tokens::default(),
                }
            });
            group.members.push(number);
            for edit in &mut group.edits {
                let again = found.iter().filter(|again| again.key == edit.key);
                let causes = again.flat_map(|again| again.causes.iter().cloned());
                add(&mut edit.causes, causes);
            }
            add(&mut group.causes, causes(one, kind, part));
            let question = question(one).map(|[before, after]| match parts.len() {
                1 => [before, after],
                _ => [before, before.saturating_add_signed(weight(&found, part))],
            });
            group.tokens.questions.extend(question);
        }
    }
    order.sort_by_key(|(kind, _)| *kind);
    order.iter().filter_map(|key| groups.remove(key)).collect()
}

/// Returns the estimated tokens of a prompt text before and after, where both are known.
fn question(one: &Pending) -> Option<[u64; 2]> {
    one.info.stage.as_ref()?;
    let after = one.info.tokens?;
    let before = match &one.accepted {
        None => 0,
        Some(accepted) => accepted.metadata.info.as_ref()?.tokens?,
    };
    Some([before, after])
}

/// Returns how many tokens a part of a text's edits adds, counting each edit as often as it occurs.
fn weight(found: &[Edit], part: &[Edit]) -> i64 {
    let of = |lines: &[String]| tokens::of_text(&lines.join("\n")) as i64;
    let is_part = |edit: &&Edit| part.iter().any(|one| one.key == edit.key);
    let made = found.iter().filter(is_part);
    made.map(|edit| of(&edit.added) - of(&edit.removed)).sum()
}

fn add(causes: &mut Vec<Cause>, more: impl IntoIterator<Item = Cause>) {
    for cause in more {
        if !causes.contains(&cause) {
            causes.push(cause);
        }
    }
}

/// Returns each edit once, where it first occurs.
fn once(edits: &[Edit]) -> Vec<Edit> {
    let mut keys = BTreeSet::new();
    let first = edits.iter().filter(|edit| keys.insert(&edit.key));
    first.cloned().collect()
}

fn kind(one: &Pending) -> Kind {
    let Some(accepted) = &one.accepted else {
        return Kind::New;
    };
    match (&accepted.contents, &one.proposed.contents) {
        (Contents::Text(_), Contents::Text(_)) if one.info.stage.is_none() => Kind::Scene,
        (Contents::Text(_), Contents::Text(_)) => Kind::Edit,
        _ => Kind::Picture,
    }
}

/// Returns a key that is equal for snapshots with the same change.
fn key(one: &Pending, kind: Kind, edits: &[Edit]) -> String {
    let parts: Vec<String> = match (kind, one.pictures()) {
        (Kind::New, _) => vec![
            one.info.task.clone(),
            one.proposed.metadata.source.clone().unwrap_or_default(),
        ],
        (_, Some((before, after))) => vec![digest::of(before), digest::of(after)],
        // A change between text and picture is a group of its own.
        (Kind::Picture, None) => vec![one.name.to_string()],
        _ => {
            let keys: BTreeSet<&String> = edits.iter().map(|edit| &edit.key).collect();
            keys.into_iter().cloned().collect()
        }
    };
    serde_json::json!([kind, parts]).to_string()
}

fn causes(one: &Pending, kind: Kind, edits: &[Edit]) -> Vec<Cause> {
    match kind {
        Kind::Scene => words::scene_causes(one),
        Kind::Edit => edits
            .iter()
            .flat_map(|edit| edit.causes.iter().cloned())
            .collect(),
        Kind::Picture => words::drawn_from(one).into_iter().collect(),
        Kind::New => Vec::new(),
    }
}

fn id(key: &str) -> String {
    digest::of(key)[..8].to_owned()
}
