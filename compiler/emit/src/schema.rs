//! `actions.schema.json`: the JSON Schema of an answer, independent of the scene.

use fab_program::Program;
use fab_program::reply;
use serde_json::json;

/// Writes the schema, indented, with a line end.
pub(super) fn emit(program: &Program) -> String {
    let mut schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": format!("an action of the task {}", program.title()),
    });
    if let (Some(whole), Some(action)) = (
        schema.as_object_mut(),
        reply::static_schema(program).as_object(),
    ) {
        whole.extend(action.clone());
    }
    let mut text = serde_json::to_string_pretty(&schema).expect("a JSON value can be written");
    text.push('\n');
    text
}
