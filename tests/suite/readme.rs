//! The README's task is a task: it compiles as it stands there.

use super::support::{ProjectFiles, root};
use compiler::{LoadError, Loader};

/// The project's files, and the README's task where the README says to write it.
struct WithReadme(String);

impl Loader for WithReadme {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        match name {
            "tasks/triangle.fab" => Ok(self.0.clone()),
            _ => ProjectFiles.load(name),
        }
    }
}

#[test]
fn the_task_in_the_readme_compiles_without_a_word() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    assert!(readme.contains("Write that as `tasks/triangle.fab`"));
    let begin = readme.find("```fab\n").unwrap() + "```fab\n".len();
    let task = &readme[begin..begin + readme[begin..].find("```").unwrap()];
    let compiled = compiler::compile("tasks/triangle.fab", &WithReadme(task.to_owned())).unwrap();
    assert!(
        compiled.diagnostics.is_empty(),
        "{:?}",
        compiled.diagnostics
    );
    assert_eq!(compiled.programs[0].task, "triangle");
    assert_eq!(compiled.programs[0].experts.len(), 1);
}
