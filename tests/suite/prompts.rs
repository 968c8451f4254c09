//! The exact prompts of the shipped tasks, pinned: a diff is read as the model would read the prompt.

use super::support::{fabc, finish, project};

fn rendered(task: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(fabc(folder.path()).args(["render", &project(&format!("tasks/{task}.fab"))]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    said.stdout
}

#[test]
fn the_prompts_of_double_straight_are_pinned() {
    insta::assert_snapshot!(rendered("double_straight"));
}

#[test]
fn the_prompts_of_double_triangle_are_pinned() {
    insta::assert_snapshot!(rendered("double_triangle"));
}

#[test]
fn the_prompts_of_all_corners_inward_are_pinned() {
    insta::assert_snapshot!(rendered("all_corners_inward"));
}

#[test]
fn the_prompts_of_corners_edges_inward_are_pinned() {
    insta::assert_snapshot!(rendered("corners_edges_inward"));
}
