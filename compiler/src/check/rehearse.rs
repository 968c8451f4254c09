//! `rehearse plan { twin(…) choose most overlap … }`: what is tried on a twin of the cloth before the world moves.

use super::context::{Context, Declared};
use super::expressions::{Scope, call, material_name};
use super::material;
use super::quantity::{read, read_whole};
use super::stage::{Prompts, number_of};
use crate::diag::{Code, Diagnostic, Reported, among};
use crate::lang::goal::METRICS;
use crate::lang::rehearse::{REVISIONS, TRUST, TWINS};
use crate::merge::{Merged, VariantChange, once};
use fab_grammar::ast::{self, Call, Choose, Name, Rehearse, Revise, Setting, Trust};
use fab_program::{
    Cloth, ClothStart, Distrusted, Material, Metric, ModelRole, Read, Rehearsal, RehearsalMeasure,
    Stage, TwinRanges,
};

/// Builds the rehearsal of a stage; `None` in a base without stages.
pub(crate) fn check<'a>(
    part: Rehearse<'a>,
    merged: &Merged<'a>,
    prompts: &Prompts,
    context: &mut Context<'a, '_>,
) -> Declared<Rehearsal> {
    let twins = once(part.twins(), "twin", Call::span, context.report);
    let choices = once(part.choices(), "choose", Choose::span, context.report);
    let revisions = once(part.revisions(), "revise", Revise::span, context.report);
    let trusts = once(part.trusts(), "trust", Trust::span, context.report);
    let lines = [twins.alone, choices.alone, revisions.alone, trusts.alone];
    let has_purpose = choices.first.is_some() || revisions.first.is_some();
    let lacks = lacking(
        part,
        [twins.first.is_none(), !has_purpose, trusts.first.is_none()],
        context,
    );
    let stage = stage(part, merged, prompts, context);
    let asked = stage.as_ref().ok().and_then(|it| it.as_ref());
    let twin = twins.first.map(|it| twin(it, context));
    let choose = choices
        .first
        .map(|it| choose(it, asked, merged, context))
        .transpose();
    let revisions = revisions
        .first
        .map(|it| revisions_of(it, asked, context))
        .transpose();
    let trust_above = trusts
        .first
        .map(|it| read(it.above(), &TRUST.range, context))
        .transpose();
    if let (Some(Ok(twin)), Ok(Some(above)), Some(line)) = (&twin, &trust_above, trusts.first) {
        never_trusted(twin, *above, line, context);
    }
    crumpled_start(part, merged, context);
    let refuses = trusts.first.and_then(Trust::else_refuse).is_some();
    lines.into_iter().collect::<Result<(), _>>()?;
    lacks?;
    let (choose, revisions) = (choose?, revisions?);
    let (Some(twin), Some(trust_above), Some(stage)) = (twin.transpose()?, trust_above?, stage?)
    else {
        return Ok(None);
    };
    Ok(Some(Rehearsal {
        stage: stage.name.clone(),
        twin,
        choose,
        revisions: revisions.unwrap_or(0),
        trust_above,
        distrusted: match refuses {
            true => Distrusted::Refuses,
            false => Distrusted::StandsAside,
        },
    }))
}

/// Reports the lines that a rehearsal must have and does not, all in one error.
///
/// - `is_missing`: its twin, what it is for, and how far the twin is trusted.
fn lacking(
    part: Rehearse<'_>,
    is_missing: [bool; 3],
    context: &mut Context<'_, '_>,
) -> Result<(), Reported> {
    const NEEDED: [(&str, &str); 3] = [
        (
            "twin",
            "write `twin(material: cotton, size: 0.95 to 1.05, friction: 0.4 to 0.9)`",
        ),
        (
            "choose",
            "write `choose most overlap`, or `revise 1 with picture`",
        ),
        (
            "trust",
            "write `trust overlap > 0.8`: where twin and camera agree less, it is not rehearsed",
        ),
    ];
    let lacks = NEEDED
        .iter()
        .zip(is_missing)
        .filter(|(_, missing)| *missing);
    let lacks: Vec<(&str, &str)> = lacks.map(|(row, _)| *row).collect();
    if lacks.is_empty() {
        return Ok(());
    }
    let words = among(lacks.iter().map(|(word, _)| *word));
    let stage = part.stage();
    let message = format!("the rehearsal of `{}` has no {words}", stage.text());
    let diagnostic = Diagnostic::new(Code::RehearsalIncomplete, stage.span(), message);
    let diagnostic = lacks.iter().fold(diagnostic, |it, (_, how)| it.help(*how));
    Err(context.missing(part.is_damaged(), stage.span().file, diagnostic))
}

/// Returns the stage that is rehearsed; `None` in a base without stages.
fn stage<'p>(
    part: Rehearse<'_>,
    merged: &Merged<'_>,
    prompts: &'p Prompts,
    context: &mut Context<'_, '_>,
) -> Declared<&'p Stage> {
    if merged.stages.is_empty() {
        return Ok(None);
    }
    let name = part.stage();
    let number = number_of(name, merged, context)?;
    let stage = prompts.stages[number].as_ref().map_err(|it| *it)?;
    if stage.read != Read::Action {
        let message = format!("the stage `{}` does not read the action", stage.name);
        let diagnostic = Diagnostic::new(Code::WrongForm, name.span(), message);
        let help = "only an action can be tried on a twin: name the last stage";
        return Err(context.error(diagnostic.help(help)));
    }
    Ok(Some(stage))
}

/// Reads what the twins are made of.
fn twin<'a>(line: Call<'a>, context: &mut Context<'a, '_>) -> Result<TwinRanges, Reported> {
    let signatures = TWINS.iter().map(|row| &row.signature);
    let (row, args, bound) = call("twin", line, signatures, Scope::Everywhere, context)?;
    let mut twin = (TWINS[row].make)(&args);
    if let Some((_, expr)) = bound.iter().find(|(arg, _)| arg.name == "material") {
        let name = material_name(*expr, context)?;
        twin.material = material::named(name, context)?;
        if let Ok(Some(cloth)) = &context.cloth
            && is_own(&twin, cloth)
        {
            let friction = cloth.table_friction();
            if (twin.size, twin.friction) == ([1.0; 2], [friction; 2]) {
                return Err(judged_cloth(line, friction, context));
            }
            own_material(name, context);
        }
        too_stiff(&twin, line, context);
    }
    Ok(twin)
}

/// Warns of twins of which the smallest cannot be laid in the simulator.
fn too_stiff(twin: &TwinRanges, line: Call<'_>, context: &mut Context<'_, '_>) {
    if let (Some(material), Ok(Some(cloth))) = (&twin.material, &context.cloth)
        && let Some(why) = context
            .loaded
            .refuses_cloth(material, twin.least_spacing_m(cloth))
    {
        let message = format!("the smallest twin cannot be laid in the simulator: {why}");
        let diagnostic = Diagnostic::new(Code::TwinTooStiff, line.span(), message);
        let help = "let `size` begin higher, or state a larger `spacing` of the cloth, which the twins share";
        context.remark(diagnostic.help(help));
    }
}

/// Warns of a cloth that starts crumpled. Where it lies at the start of a file is seen when it runs.
fn crumpled_start(part: Rehearse<'_>, merged: &Merged<'_>, context: &mut Context<'_, '_>) {
    let (Ok(Some(cloth)), Some(laid)) = (&context.cloth, merged.statement("cloth")) else {
        return;
    };
    if cloth.start != ClothStart::Crumpled {
        return;
    }
    let (laid, stage) = (laid.value().span(), part.stage().span());
    let ends = match merged.task.span().contains(stage) {
        true => [(stage, "the rehearsal"), (laid, "the cloth")],
        // The cause is what this task says about an inherited rehearsal.
        false => [(laid, "the cloth"), (stage, "the rehearsal")],
    };
    let message = "the cloth starts crumpled, and only a flat cloth has a twin";
    let diagnostic = Diagnostic::new(Code::CrumpledStartRehearsed, ends[0].0, message);
    let help = "no step of such a start is rehearsed: let it start flat, or leave out `rehearse`";
    context.remark(diagnostic.also(ends[1].0, ends[1].1).help(help));
}

/// Warns of twins that are so much larger or smaller than the cloth that none is trusted where both lie flat.
///
/// Two silhouettes overlap by at most the ratio of their areas.
fn never_trusted(twin: &TwinRanges, above: f64, line: Trust<'_>, context: &mut Context<'_, '_>) {
    let [low, high] = twin.size;
    let closest = 1.0_f64.clamp(low, high);
    let most = closest.min(1.0 / closest).powi(2);
    if most <= above {
        let message = format!(
            "twins of {low} to {high} of the cloth's size overlap the flat cloth by at most {most:.2}, and are trusted above {above}"
        );
        let diagnostic = Diagnostic::new(Code::TwinNeverTrusted, line.span(), message);
        let help = "let the range of sizes contain 1, or trust a smaller overlap";
        context.remark(diagnostic.help(help));
    }
}

/// Returns whether a twin is made of what the cloth is made of. Name and colours do not count, nor does the friction on
/// the table, which is drawn.
fn is_own(twin: &TwinRanges, cloth: &Cloth) -> bool {
    let (Some(twin), Some(cloth)) = (&twin.material, &cloth.material) else {
        return twin.material.is_none() && cloth.material.is_none();
    };
    let plain = Material {
        name: cloth.name.clone(),
        upper: cloth.upper.clone(),
        under: cloth.under.clone(),
        table_friction: cloth.table_friction,
        ..twin.without_sources()
    };
    plain == cloth.without_sources()
}

/// Warns of a twin that is made of what the judged cloth is made of.
fn own_material(name: Name<'_>, context: &mut Context<'_, '_>) {
    let message = format!(
        "the twin is made of `{}`, as the task's cloth is",
        name.text()
    );
    let diagnostic = Diagnostic::new(Code::TwinOfOwnMaterial, name.span(), message);
    let help = "a simulated cloth would be rehearsed on its own physics, and the gain would say nothing about a real one; name another material";
    context.remark(diagnostic.help(help));
}

/// Reports a twin that cannot differ from the judged cloth.
fn judged_cloth(line: Call<'_>, friction: f64, context: &mut Context<'_, '_>) -> Reported {
    let message = format!(
        "the twin is the task's own cloth: the same material, of its size and with its friction of {friction}"
    );
    let diagnostic = Diagnostic::new(Code::TwinIsJudgedCloth, line.span(), message);
    let help = "name another material, and for what is not known write ranges, such as `size: 0.95 to 1.05, friction: 0.4 to 0.9`";
    context.error(diagnostic.help(help))
}

/// Reads the measure by which the best candidate is chosen.
fn choose<'a>(
    line: Choose<'a>,
    stage: Option<&&Stage>,
    merged: &Merged<'a>,
    context: &mut Context<'a, '_>,
) -> Result<RehearsalMeasure, Reported> {
    let name = line.measure();
    let known = || RehearsalMeasure::WORDS.iter().map(|word| word.name);
    let Some(measure) = RehearsalMeasure::from_word(name.text()) else {
        let mut goals = METRICS.iter().map(|row| row.metric);
        let Some(goal) = goals.find(|it| it.as_str() == name.text()) else {
            return Err(context.unknown("rehearsal measure", name, known()));
        };
        let message = format!("`{}` cannot be measured on a twin", name.text());
        let diagnostic = Diagnostic::new(Code::NotMeasuredOnTwin, name.span(), message);
        let why = match goal {
            Metric::ParticleDistance => {
                "it is the distance from an expert's result, which nobody has before the world moves"
            }
            Metric::Coverage | Metric::NormalizedImprovement => {
                "it needs the coverage of the start, and a twin's start lies flat"
            }
        };
        let help = format!("{why}; there is {}", among(known()));
        return Err(context.error(diagnostic.help(help)));
    };
    if measure == RehearsalMeasure::Overlap
        && merged.subgoals().is_none()
        // Without a cloth, the task is there for others to extend, which may have subgoals.
        && merged.statement("cloth").is_some()
        && merged.missing_base.is_none()
        && !merged.stages.is_empty()
    {
        let message = "`overlap` needs a subgoal to compare with, and the task has none";
        let diagnostic = Diagnostic::new(Code::NotMeasuredOnTwin, name.span(), message);
        let help = "show `subgoals`, or write `choose most coverage`";
        return Err(context.missing(merged.is_damaged, name.span().file, diagnostic.help(help)));
    }
    if let (RehearsalMeasure::Coverage, Some(subgoals)) = (measure, merged.subgoals()) {
        let message =
            "`coverage` is largest where the cloth is folded least, and the task has subgoals";
        let diagnostic = Diagnostic::new(Code::FoldChosenByCoverage, name.span(), message)
            .also(subgoals.head_span(), "the subgoals")
            .help("write `choose most overlap`, which compares with the next subgoal")
            .likely(name.span(), "overlap");
        context.remark(diagnostic);
    }
    if let Some(stage) = stage.filter(|stage| stage.candidates() < 2) {
        let message = format!("the stage `{}` gives one answer to choose from", stage.name);
        let diagnostic = Diagnostic::new(Code::RehearsalIncomplete, line.span(), message);
        let help = "write `candidates 4` and a temperature above 0 behind its `model`";
        return Err(context.error(diagnostic.help(help)));
    }
    Ok(measure)
}

/// Reads how often an answer may be revised.
fn revisions_of<'a>(
    line: Revise<'a>,
    stage: Option<&&Stage>,
    context: &mut Context<'a, '_>,
) -> Result<u32, Reported> {
    let count = read_whole(line.count(), &REVISIONS.range, context)?;
    if let Some(stage) = stage.filter(|stage| stage.model == ModelRole::Text) {
        let message = format!(
            "`revise` shows a picture, but the stage `{}` asks a text model",
            stage.name
        );
        let diagnostic = Diagnostic::new(Code::PicturesForTextModel, line.span(), message);
        let help = "write `model vision` in that stage, or leave out `revise`";
        return Err(context.error(diagnostic.help(help)));
    }
    Ok(count as u32)
}

/// Reports candidates that would all be alike, and warns of those among which nothing chooses.
///
/// - `rehearsal`: the task's own, if it has one. One with an error may have been meant to choose.
pub(crate) fn candidates<'a>(
    merged: &Merged<'a>,
    prompts: &Prompts,
    rehearsal: Option<&Declared<Rehearsal>>,
    context: &mut Context<'a, '_>,
) -> Result<(), Reported> {
    let mut all = Ok(());
    for (declared, stage) in merged.stages.iter().zip(&prompts.stages) {
        let Ok(stage) = stage else {
            continue;
        };
        let settings = declared.model().flat_map(ast::Model::settings);
        let mut settings = settings.filter(|it| it.name().text() == "candidates");
        let Some(setting) = settings.next() else {
            continue;
        };
        if stage
            .temperature
            .is_none_or(|temperature| temperature <= 0.0)
        {
            let at = match stage.temperature {
                Some(_) => "at temperature 0",
                None => "without a temperature",
            };
            let message = format!("{} candidates are asked for {at}", stage.candidates());
            let diagnostic = Diagnostic::new(Code::CandidatesAlike, setting.span(), message);
            let help = "write a temperature above 0, such as `temperature 0.7`: equal questions would get equal answers";
            all = Err(context.error(diagnostic.help(help)));
        }
        let names = |part: &Rehearse<'_>| part.stage().text() == stage.name;
        let is_rehearsed = merged.rehearse().is_some_and(|part| names(&part));
        let chooses = |part: &Rehearse<'_>| {
            let chooses = part.choices().next().is_some() || part.is_damaged();
            // Without a rehearsal of the task's own, each variant's is judged where that variant is checked.
            match is_rehearsed {
                true => names(part) && chooses,
                // A name that no stage has is reported as that.
                false => names(part) || merged.stages.get(part.stage().text()).is_none(),
            }
        };
        // A variant may rehearse, so that runs with and without can be compared.
        let bodies = merged.variants.iter().filter_map(|change| match change {
            VariantChange::Body(body) => Some(body),
            VariantChange::Without(_) => None,
        });
        let in_variants = bodies.flat_map(|body| body.rehearsals());
        let mut rehearsals = merged.rehearse().into_iter().chain(in_variants);
        let is_wrong = matches!(rehearsal, Some(Err(_)));
        if !is_wrong && !rehearsals.any(|part| chooses(&part)) && !merged.is_damaged {
            unchosen(setting, stage, context);
        }
    }
    all
}

fn unchosen(setting: Setting<'_>, stage: &Stage, context: &mut Context<'_, '_>) {
    let message = format!("nothing chooses among the candidates of `{}`", stage.name);
    let diagnostic = Diagnostic::new(Code::CandidatesUnchosen, setting.span(), message);
    let help = format!(
        "one answer is asked for all the same; write `rehearse {} {{ … choose most overlap … }}`, or leave `candidates` out",
        stage.name
    );
    context.remark(diagnostic.help(help));
}
