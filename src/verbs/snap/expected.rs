//! The snapshots that a task should have: scenes, the text of each stage in each scene, and the pictures drawn for it.
//!
//! A variant shares the scenes and pictures of its task in which it would see and draw the same.

use super::camera::Seen;
use super::plan::{Expected, Plan};
use super::scene::{Moment, PinnedScene, hashes_of_pictures, short_hash};
use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{Contents, Info, Name, Origin, Side, Snapshot};
use crate::verbs::render::page::ShownStage;
use crate::verbs::render::title;
use fab_program::render::PromptPicture;
use fab_program::{Picture, Program, Stage, tokens};
use serde_json::json;
use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The last part of the name of a scene's snapshot.
const POINTS: &str = "points";

pub struct Source<'f> {
    /// Its name, as snapshots record it.
    pub name: &'f str,
    pub folder: &'f Path,
}

/// A program at one moment.
pub struct Page<'p> {
    pub program: &'p Program,
    pub moment: &'p Moment,
    pub source: &'p Source<'p>,
    pub io: &'p Io,
    /// What the camera sees, once somebody looked.
    pub seen: OnceCell<Seen>,
    plan: &'p Plan,
}

/// What a task's variants may share with it at one moment.
#[derive(Default)]
struct Shared {
    scene: Option<PinnedScene>,
    /// Hashes of what the task's own pictures are drawn from, by what they show.
    pictures: BTreeMap<String, String>,
}

/// Finds the snapshots of the programs of a file.
pub fn of_file(
    programs: &[Program],
    source: &Source<'_>,
    redraws: bool,
    plan: &Plan,
    io: &Io,
) -> Result<Vec<Expected>, Failure> {
    let mut found = Vec::new();
    // A task and its variants follow each other.
    for programs in programs.chunk_by(|one, other| one.task == other.task) {
        let moments: BTreeSet<Moment> = programs.iter().flat_map(Moment::of).collect();
        for moment in &moments {
            let mut shared = Shared::default();
            for program in programs.iter().filter(|it| moment.step <= it.horizon) {
                let page = Page {
                    program,
                    moment,
                    source,
                    io,
                    seen: OnceCell::new(),
                    plan,
                };
                let scene = page.scene(&mut shared, &mut found)?;
                for stage in &program.stages {
                    found.push(page.stage(stage, &scene)?);
                }
                page.pictures(&scene, redraws, &mut shared, &mut found)?;
            }
        }
    }
    Ok(found)
}

/// Reads the scenes pinned under a name: the pending one, which is newer, then the accepted one; both must be valid.
fn known_scenes(name: &str, plan: &Plan) -> Result<Vec<PinnedScene>, Failure> {
    let pending = plan.pending.get(name).map(|it| (it, Side::Pending));
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

impl Page<'_> {
    /// Returns the task's scene if a variant would see the same, or one that is pinned and still fits, or a new one.
    fn scene(
        &self,
        shared: &mut Shared,
        found: &mut Vec<Expected>,
    ) -> Result<PinnedScene, Failure> {
        let seen_of = self.moment.seen_of(self.program);
        if let Some(of_task) = shared.scene.as_ref().filter(|it| it.seen_of == seen_of) {
            return Ok(of_task.clone());
        }
        let name = self.name(None, Some(POINTS));
        // After an undone edit, a pending scene of something else may hide an accepted one that fits, perhaps edited by
        // hand.
        let mut known = known_scenes(&name, self.plan)?.into_iter();
        let fits = |known: &PinnedScene| known.seen_of == seen_of && known.step == self.moment.step;
        let scene = match known.find(fits) {
            Some(known) => known,
            None => self.look(seen_of)?,
        };
        let contents = Contents::Text(scene.text().trim_end().to_owned());
        let taken = self.snapshot("the points seen in", self.info(), contents);
        found.push((name, Some(taken)));
        if self.program.variant.is_none() {
            shared.scene = Some(scene.clone());
        }
        Ok(scene)
    }

    fn stage(&self, stage: &Stage, scene: &PinnedScene) -> Result<Expected, Failure> {
        let name = self.name(Some(&stage.name), None);
        if !self.can_tell(stage) {
            return Ok((name, None));
        }
        let (program, folder, step) = (self.program, self.source.folder, self.moment.step);
        let last = scene.last(program);
        let shown =
            ShownStage::without_camera(program, folder, stage, Some(scene), last.as_ref(), step)?;
        let tokens = shown.texts().map(|said| tokens::of_text(&said.text));
        let info = Info {
            stage: Some(stage.name.clone()),
            tokens: Some(tokens.sum()),
            origin: origins(&shown),
            ..self.info()
        };
        let what = format!("what a model is told in stage {} of", stage.name);
        let contents = Contents::Text(shown.text().trim_end().to_owned());
        Ok((name, Some(self.snapshot(&what, info, contents))))
    }

    /// Adds the pictures that the stages show, except those that a variant shares with its task.
    fn pictures(
        &self,
        scene: &PinnedScene,
        redraws: bool,
        shared: &mut Shared,
        found: &mut Vec<Expected>,
    ) -> Result<(), Failure> {
        let stages = self.program.stages.iter();
        let mut seen = BTreeSet::new();
        for picture in stages.flat_map(|stage| &stage.show) {
            let title = title(&PromptPicture::Drawn(*picture), self.moment.step);
            let drawn_from = self.drawn_from(picture, scene);
            let is_shared = shared.pictures.get(&title) == Some(&drawn_from);
            if is_shared || !seen.insert(title.clone()) {
                continue;
            }
            if self.program.variant.is_none() {
                shared.pictures.insert(title.clone(), drawn_from.clone());
            }
            let info = Info {
                picture: Some(title),
                drawn_from: Some(drawn_from),
                ..self.info()
            };
            found.push(self.picture(picture, info, redraws)?);
        }
        Ok(())
    }

    /// Returns a picture: the accepted or pending one if it was drawn from the same, otherwise a new one.
    fn picture(&self, picture: &Picture, info: Info, redraws: bool) -> Result<Expected, Failure> {
        let shows = info.picture.clone().unwrap_or_default();
        let name = self.name(None, Some(&shows.replace(' ', "_")));
        let known = [self.plan.accepted(&name), self.plan.pending.get(&name)];
        let mut known = known.into_iter().flatten();
        let known = known.find(|it| !redraws && is_drawn_from(it, &info));
        if let Some(known) = known {
            return Ok((name, Some(known.clone())));
        }
        let taken = self.draw(picture)?.map(|png| {
            let info = Info {
                bytes: Some(short_hash(&png)),
                ..info
            };
            self.snapshot(&format!("{shows} of"), info, Contents::Picture(png))
        });
        Ok((name, taken))
    }

    fn snapshot(&self, what: &str, info: Info, contents: Contents) -> Snapshot {
        let (title, scene) = (self.program.title(), self.moment.name);
        let description = format!("{what} {title}, scene {scene}");
        Snapshot::of(self.source.name, description, info, contents)
    }

    /// Returns `TASK.STAGE@SCENE`, `TASK.VARIANT.STAGE@SCENE`, or `TASK@SCENE.PART`.
    fn name(&self, stage: Option<&str>, part: Option<&str>) -> Name {
        let [stage, part] = [stage, part].map(|it| it.map_or(String::new(), |it| format!(".{it}")));
        let title = self.program.title().replace('/', ".");
        format!("{title}{stage}@{}{part}", self.moment.name)
    }

    fn info(&self) -> Info {
        Info {
            task: self.program.task.clone(),
            variant: self.program.variant.clone(),
            scene: Some(self.moment.name.to_owned()),
            ..Info::default()
        }
    }

    /// Returns the hash of all inputs of a picture.
    fn drawn_from(&self, picture: &Picture, scene: &PinnedScene) -> String {
        let program = self.program;
        let what = match picture {
            Picture::Subgoal { .. } => json!({
                "picture": picture,
                "step": scene.step,
                "cloth": program.cloth,
                "camera": program.camera,
                "picker": program.picker,
                "subgoals": program.subgoals,
                "files": hashes_of_pictures(program, self.source.folder),
            }),
            Picture::Scene { .. } => json!({
                "picture": picture,
                "scene": scene.text(),
                "layers": program.layers,
            }),
        };
        short_hash(what.to_string())
    }
}

/// Returns whether a picture was drawn from the same inputs, and still has these bytes: a bad merge may swap them.
fn is_drawn_from(snapshot: &Snapshot, wanted: &Info) -> bool {
    match (&snapshot.metadata.info, &snapshot.contents) {
        (Some(info), Contents::Picture(png)) => {
            info.drawn_from == wanted.drawn_from && info.bytes == Some(short_hash(png))
        }
        _ => false,
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
