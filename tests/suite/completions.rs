//! `fabc completions` and `fabc manual`: scripts that shells can parse, and pages that `man` can.

use super::support::{fabc, finish};
use std::process::Command;

#[test]
fn every_shell_gets_a_script_that_names_the_verbs() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let said = finish(fabc(folder.path()).args(["completions", shell]));
        assert_eq!((said.code, said.stderr.as_str()), (0, ""), "{shell}");
        for word in ["subgoals", "resume", "watch", "smoothing"] {
            assert!(said.stdout.contains(word), "{shell}: no `{word}`");
        }
    }
    let said = finish(fabc(folder.path()).args(["completions", "cmd"]));
    assert_eq!(said.code, 64, "{}", said.stderr);
}

#[test]
fn every_verb_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let said = finish(fabc(folder.path()).args(["manual", "pages"]));
    assert_eq!(
        (said.code, said.stdout.as_str(), said.stderr.as_str()),
        (0, "pages/fabc.1\n", "")
    );
    let page = |name: &str| std::fs::read_to_string(folder.path().join("pages").join(name));
    for verb in fabc::command().get_subcommands() {
        let name = format!("fabc-{}.1", verb.get_name());
        let text = page(&name).unwrap_or_else(|_| panic!("there is no {name}"));
        assert!(text.contains(".SH SYNOPSIS"), "{name}: {text}");
    }
    assert!(page("fabc-sim-replay.1").unwrap().contains("DIR"));
    assert!(page("fabc-robot-watchdog.1").is_err(), "it is hidden");
    std::fs::write(folder.path().join("file"), "").unwrap();
    let said = finish(fabc(folder.path()).args(["manual", "file"]));
    assert_eq!(said.code, 2, "{}", said.stderr);
    assert!(said.stderr.contains("`file`"), "{}", said.stderr);
}

/// The completions that bash offers for these words, the last of which is being typed.
fn offered(words: &[&str]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("fabc.bash");
    let said = finish(fabc(folder.path()).args(["completions", "bash"]));
    std::fs::write(&script, said.stdout).unwrap();
    std::fs::write(folder.path().join("napkin.fab"), "").unwrap();
    let line = words.join(" ");
    let (last, before) = (words[words.len() - 1], words[words.len() - 2]);
    // Bash has no `compopt` outside a real completion.
    let ask = format!(
        "compopt() {{ :; }}; source ./fabc.bash && COMP_WORDS=({line}) COMP_CWORD={} COMP_LINE='{line}' && _fabc fabc '{last}' '{before}' \
         && printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        words.len() - 1
    );
    let bash = Command::new("bash")
        .args(["--norc", "-c", &ask])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let errors = String::from_utf8(bash.stderr).unwrap();
    assert!(bash.status.success() && errors.is_empty(), "{errors}");
    let offered = String::from_utf8(bash.stdout).unwrap();
    offered.lines().map(str::to_owned).collect()
}

#[test]
#[cfg(unix)]
fn bash_reads_its_script_and_completes_verbs_and_files() {
    let verbs = offered(&["fabc", "re"]);
    assert!(verbs.contains(&"render".to_owned()), "{verbs:?}");
    assert!(verbs.contains(&"resume".to_owned()), "{verbs:?}");
    assert!(verbs.iter().all(|verb| verb.starts_with("re")), "{verbs:?}");
    // The script leaves completing files to bash.
    let files = offered(&["fabc", "render", "a.fab", "--start", "nap"]);
    assert_eq!(files, ["napkin.fab"]);
}
