//! Answers are tried on twins before the world moves; twins know what the camera shows, and nothing else.

use super::support::{self, Careless, Scripted, Trial, words_of};
use fab_agent::outcome::Outcome;
use fab_agent::policy::{MakePolicy, Prompted, Random};
use fab_agent::record::{Record, RehearsedStep, Step};
use fab_agent::rollout::{Ended, Event};
use fab_arm::journal::ARM_FILE;
use fab_arm::supervisor::Unattended;
use fab_base::interrupt::Interrupt;
use fab_model::calls::Calls;
use fab_model::{Model, ModelError, ModelKind, ModelRole, Models, Part, Reply, Request};
use fab_picture::observation::Observation;
use fab_program::{Cloth, Distrusted, Program, Rehearsal, RehearsalMeasure, TwinRanges};
use fab_world::start::Start;
use fab_world::{Executed, Look, Motion, SimulatedWorld, World, WorldError, Wrapper};
use std::fs;
use std::path::Path;

/// The stand-in, except that the named candidates place on the center.
fn careless(wrong: &'static [u32]) -> Careless<impl Fn(&Request) -> bool + Send + Sync> {
    Careless::where_wrong(|request| wrong.contains(&request.candidate))
}

/// A simulated world that claims to be real.
struct Real(SimulatedWorld);

impl Wrapper for Real {
    fn inner(&self) -> &dyn World {
        &self.0
    }

    fn inner_mut(&mut self) -> &mut dyn World {
        &mut self.0
    }

    fn is_simulated(&self) -> bool {
        false
    }
}

/// A simulated world with another cloth than its start states. Its particles are always those of the start.
struct Disguised {
    world: SimulatedWorld,
    shown: Start,
    stated: Option<Start>,
}

impl World for Disguised {
    fn name(&self) -> &str {
        self.world.name()
    }

    fn parameters(&self) -> String {
        self.world.parameters()
    }

    fn code(&self) -> String {
        self.world.code()
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn reset(&mut self, start: &Start) -> Result<(), WorldError> {
        self.stated = Some(start.clone());
        self.world.reset(&self.shown)
    }

    fn observe(&mut self) -> Result<Observation, WorldError> {
        self.world.observe()
    }

    fn act(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<Executed, WorldError> {
        self.world.act(motion, interrupt)
    }

    fn crumple(
        &self,
        start: &Start,
        seed: u64,
        interrupt: &Interrupt,
    ) -> Result<Start, WorldError> {
        self.world.crumple(start, seed, interrupt)
    }

    fn particles(&self) -> Option<Vec<[f32; 3]>> {
        self.stated.as_ref().map(|start| start.positions.clone())
    }
}

/// The small task, which rehearses its only step.
fn rehearsing() -> Program {
    with_rehearsal(support::small_task())
}

/// The same task, which tries the answers of its last stage on a twin.
fn with_rehearsal(mut program: Program) -> Program {
    let plan = program.stages.last_mut().unwrap();
    plan.temperature = Some(0.7);
    plan.candidates = Some(3);
    program.rehearsal = Some(Rehearsal {
        stage: plan.name.clone(),
        twin: TwinRanges {
            material: None,
            size: [0.98, 1.02],
            friction: [0.4, 0.6],
            draws: 1,
        },
        choose: Some(RehearsalMeasure::Overlap),
        revisions: 0,
        trust_above: 0.9,
        distrusted: Distrusted::StandsAside,
    });
    program
}

struct Played {
    report: Ended,
    line: Option<RehearsedStep>,
    record: Record,
    /// What the events said that answers were tried.
    tried: Vec<RehearsedStep>,
    /// The journal of an arm's motions; empty if nothing was sent to it, or there is none.
    motions: String,
}

/// Plays the first step in a changed simulated world.
fn play(
    program: &Program,
    model: &dyn Model,
    change: impl Fn(SimulatedWorld) -> Box<dyn World> + Sync,
    prepare: impl Fn(&mut Trial<'_>),
) -> Played {
    let make = |_: &Path| -> Result<Box<dyn World>, WorldError> {
        Ok(change(SimulatedWorld::new(
            &program.camera,
            program.picker,
        )?))
    };
    play_in(program, model, make, prepare)
}

/// Plays the first step in a world that is made for a run folder.
fn play_in(
    program: &Program,
    model: &dyn Model,
    make: impl Fn(&Path) -> Result<Box<dyn World>, WorldError> + Sync,
    prepare: impl Fn(&mut Trial<'_>),
) -> Played {
    let models = Models {
        vision: model,
        text: model,
    };
    play_as(program, &Prompted::new(models), make, prepare)
}

/// Lets a policy play the first step in a world that is made for a run folder.
fn play_as(
    program: &Program,
    policy: &dyn MakePolicy,
    make: impl Fn(&Path) -> Result<Box<dyn World>, WorldError> + Sync,
    prepare: impl Fn(&mut Trial<'_>),
) -> Played {
    let folder = tempfile::tempdir().unwrap();
    let mut trial = Trial::new(program, folder.path(), Look::default());
    trial.horizon = Some(1);
    prepare(&mut trial);
    let run = folder.path().join("run");
    let make_world = || make(&run);
    let mut tried = Vec::new();
    let report = trial.decided_in(&make_world, policy, &run, &mut |event| {
        if let Event::Motion { line, .. } = event {
            tried.extend(line.rehearsal);
        }
    });
    let report = report.unwrap();
    let record = Record::read(&run).unwrap();
    Played {
        report,
        line: record.steps[0].rehearsal.clone(),
        record,
        tried,
        motions: fs::read_to_string(run.join(ARM_FILE)).unwrap_or_default(),
    }
}

/// The number of the question whose answer was taken.
fn taken(step: &Step) -> Option<u32> {
    step.accepted.as_ref().map(|accepted| accepted.attempt)
}

fn plain(world: SimulatedWorld) -> Box<dyn World> {
    Box::new(world)
}

#[test]
fn the_candidate_is_taken_that_does_best_on_the_twin_and_the_first_question_is_as_without() {
    let model = careless(&[0, 2]);
    let program = rehearsing();
    let played = play(&program, &model, plain, |_| {});
    let line = played.line.unwrap();
    assert_eq!(played.tried, std::slice::from_ref(&line));
    assert!(
        line.overlap.unwrap() > 0.9 && line.aside.is_none(),
        "{line:?}"
    );
    let measures: Vec<f64> = line
        .candidates
        .iter()
        .map(|it| it.measure.unwrap())
        .collect();
    assert_eq!(measures.len(), 3);
    assert!(
        measures[1] > measures[0] + 0.1 && measures[0] == measures[2],
        "{measures:?}"
    );
    assert_eq!(taken(&played.record.steps[0]), Some(2));
    let step = &played.record.steps[0];
    assert_eq!(step.accepted.as_ref().unwrap().attempt, 2);
    assert!(
        played.record.spent[&1].seconds["rehearse"]
            .as_f64()
            .unwrap()
            > 0.0
    );
    // Questions differ in the candidate alone, and the first one has the key that it has without rehearsal.
    let asked = model.asked.into_inner().unwrap();
    let planned: Vec<&Request> = asked
        .iter()
        .filter(|it| it.role == ModelRole::Text)
        .collect();
    let candidates: Vec<u32> = planned.iter().map(|it| it.candidate).collect();
    assert_eq!(candidates, [0, 1, 2]);
    let mut without = program;
    without.rehearsal = None;
    let alone = careless(&[0, 2]);
    let unrehearsed = play(&without, &alone, plain, |_| {});
    assert_eq!(unrehearsed.line, None);
    let alone = alone.asked.into_inner().unwrap();
    let keys = |asked: &[Request]| asked[..2].iter().map(Request::key).collect::<Vec<_>>();
    assert_eq!(keys(&alone), keys(&asked));
    assert_eq!(alone.len(), 2);
    assert!(
        !serde_json::to_string(planned[0])
            .unwrap()
            .contains("candidate")
    );
    assert_ne!(planned[0].key(), planned[1].key());
}

/// A model that answers no candidate from this one on.
struct Failing<M> {
    answers: M,
    from: u32,
}

impl<M: Model> Model for Failing<M> {
    fn name(&self) -> &str {
        "failing"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        if request.role == ModelRole::Text && request.candidate >= self.from {
            return Err(ModelError::Unsupported {
                model: "failing".to_owned(),
                why: "the line is cut".to_owned(),
            });
        }
        self.answers.ask(request, calls)
    }
}

#[test]
fn a_candidate_that_is_not_answered_leaves_the_choice_among_those_that_are() {
    let program = rehearsing();
    let failing = |from| Failing {
        answers: careless(&[0]),
        from,
    };
    let played = play(&program, &failing(2), plain, |_| {});
    let line = played.line.unwrap();
    assert_eq!(line.candidates.len(), 2);
    assert_eq!(taken(&played.record.steps[0]), Some(2));
    let step = &played.record.steps[0];
    let last = &step.attempts.last().unwrap().result;
    assert!(format!("{last:?}").contains("the line is cut"), "{last:?}");
    assert!(step.executed.is_some());
    // Without the first answer it ends as it does without rehearsal.
    let played = play(&program, &failing(0), plain, |_| {});
    assert_eq!(taken(&played.record.steps[0]), None);
    assert_eq!(played.report.outcome, Outcome::ModelFailed);
}

#[test]
fn where_an_earlier_stage_has_no_answer_no_candidate_is_asked_for() {
    let program = rehearsing();
    let model = Scripted::new(&[""; 9]);
    let played = play(&program, &model, plain, |_| {});
    assert_eq!(played.report.outcome, Outcome::MalformedReply);
    let asked = model.asked.into_inner().unwrap();
    assert_eq!(asked.len() as u32, program.verify.attempts);
    assert_eq!(taken(&played.record.steps[0]), None);
}

#[test]
fn the_declared_measure_decides_which_candidate_is_taken() {
    // The first answer folds the cloth in half, the second a corner to the center; the third repeats the first.
    for (choose, chosen) in [
        (RehearsalMeasure::Overlap, 1),
        (RehearsalMeasure::Coverage, 2),
    ] {
        let mut program = rehearsing();
        program.rehearsal.as_mut().unwrap().choose = Some(choose);
        let played = play(&program, &careless(&[1]), plain, |_| {});
        let line = played.line.unwrap();
        assert_eq!(taken(&played.record.steps[0]), Some(chosen), "{line:?}");
        if choose == RehearsalMeasure::Coverage {
            let covered = line.candidates.iter().map(|it| it.measure.unwrap());
            for (covered, expected) in covered.zip([1.0 / 2.0, 7.0 / 8.0, 1.0 / 2.0]) {
                assert!((covered - expected).abs() < 0.05, "{line:?}");
            }
        }
    }
}

/// A model that asks to stop as it answers a candidate.
struct Stopping<M> {
    answers: M,
    at: u32,
    interrupt: Interrupt,
}

impl<M: Model> Model for Stopping<M> {
    fn name(&self) -> &str {
        self.answers.name()
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        if request.role == ModelRole::Text && request.candidate == self.at {
            self.interrupt.raise();
        }
        self.answers.ask(request, calls)
    }
}

#[test]
fn a_step_that_is_interrupted_while_an_answer_is_tried_keeps_what_was_found_and_is_taken_again() {
    let program = rehearsing();
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let mut trial = Trial::new(&program, folder.path(), Look::default());
    trial.horizon = Some(1);
    let model = Stopping {
        answers: careless(&[1]),
        at: 1,
        interrupt: trial.interrupt.clone(),
    };
    let models = |model| Models {
        vision: model,
        text: model,
    };
    let mut n_asked = 0;
    let stopped = trial.run(models(&model), &run, &mut |event| {
        n_asked += u32::from(matches!(event, Event::Verdict { .. }));
    });
    assert_eq!(stopped.outcome, Outcome::Interrupted);
    let step = Record::read(&run).unwrap().steps.remove(0);
    let line = step.rehearsal.unwrap();
    // The second answer came and is kept; it was not tried to its end, and no third one was asked for.
    assert_eq!((n_asked, step.attempts.len()), (3, 3));
    let [first] = line.candidates.as_slice() else {
        panic!("{line:?}");
    };
    assert_eq!(step.accepted, None);
    assert!(first.measure.is_some() && step.executed.is_none());

    trial.interrupt = Interrupt::default();
    let ended = trial.run(models(&careless(&[1])), &run, &mut |_| {});
    assert_eq!(ended.steps, 1);
    let again = Record::read(&run).unwrap().steps.pop().unwrap();
    let line = again.rehearsal.unwrap();
    assert_eq!((&line.candidates[0], line.candidates.len()), (first, 3));
    assert_eq!(again.accepted.unwrap().attempt, 1);
}

#[test]
fn twins_that_cannot_be_laid_are_named_in_each_step() {
    let compiled = fab_compiler::compile(
        "tasks/rehearsed/double_triangle.fab",
        &support::ProjectFiles,
    );
    let programs = compiled.unwrap().programs;
    let twins = programs.into_iter().find_map(|it| it.rehearsal);
    let mut stiff = twins.unwrap().twin.material.unwrap();
    for length_m in [
        &mut stiff.bending_length_m.warp,
        &mut stiff.bending_length_m.weft,
        &mut stiff.bending_length_m.bias,
    ] {
        *length_m *= 5.0;
    }
    let mut program = rehearsing();
    program.rehearsal.as_mut().unwrap().twin.material = Some(stiff);
    let two_steps = |trial: &mut Trial<'_>| trial.horizon = Some(2);
    let played = play(&program, &careless(&[]), plain, two_steps);
    let steps = played.record.steps.iter();
    let asides: Vec<String> = steps
        .map(|step| step.rehearsal.as_ref().unwrap().aside.clone().unwrap())
        .collect();
    let [first, second] = asides.as_slice() else {
        panic!("{asides:?}");
    };
    assert!(
        first.starts_with("a twin cannot be laid: ") && first.contains("substeps"),
        "{first}"
    );
    assert_eq!(*second, format!("there are no twins since step 1: {first}"));
}

#[test]
fn a_cloth_that_does_not_lie_flat_at_first_has_no_twin_however_well_its_outline_fits() {
    let mut program = rehearsing();
    program.rehearsal.as_mut().unwrap().distrusted = Distrusted::Refuses;
    // Folded in half: the rectangle around it fits a flat cloth of half the size.
    let folded = |trial: &mut Trial<'_>| {
        for [x, _, z] in &mut trial.start.positions {
            if *x > 0.0 {
                (*x, *z) = (-*x, *z + 0.011);
            }
        }
    };
    let model = careless(&[]);
    let played = play(&program, &model, plain, folded);
    assert_eq!(played.report.outcome, Outcome::RehearsalRefused);
    let line = played.line.unwrap();
    let why = "the cloth does not lie flat at first: more than a tenth of it is 16 mm above the table, and a flat cloth 5.0 mm";
    assert_eq!((line.aside.as_deref(), line.overlap), (Some(why), None));
    assert_eq!(model.asked.lock().unwrap().len(), 0);
}

#[test]
#[ignore = "long"]
fn a_cloth_that_is_shown_elsewhere_than_start_and_particles_state_is_rehearsed_as_it_is_shown() {
    let program = rehearsing();
    // Larger than the declared cloth, and beside the start. A twin that lay where the start states would overlap by less
    // than 0.3 with what is shown, and one of the declared size in the right place by less than 0.7.
    let larger = Cloth {
        dimx: 34,
        dimy: 34,
        ..program.cloth.clone()
    };
    let shown = Start::flat(&larger).moved(0.0, [0.07, -0.06]);
    let disguised = |world| -> Box<dyn World> {
        Box::new(Disguised {
            world,
            shown: shown.clone(),
            stated: None,
        })
    };
    let lying = play(&program, &careless(&[0]), disguised, |_| {});
    let honest = play(&program, &careless(&[0]), plain, |trial| {
        trial.start = shown.clone();
    });
    // By its particles, the cloth of the lying world never moved.
    let moved_mm = |played: &Played| played.record.steps[0].cloth.unwrap().farthest_mm;
    assert_eq!(moved_mm(&lying), 0.0);
    assert!(moved_mm(&honest) > 100.0, "{}", moved_mm(&honest));
    let line = lying.line.unwrap();
    assert!(
        line.overlap.unwrap() > 0.9 && line.aside.is_none(),
        "{line:?}"
    );
    assert_eq!(taken(&lying.record.steps[0]), Some(2), "{line:?}");
    assert_eq!(Some(line), honest.line);
}

#[test]
#[ignore = "long"]
fn where_twin_and_camera_disagree_one_question_is_asked_and_something_real_does_not_move() {
    let mut program = rehearsing();
    // Folded along its diagonal, with a layer too thin to be seen: the rectangle around it is no cloth like that.
    let folded = |trial: &mut Trial<'_>| {
        for [x, y, z] in &mut trial.start.positions {
            if *x + *y > 0.0 {
                (*x, *y, *z) = (-*y, -*x, *z + 0.004);
            }
        }
    };
    let model = careless(&[]);
    let aside = play(&program, &model, plain, folded);
    let line = aside.line.unwrap();
    assert!(
        line.aside.as_deref().unwrap().contains("overlap by 0."),
        "{line:?}"
    );
    assert!(line.candidates.is_empty(), "{line:?}");
    assert_eq!(model.asked.into_inner().unwrap().len(), 2);
    assert!(aside.record.steps[0].executed.is_some());

    let real = |world| -> Box<dyn World> { Box::new(Real(world)) };
    let model = careless(&[]);
    let refused = play(&program, &model, real, folded);
    assert_eq!(refused.report.outcome, Outcome::RehearsalRefused);
    let why = refused.report.stopped.as_deref().unwrap();
    assert!(why.contains("the task trusts more than 0.9"), "{why}");
    assert!(refused.record.steps[0].executed.is_none());
    assert_eq!(model.asked.lock().unwrap().len(), 0);
    let trusted = play(&program, &model, real, |_| {});
    assert!(trusted.record.steps[0].executed.is_some());

    program.rehearsal.as_mut().unwrap().distrusted = Distrusted::Refuses;
    let simulated = play(&program, &careless(&[]), plain, folded);
    assert_eq!(simulated.report.outcome, Outcome::RehearsalRefused);
}

/// A policy that asks no model rehearses nothing, but where something real could move it needs trusted twins too.
#[test]
fn a_policy_without_a_model_does_not_move_a_real_cloth_whose_twins_are_not_trusted() {
    let program = rehearsing();
    let simulated = || SimulatedWorld::new(&program.camera, program.picker);
    let real =
        |_: &Path| -> Result<Box<dyn World>, WorldError> { Ok(Box::new(Real(simulated()?))) };
    let plain = |_: &Path| -> Result<Box<dyn World>, WorldError> { Ok(Box::new(simulated()?)) };
    let random = Random { seed: 1 };
    let raised = |trial: &mut Trial<'_>| {
        for [_, _, z] in &mut trial.start.positions {
            *z += 0.03;
        }
    };
    let refused = play_as(&program, &random, real, raised);
    assert_eq!(refused.report.outcome, Outcome::RehearsalRefused);
    assert!(refused.record.steps[0].executed.is_none());
    let trusted = play_as(&program, &random, real, |_| {});
    let line = trusted.line.unwrap();
    assert!(
        line.overlap > Some(0.9) && line.candidates.is_empty(),
        "{line:?}"
    );
    assert!(trusted.record.steps[0].executed.is_some());
    let unseen = play_as(&program, &random, plain, raised);
    assert_eq!(unseen.line, None);
    assert!(unseen.record.steps[0].executed.is_some());
}

#[test]
fn a_step_whose_subgoal_shows_no_cloth_is_not_rehearsed() {
    let blank = |trial: &mut Trial<'_>| {
        let corner = *trial.subgoals.pictures[1].get_pixel(0, 0);
        trial.subgoals.pictures[1]
            .pixels_mut()
            .for_each(|it| *it = corner);
    };
    let played = play(&rehearsing(), &careless(&[]), plain, blank);
    let line = played.line.unwrap();
    assert!(line.overlap > Some(0.9), "{line:?}");
    let why = "no result of step 1 can be compared: a subgoal picture shows no cloth";
    assert_eq!(line.aside.as_deref(), Some(why));
}

/// A real table's task on a cloth of few particles, which rehearses on a twin of this size.
fn rehearsing_on_a_table(size: f64) -> Program {
    let mut program = support::task("real/double_triangle");
    program.verify.result = None;
    (program.cloth.dimx, program.cloth.dimy) = (13, 13);
    program.cloth.spacing_m = 0.025;
    program.experts.clear();
    program.goal = None;
    let mut program = with_rehearsal(program);
    let rehearsal = program.rehearsal.as_mut().unwrap();
    (rehearsal.twin.size, rehearsal.trust_above) = ([size; 2], 0.8);
    program
}

/// Plays the first step with the simulated arm.
fn play_with_arm(program: &Program, model: &dyn Model) -> Played {
    let make = |run: &Path| -> Result<Box<dyn World>, WorldError> {
        let robot = support::root().join("tasks/real/simulated.toml");
        let image_px = program.camera.image_px;
        let arm = support::simulated_arm(&robot, image_px, Box::new(Unattended), Some(run));
        Ok(Box::new(arm))
    };
    play_in(program, model, make, |_| {})
}

#[test]
#[ignore = "long"]
fn an_arm_does_not_move_where_twin_and_camera_disagree_and_moves_where_they_agree() {
    // The task only stands aside, but an arm counts as real.
    let program = rehearsing_on_a_table(1.3);
    let model = careless(&[]);
    let refused = play_with_arm(&program, &model);
    assert_eq!(refused.report.outcome, Outcome::RehearsalRefused);
    let why = refused.report.stopped.as_deref().unwrap();
    assert!(why.contains("the task trusts more than 0.8"), "{why}");
    assert!(refused.record.steps[0].executed.is_none());
    assert_eq!(refused.motions, "", "it moved");
    assert_eq!(model.asked.lock().unwrap().len(), 0);

    let trusted = play_with_arm(&rehearsing_on_a_table(1.0), &careless(&[0]));
    assert_eq!(trusted.report.outcome, Outcome::HorizonReached);
    let line = trusted.line.unwrap();
    assert!(
        line.overlap.unwrap() > 0.8 && line.aside.is_none(),
        "{line:?}"
    );
    assert_eq!(taken(&trusted.record.steps[0]), Some(2), "{line:?}");
    assert!(trusted.record.steps[0].executed.is_some());
    assert!(trusted.motions.contains("begin"), "{}", trusted.motions);
}

#[test]
#[ignore = "long"]
fn twins_are_carried_along_and_compared_again_and_a_rollout_repeats_byte_for_byte() {
    let program = rehearsing();
    let lines = || {
        let folder = tempfile::tempdir().unwrap();
        let trial = Trial::new(&program, folder.path(), Look::default());
        let model = careless(&[0]);
        let models = Models {
            vision: &model,
            text: &model,
        };
        let run = folder.path().join("run");
        trial.run(models, &run, &mut |_| {});
        let record = Record::read(&run).unwrap();
        let steps = record.steps.into_iter().map(|step| step.rehearsal.unwrap());
        steps.collect::<Vec<_>>()
    };
    let once = lines();
    assert_eq!(once.len(), 2);
    let overlaps: Vec<f64> = once.iter().map(|line| line.overlap.unwrap()).collect();
    // After a fold both lie folded; twins that stayed flat would overlap by about a half.
    assert!(
        overlaps[1] > 0.75 && overlaps[1] < overlaps[0],
        "{overlaps:?}"
    );
    assert_eq!(once, lines());
}

#[test]
#[ignore = "long"]
fn a_vision_model_sees_what_would_come_of_its_answer_and_may_revise_it() {
    let mut program = rehearsing();
    let plan = program.stages.last_mut().unwrap();
    plan.model = ModelRole::Vision;
    let rehearsal = program.rehearsal.as_mut().unwrap();
    (rehearsal.choose, rehearsal.revisions) = (None, 2);
    // The corners as the camera sees them.
    let listed = {
        let model = careless(&[]);
        play(&program, &model, plain, |_| {});
        let asked = model.asked.into_inner().unwrap();
        let words = words_of(&asked[1]);
        let line = words.lines().find(|line| line.contains("Cloth corners: "));
        let (_, points) = line.unwrap().split_once(": ").unwrap();
        points
            .replace("), (", ")|(")
            .split('|')
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let answer = |place: &str| format!("Pick Point = {}\nPlace Point = {place}", listed[0]);
    let [first, second] = [answer(&listed[1]), answer(&listed[2])];
    let model = Scripted::new(&["Instructions: fold it", &first, &second, &second]);
    let played = play(&program, &model, plain, |_| {});
    let line = played.line.unwrap();
    assert_eq!(line.candidates.len(), 2, "the third answer changes nothing");
    assert_eq!(taken(&played.record.steps[0]), Some(2));
    let asked = model.asked.into_inner().unwrap();
    assert_eq!(asked.len(), 4);
    let predicted = |request: &Request| match request.messages.last().unwrap().parts.last() {
        Some(Part::Image(png)) => png.sha256().to_owned(),
        other => panic!("{other:?}"),
    };
    assert!(words_of(&asked[2]).contains("how the cloth would lie after this action"));
    assert_ne!(predicted(&asked[2]), predicted(&asked[3]));
    assert_eq!(played.report.steps, 1);
    // A question about the prediction that is not answered leaves the answer before it.
    let model = Scripted::new(&["Instructions: fold it", &first]);
    let played = play(&program, &model, plain, |_| {});
    assert_eq!(taken(&played.record.steps[0]), Some(1));
    assert!(played.record.steps[0].executed.is_some());
}
