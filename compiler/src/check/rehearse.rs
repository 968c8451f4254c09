//! `rehearse plan { twin(…) choose most overlap … }`: what is tried on a twin of the cloth before the world moves.

use super::context::{Context, Declared, Result};
use super::expressions::made;
use super::material;
use super::quantity::{read, read_whole};
use crate::diag::{Code, Diagnostic, Reported};
use crate::lang::rehearse::{REVISIONS, TRUST, TWINS};
use crate::merge::{Merged, once};
use fab_grammar::ast::{self, Call, Choose, Expr, Name, Rehearse, Revise, Trust};
use fab_program::{
    Cloth, Distrusted, Material, ModelRole, Read, Rehearsal, RehearsalMeasure, Stage, TwinRanges,
};

/// Builds the rehearsal of a stage; `None` in a base without stages.
pub(crate) fn check(
    part: Rehearse<'_>,
    merged: &Merged<'_>,
    context: &mut Context<'_>,
) -> Declared<Rehearsal> {
    let twins = once(part.twins(), "twin", Call::span, context.report);
    let choices = once(part.choices(), "choose", Choose::span, context.report);
    let revisions = once(part.revisions(), "revise", Revise::span, context.report);
    let trusts = once(part.trusts(), "trust", Trust::span, context.report);
    let lines = [
        ("twin", twins.is_some()),
        ("choose", choices.is_some() || revisions.is_some()),
        ("trust", trusts.is_some()),
    ];
    if lines.iter().any(|(_, is_there)| !is_there) {
        let help = "state, for example, `twin(material: cotton, size: 0.95 to 1.05, friction: 0.4 to 0.9) choose most overlap trust overlap > 0.8`";
        let block = format!("the rehearsal of `{}`", part.stage().text());
        let block = (block.as_str(), part.stage().span());
        context.lacking(Code::RehearsalIncomplete, block, &lines, help);
    }
    let stage = stage(part, context);
    let asked = stage.as_ref().ok().and_then(|it| it.as_ref());
    let twin = twins.map(|it| twin(it, context)).transpose();
    let choose = choices.map(|it| choose(it, asked, merged, context));
    let revisions = revisions.map(|it| revisions_of(it, asked, context));
    let trust_above = trusts.map(|it| read(it.above(), &TRUST.range, context));
    let distrusted = match trusts.and_then(Trust::else_refuse) {
        Some(_) => Distrusted::Refuses,
        None => Distrusted::StandsAside,
    };
    let (choose, revisions) = (choose.transpose()?, revisions.transpose()?);
    let (Some(twin), Some(trust_above), Some(stage)) = (twin?, trust_above.transpose()?, stage?)
    else {
        return Ok(None);
    };
    Ok(Some(Rehearsal {
        stage: stage.name,
        twin,
        choose,
        revisions: revisions.unwrap_or(0),
        trust_above,
        distrusted,
    }))
}

/// Returns the stage that is rehearsed; `None` in a base without stages.
fn stage(part: Rehearse<'_>, context: &mut Context<'_>) -> Declared<Stage> {
    if context.stages.0.is_empty() {
        return Ok(None);
    }
    let name = part.stage();
    let (_, stage) = context.stage(name)?;
    if stage.read != Read::Action {
        let message = format!("the stage `{}` does not read the action", stage.name);
        let help = "only an action can be tried on a twin: name the last stage";
        return Err(context.refuse(Code::WrongForm, name.span(), message, help));
    }
    Ok(Some(stage))
}

/// Reads what the twins are made of.
fn twin(line: Call<'_>, context: &mut Context<'_>) -> Result<TwinRanges> {
    let (mut twin, _, bound) = made("twin", Expr::Call(line), TWINS, context)?;
    if let Some((name, material)) = material::of_call(&bound, context)? {
        twin.material = material;
        if let Ok(Some(cloth)) = &context.cloth
            && is_own(&twin, cloth)
        {
            let friction = cloth.table_friction();
            if (twin.size, twin.friction) == ([1.0; 2], [friction; 2]) {
                return Err(judged_cloth(line, friction, context));
            }
            own_material(name, context);
        }
    }
    Ok(twin)
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
fn own_material(name: Name<'_>, context: &mut Context<'_>) {
    let material = name.text();
    let message = format!("the twin is made of `{material}`, as the task's cloth is");
    let help = "a simulated cloth would be rehearsed on its own physics, and the gain would say nothing about a real one; name another material";
    context.warn(Code::TwinOfOwnMaterial, name.span(), message, help);
}

/// Reports a twin that cannot differ from the judged cloth.
fn judged_cloth(line: Call<'_>, friction: f64, context: &mut Context<'_>) -> Reported {
    let message = format!(
        "the twin is the task's own cloth: the same material, of its size and with its friction of {friction}"
    );
    let help = "name another material, and for what is not known write ranges, such as `size: 0.95 to 1.05, friction: 0.4 to 0.9`";
    context.refuse(Code::TwinIsJudgedCloth, line.span(), message, help)
}

/// Reads the measure by which the best candidate is chosen.
fn choose(
    line: Choose<'_>,
    stage: Option<&Stage>,
    merged: &Merged<'_>,
    context: &mut Context<'_>,
) -> Result<RehearsalMeasure> {
    let name = line.measure();
    let word = context.word("rehearsal measure", name, RehearsalMeasure::WORDS)?;
    let measure = RehearsalMeasure::from_word(word).expect("a word of the table");
    if measure == RehearsalMeasure::Overlap
        && merged.subgoals().is_none()
        // Without a cloth, the task is there for others to extend, which may have subgoals.
        && merged.statement("cloth").is_some()
        && !merged.stages.is_empty()
    {
        let message = "`overlap` needs a subgoal to compare with, and the task has none";
        let help = "show `subgoals`, or write `choose most coverage`";
        return Err(context.refuse(Code::NotMeasuredOnTwin, name.span(), message, help));
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
        let help = "write `candidates 4` and a temperature above 0 behind its `model`";
        return Err(context.refuse(Code::RehearsalIncomplete, line.span(), message, help));
    }
    Ok(measure)
}

/// Reads how often an answer may be revised.
fn revisions_of(line: Revise<'_>, stage: Option<&Stage>, context: &mut Context<'_>) -> Result<u32> {
    let count = read_whole(line.count(), &REVISIONS.range, context)?;
    if let Some(stage) = stage.filter(|stage| stage.model == ModelRole::Text) {
        return Err(context.text_model(line.span(), "`revise`", &stage.name));
    }
    Ok(count as u32)
}

/// Reports candidates that would all be alike.
pub(crate) fn candidates(merged: &Merged<'_>, context: &mut Context<'_>) {
    for declared in merged.stages.iter() {
        let stage = context.stages.get(declared.name().text());
        let mut settings = declared.model().flat_map(ast::Model::settings);
        let (Ok(Some(stage)), Some(setting)) =
            (stage, settings.find(|it| it.name().text() == "candidates"))
        else {
            continue;
        };
        let at = match stage.temperature {
            Some(temperature) if temperature > 0.0 => continue,
            Some(_) => "at temperature 0",
            None => "without a temperature",
        };
        let message = format!("{} candidates are asked for {at}", stage.candidates());
        let help = "write a temperature above 0, such as `temperature 0.7`: equal questions would get equal answers";
        context.refuse(Code::CandidatesAlike, setting.span(), message, help);
    }
}
