//! The page `docs/trials.md`, run: what three people do in their first hour, and what must come of it.
//!
//! A task is a heading, a script in a block `sh`, and a list. Tasks of one person share a folder, so that one can go on where another
//! ended. A line of the list that this does not understand fails.

#![cfg(unix)]

use std::path::Path;
use std::process::{Command, Stdio};

/// A task of the page.
#[derive(Debug)]
struct Task<'a> {
    title: &'a str,
    script: &'a str,
    expected: Vec<&'a str>,
}

/// The people of the page, each with the tasks that are run, and how many there are in all.
fn people(page: &str) -> Vec<(&str, Vec<Task<'_>>, usize)> {
    let person = |text| {
        let (name, text): (&str, &str) = split(text, "\n")?;
        let all: Vec<&str> = text.split("\n### ").skip(1).collect();
        let tasks = all.iter().filter_map(|task| {
            let (title, text) = split(task, "\n")?;
            let (_, text) = split(text, "```sh\n")?;
            let (script, text) = split(text, "\n```\n")?;
            Some(Task {
                title,
                script,
                expected: text.lines().filter_map(|l| l.strip_prefix("- ")).collect(),
            })
        });
        Some((name, tasks.collect(), all.len()))
    };
    page.split("\n## ").skip(1).filter_map(person).collect()
}

fn split<'a>(text: &'a str, at: &str) -> Option<(&'a str, &'a str)> {
    text.split_once(at)
}

/// What is wrong with what a script left and said.
fn complaint(expected: &str, folder: &Path, said: &str) -> Option<String> {
    let words: Vec<&str> = expected.split('`').collect();
    let (what, rest) = match words[..] {
        ["", what, rest] => (what, rest.trim()),
        ["says ", what, ""] => {
            return (!said.contains(what)).then(|| format!("it does not say `{what}`"));
        }
        _ => return Some("it is not understood".into()),
    };
    let path = folder.join(what);
    let rest: Vec<&str> = rest.split(' ').collect();
    match rest[..] {
        ["is", "there"] => match std::fs::metadata(&path) {
            Ok(file) if file.len() == 0 => Some("it is empty".into()),
            Ok(_) if is_broken(&path) => Some("it is no picture".into()),
            Ok(_) => None,
            Err(error) => Some(error.to_string()),
        },
        ["is", width, "x", height, "pixels"] => match size(&path) {
            Some(size) if size.map(|n| n.to_string()) == [width, height] => None,
            found => Some(format!("{found:?}")),
        },
        ["has", count, "lines"] => {
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let found = text.lines().count();
            (found.to_string() != count).then(|| format!("{found} lines"))
        }
        ["is", low, "to", high] => {
            let range = [low, high].map(|n| n.parse::<f64>().expect("a range has numbers"));
            match number_after(said, what) {
                Some(found) if (range[0]..=range[1]).contains(&found) => None,
                found => Some(format!("{found:?}")),
            }
        }
        _ => Some("it is not understood".into()),
    }
}

/// The first number behind a word.
fn number_after(said: &str, word: &str) -> Option<f64> {
    let rest = &said[said.find(word)? + word.len()..];
    let from = rest.find(|c: char| c.is_ascii_digit())?;
    let negative = rest[..from].ends_with('-');
    let number = &rest[from..];
    let end = number
        .find(|c: char| !(c.is_ascii_digit() || ".e-+".contains(c)))
        .unwrap_or(number.len());
    // A number may end a sentence.
    let number: f64 = number[..end]
        .trim_end_matches(['.', 'e', '-', '+'])
        .parse()
        .ok()?;
    Some(if negative { -number } else { number })
}

/// Whether it should be a picture and is none.
fn is_broken(path: &Path) -> bool {
    let ending = path.extension().unwrap_or_default();
    let is_picture = ["png", "exr", "hdr"].iter().any(|known| ending == *known);
    is_picture && size(path).is_none()
}

/// Width and height of a picture that is whole.
fn size(path: &Path) -> Option<[usize; 2]> {
    match path.extension()?.to_str()? {
        "png" => {
            let picture = image::open(path).ok()?;
            Some([picture.width() as usize, picture.height() as usize])
        }
        "exr" => {
            let picture = exr::prelude::read_first_flat_layer_from_file(path).ok()?;
            let size = picture.layer_data.size;
            Some([size.0, size.1])
        }
        "hdr" => {
            let bytes = std::fs::read(path).ok()?;
            let head = String::from_utf8_lossy(&bytes);
            let line = head.lines().find(|line| line.starts_with("-Y "))?;
            let words: Vec<&str> = line.split(' ').collect();
            Some([words[3].parse().ok()?, words[1].parse().ok()?])
        }
        _ => None,
    }
}

/// Runs a script up to its first command that fails; what it says on both streams, and its exit status.
fn run(script: &str, folder: &Path) -> (String, i32) {
    let program = Path::new(env!("CARGO_BIN_EXE_tyndall"));
    let beside = program.parent().expect("a program is in a folder");
    let path = std::env::var("PATH").unwrap_or_default();
    let output = Command::new("sh")
        .arg("-c")
        .arg(format!("set -e\nexec 2>&1\n{script}"))
        .current_dir(folder)
        .env("PATH", format!("{}:{path}", beside.display()))
        .stdin(Stdio::null())
        .output()
        .expect("sh starts");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    (said, output.status.code().unwrap_or(-1))
}

#[test]
fn every_task_ends_as_the_page_says() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/trials.md");
    let page = std::fs::read_to_string(page).expect("the page is there");
    let mut complaints = Vec::new();
    let people = people(&page);
    assert_eq!(people.len(), 3);
    for (name, tasks, count) in people {
        assert_eq!(count, 12, "{name}");
        assert!(tasks.len() >= 11, "{name}: only {} are run", tasks.len());
        let folder = tempfile::tempdir().expect("a folder");
        for task in tasks {
            let (said, status) = run(task.script, folder.path());
            let exit = "exits with ";
            let (exits, others): (Vec<&str>, Vec<&str>) = task
                .expected
                .iter()
                .partition(|line| line.starts_with(exit));
            let wanted = exits.first().map_or("0", |line| &line[exit.len()..]);
            assert!(
                !others.is_empty(),
                "{name}, {}: nothing is expected",
                task.title
            );
            let found = others.iter().filter_map(|line| {
                let problem = complaint(line, folder.path(), &said)?;
                Some(format!("- {line}: {problem}"))
            });
            let mut found: Vec<String> = found.collect();
            if status.to_string() != wanted {
                found.push(format!("exit status {status}, not {wanted}"));
            }
            if !found.is_empty() {
                complaints.push(format!(
                    "{name}, {}:\n{}\n{said}",
                    task.title,
                    found.join("\n")
                ));
            }
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n\n"));
}

#[test]
fn what_is_not_so_is_noticed() {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.path().join(name), bytes).expect("room for it")
    };
    put("a.csv", b"x\n1\n2\n");
    put("a.png", b"no picture");
    put("a.svg", b"");
    put("a.hdr", b"#?RADIANCE\n\n-Y 32 +X 64\n");
    let said = "EV100 8.50\n\"azimuth\": -12.5e-1,\nat last 7.";
    let check = |line: &str| complaint(line, folder.path(), said);
    for good in [
        "`a.csv` has 3 lines",
        "`a.csv` is there",
        "`a.hdr` is 64 x 32 pixels",
        "says `at last`",
        "`EV100` is 8.5 to 9",
        "`\"azimuth\"` is -1.26 to -1.24",
        "`last` is 7 to 7",
    ] {
        assert_eq!(check(good), None, "{good}");
    }
    for bad in [
        "`a.csv` has 4 lines",
        "`b.csv` has 3 lines",
        "`b.csv` is there",
        "`a.svg` is there",
        "`a.png` is there",
        "`a.hdr` is 32 x 64 pixels",
        "`a.png` is 64 x 32 pixels",
        "says `never`",
        "`EV100` is 8.6 to 9",
        "`\"azimuth\"` is 1 to 2",
        "`nothing` is 1 to 2",
        "`a.csv` is nice",
        "it looks good",
    ] {
        assert!(check(bad).is_some(), "{bad}");
    }
    let page = "# T\n\n## One\n\n### 1. a\n\n```sh\ntrue\n```\n\n- says `x`\n- exits with 2\n\n### 2. b\n\nNot run.\n";
    let people = people(page);
    let (name, tasks, count) = &people[0];
    assert_eq!((*name, tasks.len(), *count), ("One", 1, 2));
    assert_eq!((tasks[0].title, tasks[0].script), ("1. a", "true"));
    assert_eq!(tasks[0].expected, ["says `x`", "exits with 2"]);
    assert_eq!(
        run("echo out; echo err >&2; exit 3", folder.path()),
        ("out\nerr\n".into(), 3)
    );
    // Not the last one's status alone.
    assert_eq!(run("false\necho on", folder.path()), (String::new(), 1));
}
