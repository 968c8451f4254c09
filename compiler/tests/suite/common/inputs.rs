//! Generated inputs that would show work growing faster than the text: one piece of each kind, repeated.
//!
//! An `@` in a piece is replaced by the number of the repetition, so names differ.

#![allow(dead_code)]

#[path = "inputs_of_names.rs"]
mod names;

/// A text that can be made of any length.
pub struct Input {
    /// Its name in reports.
    pub name: &'static str,
    make: Make,
}

enum Make {
    /// The text before, the repeated piece, and the text after.
    Repeated(&'static str, &'static str, &'static str),
    Written(fn(usize) -> String),
}

pub const fn input(
    name: &'static str,
    before: &'static str,
    piece: &'static str,
    after: &'static str,
) -> Input {
    Input {
        name,
        make: Make::Repeated(before, piece, after),
    }
}

/// Returns every input.
pub fn all() -> impl Iterator<Item = &'static Input> {
    INPUTS.iter().chain(names::NAMES).chain(WRITTEN)
}

impl Input {
    /// Returns the text, as near to `bytes` as whole pieces allow.
    pub fn text(&self, bytes: usize) -> String {
        let (before, piece, after) = match self.make {
            Make::Repeated(before, piece, after) => (before, piece, after),
            Make::Written(write) => return write(bytes),
        };
        let mut text = before.to_owned();
        let mut number = 0usize;
        while text.len() + piece.len() + after.len() < bytes {
            text.push_str(&piece.replace('@', &number.to_string()));
            number += 1;
        }
        text.push_str(after);
        text
    }
}

const GOAL: &str = "goal ((((((((((((((((((((((((1mm))))))))))))))))))))))))\n";
const WHOLE: &str = concat!(
    "task t@ {\n cloth grid(55, 44)\n camera top_down(height: 650mm, fov: 45deg, image: 224px)\n",
    " subgoals { demonstrate { fold corner(back_left) -> corner(front_left) } }\n",
    " keypoints { cloth = mask(depth < 646mm) center = centroid(cloth) }\n",
    " actions { pick: one of center place: one of center }\n",
    " stage plan { model text say \"{{ center }} {{ actions.format }}\" read action }\n}\n",
);
const KEYPOINTS: &str = "task t {\nkeypoints {\n";
const STAGE: &str = "task t {\nstage s {\n";

/// One input for each part of the language that repeats, nests, or can be wrong.
const INPUTS: &[Input] = &[
    // Nested, and on one line.
    input("nested groups", "task t {\n", GOAL, "}\n"),
    input(
        "nested calls",
        KEYPOINTS,
        "k@ = f(f(f(f(f(f(f(f(f(f(f(f(f(f(f(f(f(f(f(f(1))))))))))))))))))))\n",
        "}}\n",
    ),
    input(
        "nested calls that do not close",
        KEYPOINTS,
        "k@ = f(1, f(1, f(1, f(1, f(1, f(1, f(1, f(1\n}}task u { keypoints {\n",
        "}}\n",
    ),
    input(
        "nested junk blocks",
        "task t {\n",
        "? {{{{{{{{{{ ? }}}}}}}}}}\n",
        "}\n",
    ),
    input(
        "nested junk blocks that do not close",
        "",
        "task t@ { ? { { { {\n",
        "",
    ),
    input(
        "one long line of arguments",
        "task t {\ngoal f(",
        "a: 1mm, ",
        "b)\n}\n",
    ),
    input(
        "one long line of alternatives",
        "task t {\ngoal a",
        " or a and b",
        "\n}\n",
    ),
    input(
        "one long line of negations",
        "task t {\ngoal ",
        "not ",
        "a\n}\n",
    ),
    input("one long line of junk", "task t {\n", "? ", "\n}\n"),
    input("one long line of words", "task t {\n", "x ", "\n}\n"),
    input("one long line of stages", "task t {\n", "stage s ", "\n}\n"),
    input(
        "one long line of sections",
        "task t {\n",
        "subgoals ",
        "\n}\n",
    ),
    input("one long line of tasks", "", "task t extends ", "\n"),
    input("one long line of whole tasks", "", "task t@ { } ", "\n"),
    input("one long line of experts", "", "experts e ", "\n"),
    input(
        "one long line of checks",
        "task t {\nverify {\n",
        "check c { a } ",
        "}}\n",
    ),
    input("one long line of strays", "", "} ", "\n"),
    input("one long line of uses", "", "use x ", "\n"),
    input("one long line of quoted uses", "", "use \"\" ", "\n"),
    input(
        "one long line of overrides",
        "task t {\n",
        "override ",
        "\n}\n",
    ),
    input(
        "one long line of folds",
        "task t {\nsubgoals {\ndemonstrate {\nfold a -> b",
        ", a -> b",
        "\n}}}\n",
    ),
    input(
        "one long line of half folds",
        "task t {\nsubgoals {\ndemonstrate {\n",
        "fold a -> ",
        "\n}}}\n",
    ),
    input("one long name", "task ", "a", " { }\n"),
    input("one long unit", "task t {\ngoal 1", "m", "\n}\n"),
    input("one long number", "task t {\ngoal ", "9", "\n}\n"),
    // Blanks and comments.
    input("blanks", "task t {\n horizon 1", " ", "\n}\n"),
    input("blank lines", "task t {\n horizon 1", "\n", "\n}\n"),
    input("blanks before strays", "", " ", "?"),
    input(
        "comments",
        "task t {\n horizon 1\n",
        "# a comment\n",
        "\n}\n",
    ),
    input(
        "comments among junk",
        "task t {\n",
        "? # a comment\n# another\n",
        "\n}\n",
    ),
    input("carriage returns", "task t {\n horizon 1\n", "\r", "\n}\n"),
    // Junk of each block, and text that looks like a beginning.
    input("junk in a file", "", "junk @\n", ""),
    input("junk in a task", "task t {\n", "junk @\n", "}\n"),
    input("junk in keypoints", KEYPOINTS, "= @\n", "}}\n"),
    input("half keypoints", KEYPOINTS, "k@ =\n", "}}\n"),
    input(
        "keypoints with a word too many",
        KEYPOINTS,
        "k@ = mask(depth < 1mm) x\n",
        "}}\n",
    ),
    input("junk in a stage", STAGE, "sho x\n", "}}\n"),
    input("says with a word too many", STAGE, "say a b\n", "}}\n"),
    input("commas at ends", STAGE, "say a,\n", "}}\n"),
    input(
        "junk in verify",
        "task t {\nverify {\n",
        "chek a { b } else \"\"\n",
        "}}\n",
    ),
    input(
        "checks that do not close",
        "task t {\nverify {\n",
        "check c { a\n",
        "}}\n",
    ),
    input(
        "checks without conditions",
        "task t {\nverify {\n",
        "check c { } else\n",
        "}}\n",
    ),
    input(
        "conditions that do not fit",
        "task t {\nverify {\n",
        "check c { 1 + 1 } else \"\"\n",
        "}}\n",
    ),
    input(
        "one long condition that does not fit",
        "task t {\nverify {\ncheck c {\n",
        "1 + 1\n",
        "}}}\n",
    ),
    input("half items", "", "task\n", ""),
    input("items without braces", "", "task t@\n", ""),
    input("items that do not close", "", "task t@ {\n", ""),
    input(
        "experts that do not close",
        "",
        "experts e@ { sequence { fold\n",
        "",
    ),
    input(
        "stages that do not close",
        "task t {\n",
        "stage s@ {\n",
        "}\n",
    ),
    input("stages without names", "task t {\n", "stage { }\n", "}\n"),
    input("surplus words", "task t {\n", "stage s x y z { }\n", "}\n"),
    input("closing braces", "", "}\n", ""),
    input("sections outside", "", "goal a\n", ""),
    input("opening braces in junk", "", "task t { ? {\n }}\n", ""),
];

/// Inputs that are not one piece repeated.
const WRITTEN: &[Input] = &[
    Input {
        name: "a chain of tasks",
        make: Make::Written(chain),
    },
    Input {
        name: "a large base and what extends it",
        make: Make::Written(large_base),
    },
];

/// Returns a chain of tasks in which each extends the one after it.
fn chain(bytes: usize) -> String {
    let mut text = String::new();
    let mut number = 0usize;
    while text.len() < bytes {
        text.push_str(&format!("task t{number} extends t{} {{ }}\n", number + 1));
        number += 1;
    }
    text
}

/// Returns one large task, and tasks that extend it, which fill the other half of the bytes.
fn large_base(bytes: usize) -> String {
    let mut text = "task base {\nkeypoints {\n".to_owned();
    let mut number = 0usize;
    while text.len() < bytes / 4 {
        text.push_str(&format!("k{number} = mask(depth < 1mm)\n"));
        number += 1;
    }
    text.push_str("}\n");
    while text.len() < bytes / 2 {
        text.push_str(&format!(
            "component c{number} \"\"\"\n  some text\n  \"\"\"\n"
        ));
        number += 1;
    }
    text.push_str("}\n");
    while text.len() < bytes {
        text.push_str(&format!("task t{number} extends base {{ }}\n"));
        number += 1;
    }
    text
}

/// Returns `task`, one valid task, with enough components added for 200 lines.
pub fn two_hundred_lines(task: &str) -> String {
    let body = task.trim_end().strip_suffix('}').unwrap_or(task);
    let mut text = body.to_owned();
    let mut number = 0usize;
    while text.lines().count() < 194 {
        text.push_str(&format!(
            "\n    component note_{number} \"\"\"\n        Note {number}: {{{{ corners }}}} are the corners of the cloth.\n        \"\"\"\n"
        ));
        number += 1;
    }
    text.push_str("}\n");
    text
}
