//! `stage plan { model text … say … read action }`: the questions to models, and the texts in them.

use super::Context;
use super::model::{self, Checked};
use super::templates::{self, Place, Scope};
use super::{examples, pictures, reads, said};
use crate::ast::{Expr, Ident, Saying, Sayings, Stage, Text};
use crate::diag::{Code, Diagnostic};
use crate::merge::{Merged, once};
use crate::source::Span;
use fab_program::{self as program, Condition, Layers, ModelRole, Picture, Template};
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

/// What a stage speaks of, and whether it shows it.
pub(super) struct Spoken {
    pub shows_layers: bool,
    pub layers: Vec<(String, Span)>,
}

/// Builds the stages; what is wrong is left out.
pub(crate) fn check(merged: &Merged<'_>, context: &mut Context<'_>) -> Prompts {
    let mut builder = Builder {
        merged,
        templates: Vec::new(),
        places: BTreeMap::new(),
        said: BTreeSet::new(),
        spoken: Vec::new(),
    };
    if let Some(beyond) = merged.stages.iter().nth(MAX_STAGES) {
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
    builder.layers(context);
    Prompts {
        stages,
        templates: builder.in_order(),
    }
}

/// Reports where the action is not read by the last stage alone.
fn who_reads_the_action(merged: &Merged<'_>, context: &mut Context<'_>) {
    let mut earlier = merged.stages.iter();
    let Some(last) = earlier.next_back() else {
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

pub(super) struct Builder<'m, 'a> {
    pub(super) merged: &'m Merged<'a>,
    templates: Vec<Template>,
    /// Where each template is, by its name.
    places: BTreeMap<String, usize>,
    /// Components that some stage says.
    pub(super) said: BTreeSet<&'m str>,
    /// For each stage that is right so far.
    pub(super) spoken: Vec<Spoken>,
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
        let shows_layers = pictures.iter().any(|picture| {
            matches!(
                picture,
                Picture::Scene {
                    layers: Layers::Drawn
                }
            )
        });
        if let (true, None, Some(part)) = (shows_layers, self.merged.annotate, show) {
            let message = "no annotations are declared";
            context.push(
                Diagnostic::new(Code::NothingToDraw, part.span, message)
                    .help("add `annotate { … }`, or write `show scene`"),
            );
        }
        context.named_layers.clear();
        let system = system.map_or(Vec::new(), |part| {
            self.sayings(number, stage, "system", part, context)
        });
        let asked = say.map(|part| self.sayings(number, stage, "say", part, context));
        self.limit(stage, system.iter().chain(asked.iter().flatten()), context);
        self.spoken.push(Spoken {
            shows_layers,
            layers: std::mem::take(&mut context.named_layers),
        });
        let read = read.and_then(|read| reads::check(read, context));
        let role = settings.as_ref().map(|settings| settings.role);
        let examples = examples::check(stage, role, read.as_ref(), context);
        let Checked {
            role,
            temperature,
            top_p,
            max_tokens,
        } = settings?;
        Some(program::Stage {
            name: stage.name.text.clone(),
            model: role,
            temperature,
            top_p,
            max_tokens,
            system,
            examples,
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
                    self.build(&name, text, None, number, context);
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
        let Some(component) = merged.components.get(&name.text) else {
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
        let guard = component.when.as_ref();
        self.build(&name.text, &component.text, guard, number, context);
        Some(name.text.clone())
    }

    /// Builds a template, once; said in a second stage it is checked again, as other names may be known there.
    fn build(
        &mut self,
        name: &str,
        text: &Text,
        guard: Option<&Expr>,
        stage: usize,
        context: &mut Context<'_>,
    ) {
        let when = match guard.map(|guard| said::guard(guard, context)) {
            None => None,
            Some(Some(when)) => Some(when),
            // The condition is wrong and reported; the text is checked as if it held.
            Some(None) => Some(Condition::Last),
        };
        let guarded = format!("component {name}");
        let scope = Scope {
            place: Place::Stage(stage),
            has_last: when.as_ref().is_some_and(Condition::implies_last),
            guarded: &guarded,
        };
        let template = templates::template(name, text, when, scope, context);
        if let Some(template) = template
            && !self.places.contains_key(name)
        {
            self.places.insert(name.to_owned(), self.templates.len());
            self.templates.push(template);
        }
    }

    fn limit<'n>(
        &self,
        stage: &Stage,
        names: impl Iterator<Item = &'n String>,
        context: &mut Context<'_>,
    ) {
        let length = |name: &String| {
            self.places
                .get(name)
                .map_or(0, |place| self.templates[*place].text.len())
        };
        let bytes: usize = names.map(length).sum();
        if bytes > MAX_STAGE_BYTES {
            let message = format!(
                "the texts of `{}` have {bytes} bytes, at most {MAX_STAGE_BYTES} are accepted",
                stage.name.text
            );
            context.push(Diagnostic::new(Code::TextTooLong, stage.name.span, message));
        }
    }

    /// Returns the components as they are declared, then the texts of the stages.
    fn in_order(self) -> Vec<Template> {
        let order = |template: &Template| {
            let declared = self.merged.components.place(&template.name);
            declared.unwrap_or(usize::MAX)
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
