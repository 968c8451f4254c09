//! The snapshots that a file should have: scenes, the text of each stage in each scene, and the pictures drawn for it.

use super::SnapArguments;
use super::camera::Camera;
use super::origins;
use super::pinned::{known_scenes, moment_of, pinned_alike, scene_name};
use super::plan::{Intended, Plan, Readable};
use super::scene::{Moment, PinnedScene, USUAL, hashes_of_pictures, short_hash};
use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{Contents, Info, Metadata, Name, Snapshot};
use crate::sources;
use crate::verbs::render::page::ShownStage;
use crate::verbs::render::title;
use fab_program::facts::Facts;
use fab_program::pointing::Pointing;
use fab_program::render::{PromptPicture, Values};
use fab_program::tokens;
use fab_program::{Picture, Program, Stage};
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};

/// The name and the intended contents of a snapshot that should exist.
pub type ExpectedSnapshot = (Name, Intended);

/// A task, and what its variants share with it.
pub struct Task {
    source: String,
    /// The snapshots found so far that should exist.
    pub snapshots: Vec<ExpectedSnapshot>,
    /// Whether to draw pictures again even if their inputs are unchanged.
    redraws: bool,
    /// Its scenes: the usual ones of the task and its variants, and those added on request.
    moments: BTreeSet<Moment>,
    /// The task's own scenes; a variant shares those in which it would see the same.
    scenes: BTreeMap<Moment, PinnedScene>,
    /// Hashes of the task's own pictures, shared likewise.
    pictures: BTreeMap<(Moment, String), String>,
}

/// A stage of one program in one scene.
struct Page<'p> {
    program: &'p Program,
    moment: &'p Moment,
    scene: &'p PinnedScene,
}

impl Task {
    /// Finds the scenes of a task, which is the first program, and of its variants.
    pub fn of(
        programs: &[Program],
        source: &str,
        arguments: &SnapArguments,
        plan: &Plan,
        io: &Io,
    ) -> Result<Task, Failure> {
        let mut moments: BTreeSet<Moment> = programs.iter().flat_map(Moment::of).collect();
        for name in plan.folder.names() {
            let Some(scene) = moment_of(name, &programs[0]) else {
                continue;
            };
            if !USUAL.contains(&scene)
                && let Some(known) = known_scenes(name, plan, io)?.into_iter().next()
            {
                moments.insert(known.moment(scene));
            }
        }
        if let Some(wanted) = arguments.moment()? {
            pinned_alike(&wanted, &moments, &programs[0])?;
            moments.insert(wanted);
        }
        Ok(Task {
            source: source.to_owned(),
            snapshots: Vec::new(),
            redraws: arguments.redraw,
            moments,
            scenes: BTreeMap::new(),
            pictures: BTreeMap::new(),
        })
    }

    /// Adds everything a program needs: the task itself, or a variant after it.
    pub fn add_expected(
        &mut self,
        program: &Program,
        file: &str,
        plan: &Plan,
        io: &Io,
    ) -> Result<(), Failure> {
        let folder = sources::folder_of(file);
        let mut camera = Camera::of(program, &folder, io);
        let moments = self.moments.clone();
        for moment in moments.iter().filter(|it| it.step <= program.horizon) {
            let scene = self.scene(program, moment, &mut camera, plan)?;
            let page = Page {
                program,
                moment,
                scene: &scene,
            };
            for stage in &program.stages {
                let info = self.info(&page, Some(&stage.name));
                let name = page.name(Some(&stage.name), None)?;
                let intended = match page.shown(stage, &camera)? {
                    Some(shown) => self.text(info, &shown),
                    None => Intended::Unchecked(info),
                };
                self.snapshots.push((name, intended));
            }
            self.pictures(&page, &mut camera, plan)?;
        }
        Ok(())
    }

    /// Returns a scene: the accepted or pending one if it still fits this task, otherwise a new one from the camera.
    fn scene(
        &mut self,
        program: &Program,
        moment: &Moment,
        camera: &mut Camera<'_>,
        plan: &Plan,
    ) -> Result<PinnedScene, Failure> {
        let seen_of = moment.seen_of(program);
        if program.variant.is_some()
            && let Some(shared) = self.scenes.get(moment).filter(|it| it.seen_of == seen_of)
        {
            return Ok(shared.clone());
        }
        let name = scene_name(program, &moment.name)?;
        // After an undone edit, a pending scene of something else may hide an accepted one that fits, perhaps edited by
        // hand.
        let known = known_scenes(&name, plan, camera.io)?.into_iter();
        let fits =
            |known: &PinnedScene| known.seen_of == seen_of && known.moment(&moment.name) == *moment;
        let scene = match { known }.find(fits) {
            Some(known) => known,
            None => camera.scene(moment, seen_of)?,
        };
        if program.variant.is_none() {
            self.scenes.insert(moment.clone(), scene.clone());
        }
        let page = Page {
            program,
            moment,
            scene: &scene,
        };
        let description = format!("the points seen in {}", page.title());
        let contents = Contents::Text(scene.text().trim_end().to_owned());
        let taken = self.taken(description, self.info(&page, None), contents);
        self.snapshots.push((name, taken));
        Ok(scene)
    }

    fn info(&self, page: &Page<'_>, stage: Option<&str>) -> Info {
        Info {
            task: page.program.task.clone(),
            variant: page.program.variant.clone(),
            stage: stage.map(str::to_owned),
            scene: Some(page.moment.name.clone()),
            ..Info::default()
        }
    }

    fn text(&self, info: Info, shown: &ShownStage) -> Intended {
        let texts = shown.texts().map(|said| tokens::of_text(&said.text));
        let stage = info.stage.clone().unwrap_or_default();
        let scene = info.scene.clone().unwrap_or_default();
        let title = match &info.variant {
            Some(variant) => format!("{}/{variant}", info.task),
            None => info.task.clone(),
        };
        let info = Info {
            tokens: Some(texts.sum()),
            origin: origins::of(shown),
            ..info
        };
        let description =
            format!("what a model is told in stage {stage} of {title}, scene {scene}");
        let contents = Contents::Text(shown.text().trim_end().to_owned());
        self.taken(description, info, contents)
    }

    fn taken(&self, description: String, info: Info, contents: Contents) -> Intended {
        let metadata = Metadata {
            source: Some(self.source.clone()),
            description: Some(description),
            info: Some(info),
            ..Metadata::default()
        };
        Intended::Taken(Box::new(Snapshot { metadata, contents }))
    }

    /// Adds the pictures that the stages show.
    fn pictures(
        &mut self,
        page: &Page<'_>,
        camera: &mut Camera<'_>,
        plan: &Plan,
    ) -> Result<(), Failure> {
        let Page {
            program,
            moment,
            scene,
        } = page;
        let shown = program.stages.iter().flat_map(|stage| &stage.show);
        let mut seen = BTreeSet::new();
        for picture in shown {
            let title = title(&PromptPicture::Drawn(*picture), moment.step);
            if !seen.insert(title.clone()) {
                continue;
            }
            let drawn_from = drawn_from(program, picture, scene, camera)?;
            let key = ((*moment).clone(), title.clone());
            if program.variant.is_none() {
                self.pictures.insert(key, drawn_from.clone());
            } else if self.pictures.get(&key) == Some(&drawn_from) {
                continue;
            }
            let name = page.name(None, Some(&title.replace(' ', "_")))?;
            let info = Info {
                picture: Some(title.clone()),
                drawn_from: Some(drawn_from),
                ..self.info(page, None)
            };
            let intended = self.picture(&name, info, page, picture, camera, plan)?;
            self.snapshots.push((name, intended));
        }
        Ok(())
    }

    fn picture(
        &self,
        name: &Name,
        info: Info,
        page: &Page<'_>,
        picture: &Picture,
        camera: &mut Camera<'_>,
        plan: &Plan,
    ) -> Result<Intended, Failure> {
        let is_of_this = |snapshot: &Snapshot| {
            let known = snapshot.metadata.info.as_ref();
            known.is_some_and(|known| known.drawn_from == info.drawn_from)
        };
        // Bytes that were swapped, as by a bad merge, match none of our pictures.
        let is_whole = |snapshot: &Snapshot| match &snapshot.contents {
            Contents::Text(_) => false,
            Contents::Picture(png) => {
                let known = snapshot.metadata.info.as_ref();
                known.is_some_and(|known| known.bytes == Some(short_hash(png)))
            }
        };
        let mut is_damaged = false;
        if let Readable::Yes(Some(accepted)) = plan.accepted(name, camera.io)
            && is_of_this(&accepted)
        {
            if is_whole(&accepted) && !self.redraws {
                return Ok(Intended::AsAccepted(info));
            }
            is_damaged = !is_whole(&accepted);
        }
        let pending = plan
            .pending(name)
            .filter(|it| is_of_this(it) && is_whole(it));
        if let Some(pending) = pending.filter(|_| !self.redraws) {
            return Ok(Intended::Taken(Box::new(pending)));
        }
        let Some(png) = camera.picture(page.moment, picture)? else {
            return Ok(match is_damaged {
                true => Intended::Damaged(info),
                false => Intended::Unchecked(info),
            });
        };
        let info = Info {
            bytes: Some(short_hash(&png)),
            ..info
        };
        let shows = info.picture.clone().unwrap_or_default();
        let description = format!("{shows} of {}", page.title());
        Ok(self.taken(description, info, Contents::Picture(png)))
    }
}

impl Page<'_> {
    fn title(&self) -> String {
        format!("{}, scene {}", self.program.title(), self.moment.name)
    }

    /// Returns `TASK.STAGE@SCENE`, `TASK.VARIANT.STAGE@SCENE`, or `TASK@SCENE.PICTURE`.
    fn name(&self, stage: Option<&str>, picture: Option<&str>) -> Result<Name, Failure> {
        name(self.program, stage, &self.moment.name, picture)
    }

    /// Returns the text of a stage in this scene; `None` if this build cannot tell.
    fn shown(&self, stage: &Stage, camera: &Camera<'_>) -> Result<Option<ShownStage>, Failure> {
        let program = self.program;
        let texts = BTreeMap::new();
        let last = self.scene.last(program);
        let values = Values::Partly(Facts {
            scene: self.scene,
            texts: &texts,
            step: self.moment.step,
            last: last.as_ref(),
            proposal: None,
            pointing: Pointing::of_camera(&program.camera),
        });
        let Some(messages) = camera.messages(stage, values, self.moment.step)? else {
            return Ok(None);
        };
        let corrections = crate::verbs::render::corrections_of(program, stage, values);
        Ok(Some(ShownStage {
            name: stage.name.clone(),
            n_asked_first: messages.len(),
            messages,
            corrections: corrections.map_err(Failure::environment)?,
            findings: Vec::new(),
            results: Vec::new(),
        }))
    }
}

pub fn name(
    program: &Program,
    stage: Option<&str>,
    scene: &str,
    part: Option<&str>,
) -> Result<Name, Failure> {
    let mut name = program.title().replace('/', ".");
    if let Some(stage) = stage {
        name.push_str(&format!(".{stage}"));
    }
    name.push_str(&format!("@{scene}"));
    if let Some(part) = part {
        name.push_str(&format!(".{part}"));
    }
    Name::new(name).map_err(Failure::environment)
}

/// Returns the hash of all inputs of a picture.
fn drawn_from(
    program: &Program,
    picture: &Picture,
    scene: &PinnedScene,
    camera: &Camera<'_>,
) -> Result<String, Failure> {
    let what = match picture {
        Picture::Subgoal { .. } => json!({
            "picture": picture,
            "step": scene.step,
            "cloth": program.cloth,
            "camera": program.camera,
            "picker": program.picker,
            "subgoals": program.subgoals,
            "files": hashes_of_pictures(program, camera.folder)?,
        }),
        Picture::Scene { .. } => json!({
            "picture": picture,
            "scene": scene.text(),
            "layers": program.layers,
        }),
    };
    Ok(short_hash(what.to_string()))
}
