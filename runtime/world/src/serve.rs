//! The bundled simulator as a program that answers lines, like any world in another language.
//!
//! In: questions of [`protocol`], line by line. Out: their answers. It serves as an example of the protocol; a rollout
//! in it equals one in [`SimulatedWorld`], bit for bit.

use crate::protocol::{self, CameraView, ClothState, Hello, Nothing, Positions, Question};
use crate::start::Start;
use crate::{Motion, SimulatedWorld, World, WorldError, conformance};
use fab_base::interrupt::Interrupt;
use fab_base::{files, npy};
use fab_picture::camera::Pinhole;
use fab_picture::png;
use fab_program::{MANNERS, Picker};
use serde::Serialize;
use serde_json::{Value, json};
use std::io::{self, BufRead, Write};
use std::path::PathBuf;
use std::sync::mpsc::channel;
use std::thread;

/// The largest positions file accepted, bytes.
const MAX_BYTES: u64 = 256 << 20;

/// Answers questions until there are no more.
///
/// Fails if an answer cannot be written. Lines that are not questions are refused.
pub fn serve(questions: impl BufRead + Send + 'static, answers: &mut impl Write) -> io::Result<()> {
    // Each question has its own interrupt, so a late one has no effect.
    let (send, lines) = channel();
    thread::spawn(move || {
        let mut newest = Interrupt::default();
        for line in questions.lines().map_while(Result::ok) {
            let question = serde_json::from_str(&line);
            if let Ok(Question::Interrupt) = question {
                newest.raise();
                continue;
            }
            newest = Interrupt::default();
            if send.send((question, newest.clone())).is_err() {
                break;
            }
        }
    });
    let mut served = Served::default();
    while let Ok((question, interrupt)) = lines.recv() {
        let answer = match question {
            Ok(question) => served.answer(question, &interrupt),
            Err(error) => Err(Stopped::Refused(format!("it is not a question: {error}"))),
        };
        let answer = answer.unwrap_or_else(|stopped| match stopped {
            Stopped::Refused(why) => json!({ "refused": why }),
            Stopped::Interrupted => json!({ "interrupted": true }),
        });
        writeln!(answers, "{answer}")?;
        answers.flush()?;
    }
    Ok(())
}

/// Why there is no answer.
enum Stopped {
    Refused(String),
    Interrupted,
}

impl From<WorldError> for Stopped {
    fn from(error: WorldError) -> Stopped {
        match error {
            WorldError::Interrupted => Stopped::Interrupted,
            WorldError::Start { why, .. } | WorldError::Motion { why } => Stopped::Refused(why),
            error => Stopped::Refused(error.to_string()),
        }
    }
}

impl From<io::Error> for Stopped {
    fn from(error: io::Error) -> Stopped {
        Stopped::Refused(error.to_string())
    }
}

/// The simulator, and its folder for files.
#[derive(Default)]
struct Served {
    world: Option<SimulatedWorld>,
    folder: PathBuf,
}

impl Served {
    fn answer(&mut self, question: Question, interrupt: &Interrupt) -> Result<Value, Stopped> {
        Ok(match question {
            Question::Hello { protocol, folder } => {
                if protocol != protocol::PROTOCOL {
                    return Err(Stopped::Refused(format!(
                        "the lines have version {protocol}, and this program answers version {}",
                        protocol::PROTOCOL
                    )));
                }
                self.folder = folder;
                written(hello(&standard()?))
            }
            Question::Reset {
                camera,
                picker,
                start,
            } => {
                let world = SimulatedWorld::new(&camera, picker)?;
                let mut world = world.with_material(start.material.as_ref());
                world.reset(&read(&start)?)?;
                self.world = Some(world);
                written(Nothing {})
            }
            Question::Observe => {
                let world = self.world.as_mut().ok_or(WorldError::NotReset)?;
                let seen = world.observe()?;
                let [rgb, depth] = ["rgb.png", "depth.npy"].map(|name| self.folder.join(name));
                files::write_whole(&rgb, &png::encode(&seen.rgb))?;
                let (width, height) = seen.depth_m.dimensions();
                let shape = [height, width].map(u64::from);
                let numbers = seen.depth_m.iter().copied();
                files::write_whole(&depth, &npy::encode_floats(&shape, numbers))?;
                written(CameraView {
                    rgb,
                    depth,
                    time_s: seen.time_s,
                    camera: Pinhole::of(&seen.camera)
                        .expect("the simulated lens has no distortion"),
                })
            }
            Question::Act { grips } => {
                let world = self.world.as_mut().ok_or(WorldError::NotReset)?;
                written(world.act(&Motion { grips }, interrupt)?)
            }
            Question::Particles => {
                let particles = self.world.as_ref().and_then(World::particles);
                let particles = particles.ok_or(WorldError::NotReset)?;
                self.positions("particles.npy", &particles)?
            }
            Question::Crumple { seed, start } => {
                let world = standard()?.with_material(start.material.as_ref());
                let heap = world.crumple(&read(&start)?, seed, interrupt)?;
                self.positions("heap.npy", &heap.positions)?
            }
            Question::Reach { .. } => {
                return Err(Stopped::Refused("everything is in reach".to_owned()));
            }
            Question::Interrupt => written(Nothing {}),
        })
    }

    fn positions(&self, name: &str, positions: &[[f32; 3]]) -> Result<Value, Stopped> {
        let path = self.folder.join(name);
        files::write_whole(&path, &npy::encode(positions))?;
        Ok(written(Positions { positions: path }))
    }
}

/// Returns a simulator for questions that need no picture.
fn standard() -> Result<SimulatedWorld, WorldError> {
    SimulatedWorld::new(&conformance::camera(), Picker::default())
}

fn hello(world: &SimulatedWorld) -> Hello {
    Hello {
        protocol: protocol::PROTOCOL,
        name: world.name().to_owned(),
        parameters: world.parameters(),
        code: world.code(),
        grippers: 1,
        particles: true,
        crumples: true,
        reach: false,
        acts_on: MANNERS.iter().map(|row| row.name.to_owned()).collect(),
        materials: true,
        repeats: true,
        limits_s: Default::default(),
    }
}

fn read(laid: &ClothState) -> Result<Start, Stopped> {
    let bytes = files::read(&laid.positions, MAX_BYTES).map_err(Stopped::Refused)?;
    let positions = npy::decode(&bytes);
    let refused = || {
        Stopped::Refused("its positions are not a float32 array of shape [particles, 3]".to_owned())
    };
    Ok(Start {
        name: laid.name.clone(),
        seed: None,
        grid: laid.grid,
        outline: None,
        positions: positions.ok_or_else(refused)?,
    })
}

fn written(answer: impl Serialize) -> Value {
    serde_json::to_value(answer).expect("an answer has string keys")
}
