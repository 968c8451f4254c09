//! `stage plan { model text … say … read action }`: the questions to models, and their texts.
//!
//! In: the stages and components of a task. Out: a stage for each declaration, and a template for each text that a
//! stage says. [`super::examples`] reads examples, [`super::placeholders`] the values in texts.

use super::conditions;
use super::context::{Context, Declared, Named, Result};
use super::examples;
use super::expressions::argument;
use super::placeholders::{TextPlace, TextScope, template};
use crate::diag::{Code, Diagnostic, Reported, among, every, nearest};
use crate::lang::stage::{MODELS, PICTURE_ROWS, PICTURES, SETTINGS};
use crate::merge::{Line, Merged, Said, once, unique};
use fab_grammar::Span;
use fab_grammar::ast::{self, ComponentOrText, Declares, Name, Sayings, Text};
use fab_program::Depends;
use fab_program::vocabulary::{ArgValue, Args, Kind};
use fab_program::{
    self as program, Condition, Layers, ModelRole, Picture, Read, Reasoning, ReasoningLevel,
    Template,
};
use std::collections::{BTreeMap, BTreeSet};

/// The most stages: each is a model call per step.
const MAX_STAGES: usize = 16;

/// The most pictures in one question.
const MAX_PICTURES: usize = 16;

/// The picture that shows the task's layers.
const WITH_LAYERS: Picture = Picture::Scene {
    layers: Layers::Drawn,
};

/// Builds the stages of a task and their texts.
pub(crate) fn check<'a>(merged: &Merged<'a>, context: &mut Context<'a>) {
    let places = merged.stages.iter().map(|stage| stage.name().span());
    let within = context.at_most(MAX_STAGES, places, "a task", "stages");
    let mut builder = Builder {
        merged,
        context,
        templates: BTreeMap::new(),
    };
    let stages = merged.stages.iter().enumerate();
    let stages: Vec<Result<program::Stage>> = stages
        .map(|(number, stage)| within.and_then(|()| builder.stage(number, stage)))
        .collect();
    action_readers(merged, builder.context);
    builder.named_layers_are_shown(&stages);
    // A stage that is wrong may say less than its author meant.
    if !stages.is_empty() && stages.iter().all(Result::is_ok) {
        builder.shown_layers_are_named();
        if merged.variant.is_none() {
            said_nowhere(merged, builder.context);
        }
    }
    builder.unsaid();
    let templates = builder.in_order();
    let names = merged.stages.iter().map(|stage| stage.name().text());
    context.stages = Named(names.zip(stages).collect());
    context.templates = templates;
}

/// Reports an error unless the last stage, and only that one, reads the action.
fn action_readers(merged: &Merged<'_>, context: &mut Context<'_>) {
    let mut earlier = merged.stages.iter();
    let Some(last) = earlier.next_back() else {
        return;
    };
    let action = |stage: ast::Stage<'_>| {
        let read = stage.read().find(|read| read.name().text() == "action");
        read.map(|read| read.span())
    };
    let name = last.name();
    let acting = earlier.find_map(|stage| Some((stage.name(), action(stage)?)));
    let new = |span, message| Diagnostic::new(Code::ActionReadElsewhere, span, message);
    let diagnostic = match (acting, action(last), last.read().next()) {
        (None, None, Some(read)) => {
            let name = name.text();
            let message = format!("the last stage, `{name}`, does not read the action");
            new(read.span(), message).help("write `read action`")
        }
        (Some((acting, _)), None, _) => {
            let (name, span, acting, place) =
                (name.text(), name.span(), acting.text(), acting.span());
            let message =
                format!("the stage `{name}` comes after `{acting}`, which reads the action");
            new(span, message).also(place, "reads the action").help(format!(
                "a new stage comes last: state it above `{acting}`, in the same task; to add a text to `{acting}`, write `say NAME in {acting} after NAME`"
            ))
        }
        (Some((acting, read)), Some(_), _) => {
            let acting = acting.text();
            let message = format!("`{acting}` reads the action, but it is not the last stage");
            new(read, message)
                .also(name.span(), "this is the last stage")
                .help("write `read NAME from \"…{NAME}\"`")
        }
        (None, ..) => return,
    };
    context.error(diagnostic);
}

/// Builds the condition on which a component is used, if it has one.
fn guard(component: ast::Component<'_>, context: &mut Context<'_>) -> Declared<Condition> {
    let Some(expr) = component.when() else {
        return Ok(None);
    };
    let when = conditions::check(expr, context)?;
    let uses = when.uses();
    if uses.action {
        return Err(context.needs_action(expr.span()));
    }
    if uses.last && !when.implies_last() {
        return Err(context.needs_last(expr.span(), "… when last and …"));
    }
    Ok(Some(when))
}

struct Builder<'m, 'a, 'c> {
    merged: &'m Merged<'a>,
    context: &'m mut Context<'c>,
    /// By name.
    templates: BTreeMap<String, Built>,
}

/// The template of a text.
struct Built {
    /// Its place in the order in which they are built.
    number: usize,
    template: Result<Template>,
    /// The layers that it names.
    layers: Vec<(String, Span)>,
}

impl<'a> Builder<'_, 'a, '_> {
    fn stage(&mut self, number: usize, stage: ast::Stage<'a>) -> Result<program::Stage> {
        let report = &mut *self.context.report;
        let model = once(stage.model(), "model", ast::Model::span, report);
        let show = once(stage.show(), "show", ast::Show::span, report);
        let say = once(stage.say(), "say", Sayings::span, report);
        let system = once(stage.system(), "system", Sayings::span, report);
        let read = once(stage.read(), "read", ast::Read::span, report);
        let (Some(model), Some(say), Some(read)) = (model, say, read) else {
            let lines = [
                ("model", model.is_some()),
                ("say", say.is_some()),
                ("read", read.is_some()),
            ];
            return Err(self.incomplete(stage.name(), &lines));
        };
        let role = role(model, self.context);
        let settings = settings(model, self.context);
        let pictures = show.map_or(Ok(Vec::new()), |line| pictures(line, self.context));
        if let Some(show) = show {
            self.showable(stage, show, role, &pictures);
        }

        let name = stage.name().text();
        let mut sayings = |line, part: Sayings<'a>| {
            let said = self.merged.said.get(name).into_iter();
            let list = said.flat_map(|said| said.line(line)).collect();
            self.sayings(number, stage, line, part, list)
        };
        let system = system.map(|part| sayings(Line::System, part));
        let say = sayings(Line::Say, say);
        let read = self::read(read, self.context);
        let examples = examples::check(stage, role, read.as_ref().map_err(|it| *it), self.context);
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
            system: system.transpose()?.unwrap_or_default(),
            examples: examples?,
            say: say?,
            show: pictures?,
            read: read?,
        })
    }

    /// Reports the lines that a stage must have and does not, all in one error.
    fn incomplete(&mut self, stage: Name<'_>, lines: &[(&str, bool); 3]) -> Reported {
        let name = stage.text();
        let replaced = format!(
            "this replaces the whole inherited stage; to add to what it says, write `say NAME in {name} after NAME`, outside of any stage"
        );
        // Who states neither the model nor what is read means to add to the inherited stage.
        let help = match lines {
            [(_, false), _, (_, false)] if self.merged.replaced_stages.contains(name) => &replaced,
            _ => {
                "write `model vision`, `say` with components or a text, and `read action` or `read NAME from \"…{NAME}\"`"
            }
        };
        let block = format!("the stage `{name}`");
        let block = (block.as_str(), stage.span());
        self.context
            .lacking(Code::StageIncomplete, block, lines, help)
    }

    /// Reports pictures for a model that takes none, and annotations if no layers are declared.
    fn showable(
        &mut self,
        stage: ast::Stage<'_>,
        show: ast::Show<'_>,
        role: Result<ModelRole>,
        pictures: &Result<Vec<Picture>>,
    ) {
        if role == Ok(ModelRole::Text) {
            self.context
                .text_model(show.span(), "`show`", stage.name().text());
        }
        let shows_layers = { pictures.iter().flatten() }.any(|it| *it == WITH_LAYERS);
        if shows_layers && self.merged.annotate().is_none() {
            let message = "no annotations are declared";
            let help = "add `annotate { … }`, or write `show scene`";
            self.context
                .refuse(Code::NothingToDraw, show.span(), message, help);
        }
    }

    // ---- texts -----------------------------------------------------------------------------------

    /// Returns the names of the templates that a line says, and builds those that are not built yet.
    ///
    /// - `part`: the line as the stage states it.
    /// - `list`: its parts, with those that were added beside them.
    fn sayings(
        &mut self,
        number: usize,
        stage: ast::Stage<'a>,
        line: Line,
        part: Sayings<'a>,
        list: Vec<ComponentOrText<'a>>,
    ) -> Result<Vec<String>> {
        let word = match line {
            Line::System => "system",
            Line::Say => "say",
        };
        let mut names = Vec::new();
        let mut n_texts = 0;
        let mut all = Ok(());
        for saying in list {
            match saying {
                ComponentOrText::Component(name) => match self.component(number, name) {
                    Ok(name) => names.extend(name),
                    Err(reported) => all = Err(reported),
                },
                ComponentOrText::Text(text) => {
                    n_texts += 1;
                    let mut name = format!("{}.{}", stage.name().text(), word);
                    if n_texts > 1 {
                        name = format!("{name}.{n_texts}");
                    }
                    self.build(&name, "component NAME", text, Ok(None), number);
                    names.push(name);
                }
            }
        }
        all?;
        if names.is_empty() && line == Line::Say {
            let name = stage.name().text();
            let message = format!("the stage `{name}` has no text left to say");
            let span = self.merged.task.name().span();
            let diagnostic = Diagnostic::new(Code::StageIncomplete, span, message)
                .also(part.span(), "all of these components are left out");
            return Err(self.context.error(diagnostic));
        }
        Ok(names)
    }

    /// Returns the name of a component's template; `None` for a removed component.
    fn component(&mut self, number: usize, name: Name<'a>) -> Result<Option<String>> {
        let text = name.text();
        let Some(component) = self.merged.components.get(text) else {
            if self.merged.components.is_removed(text) {
                return Ok(None);
            }
            let all = self.merged.components.names();
            return Err(self.context.unknown("component", name, all));
        };
        // A later stage knows all that this one knows.
        if !self.templates.contains_key(text) {
            let when = guard(component, self.context);
            let guarded = format!("component {text}");
            self.build(text, &guarded, component.text(), when, number);
        }
        Ok(Some(text.to_owned()))
    }

    /// Builds a template.
    ///
    /// - `guarded`: the beginning of a component declaration that would say the text conditionally.
    fn build(
        &mut self,
        name: &str,
        guarded: &str,
        text: Text<'a>,
        when: Result<Option<Condition>>,
        stage: usize,
    ) {
        // If the condition is wrong, check the text as if it were right.
        let has_last = when.as_ref().map_or(true, |when| {
            when.as_ref().is_some_and(Condition::implies_last)
        });
        let scope = TextScope::new(TextPlace::Stage(stage), has_last, guarded);
        let template = template(name, text, when.unwrap_or_default(), scope, self.context);
        let built = Built {
            number: self.templates.len(),
            template,
            layers: std::mem::take(&mut self.context.named_layers),
        };
        self.templates.insert(name.to_owned(), built);
    }

    /// Returns the components in the order of their declarations, then the texts of the stages.
    fn in_order(self) -> Vec<Result<Template>> {
        let place = |name: &str| self.merged.components.place(name).unwrap_or(usize::MAX);
        let mut templates: Vec<(String, Built)> = self.templates.into_iter().collect();
        templates.sort_by_key(|(name, built)| (place(name), built.number));
        templates.into_iter().map(|(_, it)| it.template).collect()
    }

    // ---- all stages together ---------------------------------------------------------------------

    /// Checks the components that no stage says.
    fn unsaid(&mut self) {
        let all = self.merged.components.iter();
        for component in all.filter(|it| !self.templates.contains_key(it.name().text())) {
            let scope = TextScope::new(TextPlace::Nowhere, true, "");
            // What is wrong with them is reported; no prompt has them.
            let _: Declared<Condition> = guard(component, self.context);
            let _: Result<Template> = template("", component.text(), None, scope, self.context);
        }
    }

    /// Reports layers that a stage names and its pictures do not show.
    fn named_layers_are_shown(&mut self, stages: &[Result<program::Stage>]) {
        for stage in stages.iter().flatten() {
            let said = stage.system.iter().chain(&stage.say);
            let said = said.filter_map(|name| self.templates.get(name));
            let named: Vec<&(String, Span)> = said.flat_map(|built| &built.layers).collect();
            let [(layer, span), others @ ..] = named.as_slice() else {
                continue;
            };
            if stage.show.contains(&WITH_LAYERS) {
                continue;
            }
            let message = format!("no picture of this stage shows `{layer}`");
            let diagnostic = Diagnostic::new(Code::LayerNotShown, *span, message)
                .help("write `show scene with annotations` in the stage");
            let others = others.iter().filter(|(other, _)| other != layer);
            let diagnostic =
                others.fold(diagnostic, |it, (_, span)| it.also(*span, "nor this one"));
            self.context.error(diagnostic);
        }
    }

    /// Reports layers that are drawn and that no stage names.
    fn shown_layers_are_named(&mut self) {
        let merged = self.merged;
        // A variant may remove the text that names a layer of its task; that is not a mistake.
        let own = merged.own_body().map(|body| body.span());
        let is_own = |span| merged.variant.is_none() || own.is_some_and(|own| own.contains(span));
        let named = self.templates.values().flat_map(|built| &built.layers);
        let named: BTreeSet<&str> = named.map(|(layer, _)| layer.as_str()).collect();
        let drawn = merged.annotate().into_iter().flat_map(|part| part.list());
        let mut unnamed = drawn.map(|layer| layer.name()).filter(|name| {
            let is_right = matches!(self.context.layers.get(name.text()), Ok(Some(_)));
            is_right && !named.contains(name.text()) && is_own(name.span())
        });
        let Some(first) = unnamed.next() else {
            return;
        };
        let name = first.text();
        let message = format!("the layer `{name}` is drawn, but no prompt says what it is");
        let diagnostic = Diagnostic::new(Code::LayerNotNamed, first.span(), message)
            .about(name)
            .help(format!(
                "write `{{{{ {name} }}}}` in a text of a stage with `show scene with annotations`"
            ));
        let diagnostic = unnamed.fold(diagnostic, |it, name| it.also(name.span(), "nor this one"));
        self.context.error(diagnostic);
    }
}

/// Warns of the components of a task and its variants that no stage of these says.
fn said_nowhere(merged: &Merged<'_>, context: &mut Context<'_>) {
    let variants = || merged.task.variants().map(|variant| variant.body());
    let bodies = || variants().chain([merged.task.body()]);
    let inherited = merged.said.values().flat_map(Said::names);
    let stated = variants().flat_map(ast::Body::stages);
    let stated = stated.flat_map(|stage| Said::of(stage).names().collect::<Vec<&str>>());
    // If one of these cannot be added, that was reported.
    let added = bodies().flat_map(ast::Body::added_sayings);
    let added = added.flat_map(|line| line.parts()).map(|name| name.text());
    let said: BTreeSet<&str> = inherited.chain(stated).chain(added).collect();
    let own = bodies().flat_map(ast::Body::components);
    let own = own.filter(|component| component.declares() == Declares::New);
    let own: Vec<Name<'_>> = own.map(|component| component.name()).collect();
    for (name, span) in own.iter().map(|name| (name.text(), name.span())) {
        if said.contains(name) || merged.components.is_removed(name) {
            continue;
        }
        let message = format!("the component `{name}` is never used");
        // Perhaps the author meant to replace an inherited component.
        let declared_here = |other: &&str| own.iter().any(|own| own.text() == *other);
        let inherited = merged.components.names().filter(|it| !declared_here(it));
        let help = match nearest(name, inherited) {
            Some(meant) => format!("did you mean `override component {meant}`?"),
            None => format!(
                "name it in a stage's `say` or `system`, write `say {name} in STAGE after NAME`, or remove it"
            ),
        };
        context.warn(Code::SaidNowhere, span, message, help);
    }
}

// ---- model ---------------------------------------------------------------------------------------

/// Reads which kind of model is asked.
fn role(line: ast::Model<'_>, context: &mut Context<'_>) -> Result<ModelRole> {
    let Some(kind) = line.settings().next() else {
        return Err(context.fault(Code::WrongForm, line.span(), "expected a kind of model"));
    };
    let word = kind.name().text();
    match word {
        "vision" => Ok(ModelRole::Vision),
        "text" => Ok(ModelRole::Text),
        _ => {
            let message = format!("there is no kind of model `{word}`");
            let diagnostic = Diagnostic::new(Code::UnknownName, kind.name().span(), message)
                .suggest(word, MODELS.iter().map(|row| row.name), "")
                .help("which model is asked is said on the command line, with `--model`");
            Err(context.error(diagnostic))
        }
    }
}

/// Reads what follows the kind of model: `temperature 0, tokens 769`.
fn settings(line: ast::Model<'_>, context: &mut Context<'_>) -> Result<Args> {
    let names = line.settings().map(|setting| setting.name());
    let all = unique(names, "setting", context.report);
    let mut list = line.settings();
    if let Some(kind) = list.next()
        && let Some(value) = kind.value()
        && let Some(row) = MODELS.iter().find(|row| row.name == kind.name().text())
    {
        let message = format!("`{}` takes no number", row.name);
        context.fault(Code::WrongForm, value.span(), message);
    }
    let settings = every(list.map(|setting| self::setting(setting, context)));
    all.and(settings).map(Args)
}

fn setting(
    setting: ast::Setting<'_>,
    context: &mut Context<'_>,
) -> Result<(&'static str, ArgValue)> {
    let name = setting.name();
    let row = context.row("setting", name, SETTINGS, |row| row.name)?;
    let (needs, example) = match row.kind {
        Kind::Quantity(range) | Kind::Whole(range) => ("number", range.from.0.to_string()),
        Kind::WordOrCount { noun, words, .. } => (noun, words[0].name.to_owned()),
        _ => unreachable!("every row of the settings is a number, or a word or a number"),
    };
    let Some(value) = setting.value() else {
        let message = format!("`{}` needs a {needs}", row.name);
        let help = format!("write `{} {example}`", row.name);
        return Err(context.refuse(Code::WrongForm, name.span(), message, help));
    };
    let value = argument(value, row.kind, context)?;
    Ok((row.name, value))
}

// ---- show ----------------------------------------------------------------------------------------

/// Reads `show subgoal(now) with arrow, subgoal(next)`: the pictures of a question.
fn pictures(line: ast::Show<'_>, context: &mut Context<'_>) -> Result<Vec<Picture>> {
    let places = line.pictures().map(|picture| picture.value().span());
    context.at_most(MAX_PICTURES, places, "a question", "pictures")?;
    every(line.pictures().map(|it| picture(it, context)))
}

fn picture(picture: ast::Picture<'_>, context: &mut Context<'_>) -> Result<Picture> {
    let written = context.loaded.written(picture.value().span());
    let written: String = written.split_whitespace().collect();
    let Some(row) = PICTURE_ROWS.iter().find(|row| row.word.name == written) else {
        let known = among(PICTURES.iter().map(|word| word.name));
        let help = format!("write {known}");
        return Err(context.wrong(Code::WrongForm, picture.value(), "a picture", Some(&help)));
    };
    let Some(drawing) = picture.with() else {
        return Ok(row.bare);
    };
    context.word("drawing", drawing, row.drawings)?;
    Ok(row.drawn)
}

// ---- read ----------------------------------------------------------------------------------------

/// Reads `read action` or `read NAME from "…{NAME}"`: the part of an answer that is read.
fn read(line: ast::Read<'_>, context: &mut Context<'_>) -> Result<Read> {
    let name = line.name().text();
    let hole = format!("{{{name}}}");
    let help = match name {
        "action" => "write `read action` alone".to_owned(),
        _ => format!("write `read {name} from \"Instructions: {hole}\"`"),
    };
    let Some(pattern) = line.pattern() else {
        if name == "action" {
            return Ok(Read::Action);
        }
        let message =
            format!("the pattern is missing: nothing says where `{name}` begins in the answer");
        return Err(context.refuse(Code::BadPattern, line.span(), message, help));
    };
    let written = pattern.plain();
    let parts = { written.iter() }.flat_map(|written| written.splitn(3, hole.as_str()));
    let parts: Vec<&str> = parts.map(str::trim).collect();
    let message = match parts.as_slice() {
        _ if name == "action" => "`action` is read in its own format".to_owned(),
        [] => "a pattern cannot contain `{{ … }}`".to_owned(),
        [_] => format!("the pattern has no `{hole}`"),
        ["", ..] => format!("the pattern has no words before `{hole}`"),
        [before, after] => {
            return Ok(Read::Text {
                name: name.to_owned(),
                before: (*before).to_owned(),
                after: (*after).to_owned(),
            });
        }
        _ => format!("the pattern has `{hole}` twice"),
    };
    Err(context.refuse(Code::BadPattern, pattern.span(), message, help))
}
