//! Compiles tasks for a cloth with another grid than they declare.

use crate::common::Memory;
use fab_compiler::diag::Severity;
use fab_compiler::{Compiled, compile_for};
use fab_program::Program;
use proptest::prelude::*;

/// A task whose every section depends on the cloth.
const TASK: &str = r#"
task sized {
    const near = 0.23edge

    cloth   grid(41, 41)
    camera  top_down(height: 1000mm, fov: 45deg, image: 720px)
    horizon 5
    goal    coverage > 0.9

    keypoints {
        cloth   = mask(depth < 999mm)
        corners = shi_tomasi(cloth, of: mask, max: 15, quality: 0.1, spacing: 20px)
        center  = centroid(cloth)
    }

    actions {
        pick:      one of corners
        direction: one of 0deg, 90deg, 180deg, 270deg
        distance:  one of 0.1edge, 0.5edge, 1edge
    }

    stage act {
        model text
        say   "{{ corners }} cover {{ coverage(cloth) }}; {{ near in mm }}. {{ actions.format }}"
        read  action
    }

    verify {
        check far { distance(pick, center) > near in px and coverage(cloth) > 0.1 } else "Too near."
    }
}
"#;

fn compiled(text: &str, grid: Option<[u32; 2]>) -> Compiled {
    compile_for("sized.fab", &Memory::of([("sized.fab", text)]), grid).unwrap()
}

/// Returns the program without the references to its text.
fn program(compiled: Compiled) -> Program {
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    let mut program = compiled.programs.into_iter().next().unwrap();
    program.sources.clear();
    program
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_program_for_a_grid_is_that_of_the_text_that_declares_it(dimx in 2u32..=200, dimy in 2u32..=200) {
        let written = TASK.replace("grid(41, 41)", &format!("grid({dimx}, {dimy})"));
        let as_declared = program(compiled(&written, None));
        let for_the_grid = program(compiled(TASK, Some([dimx, dimy])));
        prop_assert_eq!(as_declared, for_the_grid);
    }
}

#[test]
fn lengths_in_edge_are_those_of_the_given_cloth() {
    let of = |grid| serde_json::to_value(program(compiled(TASK, grid)).actions).unwrap();
    let far = |grid| of(grid)[2]["choices"]["choices"][2]["m"].as_f64().unwrap();
    assert!((far(None) - 0.25).abs() < 1e-12);
    assert!((far(Some([21, 11])) - 0.125).abs() < 1e-12);
}

#[test]
fn a_grid_that_no_cloth_may_have_is_told_with_its_numbers() {
    for grid in [[1, 40], [40, 201], [0, 0], [u32::MAX, 2]] {
        let compiled = compiled(TASK, Some(grid));
        assert!(compiled.programs.is_empty());
        let errors = compiled.diagnostics.iter();
        let errors: Vec<_> = errors.filter(|it| it.severity == Severity::Error).collect();
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert!(
            errors[0].message.contains(&grid[0].to_string()),
            "{errors:?}"
        );
        assert!(errors[0].help[0].contains("2 to 200"), "{errors:?}");
    }
}

#[test]
fn a_percentage_is_compared_as_the_fraction_that_it_is() {
    let fraction = "coverage(cloth) > 0.1";
    let checks = |compared: &str| program(compiled(&TASK.replace(fraction, compared), None)).verify;
    let expected = checks(fraction);
    assert_eq!(checks("coverage(cloth) in percent > 10"), expected);
    assert_ne!(checks("coverage(cloth) > 10"), expected);
}
