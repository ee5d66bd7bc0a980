//! The commands that serve the others: doctor, completions, man.

mod common;

use std::process::{Command, Output};

fn tyndall(arguments: &[&str]) -> Output {
    // No driver at all: what these commands say must not depend on the machine.
    Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .args(arguments)
        .env("VK_DRIVER_FILES", "none")
        .env("VK_ICD_FILENAMES", "none")
        .output()
        .expect("the program starts")
}

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).expect("the output is UTF-8")
}

#[test]
fn doctor_needs_no_driver() {
    let output = tyndall(&["doctor"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).contains("the CPU reference"));
    let output = tyndall(&["doctor", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("it is JSON");
    let adapters = json["adapters"].as_array().expect("a list of adapters");
    if cfg!(target_os = "linux") {
        assert!(adapters.is_empty(), "{adapters:?}");
        let advice = json["advice"].as_array().expect("a list of sentences");
        assert!(!advice.is_empty(), "nothing is said about what to install");
    }
    assert!(json["cores"].as_u64().is_some_and(|cores| cores > 0));
}

#[test]
fn completions_know_the_commands() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let output = tyndall(&["completions", shell]);
        assert_eq!(output.status.code(), Some(0), "{shell}");
        assert!(stdout(&output).contains("doctor"), "{shell}");
    }
    assert_eq!(tyndall(&["completions", "tcsh"]).status.code(), Some(2));
}

#[test]
fn completions_offer_values() {
    for shell in ["bash", "fish", "zsh"] {
        let output = tyndall(&["completions", shell]);
        // A colon is written with a backslash in one of them.
        let script = stdout(&output).replace('\\', "");
        for value in [
            "draft",
            "reference",
            "cie:12",
            "hosek",
            "radiosity",
            "shafts",
            "Europe/Paris",
            "nave",
            "ephemeris",
            "acescg",
            "arcsecond",
            "inscatter_sun",
        ] {
            assert!(
                script.contains(value),
                "{value} is not in the script for {shell}"
            );
        }
    }
    // What completes is not all that is taken.
    let output = tyndall(&[
        "sun",
        "--at",
        "0,0",
        "--tz",
        "+5:30",
        "--time",
        "2026-06-21",
    ]);
    assert_eq!(output.status.code(), Some(0));
    // Two hundred lines of zones would be no help.
    let help = tyndall(&["sun", "--help"]);
    assert!(!stdout(&help).contains("Europe/Paris"));
}

#[test]
fn manual_pages_are_printed() {
    let program = tyndall(&["man"]);
    assert_eq!(program.status.code(), Some(0));
    assert!(stdout(&program).contains(".TH tyndall 1"));
    let page = tyndall(&["man", "doctor"]);
    assert!(stdout(&page).contains(".TH tyndall-doctor 1"));
    assert!(stdout(&page).contains("JSON"));
    let page = tyndall(&["man", "render"]);
    let page = stdout(&page).replace('\\', "");
    for words in [
        "[--quality QUALITY]",
        "[-o|--output FILE|-]",
        "[SCENE]",
        "EXIT STATUS",
        "\n75\n",
        "\n130\n",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
    let output = tyndall(&["man", "docter"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty() && !output.stderr.is_empty());
}

#[test]
fn built_in_scenes_are_listed_and_written() {
    let output = tyndall(&["scene"]);
    let list = stdout(&output);
    for name in tyndall::scene::BUILTIN {
        assert!(list.contains(name), "{name}: {list}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let into = folder.path().join("smoke");
    let into = into.to_str().expect("a name");
    let output = tyndall(&["scene", "smoke", "-o", into]);
    let written = stdout(&output);
    assert!(written.trim_end().ends_with("smoke.toml"), "{written}");
    assert!(tyndall::scene::load(std::path::Path::new(written.trim_end())).is_ok());
    // What is there is not written over.
    let again = tyndall(&["scene", "smoke", "-o", into]);
    assert_eq!(again.status.code(), Some(2));
}

/// What the script for Bash answers to a line whose words Bash has taken apart; nothing where there is no Bash.
#[cfg(unix)]
fn completed(line: &str, words: &[&str]) -> Option<Vec<String>> {
    let script = tyndall(&["completions", "bash"]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tyndall.bash");
    std::fs::write(&path, &script.stdout).expect("it is written");
    let ask = r#"
        source "$1"; COMP_LINE=$2; shift 2
        COMP_WORDS=("$@"); COMP_CWORD=$(( $# - 1 )); COMP_POINT=${#COMP_LINE}
        COMP_WORDBREAKS=$' \t\n"\'><=;|&(:'
        function=$(complete -p tyndall | sed 's/.*-F \([^ ]*\).*/\1/')
        "$function" tyndall "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
        printf '%s\n' "${COMPREPLY[@]}""#;
    let output = Command::new("bash")
        .args(["--norc", "-c", ask, "bash"])
        .arg(&path)
        .arg(line)
        .args(words)
        .output();
    let output = match output {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return None,
        output => output.expect("bash starts"),
    };
    assert!(output.stderr.is_empty(), "{output:?}");
    Some(stdout(&output).lines().map(str::to_owned).collect())
}

#[cfg(unix)]
#[test]
fn bash_completes_names_with_colons_and_none_with_spaces() {
    let begun = ["tyndall", "sky", "--sky"];
    let Some(first) = completed("tyndall sky --sky ci", &[&begun[..], &["ci"]].concat()) else {
        common::not_run(
            "bash_completes_names_with_colons_and_none_with_spaces",
            "no bash",
        );
        return;
    };
    assert_eq!(first.len(), 16, "{first:?}");
    assert!(first.contains(&"cie:12".to_owned()), "{first:?}");
    // Bash puts in what stands behind the colon.
    let words = [&begun[..], &["cie", ":", "1"]].concat();
    let second = completed("tyndall sky --sky cie:1", &words).expect("as above");
    let expected = ["1", "10", "11", "12", "13", "14", "15", "16"];
    assert_eq!(second, expected);
    let words = [&begun[..], &["cie", ":"]].concat();
    let all = completed("tyndall sky --sky cie:", &words).expect("as above");
    assert_eq!(all.len(), 16, "{all:?}");
    // Times have colons too.
    let words = ["tyndall", "sky", "--time", "12", ":", "30", "--sky", "per"];
    let after = completed("tyndall sky --time 12:30 --sky per", &words).expect("as above");
    assert_eq!(after, ["perez"]);

    let words = ["tyndall", "accuracy", "--study", "o"];
    let study = completed("tyndall accuracy --study o", &words).expect("as above");
    assert_eq!(study, ["open-lamp"]);
}

#[test]
fn a_value_that_is_missing_is_told_in_few_words() {
    let output = tyndall(&["sun", "--tz"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("--tz"), "{said}");
    assert!(said.len() < 500, "{said}");
    // Few names are of help.
    let output = tyndall(&["sun", "--fold"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("earlier, later"), "{said}");
}

#[cfg(target_os = "linux")]
#[test]
fn no_bar_is_left_where_a_table_begins() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = env!("CARGO_BIN_EXE_tyndall");
    let study = "accuracy --effect lamps --study-size 6x4 --frames 1 --study posts --plot a.svg";
    // A terminal of both streams.
    let output = Command::new("script")
        .args(["-qec", &format!("'{program}' {study}"), "typescript"])
        .current_dir(folder.path())
        .env("TERM", "xterm")
        .stdin(std::process::Stdio::null())
        .output();
    let output = match output {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            common::not_run("no_bar_is_left_where_a_table_begins", "no `script`");
            return;
        }
        output => output.expect("it starts"),
    };
    assert!(output.status.success(), "{output:?}");
    let shown = stdout(&output);
    let (before, table) = shown.split_once("the CPU, f64; ").expect("a table");
    let erased = "\u{1b}[2K";
    assert!(before.contains(erased), "there was no bar: {before:?}");
    assert!(!table.contains(erased), "{table:?}");
    assert!(table.lines().count() > 20, "{table}");
    assert!(folder.path().join("a-posts.svg").exists());
}
