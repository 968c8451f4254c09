//! Warns if no prompt states what a model must know, if one shows what it may not answer, and if nothing uses an answer.
//!
//! In: a program without errors. Texts, examples and layers count as prompts; a plain picture does not, because a
//! model cannot read points or a format from it.

use super::context::Context;
use crate::diag::Code;
use crate::merge::Merged;
use fab_grammar::ast;
use fab_program::space;
use fab_program::{
    ActionField, Choices, Depends, Layers, Picture, Placeholder, Point, Program, Read, Stage,
    Template,
};
use std::collections::BTreeSet;

/// Warns of everything that the prompts of a task leave unspoken.
pub(crate) fn check(program: &Program, merged: &Merged<'_>, context: &mut Context<'_>) {
    for stage in &program.stages {
        let Some(part) = merged.stages.get(&stage.name) else {
            continue;
        };
        let Some(line) = part.read().next() else {
            continue;
        };
        match &stage.read {
            Read::Action => {
                format(program, stage, line, context);
                unoffered(program, stage, merged, context);
            }
            Read::Text { name, before, .. } => {
                instruction(program, name, line, context);
                prefix(program, stage, before, line, context);
            }
        }
    }
    points(program, merged, context);
}

// ---- texts ---------------------------------------------------------------------------------------

/// Returns the texts that a stage says.
fn texts<'p>(program: &'p Program, stage: &'p Stage) -> impl Iterator<Item = &'p Template> {
    let names = stage.system.iter().chain(&stage.say);
    names.filter_map(|name| program.template(name))
}

/// Returns what a stage says, and how the answers of its examples are written.
fn written<'p>(program: &'p Program, stage: &'p Stage) -> impl Iterator<Item = &'p str> {
    let examples = { stage.examples.iter() }.map(|example| example.reply.text.as_str());
    { texts(program, stage) }
        .map(|text| text.text.as_str())
        .chain(examples)
}

/// Returns the values that the texts of all stages show.
fn shown(program: &Program) -> impl Iterator<Item = &Placeholder> {
    let stages = program.stages.iter();
    let texts = stages.flat_map(|stage| texts(program, stage));
    texts.flat_map(|text| text.variables.iter().map(|variable| &variable.value))
}

// ---- what is read --------------------------------------------------------------------------------

/// Warns if no prompt says in which format the action is to be answered.
fn format(program: &Program, stage: &Stage, line: ast::Read<'_>, context: &mut Context<'_>) {
    let demos = program.demos.as_ref();
    if demos.is_some_and(|demos| demos.stage == stage.name) || has_format(program, stage) {
        return;
    }
    let name = &stage.name;
    let message = format!("no text of the stage `{name}` says in which format to answer");
    let help = "write `{{ actions.format }}` in one of them";
    context.warn(Code::FormatNeverSaid, line.span(), message, help);
}

/// Returns whether a stage's texts or examples say in which format the action is to be answered.
fn has_format(program: &Program, stage: &Stage) -> bool {
    let mut values = texts(program, stage).flat_map(|text| &text.variables);
    // The author may write the lines of the format by hand.
    values.any(|variable| variable.value == Placeholder::Format)
        || program.actions.iter().all(|field| {
            let field = space::spoken(field);
            written(program, stage).any(|text| states(text, &field))
        })
}

/// Returns whether a text has a line for a field, such as `Pick Point = (x, y)` or `"pick": [x, y]`.
fn states(text: &str, field: &str) -> bool {
    let text = text.to_lowercase();
    text.match_indices(&field.to_lowercase()).any(|(at, name)| {
        let rest = text[at + name.len()..].trim_start_matches([' ', '_', '*', '"', '`']);
        let rest = rest.strip_prefix("point").unwrap_or(rest);
        rest.trim_start_matches([' ', '*', '"', '`'])
            .starts_with(['=', ':'])
    })
}

/// Warns if a text that a stage reads is in no later text.
fn instruction(program: &Program, name: &str, line: ast::Read<'_>, context: &mut Context<'_>) {
    let templates = program.templates.iter();
    let mut values = templates.flat_map(|template| &template.variables);
    let is_used = values.any(
        |variable| matches!(&variable.value, Placeholder::Text { name: used } if used == name),
    );
    if !is_used {
        let message = format!("`{name}` is read here, and no text uses it");
        let help = format!("write `{{{{ {name} }}}}` in a text of a later stage");
        context.warn(Code::TextNeverUsed, line.name().span(), message, help);
    }
}

/// Warns if no text and no example has the words that must come before a text that is read.
fn prefix(
    program: &Program,
    stage: &Stage,
    before: &str,
    line: ast::Read<'_>,
    context: &mut Context<'_>,
) {
    let Some(pattern) = line.pattern() else {
        return;
    };
    // A prefix of signs alone, such as `>>`, is in no sentence.
    if !before.contains(char::is_alphanumeric)
        || written(program, stage).any(|text| plain(text).contains(&plain(before)))
    {
        return;
    }
    let name = &stage.name;
    let message = format!("no text of the stage `{name}` asks for an answer with `{before}`");
    let help = format!("write, for example, `Answer in one line: {before} …`");
    context.warn(Code::PrefixNeverNamed, pattern.span(), message, help);
}

/// Returns a text in lower case, with one blank between its words and without quotes and emphasis.
fn plain(text: &str) -> String {
    let text = text.replace(['`', '"', '\'', '*', '_'], "").to_lowercase();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

// ---- points --------------------------------------------------------------------------------------

/// Warns of keypoints that the texts of a stage show as if they could be answered, and that no field offers.
///
/// A point that a check reads is shown because of that check. Where any pixel is offered, or a place follows from a
/// direction, points are shown to compare with.
fn unoffered(program: &Program, stage: &Stage, merged: &Merged<'_>, context: &mut Context<'_>) {
    let points = program.actions.iter().filter(|field| field.is_point());
    let keypoints_of = |field: &ActionField| match &field.choices {
        Choices::Points { keypoints } => Some(keypoints.clone()),
        _ => None,
    };
    let Some(offered) = points.clone().map(keypoints_of).collect::<Option<Vec<_>>>() else {
        return;
    };
    let fields = merged.actions().into_iter().flat_map(|part| part.fields());
    let last = fields.filter(|it| {
        program
            .field(it.name().text())
            .is_some_and(ActionField::is_point)
    });
    let (Some(line), true) = (last.last(), points.count() > 1) else {
        return;
    };
    let mut known: BTreeSet<String> = offered.into_iter().flatten().collect();
    for check in &program.verify.checks {
        known.extend(check.holds.uses().keypoints);
    }
    for variable in texts(program, stage).flat_map(|text| &text.variables) {
        let shown = match &variable.value {
            Placeholder::Points { keypoint } => keypoint,
            Placeholder::Point {
                point: Point::Keypoint { name },
            } => name,
            _ => continue,
        };
        if known.insert(shown.clone()) {
            let (stage, field) = (&stage.name, line.name().text());
            let message = format!("the stage `{stage}` shows `{shown}`, and no field offers it");
            let help = format!(
                "add `{shown}` to the choices of `{field}`, or say the stage's texts without it"
            );
            context.warn(Code::PointsNeverOffered, line.span(), message, help);
        }
    }
}

/// Warns of keypoints that a field offers and that no text and no picture shows.
fn points(program: &Program, merged: &Merged<'_>, context: &mut Context<'_>) {
    let mut known = BTreeSet::new();
    for value in shown(program) {
        known.extend(value.uses().keypoints);
    }
    let drawn = Picture::Scene {
        layers: Layers::Drawn,
    };
    let mut stages = program.stages.iter();
    if stages.any(|stage| stage.show.contains(&drawn)) {
        for layer in &program.layers {
            known.extend(layer.mark.uses().keypoints);
        }
    }
    for field in merged.actions().into_iter().flat_map(|part| part.fields()) {
        for choice in field.one_of() {
            let ast::Expr::Name(choice) = choice else {
                continue;
            };
            let (field, name) = (field.name().text(), choice.text());
            // Once is enough for a keypoint that several fields offer.
            let is_first = known.insert(name.to_owned());
            if program.keypoint(name).is_some() && is_first {
                let message = format!("`{field}` offers `{name}`, and no prompt shows it");
                let help = format!("write `{{{{ {name} }}}}` in a text of a stage");
                context.warn(Code::PointsNeverShown, choice.span(), message, help);
            }
        }
    }
}
