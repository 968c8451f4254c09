//! What the camera adds to a task: scenes, pictures, and the full text of each stage.
//!
//! Simulation is lazy: if scenes and pictures are pinned, no cloth is laid. The authoring tool has no camera; it renders
//! texts for scenes that are pinned, and cannot draw.

use super::expected::Page;
use super::scene::PinnedScene;
use crate::exit::Failure;
use crate::io::Io;
use fab_program::{Picture, Program, Stage};

#[cfg(feature = "runtime")]
pub use crate::verbs::render::camera::Seen;
#[cfg(feature = "runtime")]
use {
    super::scene::PinnedAction, crate::sources::TaskArguments,
    crate::verbs::render::camera::fitted_to_start, crate::verbs::runtime::setting::StartArguments,
    fab_base::interrupt::Interrupt, fab_picture::png, fab_program::scene::SceneView,
};

/// The authoring tool sees nothing.
#[cfg(not(feature = "runtime"))]
pub type Seen = ();

/// Replaces programs whose cloth comes from a file of another grid by fitting ones, as a run does.
#[cfg(feature = "runtime")]
pub fn fitted(file: &str, programs: Vec<Program>, io: &Io) -> Result<Vec<Program>, Failure> {
    let fit = |program: Program| {
        let task = TaskArguments {
            file: file.to_owned(),
            task: Some(program.task.clone()),
            variant: program.variant.clone(),
        };
        let start = StartArguments::default();
        fitted_to_start(&task, &program, &start, &Interrupt::default(), io)
    };
    programs.into_iter().map(fit).collect()
}

#[cfg(feature = "runtime")]
impl Page<'_> {
    /// Returns what the camera sees.
    pub fn look(&self, seen_of: String) -> Result<PinnedScene, Failure> {
        let seen = &self.seen()?.scene;
        let names = || self.program.keypoints.iter().map(|it| it.name.clone());
        let points = names().filter_map(|name| Some((name.clone(), seen.scene.points(&name)?)));
        let areas = names().filter_map(|name| Some((name.clone(), seen.scene.area_px(&name)?)));
        let last = seen.last.as_ref().map(|last| PinnedAction {
            fields: last.proposal.fields.iter().cloned().collect(),
            pick: last.pick,
            place: last.place,
        });
        Ok(PinnedScene {
            seen_of,
            start: (),
            step: self.moment.step,
            last,
            points: points.collect(),
            areas: areas.collect(),
        })
    }

    /// Draws a picture as it is sent to a model that works in the camera's pixels.
    pub fn draw(&self, picture: &Picture) -> Result<Option<Vec<u8>>, Failure> {
        let pictures = &self.seen()?.pictures;
        let drawn = match picture {
            Picture::Subgoal { which, arrow } => {
                let subgoals = pictures.subgoals.as_ref();
                subgoals.map(|it| it.picture(*which, *arrow))
            }
            Picture::Scene { .. } => Some(&pictures.annotated),
        };
        Ok(drawn.map(png::encode))
    }

    fn seen(&self) -> Result<&Seen, Failure> {
        if let Some(seen) = self.seen.get() {
            return Ok(seen);
        }
        let start = StartArguments::default();
        let (program, folder, step) = (self.program, self.source.folder, self.moment.step);
        let interrupt = Interrupt::default();
        let seen = Seen::at(program, program, folder, &start, step, &interrupt, self.io)?;
        Ok(self.seen.get_or_init(|| seen))
    }
}

impl Page<'_> {
    /// Returns whether this build can tell the text of a stage: the authoring tool cannot read demonstrations.
    pub fn can_tell(&self, stage: &Stage) -> bool {
        let mut demos = self.program.demos.iter();
        let is_told = cfg!(feature = "runtime") || demos.all(|demos| demos.stage != stage.name);
        if !is_told {
            self.io.talk(&format!(
                "note: `{}` is shown demonstrations in stage {}, which this build of fabc cannot read; its snapshots are not checked",
                self.program.title(),
                stage.name
            ));
        }
        is_told
    }
}

#[cfg(not(feature = "runtime"))]
pub fn fitted(_file: &str, programs: Vec<Program>, _io: &Io) -> Result<Vec<Program>, Failure> {
    Ok(programs)
}

#[cfg(not(feature = "runtime"))]
impl Page<'_> {
    pub fn look(&self, _seen_of: String) -> Result<PinnedScene, Failure> {
        Err(Failure::environment(format!(
            "the scene `{}` of `{}` is not pinned, or is of another cloth, camera or keypoints; this build of fabc has no camera to see it anew",
            self.moment.name,
            self.program.title()
        )))
    }

    pub fn draw(&self, _: &Picture) -> Result<Option<Vec<u8>>, Failure> {
        self.io.talk(&format!(
            "note: a picture of `{}` may have changed, and this build of fabc cannot draw",
            self.program.title()
        ));
        Ok(None)
    }
}
