//! `prompts/*.txt.j2`: one template per stage and speaker, and one per check.
//!
//! They use the subset of Jinja described in [`fab_program::render`]. A conditional part is inside a guard,
//! `when["NAME"]`, a string that is empty if the part is left out. The guard is an index expression because Python's
//! jinja2 takes `when.items` for a method.

use crate::artifact::Artifact;
use crate::error::{EmitError, plain_name};
use fab_program::eval::{Eval, Notes};
use fab_program::facts::Facts;
use fab_program::pointing::Pointing;
use fab_program::render::{self, RenderError, SEPARATOR};
use fab_program::{Program, Template, Variable};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The variable that holds the guards, by template name.
const GUARDS: &str = "when";

/// Writes every prompt; examples are literal and stay in the program.
pub(super) fn emit(program: &Program) -> Result<Vec<Artifact>, EmitError> {
    let mut artifacts = Vec::new();
    let mut add = |name: String, text: String| {
        artifacts.push(Artifact {
            path: format!("prompts/{name}.txt.j2"),
            text,
        });
    };
    for stage in &program.stages {
        let name = plain_name(&stage.name)?;
        if !stage.system.is_empty() {
            add(format!("{name}.system"), joined(program, &stage.system)?);
        }
        add(format!("{name}.user"), joined(program, &stage.say)?);
    }
    for check in &program.verify.checks {
        let template = find(program, &check.message)?;
        let name = plain_name(&check.name)?;
        add(format!("check.{name}"), source(program, template));
    }
    if let Some(result) = &program.verify.result {
        let template = find(program, &result.message)?;
        add(result.message.clone(), source(program, template));
    }
    Ok(artifacts)
}

fn find<'p>(program: &'p Program, name: &str) -> Result<&'p Template, EmitError> {
    let template = program.template(name).ok_or_else(|| EmitError::Reference {
        name: name.to_owned(),
        wanted: "a template",
    })?;
    for variable in &template.variables {
        plain_name(&variable.name)?;
        if variable.name.split('.').next() == Some(GUARDS) {
            return Err(EmitError::Name {
                name: variable.name.clone(),
            });
        }
    }
    Ok(template)
}

/// Returns the text of a variable that is constant in an emitted prompt, where points are always in pixels.
fn constant(program: &Program, variable: &Variable) -> Option<String> {
    let pointing = Pointing::of_camera(&program.camera);
    render::constant(program, &pointing, &variable.value)
}

/// Returns a template's source with its constants filled in.
fn source(program: &Program, template: &Template) -> String {
    let mut text = template.text.clone();
    for variable in &template.variables {
        if let Some(words) = constant(program, variable) {
            text = text.replace(
                &render::placeholder(&variable.name),
                &render::escaped(&words),
            );
        }
    }
    text
}

/// Joins templates with blank lines, without those whose guard is empty.
fn joined(program: &Program, names: &[String]) -> Result<String, EmitError> {
    let parts = names
        .iter()
        .map(|name| find(program, name))
        .collect::<Result<Vec<_>, _>>()?;
    let said = unused_name(program);
    let first_certain = parts.iter().position(|part| part.when.is_none());
    let mut text = String::new();
    if first_certain.is_none() && parts.len() > 1 {
        text.push_str(&format!("{{% set {said} = \"\" %}}"));
    }
    for (index, part) in parts.iter().enumerate() {
        let follows = first_certain.is_some_and(|certain| index > certain);
        let is_first_certain = first_certain == Some(index);
        let body = closed(&source(program, part));
        if part.when.is_none() {
            // The parts before the first unconditional one bring their own separators.
            text.push_str(if is_first_certain { "" } else { SEPARATOR });
            text.push_str(&body);
            continue;
        }
        text.push_str(&format!(
            "{{% if {GUARDS}[\"{}\"] %}}",
            plain_name(&part.name)?
        ));
        match first_certain {
            Some(_) if follows => text.push_str(&format!("{SEPARATOR}{body}")),
            Some(_) => text.push_str(&format!("{body}{SEPARATOR}")),
            None => {
                if index > 0 {
                    text.push_str(&format!("{{% if {said} %}}{SEPARATOR}{{% endif %}}"));
                }
                text.push_str(&body);
                if index + 1 < parts.len() {
                    text.push_str(&format!("{{% set {said} = \"yes\" %}}"));
                }
            }
        }
        text.push_str("{% endif %}");
    }
    Ok(text)
}

/// Escapes a brace at the end of a text, which Jinja would join with the next tag.
fn closed(text: &str) -> String {
    match text.strip_suffix('{') {
        Some(before) => format!("{before}{{{{ \"{{\" }}}}"),
        None => text.to_owned(),
    }
}

/// Returns a name that no text of the program uses, for the flag that a part was already written.
fn unused_name(program: &Program) -> String {
    let mut name = "said".to_owned();
    let is_used = |name: &str| {
        let mut variables = program.templates.iter().flat_map(|it| &it.variables);
        variables.any(|variable| variable.name.split('.').next() == Some(name))
    };
    while is_used(&name) {
        name.push('_');
    }
    name
}

/// Returns the values that the emitted prompts of these templates need: the variables, and the guards under `when`.
///
/// A guard is `"yes"` or empty. A part that is left out needs no variables. Fails if a value is missing that is
/// needed.
pub fn guards_and_values(
    program: &Program,
    templates: &[String],
    facts: Facts<'_>,
) -> Result<Value, RenderError> {
    let mut guards = Map::new();
    let mut values = BTreeMap::new();
    for name in templates {
        let template = program
            .template(name)
            .ok_or_else(|| RenderError::UnknownTemplate {
                template: name.clone(),
            })?;
        let mut is_said = true;
        if let Some(when) = &template.when {
            is_said = Eval { program, facts }.holds(when, &mut Notes::new())?;
            let guard = if is_said { "yes" } else { "" };
            guards.insert(name.clone(), Value::from(guard));
        }
        if is_said {
            let known = render::values(program, template, render::Values::Known(facts))?;
            let constants = template
                .variables
                .iter()
                .filter(|variable| constant(program, variable).is_some());
            let constants: Vec<&str> = constants.map(|it| it.name.as_str()).collect();
            values.extend(
                known
                    .into_iter()
                    .filter(|(name, _)| !constants.contains(&name.as_str())),
            );
        }
    }
    let mut context = Map::new();
    context.extend(
        values
            .into_iter()
            .map(|(name, text)| (name, Value::from(text))),
    );
    if !guards.is_empty() {
        context.insert(GUARDS.to_owned(), Value::Object(guards));
    }
    Ok(Value::Object(context))
}

/// Renders an emitted prompt with the settings of the template engine that it is written for.
///
/// - `values`: an object of strings and of such objects, as [`guards_and_values`] returns it.
///
/// Fails with the reason if a value is missing or the text is not a template.
pub fn fill(template: &str, values: &Value) -> Result<String, String> {
    render::fill(template, &entries(values))
}

fn entries(values: &Value) -> BTreeMap<String, minijinja::Value> {
    let entry = |(name, value): (&String, &Value)| {
        let value = match value {
            Value::Object(_) => minijinja::Value::from(entries(value)),
            Value::String(text) => minijinja::Value::from(text.as_str()),
            other => minijinja::Value::from(other.to_string()),
        };
        (name.clone(), value)
    };
    let object = values.as_object();
    object.into_iter().flatten().map(entry).collect()
}
