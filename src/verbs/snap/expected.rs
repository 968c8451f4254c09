//! The snapshots that a task should have: scenes, the text of each stage in each scene, and the pictures drawn for it.
//!
//! A variant shares the scenes and pictures of its task in which it would see and draw the same.

use super::SnapArguments;
use super::camera::Camera;
use super::plan::{Expected, Plan, State};
use super::scene::{Moment, PinnedScene, USUAL, hashes_of_pictures, short_hash};
use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{Contents, Info, Name, Origin, Side, Snapshot};
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
use std::path::{Path, PathBuf};

/// The last part of the name of a scene's snapshot.
const POINTS: &str = "points";

/// A task and what its variants share with it.
struct Task<'a> {
    plan: &'a Plan,
    io: &'a Io,
    source: &'a str,
    /// Holds its file.
    folder: PathBuf,
    /// Whether to draw pictures again even if their inputs are unchanged.
    redraws: bool,
    /// Its scenes: the usual ones of the task and its variants, and those added on request.
    moments: BTreeSet<Moment>,
    /// The task's own scenes.
    scenes: BTreeMap<Moment, PinnedScene>,
    /// Hashes of what the task's own pictures are drawn from, by their snapshots' titles.
    pictures: BTreeMap<(Moment, String), String>,
    /// What was found so far.
    found: Vec<(Name, Expected)>,
}

/// A program in one scene.
struct Page<'p> {
    program: &'p Program,
    moment: &'p Moment,
    scene: &'p PinnedScene,
}

/// Finds the snapshots of a task, which is the first program, and of its variants.
///
/// - `source`: the name of its file as snapshots record it.
pub fn of_task(
    programs: &[Program],
    file: &str,
    source: &str,
    arguments: &SnapArguments,
    plan: &Plan,
    io: &Io,
) -> Result<Vec<(Name, Expected)>, Failure> {
    let mut task = Task {
        plan,
        io,
        source,
        folder: sources::folder_of(file),
        redraws: arguments.redraw,
        moments: moments(programs, arguments, plan)?,
        scenes: BTreeMap::new(),
        pictures: BTreeMap::new(),
        found: Vec::new(),
    };
    for program in programs {
        task.add(program)?;
    }
    Ok(task.found)
}

/// Finds the scenes of a task: the usual ones, those that were pinned on request, and the one that is requested now.
fn moments(
    programs: &[Program],
    arguments: &SnapArguments,
    plan: &Plan,
) -> Result<BTreeSet<Moment>, Failure> {
    let task = &programs[0];
    let mut moments: BTreeSet<Moment> = programs.iter().flat_map(Moment::of).collect();
    let (start, end) = (format!("{}@", task.task), format!(".{POINTS}"));
    for name in plan.folder.accepted.union(&plan.folder.pending) {
        let scene = name.0.strip_prefix(&start);
        let scene = scene.and_then(|scene| scene.strip_suffix(&end));
        if let Some(scene) = scene.filter(|scene| !USUAL.contains(scene))
            && let Some(known) = known_scenes(name, plan)?.first()
        {
            moments.insert(known.moment(scene));
        }
    }
    let Some(wanted) = arguments.moment()? else {
        return Ok(moments);
    };
    if wanted.step > task.horizon {
        return Err(Failure::usage(format!(
            "`{}` has {} steps; there is no step {} to pin",
            task.task, task.horizon, wanted.step
        )));
    }
    let is_other = |known: &&Moment| known.name == wanted.name && **known != wanted;
    if let Some(known) = moments.iter().find(is_other) {
        let start = match known.start {
            Some(seed) => format!("start {seed}"),
            None => "the task's own start".to_owned(),
        };
        return Err(Failure::usage(format!(
            "the scene `{}` of `{}` is pinned already: {start}, step {}; choose another name, or remove its `.points.snap`",
            wanted.name, task.task, known.step
        )));
    }
    moments.insert(wanted);
    Ok(moments)
}

/// Reads the scenes pinned under a name: the pending one, which is newer, then the accepted one.
///
/// Fails if a readable snapshot is not a valid scene, since somebody edited it.
fn known_scenes(name: &Name, plan: &Plan) -> Result<Vec<PinnedScene>, Failure> {
    let pending = plan.pending(name).map(|it| (it, Side::Pending));
    let accepted = plan.accepted(name).map(|it| (it, Side::Accepted));
    let known = pending.into_iter().chain(accepted);
    let parsed = known.map(|(snapshot, side)| {
        let scene = match &snapshot.contents {
            Contents::Text(text) => PinnedScene::parse(text),
            Contents::Picture(_) => Err("it is a picture".to_owned()),
        };
        scene.map_err(|why| {
            let path = plan.folder.file(name, side);
            Failure::environment(format!("`{}` is no scene: {why}", path.display()))
        })
    });
    parsed.collect()
}

impl Task<'_> {
    /// Adds everything that a program needs: the task itself, or a variant after it.
    fn add(&mut self, program: &Program) -> Result<(), Failure> {
        let folder = self.folder.clone();
        let mut camera = Camera::of(program, &folder, self.io);
        let moments = self.moments.clone();
        for moment in moments.iter().filter(|it| it.step <= program.horizon) {
            let scene = &self.scene(program, moment, &mut camera)?;
            let page = Page {
                program,
                moment,
                scene,
            };
            for stage in &program.stages {
                self.stage(&page, stage, &camera)?;
            }
            self.pictures(&page, &mut camera)?;
        }
        Ok(())
    }

    /// Returns a scene: the accepted or pending one if it still fits this program, otherwise a new one from the camera.
    fn scene(
        &mut self,
        program: &Program,
        moment: &Moment,
        camera: &mut Camera<'_>,
    ) -> Result<PinnedScene, Failure> {
        let seen_of = moment.seen_of(program);
        let is_variant = program.variant.is_some();
        let shared = self.scenes.get(moment).filter(|it| it.seen_of == seen_of);
        if let Some(shared) = shared.filter(|_| is_variant) {
            return Ok(shared.clone());
        }
        let name = name(program, None, &moment.name, Some(POINTS));
        // After an undone edit, a pending scene of something else may hide an accepted one that fits, perhaps edited by
        // hand.
        let mut known = known_scenes(&name, self.plan)?.into_iter();
        let fits =
            |known: &PinnedScene| known.seen_of == seen_of && known.moment(&moment.name) == *moment;
        let scene = match known.find(fits) {
            Some(known) => known,
            None => camera.scene(moment, seen_of)?,
        };
        if !is_variant {
            self.scenes.insert(moment.clone(), scene.clone());
        }
        let page = Page {
            program,
            moment,
            scene: &scene,
        };
        let description = format!("the points seen in {}", page.title());
        let contents = Contents::Text(scene.text().trim_end().to_owned());
        self.take(name, page.info(None), description, contents);
        Ok(scene)
    }

    /// Adds the text of a stage.
    fn stage(
        &mut self,
        page: &Page<'_>,
        stage: &Stage,
        camera: &Camera<'_>,
    ) -> Result<(), Failure> {
        let name = page.name(Some(&stage.name), None);
        let info = page.info(Some(&stage.name));
        let Some(shown) = page.shown(stage, camera)? else {
            self.leave(name, info, State::Unchecked);
            return Ok(());
        };
        let texts = shown.texts().map(|said| tokens::of_text(&said.text));
        let info = Info {
            tokens: Some(texts.sum()),
            origin: origins(&shown),
            ..info
        };
        let description = format!(
            "what a model is told in stage {} of {}",
            stage.name,
            page.title()
        );
        let contents = Contents::Text(shown.text().trim_end().to_owned());
        self.take(name, info, description, contents);
        Ok(())
    }

    /// Adds the pictures that the stages show.
    fn pictures(&mut self, page: &Page<'_>, camera: &mut Camera<'_>) -> Result<(), Failure> {
        let stages = page.program.stages.iter();
        let mut seen = BTreeSet::new();
        for picture in stages.flat_map(|stage| &stage.show) {
            let title = title(&PromptPicture::Drawn(*picture), page.moment.step);
            if !seen.insert(title.clone()) {
                continue;
            }
            let drawn_from = drawn_from(page, picture, &self.folder)?;
            let key = (page.moment.clone(), title.clone());
            if page.program.variant.is_none() {
                self.pictures.insert(key, drawn_from.clone());
            } else if self.pictures.get(&key) == Some(&drawn_from) {
                continue;
            }
            let info = Info {
                picture: Some(title),
                drawn_from: Some(drawn_from),
                ..page.info(None)
            };
            self.picture(page, info, picture, camera)?;
        }
        Ok(())
    }

    /// Adds a picture: the accepted or pending one if it was drawn from the same, otherwise a new one.
    fn picture(
        &mut self,
        page: &Page<'_>,
        info: Info,
        picture: &Picture,
        camera: &mut Camera<'_>,
    ) -> Result<(), Failure> {
        let shows = info.picture.clone().unwrap_or_default();
        let name = page.name(None, Some(&shows.replace(' ', "_")));
        let is_of_this = |snapshot: &Snapshot| {
            let known = snapshot.metadata.info.as_ref();
            known.is_some_and(|known| known.drawn_from == info.drawn_from)
        };
        let accepted = self.plan.accepted(&name).filter(|it| is_of_this(it));
        let is_whole_one = accepted.is_some_and(is_whole);
        if is_whole_one && !self.redraws {
            self.leave(name, info, State::Same);
            return Ok(());
        }
        let pending = self.plan.pending(&name);
        let pending = pending.filter(|it| is_of_this(it) && is_whole(it));
        if let Some(pending) = pending.filter(|_| !self.redraws) {
            let state = self.plan.compared(&name, &pending.contents);
            let expected = Expected {
                info,
                state,
                taken: Some(pending.clone()),
            };
            self.found.push((name, expected));
            return Ok(());
        }
        let Some(png) = camera.picture(page.moment, picture)? else {
            let is_damaged = accepted.is_some() && !is_whole_one;
            let state = if is_damaged {
                State::Changed
            } else {
                State::Unchecked
            };
            self.leave(name, info, state);
            return Ok(());
        };
        let info = Info {
            bytes: Some(short_hash(&png)),
            ..info
        };
        let description = format!("{shows} of {}", page.title());
        self.take(name, info, description, Contents::Picture(png));
        Ok(())
    }

    /// Adds a snapshot with these contents.
    fn take(&mut self, name: Name, info: Info, description: String, contents: Contents) {
        let expected = Expected {
            state: self.plan.compared(&name, &contents),
            taken: Some(Snapshot::of(
                self.source,
                description,
                info.clone(),
                contents,
            )),
            info,
        };
        self.found.push((name, expected));
    }

    /// Adds a snapshot whose accepted contents stay.
    fn leave(&mut self, name: Name, info: Info, state: State) {
        let expected = Expected {
            info,
            state,
            taken: None,
        };
        self.found.push((name, expected));
    }
}

impl Page<'_> {
    fn title(&self) -> String {
        format!("{}, scene {}", self.program.title(), self.moment.name)
    }

    fn name(&self, stage: Option<&str>, picture: Option<&str>) -> Name {
        name(self.program, stage, &self.moment.name, picture)
    }

    fn info(&self, stage: Option<&str>) -> Info {
        Info {
            task: self.program.task.clone(),
            variant: self.program.variant.clone(),
            stage: stage.map(str::to_owned),
            scene: Some(self.moment.name.clone()),
            ..Info::default()
        }
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
        let shown = ShownStage::of(program, stage, values, messages);
        shown.map(Some).map_err(Failure::environment)
    }
}

/// Returns `TASK.STAGE@SCENE`, `TASK.VARIANT.STAGE@SCENE`, or `TASK@SCENE.PART`.
fn name(program: &Program, stage: Option<&str>, scene: &str, part: Option<&str>) -> Name {
    let stage = stage.map_or(String::new(), |stage| format!(".{stage}"));
    let part = part.map_or(String::new(), |part| format!(".{part}"));
    let title = program.title().replace('/', ".");
    Name(format!("{title}{stage}@{scene}{part}"))
}

/// Returns whether a picture has the bytes that were drawn. Bytes that were swapped, as by a bad merge, have not.
fn is_whole(snapshot: &Snapshot) -> bool {
    let bytes = snapshot.metadata.info.as_ref().map(|info| &info.bytes);
    match &snapshot.contents {
        Contents::Text(_) => false,
        Contents::Picture(png) => bytes.is_some_and(|bytes| *bytes == Some(short_hash(png))),
    }
}

/// Returns the origins of a page's lines; merges those that are consecutive in the file.
fn origins(shown: &ShownStage) -> Vec<Origin> {
    let mut origins: Vec<Origin> = Vec::new();
    for (line, number) in shown.lines().iter().zip(1u32..) {
        let Some(origin) = &line.origin else {
            continue;
        };
        let place = origin.place.as_ref();
        let next = Origin {
            from: number,
            to: number,
            component: origin.source.replace(' ', "_"),
            place: place.map(|place| (place.file.clone(), place.line)),
        };
        match origins.last_mut() {
            Some(before) if is_followed(before, &next) => before.to = number,
            _ => origins.push(next),
        }
    }
    origins
}

/// Returns whether `next` directly follows `before`, on the page and in its file.
fn is_followed(before: &Origin, next: &Origin) -> bool {
    let count = before.to + 1 - before.from;
    let place = before.place.as_ref();
    let place = place.map(|(file, line)| (file.clone(), line + count));
    before.to + 1 == next.from && before.component == next.component && place == next.place
}

/// Returns the hash of all inputs of a picture.
fn drawn_from(page: &Page<'_>, picture: &Picture, folder: &Path) -> Result<String, Failure> {
    let Page { program, scene, .. } = page;
    let what = match picture {
        Picture::Subgoal { .. } => json!({
            "picture": picture,
            "step": scene.step,
            "cloth": program.cloth,
            "camera": program.camera,
            "picker": program.picker,
            "subgoals": program.subgoals,
            "files": hashes_of_pictures(program, folder)?,
        }),
        Picture::Scene { .. } => json!({
            "picture": picture,
            "scene": scene.text(),
            "layers": program.layers,
        }),
    };
    Ok(short_hash(what.to_string()))
}
