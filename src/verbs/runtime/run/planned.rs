//! The output of `fabc run --plan-only`: the plan of the first action, segment by segment.

use crate::exit::Failure;
use fab_agent::rollout::Ended;
use fab_arm::plan::Plan;
use fab_arm::settings::{DriverKind, Settings};
use fab_arm::world::{PLAN_FILE, PLAN_PICTURE, read_plan};
use fab_base::table::{Align, aligned};
use serde::Serialize;
use std::path::Path;

#[derive(Serialize)]
pub struct PlannedRun {
    #[serde(flatten)]
    report: Ended,
    plan: Option<Plan>,
}

impl PlannedRun {
    pub fn of(report: Ended) -> Result<PlannedRun, Failure> {
        let folder = Path::new(&report.took.run_dir);
        let is_planned = folder.join(PLAN_FILE).exists();
        let plan = is_planned.then(|| read_plan(folder)).transpose();
        let plan = plan.map_err(Failure::environment)?;
        Ok(PlannedRun { report, plan })
    }

    pub fn text(&self, settings: &Settings) -> String {
        let (outcome, folder) = (self.report.outcome.name(), &self.report.took.run_dir);
        let plan = self.plan.as_ref().map(|plan| table(plan, settings));
        let drawing = plan.as_ref().map(|_| format!(" (drawing: {PLAN_PICTURE})"));
        let plan = plan.unwrap_or("no action was planned".to_owned());
        let drawing = drawing.unwrap_or_default();
        format!("outcome: {outcome}; nothing moved\n{plan}\nrun folder: {folder}{drawing}")
    }
}

fn table(plan: &Plan, settings: &Settings) -> String {
    let place = |[x, y, z]: [f64; 3]| format!("{x:.3}, {y:.3}, {z:.3} m");
    let mut lines = vec![format!(
        "pick at {}, place at {}, in the base frame of `{}`",
        place(plan.pick_m),
        place(plan.place_m),
        plan.model
    )];
    let titles = "segment;x, m;y, m;z, m;way, mm;time, s;joints, degrees";
    let mut rows = vec![titles.split(';').map(str::to_owned).collect()];
    rows.extend(plan.segments.iter().map(|segment| {
        let mut row = vec![segment.name.name().to_owned()];
        match segment.hand {
            Some(opening) => row.push(format!("{opening:?}").to_lowercase()),
            None => {
                row.extend(segment.to_m.map(|metres| format!("{metres:.3}")));
                row.push(format!("{:.1}", segment.way_m * 1000.0));
                row.push(format!("{:.1}", segment.takes_s));
                let joints = segment.joints_deg.iter().map(|angle| format!("{angle:.1}"));
                row.push(joints.collect::<Vec<_>>().join(" "));
            }
        }
        row
    }));
    use Align::{Left, Right};
    lines.extend(aligned(&[Left, Right, Right, Right, Right, Right], &rows));
    lines.push(format!(
        "in all {:.3} m in {:.1} s at up to {} m/s, without the fingers",
        plan.way_m(),
        plan.takes_s(),
        settings.motion.speed_m_s
    ));
    if settings.driver == DriverKind::Kinova {
        let estimated = "the node of this arm finds joint angles and a speed of its own: the times are estimates";
        lines.push(estimated.to_owned());
    }
    lines.extend(plan.refusal());
    lines.join("\n")
}
