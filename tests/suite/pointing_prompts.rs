//! Frames other than pixels: demonstrations, the missing sentence of a prompt, and tasks that cannot be asked this way.

use super::pointing::Silent;
use super::support::{self, Scripted, Trial, words_of};
use fab_agent::examples::Examples;
use fab_compiler::{LoadError, Loader, compile};
use fab_model::Lowering;
use fab_model::Models;
use fab_model::lowering;
use fab_model::lowering::Points;
use fab_program::Program;
use fab_program::pointing::{CoordinateUnit, Order};

const THOUSANDTHS_Y_FIRST: Lowering = Lowering {
    unit: CoordinateUnit::PerMille,
    order: Order::Yx,
    ..Lowering::PIXELS
};

const MARKS: Lowering = Lowering {
    points: Points::Marks,
    ..Lowering::PIXELS
};

/// A shipped task's variant.
fn variant(task: &str, name: &str) -> Program {
    let compiled = compile(&format!("tasks/{task}.fab"), &support::ProjectFiles).unwrap();
    let mut programs = compiled.programs.into_iter();
    programs
        .find(|program| program.variant.as_deref() == Some(name))
        .unwrap()
}

#[test]
fn demonstrations_are_told_in_the_frame_of_the_model() {
    let program = variant("double_triangle", "in_context");
    let examples = Examples::load(&program, &support::root().join("tasks")).unwrap();
    let first_example = |lowering: Lowering| {
        let pointing = lowering.pointing([program.camera.image_px; 2]);
        let shown = examples.demonstrations.as_ref().unwrap();
        let answered = shown
            .answered_examples(&program, "plan", 1, pointing)
            .unwrap();
        assert!(answered.len() > 3);
        answered.into_iter().next().unwrap()
    };
    let in_pixels = first_example(Lowering::PIXELS);
    assert_eq!(
        in_pixels[1].text,
        "Pick Point = (65, 28)\nPlace Point = (158, 195)\n\
         Of the listed points (65, 28) is the corner at the top left, and (158, 195) is the corner at the bottom right."
    );
    let in_thousandths = first_example(THOUSANDTHS_Y_FIRST);
    assert_eq!(
        in_thousandths[1].text,
        "Pick Point = [127, 292]\nPlace Point = [873, 708]\n\
         Of the listed points [127, 292] is the corner at the top left, and [873, 708] is the corner at the bottom right."
    );
    assert!(
        in_thousandths[0]
            .text
            .contains("- Cloth corners: [873, 708], [292, 873], [708, 127], [127, 292]\n")
    );
    let by_number = first_example(MARKS);
    assert_eq!(
        by_number[1].text,
        "Pick Point = 4\nPlace Point = 1\n\
         Of the listed points 4 at (65, 28) is the corner at the top left, and 1 at (158, 195) is the corner at the bottom right."
    );
    assert!(
        by_number[0]
            .text
            .contains("- Cloth corners: 1 at (158, 195), 2 at (195, 65), ")
    );
}

/// A loader that returns one text for every path.
struct OneText(String);

impl Loader for OneText {
    fn load(&self, _: &str) -> Result<String, LoadError> {
        Ok(self.0.clone())
    }
}

/// A task of one stage that does not say how to write a point; it offers `pick`.
fn plain(pick: &str) -> Program {
    let text = format!(
        "task plain {{
    cloth grid(28, 28)
    camera top_down(height: 650mm, fov: 45deg, image: 224px)
    horizon 1
    keypoints {{
        cloth   = mask(depth < 646mm)
        corners = harris(cloth, image: 128px, max: 27, quality: 0.04, spacing: 10px)
        center  = centroid(cloth, at: start)
    }}
    actions {{
        pick:  {pick}
        place: one of center
    }}
    stage act {{
        model vision
        show scene
        say  \"The corners are {{{{ corners }}}}, the center {{{{ center }}}}. {{{{ actions.format }}}}\"
        read action
    }}
    verify {{ attempts 1 }}
}}"
    );
    let compiled = compile("plain.fab", &OneText(text)).unwrap();
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    compiled.programs.into_iter().next().unwrap()
}

#[test]
fn a_prompt_that_does_not_say_how_points_are_written_gets_a_sentence() {
    let program = plain("one of corners");
    let folder = tempfile::tempdir().unwrap();
    let trial = Trial::new(&program, folder.path(), Default::default());
    for (lowering, is_added) in [
        (Lowering::PIXELS, false),
        (THOUSANDTHS_Y_FIRST, true),
        (MARKS, true),
    ] {
        let model = Silent(Scripted::new(&[]), lowering);
        let models = Models {
            vision: &model,
            text: &model,
        };
        let run = folder
            .path()
            .join(format!("run_{:?}_{:?}", lowering.unit, lowering.points));
        trial.run(models, &run, &mut |_| {});
        let asked = model.0.asked.into_inner().unwrap();
        let words = words_of(&asked[0]);
        let says_so = words.contains("\n\nA point is written ");
        assert_eq!(says_so, is_added, "{words}");
    }
}

#[test]
fn what_cannot_be_asked_of_a_model_is_said_before_anything_is_done() {
    let program = plain("any of cloth");
    let check = |lowering| {
        let model = Silent(Scripted::new(&[]), lowering);
        let models = Models {
            vision: &model,
            text: &model,
        };
        lowering::check(&program, models)
    };
    assert!(check(Lowering::PIXELS).is_ok());
    assert!(check(THOUSANDTHS_Y_FIRST).is_ok());
    let why = check(MARKS).unwrap_err().to_string();
    assert!(why.contains("any point of `cloth`"), "{why}");
}
