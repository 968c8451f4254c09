//! Answers are tried on twins before the world moves; twins know what the camera shows, and nothing else.

use super::support::{self, Scripted, Trial, words_of};
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::policy::Prompted;
use fab_agent::record::{Record, RehearsedStep};
use fab_agent::rollout::{self, Ended, Job};
use fab_model::calls::Calls;
use fab_model::{Model, ModelError, ModelKind, ModelRole, Models, Part, Reply, Request};
use fab_program::{Distrusted, Program, Rehearsal, RehearsalMeasure, TwinRanges};
use fab_standins::Geometric;
use fab_world::{Look, SimulatedWorld, World, WorldError, Wrapper};
use std::sync::Mutex;

/// The stand-in, except that the named candidates place on the center.
struct Careless {
    wrong: &'static [u32],
    asked: Mutex<Vec<Request>>,
}

impl Careless {
    fn in_candidates(wrong: &'static [u32]) -> Careless {
        Careless {
            wrong,
            asked: Mutex::default(),
        }
    }
}

impl Model for Careless {
    fn name(&self) -> &str {
        "careless"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        self.asked.lock().unwrap().push(request.clone());
        let reply = Geometric.ask(request, calls)?;
        let asked = words_of(request);
        let Some((pick, _)) = reply.text.split_once("Place Point = ") else {
            return Ok(reply);
        };
        if !self.wrong.contains(&request.candidate) {
            return Ok(reply);
        }
        let (_, center) = asked.split_once("- Cloth center: ").unwrap();
        let center = center.lines().next().unwrap();
        Ok(Reply::text(format!("{pick}Place Point = {center}\n")))
    }
}

/// A simulated world that may lie about its particles, and may claim to be real.
struct Disguised {
    world: SimulatedWorld,
    shift_m: f32,
    is_simulated: bool,
}

impl Wrapper for Disguised {
    fn inner(&self) -> &dyn World {
        &self.world
    }

    fn inner_mut(&mut self) -> &mut dyn World {
        &mut self.world
    }

    fn is_simulated(&self) -> bool {
        self.is_simulated
    }

    fn particles(&self) -> Option<Vec<[f32; 3]>> {
        let particles = self.world.particles()?;
        let shifted = particles
            .into_iter()
            .map(|[x, y, z]| [y + self.shift_m, x, z]);
        Some(shifted.collect())
    }
}

/// The small task, which rehearses its only step.
fn rehearsing() -> Program {
    let mut program = support::small_task();
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
}

/// Plays the first step in a world.
fn play(
    program: &Program,
    model: &dyn Model,
    change: impl Fn(SimulatedWorld) -> Box<dyn World> + Sync,
    prepare: impl Fn(&mut Trial<'_>),
) -> Played {
    let folder = tempfile::tempdir().unwrap();
    let mut trial = Trial::new(program, folder.path(), Look::default());
    prepare(&mut trial);
    let make_world = || -> Result<Box<dyn World>, WorldError> {
        Ok(change(SimulatedWorld::new(
            &program.camera,
            program.picker,
        )?))
    };
    let models = Models {
        vision: model,
        text: model,
    };
    let job = Job {
        program,
        start: &trial.start,
        subgoals: &trial.subgoals,
        examples: &trial.examples,
        make_policy: &Prompted { models },
        budget: &trial.budget,
        recorder: None,
        make_world: &make_world,
        make_expert_world: &make_world,
        cache: &trial.cache,
        interrupt: &trial.interrupt,
        horizon: Some(1),
        early_stop: true,
        operator: None,
        repetition: 0,
        start_number: None,
    };
    let run = folder.path().join("run");
    let report = rollout::run(&job, RunFolder::create(&run).unwrap(), &mut |_| {}).unwrap();
    let record = Record::read(&run).unwrap();
    Played {
        report,
        line: record.steps[0].rehearsal.clone(),
        record,
    }
}

fn plain(world: SimulatedWorld) -> Box<dyn World> {
    Box::new(world)
}

#[test]
fn the_candidate_is_taken_that_does_best_on_the_twin_and_the_first_question_is_as_without() {
    let model = Careless::in_candidates(&[0, 2]);
    let program = rehearsing();
    let played = play(&program, &model, plain, |_| {});
    let line = played.line.unwrap();
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
    assert_eq!((line.chosen, line.calls), (Some(2), 2));
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
    let alone = Careless::in_candidates(&[0, 2]);
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

#[test]
#[ignore = "long"]
fn a_world_whose_particles_lie_elsewhere_than_its_camera_shows_is_judged_by_its_camera() {
    let program = rehearsing();
    let line = |shift_m: f32| {
        let disguised = |world| -> Box<dyn World> {
            Box::new(Disguised {
                world,
                shift_m,
                is_simulated: true,
            })
        };
        let model = Careless::in_candidates(&[0]);
        let played = play(&program, &model, disguised, |_| {});
        (played.line.unwrap(), played.record.steps[0].cloth)
    };
    let [honest, lying] = [0.0, 0.07].map(line);
    assert_eq!(honest.0, lying.0);
    assert_eq!(honest.0.chosen, Some(2));
}

#[test]
#[ignore = "long"]
fn where_twin_and_camera_disagree_one_question_is_asked_and_something_real_does_not_move() {
    let mut program = rehearsing();
    // Folded along its diagonal: the rectangle around it is no cloth like that.
    let folded = |trial: &mut Trial<'_>| {
        for [x, y, z] in &mut trial.start.positions {
            if *x + *y > 0.0 {
                (*x, *y, *z) = (-*y, -*x, *z + 0.01);
            }
        }
    };
    let model = Careless::in_candidates(&[]);
    let aside = play(&program, &model, plain, folded);
    let line = aside.line.unwrap();
    assert!(
        line.aside.as_deref().unwrap().contains("overlap by 0."),
        "{line:?}"
    );
    assert_eq!(
        (line.candidates.len(), line.chosen, line.calls),
        (0, None, 0)
    );
    assert_eq!(model.asked.into_inner().unwrap().len(), 2);
    assert!(aside.record.steps[0].executed.is_some());

    program.rehearsal.as_mut().unwrap().distrusted = Distrusted::Refuses;
    let model = Careless::in_candidates(&[]);
    let simulated = play(&program, &model, plain, folded);
    assert!(
        simulated.record.steps[0].executed.is_some(),
        "nothing real moves"
    );
    let real = |world| -> Box<dyn World> {
        Box::new(Disguised {
            world,
            shift_m: 0.0,
            is_simulated: false,
        })
    };
    let model = Careless::in_candidates(&[]);
    let refused = play(&program, &model, real, folded);
    assert_eq!(refused.report.outcome, Outcome::RehearsalRefused);
    let why = refused.report.stopped.as_deref().unwrap();
    assert!(why.contains("the task trusts more than 0.9"), "{why}");
    assert!(refused.record.steps[0].executed.is_none());
    assert_eq!(model.asked.lock().unwrap().len(), 0);
    let trusted = play(&program, &model, real, |_| {});
    assert!(trusted.record.steps[0].executed.is_some());
}

#[test]
#[ignore = "long"]
fn twins_are_carried_along_and_compared_again_and_a_rollout_repeats_byte_for_byte() {
    let program = rehearsing();
    let lines = || {
        let folder = tempfile::tempdir().unwrap();
        let trial = Trial::new(&program, folder.path(), Look::default());
        let model = Careless::in_candidates(&[0]);
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
        let model = Careless::in_candidates(&[]);
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
    assert_eq!((line.chosen, line.calls), (Some(2), 2));
    let asked = model.asked.into_inner().unwrap();
    assert_eq!(asked.len(), 4);
    let predicted = |request: &Request| match request.messages.last().unwrap().parts.last() {
        Some(Part::Image(png)) => png.sha256().to_owned(),
        other => panic!("{other:?}"),
    };
    assert!(words_of(&asked[2]).contains("how the cloth would lie after this action"));
    assert_ne!(predicted(&asked[2]), predicted(&asked[3]));
    assert_eq!(played.report.steps, 1);
}
