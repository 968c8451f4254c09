//! Tests that the table of metrics in `docs/bench.md` matches the rows.
#![allow(clippy::unwrap_used, missing_docs)]

use fab_bench::metric::{Better, METRICS, Metric};
use std::path::Path;

const BEGIN: &str = "<!-- metrics: FABC_WRITE_DOCS=1 cargo test -p fab-bench --test metrics -->\n";
const END: &str = "<!-- end of metrics -->";

fn table() -> String {
    let mut table = "| metric | unit | better | what it is |\n|---|---|---|---|\n".to_owned();
    for row in METRICS {
        let better = match row.better {
            Better::Higher => "higher",
            Better::Lower => "lower",
        };
        let (name, unit, about) = (row.name, row.unit.name(), row.about);
        table.push_str(&format!("| `{name}` | {unit} | {better} | {about} |\n"));
    }
    table
}

#[test]
fn the_page_lists_every_metric() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/bench.md");
    let text = std::fs::read_to_string(&page).unwrap();
    let (before, rest) = text.split_once(BEGIN).unwrap();
    let (there, after) = rest.split_once(END).unwrap();
    if std::env::var_os("FABC_WRITE_DOCS").is_some() {
        std::fs::write(&page, [before, BEGIN, &table(), END, after].concat()).unwrap();
    } else {
        assert_eq!(
            there,
            table(),
            "write it: FABC_WRITE_DOCS=1 cargo test -p fab-bench --test metrics"
        );
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
