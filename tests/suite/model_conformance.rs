//! What every [`Model`] must do; add a line at the end for each new model.

use super::support::{self, Scripted};
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Budget, Ledger};
use fab_model::{Message, Model, Part, Png, Request, Speaker};
use fab_program::ModelRole;
use fab_providers::Remote;
use fab_providers::remote::{Answers, BaseUrl, Gate, Settings, Shared, Wire};
use fab_standins::imperfect::Errors;
use fab_standins::{Geometric, Imperfect, Random};
use fab_test_provider::{Provider, Response};
use std::sync::Arc;

/// Fails with the name of the promise that a model breaks.
fn conforms(make: &dyn Fn() -> Box<dyn Model>) {
    let model = make();
    assert!(!model.name().is_empty());
    for request in requests() {
        let first = make().ask(&request, &mut Ledger::unwritten(&Budget::default()));
        let again = make().ask(&request, &mut Ledger::unwritten(&Budget::default()));
        match (first, again) {
            (Ok(first), Ok(again)) => assert_eq!(
                first, again,
                "equal requests have different replies at repetition 0"
            ),
            (Err(first), Err(again)) => assert_eq!(first.to_string(), again.to_string()),
            (first, again) => panic!("answers once and fails once: {first:?}, {again:?}"),
        }
    }
}

/// Valid and invalid questions; none may make a model panic.
fn requests() -> Vec<Request> {
    let text = |words: &str| Part::Text(words.to_owned());
    let user = |parts: Vec<Part>| {
        vec![Message {
            speaker: Speaker::User,
            parts,
        }]
    };
    let noise = Part::Image(Png::new(vec![7; 300]));
    let blank = Part::Image(Png::new(fab_picture::png::encode(&image::RgbImage::new(
        32, 32,
    ))));
    let conversations = vec![
        Vec::new(),
        user(Vec::new()),
        user(vec![text("")]),
        user(vec![text("fold it"), noise.clone()]),
        user(vec![text("fold it"), blank.clone(), blank.clone()]),
        user(vec![blank.clone(), noise, blank]),
        user(vec![text(
            "- Cloth corners: (999999999999, -4), (NaN, 3)\n- Cloth center: ()",
        )]),
        user(vec![text(
            "- Method of folding: pick the left corner\n- Cloth corners: (1, 2)\n- Cloth center: (1, 2)",
        )]),
        user(vec![text(&"(1, 2), ".repeat(20_000))]),
        vec![Message::text(Speaker::Assistant, "Pick Point = (1, 2)")],
    ];
    let request = |(role, messages)| Request::new(role, messages);
    let both = conversations.into_iter().flat_map(|messages| {
        [
            (ModelRole::Vision, messages.clone()),
            (ModelRole::Text, messages),
        ]
    });
    let mut all: Vec<Request> = both.map(request).collect();
    let bare = all[9].clone();
    all.extend(schemas().into_iter().map(|schema| Request {
        schema: Some(schema),
        ..bare.clone()
    }));
    all
}

/// Valid and invalid answer schemas.
fn schemas() -> Vec<serde_json::Value> {
    use serde_json::json;
    let field = |values: serde_json::Value| json!({ "type": "string", "enum": values });
    vec![
        json!({ "properties": { "pick": field(json!(["(1, 2)", "(3, 4)"])), "place": field(json!(["(5, 6)"])) } }),
        json!({ "properties": { "pick": field(json!([])) } }),
        json!({ "properties": { "pick": field(json!([1, null])), "direction": field(json!(["x deg", " deg"])) } }),
        json!({ "properties": { "pick": { "type": "string", "pattern": "^$" } } }),
        json!({ "properties": 3 }),
        json!([]),
    ]
}

#[test]
fn the_geometric_stand_in_conforms() {
    conforms(&|| Box::new(Geometric));
}

#[test]
fn the_random_policy_conforms() {
    conforms(&|| Box::new(Random::seeded(3)));
}

#[test]
fn the_imperfect_stand_in_conforms() {
    for rate in [0.0, 0.5, 1.0] {
        conforms(&|| Box::new(Imperfect::new(rate, 3, Errors::Mixed).unwrap()));
    }
}

#[test]
fn the_scripted_double_conforms() {
    conforms(&|| Box::new(Scripted::new(&["one answer"])));
}

#[test]
fn a_providers_model_conforms() {
    let provider = Provider::playing(vec![Response::answer("one answer", 9, 2)]);
    conforms(&|| {
        let base = BaseUrl::parse(provider.base_url()).unwrap();
        let shared = Shared {
            tell: Arc::new(|_| {}),
            gate: Arc::new(Gate::new(1)),
            answers: Arc::new(Answers::none()),
            interrupt: Interrupt::default(),
            hidden: Vec::new(),
        };
        let settings = Settings::new("compatible", "a-model", Wire::OpenaiChat, base);
        Box::new(Remote::new(settings, shared).unwrap())
    });
}

#[test]
fn the_stand_in_is_called_one() {
    assert_eq!(Geometric.nature(), fab_model::ModelKind::StandIn);
    assert_eq!(support::task("double_straight").stages.len(), 2);
}

#[test]
fn a_requests_key_covers_every_part_of_it() {
    let base = requests().remove(9);
    let mut keys = vec![base.key()];
    let mut change = |change: &dyn Fn(&mut Request)| {
        let mut changed = base.clone();
        change(&mut changed);
        keys.push(changed.key());
    };
    change(&|request| {
        request.role = if request.role == ModelRole::Text {
            ModelRole::Vision
        } else {
            ModelRole::Text
        }
    });
    change(&|request| request.temperature = Some(0.0));
    change(&|request| request.max_tokens = Some(5));
    change(&|request| request.repetition = 1);
    change(&|request| request.step = 2);
    change(&|request| request.schema = Some(serde_json::json!({ "type": "object" })));
    change(&|request| request.messages.push(Message::text(Speaker::User, "")));
    change(&|request| {
        request.messages[0]
            .parts
            .push(Part::Image(Png::new(vec![1])))
    });
    change(&|request| {
        request.messages[0]
            .parts
            .push(Part::Image(Png::new(vec![2])))
    });
    let count = keys.len();
    keys.sort();
    keys.dedup();
    assert_eq!(keys.len(), count, "two different requests have one key");
}
