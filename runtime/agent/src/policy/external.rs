//! The policy of a user's program, in any language.
//!
//! In: lines of JSON, as [`protocol`] types them: what stays the same in a rollout, then for each proposal pictures by
//! path, keypoints, the offered choices, refusals so far. Out: one line each, with the grips or a refusal. The program is
//! started at the first question, and its answers are stored in the run folder before they are used: a resumed rollout
//! asks only new questions.

use super::proposing::{Answer, Proposed, Refusal, STAGE, until_accepted};
use super::protocol::{
    self, Decide, FieldValue, Last, Line, Offered, PROTOCOL, Pictures, Refused, grip,
};
use super::{
    Decision, Description, Exchange, Exchanged, Kind, Policy, PolicyError, Question, StepView,
};
use crate::journal::JournalError;
use crate::outcome::Outcome;
use fab_base::child::{Child, ChildError, CommandLine, excerpt};
use fab_base::interrupt::Interrupt;
use fab_base::{digest, files, npy};
use fab_model::Reply;
use fab_picture::camera::Pinhole;
use fab_picture::png;
use fab_program::spaces::Spaces;
use fab_program::{ActionField, Arrow, Choices, PixelPoint, Proposal, SubgoalStep, Value, space};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The file in the run folder that receives the program's stderr.
const STDERR_FILE: &str = "policy.stderr.txt";

/// What a program may see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sight {
    /// Only what the camera shows.
    Camera,
    /// The true positions of the particles, too.
    Particles,
}

/// A policy that asks a program.
#[derive(Debug)]
pub struct External {
    command: CommandLine,
    sight: Sight,
    limit: Duration,
    /// SHA-256 of the files that the command line names.
    code: String,
    child: Option<Child>,
}

impl External {
    /// Makes the policy of a command line; nothing is started yet.
    ///
    /// - `limit`: the longest that one answer may take.
    pub fn new(command: CommandLine, sight: Sight, limit: Duration) -> External {
        External {
            code: digest::of_files(command.files()),
            command,
            sight,
            limit,
            child: None,
        }
    }
}

impl Policy for External {
    fn description(&self) -> Description {
        Description {
            kind: Kind::Program,
            name: match self.sight {
                Sight::Camera => format!("exec:{}", self.command),
                Sight::Particles => format!("exec+particles:{}", self.command),
            },
            sees_particles: self.sight == Sight::Particles,
            models: None,
            code: Some(self.code.clone()),
        }
    }

    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, PolicyError> {
        let Some(folder) = step.folder else {
            let why = "a program is asked in a rollout only: it gets files by their paths";
            return Err(PolicyError::Unfit(why.to_owned()));
        };
        let folder = &std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        if folder.to_str().is_none() {
            return Err(PolicyError::Unfit(format!(
                "the run folder `{}` is not UTF-8, so no line can name it: choose another one with `--out`",
                folder.display()
            )));
        }
        let reset = reset(step);
        let files = write_files(step, folder)?;
        until_accepted(step, exchange, &mut |refusals, exchange| {
            let mut sent = [reset.clone(), decide(step, &files, refusals)];
            // Relative paths make equal questions equal in any run folder.
            let key = digest::of(text(&sent));
            sent.iter_mut()
                .for_each(|question| question.place_in(folder));
            let text = text(&sent[1]);
            let question = Question::Line { key, text };
            (exchange.record)(Exchanged::Question {
                stage: STAGE,
                attempt: refusals.len() as u32 + 1,
                question: &question,
            })?;
            let interrupt = exchange.interrupt;
            let asked = exchange
                .asking
                .once(&question.key(), || self.ask(&sent, folder, interrupt))?;
            let (reply, answer) = match asked {
                Ok(reply) => {
                    let answer = read(step, &reply.text);
                    (Some(reply), answer)
                }
                Err((outcome, why)) => {
                    self.child = None;
                    (None, Answer::Stop { outcome, why })
                }
            };
            Ok(Proposed {
                question: Some(question),
                reply,
                note: None,
                answer,
            })
        })
    }
}

impl External {
    /// Returns the program's line after checking that it is a valid answer; starts the program if it does not run.
    fn ask(
        &mut self,
        [reset, decide]: &[protocol::Question; 2],
        folder: &Path,
        interrupt: &Interrupt,
    ) -> Result<Reply, (Outcome, String)> {
        let limit = self.limit;
        let child = match &mut self.child {
            Some(child) => child,
            absent => {
                let stderr = folder.join(STDERR_FILE);
                let child = Child::start(&self.command, Some(&stderr)).map_err(failed)?;
                let child = absent.insert(child);
                greet(child, &self.command, limit, interrupt)?;
                let (refused, line) = answer_of(child, reset, limit, interrupt).map_err(failed)?;
                if refused.grips.is_some() {
                    let why = "to `reset` it is `{}`, or has only `refuse`";
                    return Err(failed(child.no_answer(line.as_bytes(), why)));
                }
                if refused.refuse.is_some() {
                    return Ok(Reply::text(line));
                }
                child
            }
        };
        let (_, line) = answer_of(child, decide, limit, interrupt).map_err(failed)?;
        Ok(Reply::text(line))
    }
}

/// Makes sure that a program answers this version of the lines.
fn greet(
    child: &mut Child,
    command: &CommandLine,
    limit: Duration,
    interrupt: &Interrupt,
) -> Result<(), (Outcome, String)> {
    let hello = protocol::Question::Hello { protocol: PROTOCOL };
    let answered = child.ask(&hello, limit, interrupt);
    let why = match answered {
        Ok(protocol::Hello { protocol: PROTOCOL }) => return Ok(()),
        Err(ChildError::Interrupted) => return Err(failed(ChildError::Interrupted)),
        Ok(protocol::Hello { protocol }) => {
            format!("`{command}` answers version {protocol} of the lines")
        }
        Err(error) => error.to_string(),
    };
    let why = format!(
        "{why}; this fabc asks in version {PROTOCOL}: answer `{{\"do\": \"hello\"}}` with `{{\"protocol\": {PROTOCOL}}}`, \
         `{{\"do\": \"reset\"}}` with `{{}}`, and then each `{{\"do\": \"decide\"}}`"
    );
    Err((Outcome::PolicyFailed, why))
}

/// Sends a question; returns the line that answers it, parsed and as it came.
fn answer_of(
    child: &mut Child,
    question: &protocol::Question,
    limit: Duration,
    interrupt: &Interrupt,
) -> Result<(Line, String), ChildError> {
    child.send(question)?;
    let line = child.receive(limit, interrupt)?;
    let answer = child.read(&line)?;
    Ok((answer, String::from_utf8_lossy(&line).into_owned()))
}

fn failed(error: ChildError) -> (Outcome, String) {
    let outcome = match error {
        ChildError::Interrupted => Outcome::Interrupted,
        _ => Outcome::PolicyFailed,
    };
    (outcome, error.to_string())
}

fn read(step: &StepView<'_>, line: &str) -> Answer {
    let unreadable = |field: &str, message: String| Answer::Unreadable {
        field: field.to_owned(),
        message,
    };
    match serde_json::from_str(line) {
        Ok(Line {
            grips: None,
            refuse: Some(why),
        }) => Answer::Stop {
            outcome: Outcome::PolicyStopped,
            why: match why.trim() {
                "" => "the policy gives no reason".to_owned(),
                why => excerpt(why.as_bytes()),
            },
        },
        Ok(Line {
            grips: Some(grips),
            refuse: None,
        }) => match grips.as_slice() {
            [grip] => match proposal(step, grip) {
                Ok(proposal) => Answer::Grip(proposal),
                Err((field, message)) => unreadable(&field, message),
            },
            grips => unreadable(
                "grips",
                format!(
                    "there are {} grips, and the world has one gripper",
                    grips.len()
                ),
            ),
        },
        Ok(_) => unreadable(
            "grips",
            "the answer must have either `grips` or `refuse`, and it has both or neither"
                .to_owned(),
        ),
        Err(error) => unreadable("grips", error.to_string()),
    }
}

/// Reads a grip; fails with the wrong field and the reason.
fn proposal(step: &StepView<'_>, grip: &Map<String, Json>) -> Result<Proposal, (String, String)> {
    let declared = &step.program.actions;
    let names = || {
        let names = declared.iter().map(|field| format!("`{}`", field.name));
        names.collect::<Vec<_>>().join(", ")
    };
    let is_unknown = |name: &&String| !declared.iter().any(|field| field.name == **name);
    if let Some(name) = grip.keys().find(is_unknown) {
        let name = excerpt(name.as_bytes());
        let message = format!("the task has no field `{name}`; it has {}", names());
        return Err((name, message));
    }
    let mut fields = Vec::with_capacity(declared.len());
    for field in declared {
        let wrong = |message: String| (field.name.clone(), message);
        let stated = grip.get(&field.name);
        let stated = stated.ok_or_else(|| {
            wrong(format!(
                "`{}` is missing; a grip has {}",
                field.name,
                names()
            ))
        })?;
        let value = value(field, stated).ok_or_else(|| {
            let right = match field.is_point() {
                true => "a pixel, `[column, row]`, whole numbers".to_owned(),
                false => format!("one of {}", space::listed(field, &space::declared(field))),
            };
            wrong(format!(
                "`{}` is {}, and has to be {right}",
                field.name,
                excerpt(stated.to_string().as_bytes())
            ))
        })?;
        fields.push((field.name.clone(), value));
    }
    Ok(Proposal { fields })
}

fn value(field: &ActionField, stated: &Json) -> Option<Value> {
    if field.is_point() {
        return PixelPoint::deserialize(stated).ok().map(Value::Point);
    }
    let text = stated.as_str()?;
    let mut declared = space::declared(field).into_iter();
    declared.find(|value| space::text(field, value) == text)
}

/// Writes the files that the rollout itself does not store; returns all files by their names in the run folder.
fn write_files(
    step: &StepView<'_>,
    folder: &Path,
) -> Result<(Pictures, Option<PathBuf>), JournalError> {
    let name = |what: &str| PathBuf::from(format!("step_{}/{what}", step.number));
    let write = |what: &str, bytes: &[u8]| {
        let (name, path) = (name(what), folder.join(name(what)));
        let parent = path.parent().unwrap_or(folder);
        let written =
            std::fs::create_dir_all(parent).and_then(|()| files::write_whole(&path, bytes));
        match written {
            Ok(()) => Ok(name),
            Err(error) => Err(JournalError::Unwritable {
                path,
                why: error.to_string(),
            }),
        }
    };
    let depth = &step.observation.depth_m;
    let shape = [u64::from(depth.height()), u64::from(depth.width())];
    let subgoal = |what: &str, which| {
        let shown = step.pictures.subgoals.as_ref();
        let shown = shown.map(|it| png::encode(it.picture(which, Arrow::Absent)));
        shown.map(|png| write(what, &png)).transpose()
    };
    let pictures = Pictures {
        scene: name("before.png"),
        annotated: write("annotated.png", &png::encode(&step.pictures.annotated))?,
        depth: write(
            "depth.npy",
            &npy::encode_floats(&shape, depth.iter().copied()),
        )?,
        subgoal_now: subgoal("subgoal_now.png", SubgoalStep::Now)?,
        subgoal_next: subgoal("subgoal_next.png", SubgoalStep::Next)?,
    };
    let particles = step.truth.as_ref();
    let particles = particles.map(|it| write("particles.npy", &npy::encode(it.particles)));
    Ok((pictures, particles.transpose()?))
}

/// Returns the question that begins a rollout, with files by their names in the run folder.
fn reset(step: &StepView<'_>) -> protocol::Question {
    let program = step.program;
    protocol::Question::Reset(Box::new(protocol::Reset {
        task: program.task.clone(),
        variant: program.variant.clone(),
        program: PathBuf::from("program.json"),
        spaces: Spaces::of(program),
        horizon: step.horizon,
        attempts: program.verify.attempts,
        repetition: step.repetition,
        grid: step.truth.map(|_| program.cloth.clone()),
    }))
}

/// Returns the question for a decision, with files by their names in the run folder.
fn decide(
    step: &StepView<'_>,
    (pictures, particles): &(Pictures, Option<PathBuf>),
    refusals: &[Refusal],
) -> protocol::Question {
    let actions = &step.program.actions;
    let offered = actions.iter().map(|field| {
        let offered = match &field.choices {
            Choices::Region { mask } => Offered::Region {
                any_of: mask.clone(),
            },
            _ => {
                let values = space::choices(field, step.scene);
                let values = values.iter().map(|value| FieldValue::of(field, value));
                Offered::Values(values.collect())
            }
        };
        (field.name.clone(), offered)
    });
    let refusals = refusals.iter().map(|refusal| Refused {
        grips: refusal
            .proposal
            .iter()
            .map(|it| grip(actions, it))
            .collect(),
        check: refusal.check.clone(),
        why: refusal.why.clone(),
    });
    protocol::Question::Decide(Box::new(Decide {
        step: step.step,
        action: step.number,
        pictures: pictures.clone(),
        camera: Pinhole::of(&step.observation.camera),
        keypoints: step.scene.to_json(),
        offered: offered.collect(),
        last: step.last.map(|last| Last {
            grips: vec![grip(actions, &last.proposal)],
            picked_px: vec![last.pick],
            placed_px: vec![last.place],
        }),
        refusals: refusals.collect(),
        particles: particles.clone(),
    }))
}

fn text(questions: &impl Serialize) -> String {
    serde_json::to_string(questions).expect("questions have string keys and finite numbers")
}
