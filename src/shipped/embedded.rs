//! The tasks embedded in the program: sources, libraries, pinned subgoal pictures, demonstrations.
//!
//! A test compares the list with `tasks/`. The list leaves out tasks that need an arm (`real`), the
//! paper's folds of measured cloths (`textiles`), tasks that rehearse (`rehearsed`) with their library
//! (`lib/rehearsed.fab`), snapshots, and suites.

/// Lists files of `tasks/` with their bytes.
macro_rules! embed {
    ($($path:literal,)*) => {
        &[$(($path, include_bytes!(concat!("../../tasks/", $path)) as &[u8])),*]
    };
}

/// Each file's path relative to `tasks/`, and its bytes.
pub const FILES: &[(&str, &[u8])] = embed![
    "all_corners_inward.fab",
    "all_corners_inward.subgoals/0.png",
    "all_corners_inward.subgoals/1.png",
    "all_corners_inward.subgoals/2.png",
    "all_corners_inward.subgoals/3.png",
    "all_corners_inward.subgoals/4.png",
    "all_corners_inward.subgoals/pins.json",
    "corners_edges_inward.fab",
    "corners_edges_inward.subgoals/0.png",
    "corners_edges_inward.subgoals/1.png",
    "corners_edges_inward.subgoals/2.png",
    "corners_edges_inward.subgoals/3.png",
    "corners_edges_inward.subgoals/4.png",
    "corners_edges_inward.subgoals/pins.json",
    "cupboard.fab",
    "cupboard.subgoals/0.png",
    "cupboard.subgoals/1.png",
    "cupboard.subgoals/2.png",
    "cupboard.subgoals/3.png",
    "cupboard.subgoals/4.png",
    "cupboard.subgoals/pins.json",
    "demos/all_corners_inward.jsonl",
    "demos/corners_edges_inward.jsonl",
    "demos/double_straight.jsonl",
    "demos/double_triangle.jsonl",
    "double_straight.fab",
    "double_straight.subgoals/0.png",
    "double_straight.subgoals/1.png",
    "double_straight.subgoals/2.png",
    "double_straight.subgoals/3.png",
    "double_straight.subgoals/pins.json",
    "double_triangle.fab",
    "double_triangle.subgoals/0.png",
    "double_triangle.subgoals/1.png",
    "double_triangle.subgoals/2.png",
    "double_triangle.subgoals/pins.json",
    "hem.fab",
    "hem.subgoals/0.png",
    "hem.subgoals/1.png",
    "hem.subgoals/pins.json",
    "house.fab",
    "house.subgoals/0.png",
    "house.subgoals/1.png",
    "house.subgoals/2.png",
    "house.subgoals/pins.json",
    "lib/experts.fab",
    "lib/folding.fab",
    "lib/materials.fab",
    "lib/napkins.fab",
    "lib/real.fab",
    "lib/smoothing.fab",
    "open_envelope.fab",
    "open_envelope.subgoals/0.png",
    "open_envelope.subgoals/1.png",
    "open_envelope.subgoals/2.png",
    "open_envelope.subgoals/3.png",
    "open_envelope.subgoals/pins.json",
    "paper_plane.fab",
    "paper_plane.subgoals/0.png",
    "paper_plane.subgoals/1.png",
    "paper_plane.subgoals/2.png",
    "paper_plane.subgoals/3.png",
    "paper_plane.subgoals/pins.json",
    "pocket_envelope.fab",
    "pocket_envelope.subgoals/0.png",
    "pocket_envelope.subgoals/1.png",
    "pocket_envelope.subgoals/2.png",
    "pocket_envelope.subgoals/pins.json",
    "sash.fab",
    "sash.subgoals/0.png",
    "sash.subgoals/1.png",
    "sash.subgoals/2.png",
    "sash.subgoals/pins.json",
    "smoothing.fab",
];

#[cfg(test)]
mod tests {
    use super::FILES;
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    const LEFT_OUT: [&str; 6] = [
        "real",
        "rehearsed",
        "lib/rehearsed.fab",
        "snapshots",
        "suites",
        "textiles",
    ];

    /// Adds the files of a folder by their paths relative to `tasks`.
    fn list(tasks: &Path, folder: &Path, files: &mut BTreeSet<String>) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.strip_prefix(tasks).expect("a path in it");
            let name = name.to_str().expect("plain letters").replace('\\', "/");
            if LEFT_OUT.contains(&name.as_str()) {
                continue;
            }
            match path.is_dir() {
                true => list(tasks, &path, files),
                false => drop(files.insert(name)),
            }
        }
    }

    #[test]
    fn every_shipped_task_is_embedded_with_what_it_reads() {
        let tasks = Path::new(env!("CARGO_MANIFEST_DIR")).join("tasks");
        let mut files = BTreeSet::new();
        list(&tasks, &tasks, &mut files);
        let embedded: BTreeSet<String> = FILES.iter().map(|(path, _)| (*path).to_owned()).collect();
        assert_eq!(embedded, files);
    }
}
