//! Names of tasks, and what is suggested in their place.

use super::*;

#[test]
fn what_is_no_name_is_refused_with_one_that_is() {
    for (name, right) in [
        ("9lives", "my_9lives"),
        ("tea towel", "tea_towel"),
        ("towel.fab", "towel"),
        ("tasks/towel", "tasks_towel"),
        ("fold", "my_fold"),
        ("task", "my_task"),
        ("Küche", "K_che"),
        ("", "my"),
        ("../../x", "x"),
        ("a\u{1b}[2J", "a_2J"),
    ] {
        let failure = check(name).err().map(|failure| failure.to_string());
        let message = failure.unwrap_or_default();
        assert!(
            message.ends_with(&format!("`{right}` would be right")),
            "{name}: {message}"
        );
        assert!(!message.contains('\u{1b}'), "{message}");
        assert!(check(right).is_ok(), "{right}");
    }
}

#[test]
fn names_are_not_longer_than_a_file_name_may_be() {
    assert!(check(&"a".repeat(LONGEST)).is_ok());
    assert!(check(&"a".repeat(LONGEST + 1)).is_err());
}
