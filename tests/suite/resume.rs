//! Resuming rollouts that were cut off, stopped by a cap, or changed in the meantime.

use super::support::{self, Captured, Trial, bring_library, fabc, finish, project};
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::record::RECORD_FILE;
use fab_agent::rollout::Ended;
use fab_base::interrupt::Interrupt;
use fab_model::Models;
use fab_model::calls::{Budget, Call, Calls, Caps, Spent, Usage, Usd, ledger};
use fab_model::{Model, ModelError, ModelKind, Reply, Request};
use fab_standins::Geometric;
use fab_test_provider::Provider;
use fab_world::Look;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Mutex;

/// What each answer costs.
const PRICE: Usd = Usd::from_nano(1_000_000);

/// The stand-in as a paid model: each question is a call.
#[derive(Default)]
struct Bought {
    sent: Mutex<Vec<String>>,
}

impl Model for Bought {
    fn name(&self) -> &str {
        "shop:geometric"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::Model
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        let key = request.key();
        calls.begin(&Call {
            model: self.name(),
            key: &key,
            number: 1,
            at_most: Some(PRICE),
        })?;
        self.sent.lock().unwrap().push(key);
        let reply = Reply {
            usage: Some(Usage {
                input_tokens: 1000,
                output_tokens: 10,
                ..Usage::default()
            }),
            cost: Some(PRICE),
            ..Geometric.ask(request, calls)?
        };
        calls.end(Ok(&reply))?;
        Ok(reply)
    }
}

impl Bought {
    fn both(&self) -> Models<'_> {
        Models {
            vision: self,
            text: self,
        }
    }

    fn sent(&self) -> Vec<String> {
        self.sent.lock().unwrap().clone()
    }
}

fn journal(run: &Path) -> String {
    fs::read_to_string(run.join(RECORD_FILE)).unwrap()
}

fn play(trial: &Trial<'_>, model: &Bought, run: &Path) -> Ended {
    trial.run(model.both(), run, &mut |_| {})
}

/// Copies the top-level files of a run folder; the others are written again.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        if entry.path().is_file() {
            fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
        }
    }
}

#[test]
#[ignore = "long"]
fn a_rollout_cut_off_anywhere_comes_out_the_same_and_asks_nothing_twice() {
    let folder = tempfile::tempdir().unwrap();
    let program = support::small_task();
    let trial = Trial::new(&program, folder.path(), Look::default());
    let whole = folder.path().join("whole");
    let model = Bought::default();
    let report = play(&trial, &model, &whole);
    assert_eq!(report.took.spent.calls, 4);
    assert_eq!(report.took.cost_usd, Some(0.004));
    let sent = model.sent();
    let lines = journal(&whole);
    let ends: Vec<usize> = lines.match_indices('\n').map(|(at, _)| at + 1).collect();
    // Within the header, at each line's end, within each line, and complete.
    let mut cuts = vec![0, 30];
    cuts.extend(ends.iter().flat_map(|end| [*end, end + 40]));
    let calls = fs::read_to_string(whole.join(ledger::LEDGER_FILE)).unwrap();
    let noted: Vec<usize> = calls.match_indices('\n').map(|(at, _)| at + 1).collect();
    for (number, cut) in cuts
        .into_iter()
        .filter(|cut| *cut <= lines.len())
        .enumerate()
    {
        let run = folder.path().join(format!("cut-{number}"));
        copy(&whole, &run);
        fs::write(run.join(RECORD_FILE), &lines[..cut]).unwrap();
        // Two questions of each step come before its line, with three lines each; the next call was in progress.
        let steps = ends
            .iter()
            .filter(|end| **end <= cut)
            .count()
            .saturating_sub(1)
            .min(2);
        let kept = noted[(6 * steps + 1).min(noted.len() - 1)];
        fs::write(run.join(ledger::LEDGER_FILE), &calls[..kept]).unwrap();
        let answered = ledger::read(&run).unwrap().answered;
        let model = Bought::default();
        play(&trial, &model, &run);
        assert_eq!(journal(&run), lines, "cut at {cut}");
        let before: BTreeSet<String> = answered.into_keys().collect();
        let now: BTreeSet<String> = model.sent().into_iter().collect();
        assert!(
            before.is_disjoint(&now),
            "a question was asked again, cut at {cut}"
        );
        assert_eq!(before.len() + now.len(), sent.len(), "cut at {cut}");
        assert_eq!(model.sent().len(), now.len(), "cut at {cut}");
    }
}

#[test]
#[ignore = "long"]
fn a_cap_ends_a_rollout_and_a_higher_one_goes_on_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let program = support::small_task();
    let run = folder.path().join("run");
    let mut trial = Trial::new(&program, folder.path(), Look::default());
    let cost = Usd::from_dollars(0.0035);
    for (caps, calls) in [
        (
            Caps {
                cost: None,
                calls: Some(1),
            },
            1,
        ),
        (Caps { cost, calls: None }, 3),
    ] {
        trial.budget = Budget::new(caps, &Interrupt::default());
        trial.budget.restore(&spent(&run));
        let report = play(&trial, &Bought::default(), &run);
        assert_eq!(report.outcome, Outcome::BudgetExhausted);
        assert_eq!(spent(&run).calls, calls);
        let ended = journal(&run);
        assert!(
            ended.contains("cap of"),
            "the journal names the cap: {ended}"
        );
    }
    trial.budget = Budget::default();
    trial.budget.restore(&spent(&run));
    let model = Bought::default();
    let report = play(&trial, &model, &run);
    assert_eq!(report.outcome, Outcome::HorizonReached);
    assert_eq!((model.sent().len(), report.took.spent.calls), (1, 4));
    assert_eq!(report.took.spent.usage.input_tokens, 4000);
}

fn spent(run: &Path) -> Spent {
    ledger::read(run).unwrap().spent
}

#[test]
fn a_done_step_whose_answers_are_lost_is_not_bought_again() {
    let folder = tempfile::tempdir().unwrap();
    let program = support::small_task();
    let run = folder.path().join("run");
    let mut trial = Trial::new(&program, folder.path(), Look::default());
    let capped = |calls| Caps {
        cost: None,
        calls: Some(calls),
    };
    trial.budget = Budget::new(capped(3), &Interrupt::default());
    play(&trial, &Bought::default(), &run);
    fs::remove_file(run.join(ledger::LEDGER_FILE)).unwrap();
    let (journal_before, asked) = (journal(&run), run.join("step_1/describe_1.prompt.txt"));
    fs::write(&asked, "as it was").unwrap();
    trial.budget = Budget::default();
    let model = Bought::default();
    let error = trial.try_run(model.both(), &run, &mut |_| {}).unwrap_err();
    assert!(
        error.to_string().contains("not in the ledger of calls"),
        "{error}"
    );
    assert_eq!(model.sent().len(), 0);
    assert_eq!(journal(&run), journal_before);
    assert_eq!(fs::read_to_string(&asked).unwrap(), "as it was");

    // Changed subgoal pictures are noticed in the first line, before anything is asked.
    trial.subgoals.pictures.reverse();
    let error = trial.try_run(model.both(), &run, &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("`subgoal_pictures`"), "{error}");
}

#[test]
fn a_run_that_is_being_written_is_not_gone_on_with() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let open = RunFolder::create(&run).unwrap();
    let refused = RunFolder::reopen(&run).unwrap_err().to_string();
    assert!(refused.contains("another fabc is writing"), "{refused}");
    drop(open);
    assert!(RunFolder::reopen(&run).is_ok());
}

#[test]
#[ignore = "long"]
fn the_command_goes_on_with_a_run_and_notices_a_changed_task() {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    let task = fs::read_to_string(project("tasks/double_triangle.fab")).unwrap();
    fs::write(folder.path().join("mine.fab"), &task).unwrap();
    let begun = finish(fabc(folder.path()).args(["run", "mine.fab", "--out", "run"]));
    assert_eq!(begun.code, 0, "{}", begun.stderr);
    let run = folder.path().join("run");
    let whole = journal(&run);
    let first_two: String = whole.split_inclusive('\n').take(2).collect();
    fs::write(run.join(RECORD_FILE), &first_two).unwrap();

    // Run from another folder, since paths are relative to the folder where the run was started.
    let elsewhere = folder.path().join("elsewhere");
    fs::create_dir(&elsewhere).unwrap();
    let resumed = finish(fabc(&elsewhere).args(["resume", "../run", "--json"]));
    assert_eq!(resumed.code, 0, "{}", resumed.stderr);
    assert!(
        resumed.stderr.contains("resuming after step 1"),
        "{}",
        resumed.stderr
    );
    assert_eq!(journal(&run), whole);

    let ended = finish(fabc(&elsewhere).args(["resume", "../run"]));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    assert!(
        ended.stderr.contains("has already ended (goal_reached)"),
        "{}",
        ended.stderr
    );

    fs::write(run.join(RECORD_FILE), &first_two).unwrap();
    let changed = task.replace("< 40mm", "< 41mm");
    assert_ne!(changed, task);
    fs::write(folder.path().join("mine.fab"), changed).unwrap();
    let refused = finish(fabc(&elsewhere).args(["resume", "../run"]));
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(refused.stderr.contains("`program`"), "{}", refused.stderr);
    assert_eq!(journal(&run), first_two, "what was there is still there");
}

#[test]
fn what_cannot_be_gone_on_with_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let resume = |name: &str| {
        let said = finish(fabc(folder.path()).args(["resume", name]));
        assert_eq!(said.code, 2, "{}", said.stderr);
        said.stderr
    };
    assert!(resume("absent").contains("there is no run folder `absent`"));
    fs::create_dir(folder.path().join("empty")).unwrap();
    assert!(resume("empty").contains("run.json cannot be read"));
    fs::create_dir(folder.path().join("odd")).unwrap();
    fs::write(folder.path().join("odd/run.json"), "{}").unwrap();
    assert!(resume("odd").contains("run.json is damaged"));
}

/// A run with a provider, in a cache of its own.
fn paid(folder: &Path, provider: &Provider, more: &[&str]) -> Captured {
    let asked = [
        "--model",
        "compatible:geometric",
        "--allow-unknown-price",
        "--base-url",
        provider.base_url(),
    ];
    finish(
        fabc(folder)
            .arg("run")
            .args(more)
            .args(asked)
            .env("FABC_CACHE_DIR", folder.join("cache")),
    )
}

#[test]
#[ignore = "long"]
fn two_replays_of_one_run_write_its_journal() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::of(Geometric);
    let task = project("tasks/double_triangle.fab");
    let bought = paid(folder.path(), &provider, &[&task, "--out", "first"]);
    assert_eq!(bought.code, 0, "{}", bought.stderr);
    let calls = provider.counts().len();
    for (name, source) in [
        ("second", "replay:first"),
        ("third", "replay:first/calls.jsonl"),
    ] {
        let arguments = ["run", &task, "--out", name, "--model", source];
        let replayed = finish(fabc(folder.path()).args(arguments));
        assert_eq!(replayed.code, 0, "{}", replayed.stderr);
    }
    assert_eq!(provider.counts().len(), calls, "a replay asks nobody");
    let journal = |name: &str| journal(&folder.path().join(name));
    assert_eq!(journal("second"), journal("third"));
    assert_eq!(
        journal("first").replace("\"compatible:geometric", "\"replay(compatible:geometric)"),
        journal("second")
    );
}

#[test]
#[ignore = "long"]
fn a_replay_of_another_prompt_says_which_part_changed() {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    let provider = Provider::of(Geometric);
    let task = fs::read_to_string(project("tasks/double_triangle.fab")).unwrap();
    fs::write(folder.path().join("mine.fab"), &task).unwrap();
    let bought = paid(folder.path(), &provider, &["mine.fab", "--out", "first"]);
    assert_eq!(bought.code, 0, "{}", bought.stderr);
    let library = folder.path().join("lib/folding.fab");
    let text = fs::read_to_string(&library).unwrap();
    let changed = text.replace("Answer in two lines:", "Answer in exactly two lines:");
    assert_ne!(changed, text);
    fs::write(&library, changed).unwrap();
    let second = [
        "run",
        "mine.fab",
        "--out",
        "second",
        "--model",
        "replay:first",
    ];
    let said = finish(fabc(folder.path()).args(second));
    assert_eq!(said.code, 2, "{}", said.stderr);
    let named = "(recorded \"Answer in two lines:\", now \"Answer in exactly two lines:\")";
    assert!(said.stderr.contains(named), "{}", said.stderr);
}
