//! The policy of a user's program, in any language.
//!
//! In: one line of JSON per proposal: pictures by path, keypoints, the offered choices, refusals so far. Out: one line
//! with the grips, or a refusal. `docs/policies.md` documents both. The program is started at the first question, and
//! its answers are stored in the run folder before they are used: a resumed rollout asks only new questions.

use super::proposing::{Answer, Proposed, Refusal, until_accepted};
use super::{Decision, Description, Exchange, Kind, Policy, PolicyError, Question, StepView};
use crate::outcome::Outcome;
use fab_base::child::{Child, ChildError, CommandLine, excerpt};
use fab_base::{digest, files, npy};
use fab_model::Reply;
use fab_picture::camera::Pinhole;
use fab_picture::png;
use fab_program::{ActionField, Arrow, Choices, PixelPoint, Proposal, SubgoalStep, Value, space};
use serde::Deserialize;
use serde_json::{Map, Value as Json, json};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Version of the protocol.
const PROTOCOL: u32 = 1;

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
        let files = Files::write(step, folder).map_err(|(name, error)| {
            crate::journal::JournalError::Unwritable {
                path: folder.join(name),
                why: error.to_string(),
            }
        })?;
        until_accepted(step, exchange, &mut |refusals, exchange| {
            // Relative paths make equal questions equal in any run folder.
            let relative = question(step, &files, refusals, &|name| PathBuf::from(name));
            let key = digest::of(relative.to_string());
            let sent = question(step, &files, refusals, &|name| folder.join(name));
            let interrupt = exchange.interrupt;
            let asked = exchange
                .asking
                .once(&key, || self.ask(&sent, folder, interrupt))?;
            let (reply, answer) = match asked {
                Ok(reply) => {
                    let answer = read(step, &reply.text);
                    (Some(reply), answer)
                }
                Err(ChildError::Interrupted) => {
                    let why = ChildError::Interrupted.to_string();
                    let outcome = Outcome::Interrupted;
                    (None, Answer::Stop { outcome, why })
                }
                Err(error) => {
                    self.child = None;
                    let outcome = Outcome::PolicyFailed;
                    let why = error.to_string();
                    (None, Answer::Stop { outcome, why })
                }
            };
            let text = sent.to_string();
            Ok(Proposed {
                question: Some(Question::Line { key, text }),
                reply,
                note: None,
                answer,
            })
        })
    }
}

impl External {
    /// Returns the program's line after checking that it is a valid answer.
    fn ask(
        &mut self,
        question: &Json,
        folder: &Path,
        interrupt: &fab_base::interrupt::Interrupt,
    ) -> Result<Reply, ChildError> {
        let child = match &mut self.child {
            Some(child) => child,
            absent => {
                let stderr = folder.join(STDERR_FILE);
                absent.insert(Child::start(&self.command, Some(&stderr))?)
            }
        };
        child.send(question)?;
        let line = child.receive(self.limit, interrupt)?;
        child.read::<Line>(&line)?;
        Ok(Reply::text(String::from_utf8_lossy(&line).into_owned()))
    }
}

/// A program's answer: one of the two fields.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    /// The action of each gripper.
    grips: Option<Vec<Map<String, Json>>>,
    /// The reason for proposing nothing further.
    refuse: Option<String>,
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

/// The files of a step, by their names in the run folder.
struct Files {
    scene: String,
    annotated: String,
    depth: String,
    subgoals: Option<[String; 2]>,
    particles: Option<String>,
}

impl Files {
    /// Writes the files that the rollout itself does not store.
    fn write(step: &StepView<'_>, folder: &Path) -> Result<Files, (String, std::io::Error)> {
        let name = |what: &str| format!("step_{}/{what}", step.number);
        let write = |what: &str, bytes: &[u8]| {
            let name = name(what);
            let path = folder.join(&name);
            let parent = path.parent().unwrap_or(folder);
            let written =
                std::fs::create_dir_all(parent).and_then(|()| files::write_whole(&path, bytes));
            written
                .map(|()| name.clone())
                .map_err(|error| (name, error))
        };
        let depth = &step.observation.depth_m;
        let shape = [u64::from(depth.height()), u64::from(depth.width())];
        let subgoals = match &step.pictures.subgoals {
            None => None,
            Some(pictures) => {
                let picture = |which| png::encode(pictures.picture(which, Arrow::Absent));
                Some([
                    write("subgoal_now.png", &picture(SubgoalStep::Now))?,
                    write("subgoal_next.png", &picture(SubgoalStep::Next))?,
                ])
            }
        };
        let particles = match &step.truth {
            None => None,
            Some(truth) => Some(write("particles.npy", &npy::encode(truth.particles))?),
        };
        Ok(Files {
            scene: name("before.png"),
            annotated: write("annotated.png", &png::encode(&step.pictures.annotated))?,
            depth: write(
                "depth.npy",
                &npy::encode_floats(&shape, depth.iter().copied()),
            )?,
            subgoals,
            particles,
        })
    }
}

/// Writes the question for a program.
///
/// - `place`: maps a file name of the run folder to the path in the question.
fn question(
    step: &StepView<'_>,
    files: &Files,
    refusals: &[Refusal],
    place: &dyn Fn(&str) -> PathBuf,
) -> Json {
    let program = step.program;
    let offered = program.actions.iter().map(|field| {
        let values = match &field.choices {
            Choices::Region { mask } => json!({ "any_of": mask }),
            _ => {
                let values = space::choices(field, step.scene);
                values.iter().map(|value| written(field, value)).collect()
            }
        };
        (field.name.clone(), values)
    });
    let grip = |proposal: &Proposal| -> Json {
        let fields = program.actions.iter().filter_map(|field| {
            let value = proposal.get(&field.name)?;
            Some((field.name.clone(), written(field, value)))
        });
        Json::Object(fields.collect())
    };
    let lengths = program
        .actions
        .iter()
        .filter_map(|field| match &field.choices {
            Choices::Lengths { choices, .. } => {
                let texts = choices.iter().map(|choice| {
                    let length = Value::Length {
                        length: choice.value,
                    };
                    (space::text(field, &length), json!(choice.m))
                });
                Some((field.name.clone(), Json::Object(texts.collect())))
            }
            _ => None,
        });
    let refusals = refusals.iter().map(|refusal| {
        let grips = refusal.proposal.iter().map(grip);
        json!({ "grips": grips.collect::<Vec<_>>(), "check": refusal.check, "why": refusal.why })
    });
    let mut question = json!({
        "protocol": PROTOCOL,
        "task": program.task,
        "variant": program.variant,
        "program": place("program.json"),
        "repetition": step.repetition,
        "step": step.step,
        "horizon": step.horizon,
        "action": step.number,
        "pictures": {
            "scene": place(&files.scene),
            "annotated": place(&files.annotated),
            "depth": place(&files.depth),
            "subgoal_now": files.subgoals.as_ref().map(|[now, _]| place(now)),
            "subgoal_next": files.subgoals.as_ref().map(|[_, next]| place(next)),
        },
        "camera": Pinhole::of(&step.observation.camera),
        "keypoints": step.scene.to_json(),
        "offered": Json::Object(offered.collect()),
        "lengths_m": Json::Object(lengths.collect()),
        "last": step.last.map(|last| json!({
            "grips": [grip(&last.proposal)],
            "pick_px": last.pick,
            "place_px": last.place,
        })),
        "attempts": program.verify.attempts,
        "refusals": refusals.collect::<Vec<_>>(),
    });
    if let Some(particles) = &files.particles {
        question["particles"] = json!(place(particles));
        question["grid"] = json!(program.cloth);
    }
    question
}

/// Writes a value in the form of a grip's field.
fn written(field: &ActionField, value: &Value) -> Json {
    match value {
        Value::Point(point) => json!(point),
        other => json!(space::text(field, other)),
    }
}
