//! `stage plan { model text … say … read action }`: the questions to models, and their texts.
//!
//! In: the stages and components of a task. Out: a stage for each declaration, and a template for each text that a
//! stage says. [`super::examples`] reads examples, [`super::placeholders`] the values in texts.

use super::conditions;
use super::context::{Context, Declared};
use super::examples;
use super::expressions::{Scope, argument};
use super::missing_action::{needs_action, needs_last};
use super::placeholders::{TextPlace, TextScope, template};
use crate::diag::{Code, Diagnostic, Reported, among, nearest};
use crate::lang::stage::{DRAWINGS, MODELS, PICTURE_ROWS, PICTURES, SETTINGS};
use crate::merge::{Merged, Said, once, unique};
use fab_grammar::Span;
use fab_grammar::ast::{self, ComponentOrText, Expr, Name, Sayings, Text};
use fab_program::Depends;
use fab_program::vocabulary::{ArgValue, Kind};
use fab_program::{
    self as program, Condition, Layers, ModelRole, Picture, Read, Reasoning, ReasoningLevel,
    Template,
};
use std::collections::{BTreeMap, BTreeSet};

/// The most bytes of all texts of one stage.
const MAX_STAGE_BYTES: usize = 64 << 10;

/// The most stages: each is a model call per step.
const MAX_STAGES: usize = 16;

/// The most pictures in one question.
const MAX_PICTURES: usize = 16;

/// The stages, and every text that they say.
pub(crate) struct Prompts {
    /// In the order of their declarations.
    pub stages: Vec<Result<program::Stage, Reported>>,
    pub templates: Vec<Result<Template, Reported>>,
    /// The proof of an error that concerns several stages, if there is one.
    pub joined: Result<(), Reported>,
}

/// Builds the stages of a task and their texts.
pub(crate) fn check<'a>(merged: &Merged<'a>, context: &mut Context<'a, '_>) -> Prompts {
    let n_stages = merged.stages.len();
    let beyond = merged
        .stages
        .iter()
        .nth(MAX_STAGES)
        .map(|stage| stage.name().span());
    let within = context.bounded(beyond, || {
        format!("there are {n_stages} stages, at most {MAX_STAGES} are accepted")
    });
    if let Err(reported) = within {
        return Prompts {
            stages: vec![Err(reported); n_stages],
            templates: Vec::new(),
            joined: Ok(()),
        };
    }
    let mut builder = Builder {
        merged,
        templates: Vec::new(),
        places: BTreeMap::new(),
        last_use: BTreeMap::new(),
        layers: Vec::new(),
        has_wrong_stage: false,
    };
    let stages = merged.stages.iter().enumerate();
    let stages: Vec<Result<program::Stage, Reported>> = stages
        .map(|(number, stage)| builder.stage(number, stage, context))
        .collect();
    let readers = action_readers(merged, context);
    builder.has_wrong_stage = stages.iter().any(Result::is_err);
    builder.unused(context);
    let layers = builder.layers(context);
    Prompts {
        stages,
        templates: builder.in_order(),
        joined: readers.and(layers),
    }
}

/// Reports an error unless the last stage, and only that one, reads the action.
fn action_readers(merged: &Merged<'_>, context: &mut Context<'_, '_>) -> Result<(), Reported> {
    let mut earlier = merged.stages.iter();
    let Some(last) = earlier.next_back() else {
        return Ok(());
    };
    let mut all = Ok(());
    let action = |stage: ast::Stage<'_>| {
        let read = stage.read().find(|read| read.name().text() == "action");
        read.map(|read| read.span())
    };
    let report = |span, message| Diagnostic::new(Code::ActionReadElsewhere, span, message);
    let acting = earlier.filter(|stage| action(*stage).is_some());
    let acting: Vec<ast::Stage<'_>> = acting.collect();
    if let ([acting], None) = (acting.as_slice(), action(last)) {
        let (name, asked) = (last.name().text(), acting.name().text());
        let message = format!("the stage `{name}` comes after `{asked}`, which reads the action");
        let own = merged.task.body().span();
        let is_own = acting.span().file == own.file && acting.span().start >= own.start;
        let help = match is_own && !merged.replaced_stages.contains_key(asked) {
            true => format!("move it above `stage {asked}`"),
            false => format!(
                "a stage that is added comes last; to say more, write `say NAME in {asked} after NAME`, to ask more, state all stages in a task without `extends`"
            ),
        };
        let diagnostic = report(last.name().span(), message)
            .also(acting.name().span(), "reads the action")
            .help(help);
        return Err(context.error(diagnostic));
    }
    for stage in acting {
        let Some(span) = action(stage) else {
            continue;
        };
        let message = format!(
            "`{}` reads the action, but it is not the last stage",
            stage.name().text()
        );
        let diagnostic = report(span, message)
            .also(last.name().span(), "this is the last stage")
            .help("write `read NAME from \"…{NAME}\"`");
        all = Err(context.error(diagnostic));
    }
    if let (None, Some(read)) = (action(last), last.read().next()) {
        let name = last.name().text();
        let message = format!("the last stage, `{name}`, does not read the action");
        let diagnostic = report(read.span(), message).help("write `read action`");
        all = Err(context.error(diagnostic));
    }
    all
}

/// Builds the condition on which a component is used.
pub(crate) fn guard<'a>(
    expr: Expr<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Condition, Reported> {
    let when = conditions::check(expr, context)?;
    let uses = when.uses();
    if uses.action {
        return Err(needs_action(expr.span(), context));
    }
    if uses.last && !when.implies_last() {
        return Err(needs_last(expr.span(), "… when last and …", context));
    }
    Ok(when)
}

/// Builds the condition of a component, if it has one.
fn component_guard<'a>(
    component: ast::Component<'a>,
    context: &mut Context<'a, '_>,
) -> Declared<Condition> {
    component
        .when()
        .map(|expr| guard(expr, context))
        .transpose()
}

/// The layers that a stage's texts name, and whether its pictures show any.
struct StageLayers {
    named: Vec<(String, Span)>,
    shows_layers: Result<bool, Reported>,
}

struct Builder<'m, 'a> {
    merged: &'m Merged<'a>,
    templates: Vec<(String, Result<Template, Reported>)>,
    /// The index of each template by its name.
    places: BTreeMap<String, usize>,
    /// The last stage that says each component.
    last_use: BTreeMap<&'a str, usize>,
    /// For each stage.
    layers: Vec<StageLayers>,
    /// Whether a stage has an error, so that it may say less than its author meant.
    has_wrong_stage: bool,
}

impl<'a> Builder<'_, 'a> {
    fn stage(
        &mut self,
        number: usize,
        stage: ast::Stage<'a>,
        context: &mut Context<'a, '_>,
    ) -> Result<program::Stage, Reported> {
        let model = once(stage.model(), "model", ast::Model::span, context.report);
        let show = once(stage.show(), "show", ast::Show::span, context.report);
        let say = once(stage.say(), "say", Sayings::span, context.report);
        let system = once(stage.system(), "system", Sayings::span, context.report);
        let read = once(stage.read(), "read", ast::Read::span, context.report);
        let lines = [model.alone, show.alone, say.alone, system.alone, read.alone];
        let lines_needed = [
            (
                "model",
                model.first.is_none(),
                "write `model vision` or `model text`",
            ),
            (
                "say",
                say.first.is_none(),
                "write `say` and components or a text",
            ),
            (
                "read",
                read.first.is_none(),
                "write `read action`, or `read NAME from \"…{NAME}\"`",
            ),
        ];
        let lacks = lines_needed.iter().filter(|(_, is_missing, _)| *is_missing);
        let lacks: Vec<(&str, &str)> = lacks.map(|(word, _, how)| (*word, *how)).collect();
        // One error for all of them; it is made when the first is looked for.
        let mut reported = None;
        let mut report = || *reported.get_or_insert_with(|| self.lacking(&lacks, stage, context));
        let model = model.first.ok_or_else(&mut report);
        let say = say.first.ok_or_else(&mut report);
        let read = read.first.ok_or_else(&mut report);

        let (role, settings) = match model {
            Ok(line) => self::model(line, context),
            Err(reported) => (Err(reported), Err(reported)),
        };
        let pictures = show
            .first
            .map_or(Vec::new(), |line| self::pictures(line, context));
        let showable = show.first.map_or(Ok(()), |line| {
            let role = role.and_then(|role| Ok((role, model?)));
            self.showable(stage, line, role, &pictures, context)
        });

        context.named_layers.clear();
        let mut placed = BTreeSet::new();
        let mut with_added = |line: Sayings<'a>| match self.merged.said.get(stage.name().text()) {
            Some(said) => (line, said.with_added(line.list(), &mut placed)),
            None => (line, line.list().collect()),
        };
        let system = system.first.map(&mut with_added);
        let say = say.map(with_added);
        let system = system.map_or(Ok(Vec::new()), |(line, list)| {
            self.sayings(number, stage, "system", line, list, context)
        });
        let say =
            say.and_then(|(line, list)| self.sayings(number, stage, "say", line, list, context));
        let names = system.iter().chain(say.iter()).flatten();
        let n_bytes: usize = names.map(|name| self.n_bytes(name)).sum();
        let beyond = (n_bytes > MAX_STAGE_BYTES).then(|| {
            let name = stage.name();
            let message = format!(
                "the texts of `{}` have {n_bytes} bytes, at most {MAX_STAGE_BYTES} are accepted",
                name.text()
            );
            context.fault(Code::TextTooLong, name.span(), message)
        });
        let named = std::mem::take(&mut context.named_layers);
        self.layers.push(StageLayers {
            named,
            shows_layers: shows_layers(&pictures),
        });

        let read = read.and_then(|line| self::read(line, context));
        let examples = examples::check(stage, role, read.as_ref().map_err(|it| *it), context);
        showable?;
        lines.into_iter().collect::<Result<(), _>>()?;
        beyond.map_or(Ok(()), Err)?;
        let settings = settings?;
        let number = |name: &str| match settings.get(name)? {
            ArgValue::Number(number) => Some(*number),
            _ => None,
        };
        Ok(program::Stage {
            name: stage.name().text().to_owned(),
            model: role?,
            temperature: number("temperature"),
            top_p: number("top_p"),
            max_tokens: number("tokens").map(|tokens| tokens as u32),
            reasoning: match settings.get("reasoning") {
                Some(ArgValue::Number(tokens)) => Some(Reasoning::Tokens(*tokens as u32)),
                Some(ArgValue::Word(word)) => ReasoningLevel::from_word(word).map(Reasoning::Level),
                _ => None,
            },
            candidates: number("candidates").map(|count| count as u32),
            system: system?,
            examples: examples.into_iter().collect::<Result<_, _>>()?,
            say: say?,
            show: pictures.into_iter().collect::<Result<_, _>>()?,
            read: read?,
        })
    }

    /// Reports the lines that a stage must have and does not, all in one error.
    ///
    /// - `lacks`: each line's word, and how to write it.
    fn lacking(
        &self,
        lacks: &[(&str, &str)],
        stage: ast::Stage<'a>,
        context: &mut Context<'a, '_>,
    ) -> Reported {
        let name = stage.name();
        let words = among(lacks.iter().map(|(word, _)| *word));
        let message = format!("the stage `{}` has no {words}", name.text());
        let diagnostic = Diagnostic::new(Code::StageIncomplete, name.span(), message);
        let replaced = self.merged.replaced_stages.get(name.text());
        // Who states neither the model nor what is read means to add to the inherited stage.
        let adds = ["model", "read"]
            .iter()
            .all(|line| lacks.iter().any(|(word, _)| word == line));
        let diagnostic = match replaced.filter(|_| adds) {
            Some((_, said)) => {
                let own = stage.system().chain(stage.say()).flat_map(Sayings::list);
                let added = own.filter_map(|saying| match saying {
                    ComponentOrText::Component(part) => Some(part.text()),
                    ComponentOrText::Text(_) => None,
                });
                let added = { added }.find(|part| !said.says(part)).unwrap_or("NAME");
                let stage = name.text();
                let way = match said.names().next_back() {
                    Some(beside) => format!(
                        "to add to what it says, write `say {added} in {stage} after {beside}`, outside of any stage"
                    ),
                    None => "it says no component to add another to, so state all of its lines"
                        .to_owned(),
                };
                diagnostic.help(format!("this replaces the whole inherited stage; {way}"))
            }
            None => lacks.iter().fold(diagnostic, |it, (_, how)| it.help(*how)),
        };
        let reported = context.error(diagnostic);
        if let Some((before, _)) = replaced
            && stage.read().next().is_none()
        {
            for read in before.read() {
                context.names.lose(read.name().text(), reported);
            }
        }
        reported
    }

    /// Reports pictures for a model that takes none, and annotations if no layers are declared.
    fn showable(
        &self,
        stage: ast::Stage<'a>,
        show: ast::Show<'a>,
        model: Result<(ModelRole, ast::Model<'a>), Reported>,
        pictures: &[Result<Picture, Reported>],
        context: &mut Context<'a, '_>,
    ) -> Result<(), Reported> {
        let mut all = Ok(());
        if let Ok((ModelRole::Text, model)) = model {
            let message = format!(
                "the stage `{}` shows pictures to a text model",
                stage.name().text()
            );
            let diagnostic = Diagnostic::new(Code::PicturesForTextModel, show.span(), message);
            let diagnostic = diagnostic.help("write `model vision`, or remove `show`");
            all = Err(context.error(diagnostic.also(model.span(), "asks a text model")));
        }
        if let (Ok(true), None) = (shows_layers(pictures), self.merged.annotate) {
            let message = "no annotations are declared";
            let diagnostic = Diagnostic::new(Code::NothingToDraw, show.span(), message);
            let help = "add `annotate { … }`, or write `show scene`";
            all = Err(context.error(diagnostic.help(help)));
        }
        all
    }

    // ---- texts -----------------------------------------------------------------------------------

    /// Returns the names of the templates that a line says, and builds those that are not built yet.
    ///
    /// - `list`: the line's parts, with those that were added beside them.
    fn sayings(
        &mut self,
        number: usize,
        stage: ast::Stage<'a>,
        part: &str,
        line: Sayings<'a>,
        list: Vec<ComponentOrText<'a>>,
        context: &mut Context<'a, '_>,
    ) -> Result<Vec<String>, Reported> {
        let mut names = Vec::new();
        let mut n_texts = 0;
        let mut all = Ok(());
        for saying in list {
            match saying {
                ComponentOrText::Component(name) => match self.component(number, name, context) {
                    Ok(name) => names.extend(name),
                    Err(reported) => all = Err(reported),
                },
                ComponentOrText::Text(text) => {
                    n_texts += 1;
                    let suffix = if n_texts == 1 {
                        String::new()
                    } else {
                        format!(".{n_texts}")
                    };
                    let name = format!("{}.{part}{suffix}", stage.name().text());
                    self.build(&name, "component NAME", text, Ok(None), number, context);
                    names.push(name);
                }
            }
        }
        all?;
        if names.is_empty() && part == "say" {
            let message = format!(
                "the stage `{}` has no text left to say",
                stage.name().text()
            );
            let span = self.merged.task.name().span();
            let diagnostic = Diagnostic::new(Code::StageIncomplete, span, message);
            let diagnostic = diagnostic.also(line.span(), "all of these components are left out");
            return Err(context.error(diagnostic));
        }
        Ok(names)
    }

    /// Returns the name of a component's template; `None` for a removed component.
    fn component(
        &mut self,
        number: usize,
        name: Name<'a>,
        context: &mut Context<'a, '_>,
    ) -> Result<Option<String>, Reported> {
        let text = name.text();
        let Some(component) = self.merged.components.get(text) else {
            if self.merged.removed.contains(text) {
                return Ok(None);
            }
            let all = self
                .merged
                .components
                .iter()
                .map(|component| component.name().text());
            return Err(context.unknown("component", name, all));
        };
        // Each stage that says it checks it again, because later stages know more names.
        if self.last_use.insert(text, number) != Some(number) {
            let when = component_guard(component, context);
            let guarded = format!("component {text}");
            self.build(text, &guarded, component.text(), when, number, context);
        }
        Ok(Some(text.to_owned()))
    }

    /// Builds a template, or checks again one that another stage built.
    ///
    /// - `guarded`: the beginning of a component declaration that would say the text conditionally.
    fn build(
        &mut self,
        name: &str,
        guarded: &str,
        text: Text<'a>,
        when: Result<Option<Condition>, Reported>,
        stage: usize,
        context: &mut Context<'a, '_>,
    ) {
        let has_last = match &when {
            Ok(when) => when.as_ref().is_some_and(Condition::implies_last),
            // Check the text as if the condition were right.
            Err(_) => true,
        };
        let scope = TextScope {
            place: TextPlace::Stage(stage),
            has_last,
            guarded,
        };
        let template = match when {
            Ok(when) => template(name, text, when, scope, context),
            Err(reported) => template(name, text, None, scope, context).and(Err(reported)),
        };
        match self.places.get(name) {
            Some(place) if template.is_err() => self.templates[*place].1 = template,
            Some(_) => {}
            None => {
                self.places.insert(name.to_owned(), self.templates.len());
                self.templates.push((name.to_owned(), template));
            }
        }
    }

    /// Returns the length of a template without errors.
    fn n_bytes(&self, name: &str) -> usize {
        let template = self.places.get(name).map(|place| &self.templates[*place].1);
        template.map_or(0, |template| {
            template.as_ref().map_or(0, |it| it.text.len())
        })
    }

    /// Returns the components in the order of their declarations, then the texts of the stages.
    fn in_order(self) -> Vec<Result<Template, Reported>> {
        let components = &self.merged.components;
        let mut templates = self.templates;
        templates.sort_by_key(|(name, _)| components.place(name).unwrap_or(usize::MAX));
        templates
            .into_iter()
            .map(|(_, template)| template)
            .collect()
    }

    // ---- all stages together ---------------------------------------------------------------------

    /// Checks the components that no stage says, and warns of those that the task itself declares.
    fn unused(&mut self, context: &mut Context<'a, '_>) {
        let merged = self.merged;
        let own = merged
            .own_body()
            .into_iter()
            .flat_map(ast::Body::components);
        let own: BTreeSet<Span> = own.map(|component| component.name().span()).collect();
        let is_task = merged.variant.is_none();
        let variants = merged.task.variants().filter(|_| is_task);
        let variants: Vec<ast::Body<'_>> = variants.map(|variant| variant.body()).collect();
        // If one of these cannot be added, that was reported.
        let added = merged
            .own_body()
            .into_iter()
            .chain(variants.iter().copied());
        let added = added.flat_map(ast::Body::added_sayings);
        let mut said: BTreeSet<&str> = added
            .flat_map(|line| line.parts())
            .map(|name| name.text())
            .collect();
        // What only a variant says is used, too.
        for stage in variants.iter().flat_map(|variant| variant.stages()) {
            said.extend(Said::of(stage).names());
        }
        let can_say = !merged.stages.is_empty() && merged.missing_base.is_none();
        let can_say = can_say && !self.has_wrong_stage;
        for component in merged.components.iter() {
            let name = component.name();
            if self.last_use.contains_key(name.text()) {
                continue;
            }
            let when = component_guard(component, context);
            let scope = TextScope {
                place: TextPlace::Nowhere,
                has_last: true,
                guarded: "",
            };
            let template = template(name.text(), component.text(), None, scope, context);
            if let Err(reported) = when.and(template) {
                self.templates.push((name.text().to_owned(), Err(reported)));
            }
            if can_say && own.contains(&name.span()) && !said.contains(name.text()) {
                let message = format!("the component `{}` is never used", name.text());
                let diagnostic = Diagnostic::new(Code::SaidNowhere, name.span(), message);
                // Perhaps the author meant to replace an inherited component.
                let inherited = merged.components.iter().map(|component| component.name());
                let inherited = inherited.filter(|name| !own.contains(&name.span()));
                let meant = nearest(name.text(), inherited.map(|name| name.text()));
                let help = match (meant, addable(merged)) {
                    (Some(meant), _) => format!("did you mean `override component {meant}`?"),
                    (None, Some((stage, beside))) => format!(
                        "add it to what a stage says, such as `say {} in {stage} after {beside}`, or remove it",
                        name.text()
                    ),
                    (None, None) => {
                        "name it in a stage's `say` or `system`, or remove it".to_owned()
                    }
                };
                context.remark(diagnostic.help(help));
            }
        }
    }

    /// Reports layers that are drawn but not named, or named but not drawn.
    fn layers(&self, context: &mut Context<'a, '_>) -> Result<(), Reported> {
        let mut all = Ok(());
        for stage in &self.layers {
            let mut named = stage.named.iter();
            if stage.shows_layers != Ok(false) {
                continue;
            }
            let Some((layer, span)) = named.next() else {
                continue;
            };
            let message = format!("no picture of this stage shows `{layer}`");
            let diagnostic = Diagnostic::new(Code::LayerNotShown, *span, message)
                .help("write `show scene with annotations` in the stage");
            let others = named.filter(|(other, _)| other != layer);
            all = Err(context
                .error(others.fold(diagnostic, |it, (_, span)| it.also(*span, "nor this one"))));
        }
        let merged = self.merged;
        if merged.stages.is_empty() || self.has_wrong_stage {
            return all;
        }
        // A variant may remove the text that names a layer of its task; that is not a mistake.
        let own = merged.own_body().map(|body| body.span());
        let is_own = |span| merged.variant.is_none() || own.is_some_and(|own| own.contains(span));
        let named = self.layers.iter().flat_map(|stage| &stage.named);
        let named: BTreeSet<&str> = named.map(|(layer, _)| layer.as_str()).collect();
        let drawn = merged.annotate.into_iter().flat_map(|part| part.list());
        let mut unnamed = drawn.map(|layer| layer.name()).filter(|name| {
            let is_right = matches!(context.layers.get(name.text()), Some(Ok(_)));
            is_right && !named.contains(name.text()) && is_own(name.span())
        });
        let Some(first) = unnamed.next() else {
            return all;
        };
        let name = first.text();
        let message = format!("the layer `{name}` is drawn, but no prompt says what it is");
        let diagnostic = Diagnostic::new(Code::LayerNotNamed, first.span(), message)
            .about(name)
            .help(match self.layers.iter().any(|it| it.shows_layers == Ok(true)) {
                true => format!("write `{{{{ {name} }}}}` in a text of the stage that shows it"),
                false => format!(
                    "write `show scene with annotations` in a stage, and `{{{{ {name} }}}}` in a text of it"
                ),
            });
        let diagnostic = unnamed.fold(diagnostic, |it, name| it.also(name.span(), "nor this one"));
        // A placeholder that did not parse may name it.
        all = Err(context.error(diagnostic));
        all
    }
}

/// Returns an inherited stage, and the last component that it says; `None` if the task states all of its stages.
fn addable<'a>(merged: &Merged<'a>) -> Option<(&'a str, &'a str)> {
    let own: BTreeSet<&str> = merged
        .task
        .body()
        .stages()
        .map(|stage| stage.name().text())
        .collect();
    let inherited = merged.stages.iter().map(|stage| stage.name().text());
    inherited
        .filter(|stage| !own.contains(stage))
        .find_map(|stage| Some((stage, merged.said.get(stage)?.names().next_back()?)))
}

/// Returns which stage a name means; reports an unknown one.
pub(super) fn number_of(
    name: Name<'_>,
    merged: &Merged<'_>,
    context: &mut Context<'_, '_>,
) -> Result<usize, Reported> {
    let names = || merged.stages.iter().map(|stage| stage.name().text());
    names()
        .position(|known| known == name.text())
        .ok_or_else(|| context.unknown("stage", name, names()))
}

// ---- model ---------------------------------------------------------------------------------------

/// The values of a model's settings, by their names.
type Settings = BTreeMap<&'static str, ArgValue>;

/// Reads `model text, temperature 0, tokens 769`: the model that is asked, and its settings.
fn model<'a>(
    line: ast::Model<'a>,
    context: &mut Context<'a, '_>,
) -> (Result<ModelRole, Reported>, Result<Settings, Reported>) {
    let names = line.settings().map(|setting| setting.name());
    let twice = unique(names, "setting", context.report);
    let mut list = line.settings();
    let Some(kind) = list.next() else {
        let diagnostic = Diagnostic::new(Code::WrongForm, line.span(), "expected a kind of model");
        let reported = context.error(diagnostic);
        return (Err(reported), Err(reported));
    };
    let word = kind.name().text();
    if nearest(word, MODELS.iter().map(|row| row.name)).is_none() {
        let message = format!("there is no kind of model `{word}`");
        let diagnostic = Diagnostic::new(Code::UnknownName, kind.name().span(), message);
        let help = "write `model vision` or `model text`; which model is asked is said on the command line, with `--model`";
        let reported = context.error(diagnostic.help(help));
        return (Err(reported), Err(reported));
    }
    let role = context
        .word("kind of model", kind.name(), MODELS)
        .map(|word| match word {
            "vision" => ModelRole::Vision,
            _ => ModelRole::Text,
        });
    let mut settings = twice.any().map(|()| Settings::new());
    if let Some(value) = kind.value() {
        let message = format!("`{}` takes no number", kind.name().text());
        settings = Err(context.fault(Code::WrongForm, value.span(), message));
    }
    for setting in list {
        match (self::setting(setting, context), &mut settings) {
            (Ok((name, value)), Ok(settings)) => {
                settings.insert(name, value);
            }
            (Err(reported), _) => settings = Err(reported),
            (Ok(_), Err(_)) => {}
        }
    }
    (role, settings)
}

fn setting<'a>(
    setting: ast::Setting<'a>,
    context: &mut Context<'a, '_>,
) -> Result<(&'static str, ArgValue), Reported> {
    let name = setting.name();
    let Some(row) = SETTINGS.iter().find(|row| row.name == name.text()) else {
        return Err(context.unknown("setting", name, SETTINGS.iter().map(|row| row.name)));
    };
    let (needs, example) = match row.kind {
        Kind::Quantity(range) | Kind::Whole(range) => ("number", range.from.0.to_string()),
        Kind::WordOrCount { noun, words, .. } => (noun, words[0].name.to_owned()),
        _ => unreachable!("every row of the settings is a number, or a word or a number"),
    };
    let Some(value) = setting.value() else {
        let message = format!("`{}` needs a {needs}", row.name);
        let diagnostic = Diagnostic::new(Code::WrongForm, name.span(), message);
        let help = format!("write `{} {example}`", row.name);
        return Err(context.error(diagnostic.help(help)));
    };
    let value = argument(value, row.kind, Scope::Everywhere, context)?;
    Ok((row.name, value))
}

// ---- show ----------------------------------------------------------------------------------------

/// Reads `show subgoal(now) with arrow, subgoal(next)`: the pictures of a question.
fn pictures<'a>(
    line: ast::Show<'a>,
    context: &mut Context<'a, '_>,
) -> Vec<Result<Picture, Reported>> {
    let beyond = line
        .pictures()
        .nth(MAX_PICTURES)
        .map(|picture| picture.value().span());
    let within = context.bounded(beyond, || {
        format!("at most {MAX_PICTURES} pictures are shown at once")
    });
    match within {
        Ok(()) => line
            .pictures()
            .map(|picture| self::picture(picture, context))
            .collect(),
        Err(reported) => vec![Err(reported)],
    }
}

fn picture<'a>(
    picture: ast::Picture<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Picture, Reported> {
    let written = form(picture.value());
    let row = PICTURE_ROWS
        .iter()
        .find(|row| row.word.name == written)
        .ok_or_else(|| {
            let diagnostic = context.unexpected(Code::WrongForm, picture.value(), "a picture");
            let known = among(PICTURES.iter().map(|word| word.name));
            context.error(diagnostic.help(format!("write {known}")))
        });
    let drawings = row.map_or(DRAWINGS, |row| row.drawings);
    let drawing = picture
        .with()
        .map(|name| context.word("drawing", name, drawings))
        .transpose()?;
    row.map(|row| {
        if drawing.is_some() {
            row.drawn
        } else {
            row.bare
        }
    })
}

/// Writes a name, or a call with names, in the form that the rows of pictures use.
fn form(value: Expr<'_>) -> String {
    match value {
        Expr::Name(name) => name.text().to_owned(),
        Expr::Call(call) => {
            let arguments = call.arguments().map(|it| match (it.label(), it.value()) {
                (None, Expr::Name(name)) => name.text(),
                _ => "…",
            });
            format!(
                "{}({})",
                call.name().text(),
                arguments.collect::<Vec<_>>().join(", ")
            )
        }
        _ => String::new(),
    }
}

/// Returns whether a picture shows the task's layers. A picture with an error may be meant to.
fn shows_layers(pictures: &[Result<Picture, Reported>]) -> Result<bool, Reported> {
    let drawn = Picture::Scene {
        layers: Layers::Drawn,
    };
    if pictures.contains(&Ok(drawn)) {
        return Ok(true);
    }
    pictures
        .iter()
        .try_fold(false, |_, picture| picture.map(|_| false))
}

// ---- read ----------------------------------------------------------------------------------------

/// Reads `read action` or `read NAME from "…{NAME}"`: the part of an answer that is read.
fn read(line: ast::Read<'_>, context: &mut Context<'_, '_>) -> Result<Read, Reported> {
    let name = line.name().text();
    let hole = format!("{{{name}}}");
    let help = match name {
        "action" => "write `read action` alone".to_owned(),
        _ => format!("write `read {name} from \"Instructions: {hole}\"`"),
    };
    let mut refuse = |span, message: String| {
        let diagnostic = Diagnostic::new(Code::BadPattern, span, message);
        Err(context.error(diagnostic.help(help.as_str())))
    };
    let (name, pattern) = match (name, line.pattern()) {
        ("action", None) => return Ok(Read::Action),
        ("action", Some(pattern)) => {
            return refuse(
                pattern.span(),
                "`action` is read in its own format".to_owned(),
            );
        }
        (_, None) => {
            let message =
                format!("the pattern is missing: nothing says where `{name}` begins in the answer");
            return refuse(line.span(), message);
        }
        (name, Some(pattern)) => (name.to_owned(), pattern),
    };
    let Some(written) = pattern.plain() else {
        return refuse(
            pattern.span(),
            "a pattern cannot contain `{{ … }}`".to_owned(),
        );
    };
    let Some((before, after)) = written.split_once(&hole) else {
        return refuse(pattern.span(), format!("the pattern has no `{hole}`"));
    };
    let (before, after) = (before.trim(), after.trim());
    if before.is_empty() {
        return refuse(
            pattern.span(),
            format!("the pattern has no words before `{hole}`"),
        );
    }
    if after.contains(&hole) {
        return refuse(pattern.span(), format!("the pattern has `{hole}` twice"));
    }
    Ok(Read::Text {
        name,
        before: before.to_owned(),
        after: after.to_owned(),
    })
}
