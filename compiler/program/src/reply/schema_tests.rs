//! The names of texts, and prompts that ask for reasons.

use super::*;

#[test]
fn a_text_has_one_property_named_after_the_words_before_it() {
    for (before, name) in [
        ("Instructions:", "instructions"),
        ("- The plan, in words =", "the_plan__in_words"),
    ] {
        let schema = text_schema(before);
        let properties = schema["properties"].as_object().expect("a table");
        assert_eq!(properties.keys().collect::<Vec<_>>(), [name]);
        assert_eq!(schema["required"], json!([name]));
        let answer = json!({ name: "Fold it." }).to_string();
        let read = crate::reply::read_text(before, "", &answer).map(|it| it.value);
        assert_eq!(read.as_deref(), Ok("Fold it."), "{before}");
    }
}

#[test]
fn a_prompt_asks_for_reasons_in_many_words_and_wants_none_in_others() {
    for asking in [
        "then give your reason",
        "explain your choice",
        "state your rationale first",
        "think step-by-step",
        "say why you chose it",
    ] {
        assert!(wants_reasons(asking), "{asking}");
    }
    for other in [
        "give no reason",
        "do not explain",
        "for this reason stay on the cloth",
        "there is no reason to hurry",
        "without explanations",
        "begin your answer with these two lines",
    ] {
        assert!(!wants_reasons(other), "{other}");
    }
}
