//! Tests that the tables of metrics and of axes in `docs/bench.md` match the rows.
use fab_bench::metric::{METRICS, Metric};
use fab_world::vary::{AXES, Axis};
use std::path::Path;

const WRITE: &str = "FABC_WRITE_DOCS=1 cargo test -p fab-bench --test suite metrics";

fn metrics() -> String {
    let mut table = "| metric | unit | better | what it is |\n|---|---|---|---|\n".to_owned();
    for row in METRICS {
        let (name, unit, better, about) = (row.name, row.unit, row.better, row.about);
        table.push_str(&format!("| `{name}` | {unit} | {better} | {about} |\n"));
    }
    table
}

fn axes() -> String {
    let mut table = "| axis | unit | from | to | what varies |\n|---|---|---|---|---|\n".to_owned();
    for axis in AXES {
        let Axis {
            name,
            unit,
            low,
            high,
            about,
            ..
        } = axis;
        table.push_str(&format!(
            "| `{name}` | {unit} | {low} | {high} | {about} |\n"
        ));
    }
    table
}

#[test]
fn the_page_lists_every_metric_and_every_axis() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/bench.md");
    for (what, table) in [("metrics", metrics()), ("axes", axes())] {
        let text = std::fs::read_to_string(&page).unwrap();
        let begin = format!("<!-- {what}: {WRITE} -->\n");
        let end = format!("<!-- end of {what} -->");
        let (before, rest) = text.split_once(&begin).unwrap();
        let (there, after) = rest.split_once(&end).unwrap();
        if std::env::var_os("FABC_WRITE_DOCS").is_some() {
            std::fs::write(&page, [before, &begin, &table, &end, after].concat()).unwrap();
        } else {
            assert_eq!(there, table, "write it: {WRITE}");
        }
    }
}

#[test]
fn names_are_unique_and_an_unknown_one_is_told_the_others() {
    for (index, row) in METRICS.iter().enumerate() {
        assert!(METRICS[..index].iter().all(|other| other.name != row.name));
        let metric: Metric = serde_json::from_value(row.name.into()).unwrap();
        assert_eq!(serde_json::json!(metric), row.name);
    }
    let error = serde_json::from_str::<Metric>("\"distance\"").unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("there is no metric `distance`, only `mean_particle_distance_mm`")
    );
}
