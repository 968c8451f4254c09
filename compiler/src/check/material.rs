//! `material NAME { weight 420g/m2 from "…" … }`: what a cloth is made of.

use super::arguments::{Bound, bind, form};
use super::context::{Context, Result};
use super::expressions::{material_name, values, without_edge};
use super::short_text::line;
use crate::diag::{Code, Diagnostic};
use crate::lang::material::{self, PROPERTIES};
use crate::merge::repeated;
use fab_grammar::ast::{self, File, Name, Text};
use fab_program::data::material::{Directions, RECORDED, Source};
use fab_program::vocabulary::Kind;
use fab_program::{Colour, Face, Material};
use std::collections::BTreeMap;

/// The most characters of a source: about five lines.
const MAX_SOURCE_CHARS: usize = 500;

/// Reads a declared material.
pub(crate) fn check(declared: ast::Material<'_>, context: &mut Context<'_>) -> Result<Material> {
    // The constants of a task mean nothing here, and `edge` has no size.
    let name = declared.name();
    let mut all = Ok(());
    if name.text() == RECORDED {
        let message = format!("`{RECORDED}` is the cloth of the recorded scene");
        let help = "choose another name for the material";
        all = Err(context.refuse(Code::DuplicateName, name.span(), message, help));
    }
    let zero = Directions {
        warp: 0.0,
        weft: 0.0,
        bias: 0.0,
    };
    let mut material = Material {
        name: name.text().to_owned(),
        weight_kg_m2: 0.0,
        thickness_m: 0.0,
        bending_length_m: zero,
        crease_recovery_deg: 0.0,
        stretch: zero,
        table_friction: 0.0,
        self_friction: 0.0,
        upper: Colour::recorded(Face::Upper),
        under: Colour::recorded(Face::Under),
        sources: Vec::new(),
    };
    let mut given: BTreeMap<&str, Name<'_>> = BTreeMap::new();
    for property in declared.properties() {
        let word = property.name();
        let first = *given.entry(word.text()).or_insert(word);
        if first.span() != word.span() {
            let diagnostic = repeated(word.text(), first.span(), word.span());
            all = Err(context.error(diagnostic));
        } else if let Err(reported) = set(property, &mut material, context) {
            all = Err(reported);
        }
    }
    // A misspelt property is not missing too.
    all?;
    let needed = PROPERTIES.iter().filter(|row| row.face.is_none());
    let needed = needed.map(|row| &row.call.signature);
    let mut missing = needed.clone().filter(|it| !given.contains_key(it.name));
    if let Some(first) = missing.next() {
        let lines: Vec<_> = needed
            .map(|it| (it.name, given.contains_key(it.name)))
            .collect();
        let block = format!("the material `{}`", name.text());
        let block = (block.as_str(), name.span());
        let help = format!("write `{}`", material::form(first));
        return Err(context.lacking(Code::MaterialIncomplete, block, &lines, &help));
    }
    Ok(material)
}

/// Reads one property into a material.
fn set(
    property: ast::Property<'_>,
    material: &mut Material,
    context: &mut Context<'_>,
) -> Result<()> {
    let word = property.name();
    let rows = || PROPERTIES.iter().map(|row| &row.call.signature);
    let found = property
        .call()
        .and_then(|call| Some((call, form(call, rows())?)));
    let Some((call, (index, signature))) = found else {
        return Err(context.unknown("property of a material", word, rows().map(|row| row.name)));
    };
    let row = &PROPERTIES[index];
    let written = material::form(signature);
    let bound = bind(call, signature, material::form, context)?;
    let args = values(&bound, signature, context)?;
    let message = "a material has no `edge`: cloths of many sizes are made of it";
    without_edge(&args, &bound, message, context)?;
    (row.call.make)(material, &args);
    let (text, cited) = (property.text(), property.cited());
    let (code, span, message, help) = match (row.face, text, cited) {
        (Some(face), Some(text), _) => {
            let rgb = rgb(text, context)?;
            match face {
                Face::Upper => material.upper.rgb = rgb,
                Face::Under => material.under.rgb = rgb,
            }
            return Ok(());
        }
        (None, None, Some(cited)) => {
            material.sources.push(Source {
                property: word.text().to_owned(),
                from: line(cited, "a source", MAX_SOURCE_CHARS, context)?,
            });
            return Ok(());
        }
        (Some(_), None, _) => (
            Code::MaterialIncomplete,
            word.span(),
            format!("`{}` does not say which colour that is", word.text()),
            format!("write `{written}`"),
        ),
        (None, Some(text), _) => (
            Code::WrongForm,
            text.span(),
            format!("a text beside `{}` has no meaning", word.text()),
            "write `from` before it, if it says where the value comes from".to_owned(),
        ),
        (None, None, None) => (
            Code::MaterialIncomplete,
            word.span(),
            format!("`{}` does not say where its value comes from", word.text()),
            "write `from \"…\"` behind the value: a publication, or how you measured it".to_owned(),
        ),
    };
    Err(context.refuse(code, span, message, help))
}

/// Reads `"#ff7100"` as red, green and blue.
fn rgb(text: Text<'_>, context: &mut Context<'_>) -> Result<[u8; 3]> {
    let plain = text.plain().unwrap_or_default();
    let digits = plain.strip_prefix('#').filter(|it| it.len() == 6);
    let number = digits
        .filter(|it| it.chars().all(|digit| digit.is_ascii_hexdigit()))
        .and_then(|it| u32::from_str_radix(it, 16).ok());
    let Some(number) = number else {
        let written = context.written(text.span());
        let message = format!("expected a colour, found `{written}`");
        let help = "a colour is `#` with two hexadecimal digits each for red, green and blue, such as `\"#ff7100\"`";
        return Err(context.refuse(Code::WrongForm, text.span(), message, help));
    };
    let [_, red, green, blue] = number.to_be_bytes();
    Ok([red, green, blue])
}

/// Reads the material that a call names, with that name; `None` if it names none.
pub(super) fn of_call<'a>(
    bound: &Bound<'a>,
    context: &mut Context<'_>,
) -> Result<Option<(Name<'a>, Option<Material>)>> {
    let mut materials = bound.iter();
    let Some((_, expr)) = materials.find(|(arg, _)| matches!(arg.kind, Kind::Material)) else {
        return Ok(None);
    };
    let name = material_name(*expr, context)?;
    Ok(Some((name, named(name, context)?)))
}

/// Reads the material of this name; `None` is the recorded cloth.
fn named(name: Name<'_>, context: &mut Context<'_>) -> Result<Option<Material>> {
    if name.text() == RECORDED {
        return Ok(None);
    }
    let file = name.span().file;
    if let Some(declared) = context.loaded.material(file, name.text()) {
        return context.outside.materials[&declared.span()]
            .clone()
            .map(Some);
    }
    let seen = context.loaded.visible_from(file);
    let names = seen.flat_map(File::materials).map(|it| it.name().text());
    let message = format!("there is no material `{}`", name.text());
    let diagnostic = Diagnostic::new(Code::UnknownName, name.span(), message)
        .about(name.text())
        .suggest(name.text(), names.chain([RECORDED]), "");
    let mut seen = context.loaded.visible_from(file);
    let library = "lib/materials.fab";
    if seen.any(|file| {
        context
            .loaded
            .portable_name(file.span().file)
            .ends_with(library)
    }) {
        return Err(context.error(diagnostic));
    }
    let help = "the shipped ones need `use \"lib/materials.fab\"` at the top of this file";
    Err(context.error(diagnostic.help(help)))
}
