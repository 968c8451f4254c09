//! A simulated cloth that goes through itself: what a run says, and what its record keeps.

use super::support::{fabc, finish, root};
use fab_agent::record::Record;
use std::fs;

/// A cloth of silk, pulled anywhere.
fn silk(start: &str) -> String {
    format!(
        r#"
use "materials.fab"
task silk {{
    cloth  grid(24, 24, start: {start}, material: silk)
    goal   normalized_improvement > 0.95
    horizon 1
    camera top_down(height: 650mm, fov: 45deg, image: 224px)
    picker drop
    keypoints {{ cloth = mask(depth < 649.6mm) }}
    actions {{
        pick:      any of cloth
        direction: one of 0deg, 90deg, 180deg, 270deg
        distance:  one of 0.5edge
    }}
    stage act {{
        model vision
        show  scene
        say   "Pull {{{{ pick.choices }}}}. {{{{ actions.format }}}}"
        read  action
    }}
    verify {{ attempts 2, else skip }}
}}
"#
    )
}

#[test]
fn a_run_says_that_the_cloth_goes_through_itself_and_its_record_counts_the_edges() {
    let folder = tempfile::tempdir().unwrap();
    let materials = root().join("tasks/lib/materials.fab");
    fs::copy(materials, folder.path().join("materials.fab")).unwrap();
    for (start, crosses) in [("crumpled", true), ("flat", false)] {
        fs::write(folder.path().join("silk.fab"), silk(start)).unwrap();
        let words = ["run", "silk.fab", "--policy", "random", "--out", start];
        let said = finish(fabc(folder.path()).args(words)).stderr;
        let record = Record::read(&folder.path().join(start)).unwrap();
        let step = &record.steps[0];
        assert!(step.executed.is_some(), "{said}");
        assert_eq!(step.crossings.is_some(), crosses, "{said}");
        let at_start =
            "at the start the simulated cloth goes through itself, as no real one does (";
        assert_eq!(said.contains(at_start), crosses, "{said}");
        // It is said again only of an action that adds to it.
        let places = |said: &str, behind: &str| -> usize {
            let (_, rest) = said.split_once(behind).unwrap_or_default();
            let (count, _) = rest.split_once(' ').unwrap_or_default();
            count.parse().unwrap_or(0)
        };
        let before = places(&said, at_start);
        let note = "after step 1 the simulated cloth goes through itself, as no real one does (";
        let more = step.crossings.filter(|count| *count > before);
        assert_eq!(places(&said, note), more.unwrap_or(0), "{said}");
    }
}
