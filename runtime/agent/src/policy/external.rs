//! The policy of a user's program, in any language.
//!
//! In: lines of JSON, as [`protocol`] types them: what stays the same in a rollout, then for each proposal pictures by
//! path, keypoints, the offered choices, refusals so far. Out: one line each, with the grips or a refusal. The program is
//! started at the first question, and its answers are stored in the run folder before they are used: a resumed rollout
//! asks only new questions.

use super::proposing::{Refusal, STAGE, Source, stop, until_accepted};
use super::protocol::{
    self, Answer, Decide, FieldValue, Grip, Hello, Last, Offered, PROTOCOL, Pictures, Ready,
    Refused, grip,
};
use super::{
    Decision, Description, Exchange, Exchanged, Finding, Kind, Policy, Question, RunError, StepView,
};
use crate::journal;
use crate::outcome::Outcome;
use fab_base::child::{Child, ChildError, CommandLine, excerpt};
use fab_base::interrupt::Interrupt;
use fab_base::wording::quoted;
use fab_base::{digest, npy};
use fab_model::Reply;
use fab_picture::camera::Pinhole;
use fab_picture::png;
use fab_program::reply::Malformed;
use fab_program::spaces::Spaces;
use fab_program::{Arrow, Choices, Proposal, SubgoalStep, Value, space};
use serde::Serialize;
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
        let name = match self.sight {
            Sight::Camera => format!("exec:{}", self.command),
            Sight::Particles => format!("exec+particles:{}", self.command),
        };
        Description {
            sees_particles: self.sight == Sight::Particles,
            code: Some(self.code.clone()),
            ..Description::new(Kind::Program, name)
        }
    }

    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, RunError> {
        let folder = step.folder.and_then(|it| std::path::absolute(it).ok());
        let Some(folder) = &folder.filter(|it| it.to_str().is_some()) else {
            let why = "a program is given files by their paths, and there is no run folder whose path is UTF-8: choose another one with `--out`";
            return Err(RunError::Unfit(why.to_owned()));
        };
        write_files(step, folder)?;
        until_accepted(step, exchange, &mut |refusals, exchange| {
            let asked_in = |folder: &Path| [reset(step, folder), decide(step, folder, refusals)];
            // Relative paths make equal questions equal in any run folder.
            let key = digest::of(text(&asked_in(Path::new(""))));
            let sent = asked_in(folder);
            let text = text(&sent[1]);
            let question = Question::Line { key, text };
            let files = (exchange.record)(Exchanged::Question {
                stage: STAGE,
                attempt: refusals.len() as u32 + 1,
                question: &question,
            })?;
            let interrupt = exchange.interrupt;
            let asked = exchange
                .asking
                .once(&question.key(), |_| self.ask(&sent, folder, interrupt))
                .map_err(RunError::failed)?;
            let (reply, answer) = match asked {
                Ok(reply) => {
                    let answer = read(step, &reply.text);
                    (Some(reply), answer)
                }
                Err(error) => {
                    self.child = None;
                    let outcome = match error {
                        ChildError::Interrupted => Outcome::Interrupted,
                        ChildError::Failed(_) => Outcome::PolicyFailed,
                    };
                    (None, stop(outcome, error.to_string()))
                }
            };
            let source = Source {
                sent: files,
                reply,
                note: None,
            };
            Ok((source, answer))
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
    ) -> Result<Reply, ChildError> {
        let limit = self.limit;
        let child = match &mut self.child {
            Some(child) => child,
            absent => {
                let stderr = folder.join(STDERR_FILE);
                let child = absent.insert(Child::start(&self.command, Some(&stderr))?);
                let hello = protocol::Question::Hello { protocol: PROTOCOL };
                let Hello { protocol } = child.ask(&hello, limit, interrupt)?;
                if protocol != PROTOCOL {
                    return Err(ChildError::Failed(format!(
                        "`{}` answers version {protocol} of the lines; this fabc asks in version {PROTOCOL}",
                        self.command
                    )));
                }
                let ready: Ready = child.ask(reset, limit, interrupt)?;
                if let Some(why) = ready.refuse {
                    return Ok(Reply::text(text(&Answer::Refuse(why))));
                }
                child
            }
        };
        child.send(decide)?;
        let line = child.receive(limit, interrupt)?;
        if let Err(error) = serde_json::from_slice::<Answer>(&line) {
            let why = format!("{error}; it has either `grips`, a list of one grip, or `refuse`");
            return Err(child.no_answer(&line, why));
        }
        Ok(Reply::text(String::from_utf8_lossy(&line).into_owned()))
    }
}

/// Reads a line that the program wrote in answer to a question for a decision.
fn read(step: &StepView<'_>, line: &str) -> Result<Proposal, Box<Finding>> {
    match serde_json::from_str(line) {
        Ok(Answer::Grips([grip])) => proposal(step, grip),
        Ok(Answer::Refuse(why)) => stop(Outcome::PolicyStopped, excerpt(why.trim().as_bytes())),
        Err(error) => Err(unreadable("grips", error.to_string())),
    }
}

fn unreadable(field: &str, message: String) -> Box<Finding> {
    Box::new(Finding::Malformed(Malformed {
        field: field.to_owned(),
        message,
        stated: Vec::new(),
    }))
}

/// Reads a grip; fails with the wrong field and the reason.
fn proposal(step: &StepView<'_>, mut grip: Grip) -> Result<Proposal, Box<Finding>> {
    let declared = &step.program.actions;
    let fields = declared.iter().map(|field| {
        let name = &field.name;
        let stated = grip.remove(name);
        let offered = space::declared(field);
        let value = match &stated {
            Some(FieldValue::Pixel(pixel)) if field.is_point() => Some(Value::Point(*pixel)),
            Some(FieldValue::Text(text)) => {
                let mut offered = offered.iter();
                offered.find(|it| space::text(field, it) == *text).cloned()
            }
            _ => None,
        };
        let value = value.ok_or_else(|| {
            let right = if field.is_point() {
                "a pixel, `[column, row]`, whole numbers".to_owned()
            } else {
                format!("one of {}", space::listed(field, &offered))
            };
            let is = match &stated {
                Some(stated) => excerpt(text(stated).as_bytes()),
                None => "missing".to_owned(),
            };
            unreadable(name, format!("`{name}` is {is}, and has to be {right}"))
        })?;
        Ok((name.clone(), value))
    });
    let fields = fields.collect::<Result<_, Box<Finding>>>()?;
    if let Some(name) = grip.keys().next() {
        let name = excerpt(name.as_bytes());
        let names = quoted(declared.iter().map(|field| &field.name));
        let message = format!("the task has no field `{name}`; it has {names}");
        return Err(unreadable(&name, message));
    }
    Ok(Proposal { fields })
}

/// Returns the path of a step's file in a run folder.
fn file(step: &StepView<'_>, folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("step_{}/{name}", step.number))
}

/// Writes the files that the rollout itself does not store.
fn write_files(step: &StepView<'_>, folder: &Path) -> Result<(), RunError> {
    let depth = &step.observation.depth_m;
    let shape = [u64::from(depth.height()), u64::from(depth.width())];
    let depth = npy::encode_floats(&shape, depth.iter().copied());
    let mut files = vec![
        ("annotated.png", png::encode(&step.pictures.annotated)),
        ("depth.npy", depth),
    ];
    if let Some(shown) = &step.pictures.subgoals {
        let picture = |which| png::encode(shown.picture(which, Arrow::Absent));
        files.push(("subgoal_now.png", picture(SubgoalStep::Now)));
        files.push(("subgoal_next.png", picture(SubgoalStep::Next)));
    }
    if let Some(truth) = step.truth {
        files.push(("particles.npy", npy::encode(truth.particles)));
    }
    for (name, bytes) in files {
        journal::write(&file(step, folder, name), &bytes)?;
    }
    Ok(())
}

/// Returns the question that begins a rollout, with the paths of files in a run folder.
fn reset(step: &StepView<'_>, folder: &Path) -> protocol::Question {
    let program = step.program;
    protocol::Question::Reset(Box::new(protocol::Reset {
        task: program.task.clone(),
        variant: program.variant.clone(),
        program: folder.join("program.json"),
        spaces: Spaces::of(program),
        horizon: step.horizon,
        attempts: program.verify.attempts,
        repetition: step.repetition,
        grid: step.truth.map(|_| program.cloth.clone()),
    }))
}

/// Returns the question for a decision, with the paths of files in a run folder.
fn decide(step: &StepView<'_>, folder: &Path, refusals: &[Refusal]) -> protocol::Question {
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
    let refusals = refusals.iter().map(|refusal| {
        let grips = refusal.proposal.iter().map(|it| grip(actions, it));
        Refused {
            grips: grips.collect(),
            check: refusal.check.clone(),
            why: refusal.why.clone(),
        }
    });
    let file = |name: &str| file(step, folder, name);
    let subgoal = |name| step.pictures.subgoals.as_ref().map(|_| file(name));
    protocol::Question::Decide(Box::new(Decide {
        step: step.step,
        action: step.number,
        pictures: Pictures {
            scene: file("before.png"),
            annotated: file("annotated.png"),
            depth: file("depth.npy"),
            subgoal_now: subgoal("subgoal_now.png"),
            subgoal_next: subgoal("subgoal_next.png"),
        },
        camera: Pinhole::of(&step.observation.camera),
        keypoints: step.scene.to_json(),
        offered: offered.collect(),
        last: step.last.map(|last| Last {
            grips: vec![grip(actions, &last.proposal)],
            picked_px: vec![last.pick],
            placed_px: vec![last.place],
        }),
        refusals: refusals.collect(),
        particles: step.truth.map(|_| file("particles.npy")),
    }))
}

fn text(lines: &impl Serialize) -> String {
    serde_json::to_string(lines).expect("lines have string keys and finite numbers")
}
