//! `stage plan { model text … say … read action }`: the questions to models, and the texts in them.

use super::Context;
use super::model::{self, Checked};
use super::templates::{self, Place};
use super::{pictures, reads};
use crate::ast::{Component, Ident, Saying, Sayings, Stage, Text};
use crate::diag::{Code, Diagnostic};
use crate::merge::{Merged, once};
use crate::program::{self, ActionField, ModelRole, Template};
use crate::source::Span;
use std::collections::{BTreeMap, BTreeSet};

/// The most bytes that all texts of one stage may have.
const MAX_STAGE_BYTES: usize = 64 << 10;

/// The most stages: each is a model call per step.
const MAX_STAGES: usize = 16;

/// The stages, and every text that they say.
pub(crate) struct Prompts {
    pub stages: Vec<program::Stage>,
    pub templates: Vec<Template>,
}

/// Builds the stages; what is wrong is left out.
pub(crate) fn check(
    merged: &Merged<'_>,
    actions: &[ActionField],
    context: &mut Context<'_>,
) -> Prompts {
    let mut builder = Builder {
        merged,
        actions,
        templates: Vec::new(),
        built: BTreeMap::new(),
        said: BTreeSet::new(),
    };
    if let Some(beyond) = merged.stages.get(MAX_STAGES) {
        let message = format!(
            "there are {} stages, at most {MAX_STAGES} are accepted",
            merged.stages.len()
        );
        context.push(Diagnostic::new(Code::OutOfRange, beyond.name.span, message));
        return Prompts {
            stages: Vec::new(),
            templates: Vec::new(),
        };
    }
    let stages = merged
        .stages
        .iter()
        .enumerate()
        .filter_map(|(number, stage)| builder.stage(number, stage, context))
        .collect();
    who_reads_the_action(merged, context);
    read_names(merged, context);
    builder.unsaid(context);
    Prompts {
        stages,
        templates: builder.in_order(),
    }
}

/// Reports where the action is not read by the last stage alone.
fn who_reads_the_action(merged: &Merged<'_>, context: &mut Context<'_>) {
    let Some((last, earlier)) = merged.stages.split_last() else {
        return;
    };
    let action = |stage: &Stage| {
        stage
            .read
            .iter()
            .find(|read| read.name.text == "action")
            .map(|read| read.span)
    };
    for stage in earlier {
        if let Some(span) = action(stage) {
            let message = format!(
                "`{}` reads the action, but it is not the last stage",
                stage.name.text
            );
            context.push(
                Diagnostic::new(Code::ActionReadElsewhere, span, message)
                    .also(last.name.span, "this is the last stage"),
            );
        }
    }
    if action(last).is_none() && !last.read.is_empty() {
        let message = format!(
            "the last stage, `{}`, does not read the action",
            last.name.text
        );
        context.push(
            Diagnostic::new(Code::ActionReadElsewhere, last.read[0].span, message)
                .help("write `read action`"),
        );
    }
}

/// Reports texts that are read under a name that something else has.
fn read_names(merged: &Merged<'_>, context: &mut Context<'_>) {
    let keypoints = merged.keypoints.iter().map(|keypoint| &keypoint.name);
    let fields = merged
        .actions
        .iter()
        .flat_map(|part| &part.fields)
        .map(|field| &field.name);
    let reads = merged
        .stages
        .iter()
        .flat_map(|stage| &stage.read)
        .map(|read| &read.name)
        .filter(|name| name.text != "action");
    crate::merge::unique(keypoints.chain(fields).chain(reads), "name", context.report);
}

struct Builder<'m, 'a> {
    merged: &'m Merged<'a>,
    actions: &'m [ActionField],
    templates: Vec<Template>,
    /// Components that some stage says.
    said: BTreeSet<&'m str>,
    /// For each text its length, or nothing where it is wrong, and the last stage for which it was checked.
    built: BTreeMap<String, (usize, usize)>,
}

impl<'m, 'a> Builder<'m, 'a> {
    fn stage(
        &mut self,
        number: usize,
        stage: &'m Stage,
        context: &mut Context<'_>,
    ) -> Option<program::Stage> {
        let model = once(&stage.model, "`model`", |part| part.span, context.report);
        let show = once(&stage.show, "`show`", |part| part.span, context.report);
        let say = once(&stage.say, "`say`", |part| part.span, context.report);
        let system = once(&stage.system, "`system`", |part| part.span, context.report);
        let read = once(&stage.read, "`read`", |part| part.span, context.report);
        for (part, is_there) in [
            ("model", model.is_some()),
            ("say", say.is_some()),
            ("read", read.is_some()),
        ] {
            if !is_there && !stage.has_faults {
                let message = format!("the stage `{}` has no `{part}`", stage.name.text);
                context.push(
                    Diagnostic::new(Code::StageIncomplete, stage.name.span, message)
                        .help(part_help(part)),
                );
            }
        }
        let settings = model.and_then(|part| model::check(part, context));
        let pictures = show.map_or(Vec::new(), |part| pictures::check(part, context));
        if let (
            Some(part),
            Some(Checked {
                role: ModelRole::Text,
                ..
            }),
        ) = (show, &settings)
        {
            let message = format!("the text model of `{}` is shown pictures", stage.name.text);
            let diagnostic = Diagnostic::new(Code::PicturesForTextModel, part.span, message)
                .help("write `model vision`, or remove `show`");
            context.push(match model {
                Some(model) => diagnostic.also(model.span, "asks a text model"),
                None => diagnostic,
            });
        }
        let system = system.map_or(Vec::new(), |part| {
            self.sayings(number, stage, "system", part, context)
        });
        let asked = say.map(|part| self.sayings(number, stage, "say", part, context));
        self.limit(stage, system.iter().chain(asked.iter().flatten()), context);
        let read = read.and_then(|read| reads::check(read, context));
        let Checked {
            role,
            temperature,
            max_tokens,
        } = settings?;
        Some(program::Stage {
            name: stage.name.text.clone(),
            model: role,
            temperature,
            top_p: None,
            max_tokens,
            system,
            examples: Vec::new(),
            say: asked?,
            show: pictures,
            read: read?,
        })
    }

    /// Returns the templates' names; builds each template that is not built yet.
    fn sayings(
        &mut self,
        number: usize,
        stage: &'m Stage,
        part: &str,
        sayings: &'m Sayings,
        context: &mut Context<'_>,
    ) -> Vec<String> {
        let mut names = Vec::new();
        let mut n_texts = 0;
        for saying in &sayings.list {
            match saying {
                Saying::Component(name) => names.extend(self.component(number, name, context)),
                Saying::Text(text) => {
                    n_texts += 1;
                    let suffix = if n_texts == 1 {
                        String::new()
                    } else {
                        format!(".{n_texts}")
                    };
                    let name = format!("{}.{part}{suffix}", stage.name.text);
                    self.build(&name, text, number, context);
                    names.push(name);
                }
            }
        }
        if names.is_empty() && part == "say" && self.all_are_removed(sayings) {
            let message = format!("nothing is left for `{}` to say", stage.name.text);
            context.push(
                Diagnostic::new(Code::StageIncomplete, self.merged.task.name.span, message)
                    .also(sayings.span, "all of this is left out"),
            );
        }
        names
    }

    fn all_are_removed(&self, sayings: &Sayings) -> bool {
        sayings.list.iter().all(|saying| matches!(saying, Saying::Component(name) if self.merged.removed.contains(name.text.as_str())))
    }

    fn component(
        &mut self,
        number: usize,
        name: &'m Ident,
        context: &mut Context<'_>,
    ) -> Option<String> {
        let merged = self.merged;
        let Some(component) = merged.component(&name.text) else {
            if !merged.removed.contains(name.text.as_str()) {
                context.unknown(
                    "component",
                    name,
                    merged
                        .components
                        .iter()
                        .map(|component| component.name.text.as_str()),
                );
            }
            return None;
        };
        self.said.insert(&name.text);
        self.build(&name.text, &component.text, number, context);
        Some(name.text.clone())
    }

    fn build(&mut self, name: &str, text: &Text, stage: usize, context: &mut Context<'_>) {
        // A component that is said again in a stage needs no second look.
        if self.built.get(name).is_some_and(|(_, last)| *last == stage) {
            return;
        }
        let template = templates::template(name, text, Place::Stage(stage), self.actions, context);
        let is_new = self.built.get(name).is_none_or(|(length, _)| *length == 0);
        let length = template.as_ref().map_or(0, |template| template.text.len());
        let known = self.built.entry(name.to_owned()).or_default();
        *known = (known.0.max(length), stage);
        if is_new {
            self.templates.extend(template);
        }
    }

    fn limit<'n>(
        &self,
        stage: &Stage,
        names: impl Iterator<Item = &'n String>,
        context: &mut Context<'_>,
    ) {
        let length = |name: &String| self.built.get(name).map_or(0, |(length, _)| *length);
        let bytes: usize = names.map(length).sum();
        if bytes > MAX_STAGE_BYTES {
            let message = format!(
                "the texts of `{}` have {bytes} bytes, at most {MAX_STAGE_BYTES} are accepted",
                stage.name.text
            );
            context.push(Diagnostic::new(Code::TextTooLong, stage.name.span, message));
        }
    }

    /// Warns of components of this task itself that no stage says, and checks their names all the same.
    fn unsaid(&mut self, context: &mut Context<'_>) {
        let own: BTreeSet<Span> = self
            .merged
            .task
            .components
            .iter()
            .map(|own| own.name.span)
            .collect();
        for component in &self.merged.components {
            let Component { name, text, .. } = component;
            if self.said.contains(name.text.as_str()) {
                continue;
            }
            templates::template(&name.text, text, Place::Nowhere, self.actions, context);
            let is_own = own.contains(&name.span);
            if is_own && !self.merged.stages.is_empty() && !self.merged.is_broken {
                let message = format!("the component `{}` is said nowhere", name.text);
                context.push(
                    Diagnostic::new(Code::SaidNowhere, name.span, message)
                        .help("name it in a stage's `say` or `system`, or remove it"),
                );
            }
        }
    }

    /// Returns the components as they are declared, then the texts of the stages.
    fn in_order(self) -> Vec<Template> {
        let declared: BTreeMap<&str, usize> = self
            .merged
            .components
            .iter()
            .enumerate()
            .map(|(place, component)| (component.name.text.as_str(), place))
            .collect();
        let order = |template: &Template| {
            let place = declared.get(template.name.as_str()).copied();
            place.unwrap_or(declared.len())
        };
        let mut templates = self.templates;
        templates.sort_by_key(order);
        templates
    }
}

fn part_help(part: &str) -> &'static str {
    match part {
        "model" => "write `model vision` or `model text`",
        "say" => "write `say` and components or a text",
        _ => "write `read action`, or `read NAME from \"…{NAME}\"`",
    }
}
