//! `cargo xtask breaks`: small breaks, put into a copy of the sources one at a time, and whether the test that must notice does.
//!
//! The list is `tests/breaks.toml`. A break that goes unnoticed is a hole in the tests; one whose text is no longer found, or found
//! twice, has gone stale. The sources themselves are never touched.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

/// How long a test may take before it counts as one that no longer ends.
const PATIENCE: Duration = Duration::from_secs(600);

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    #[serde(rename = "break")]
    breaks: Vec<Break>,
}

/// One break.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Break {
    /// What it breaks, in words.
    name: String,
    /// The file, from the root.
    file: String,
    /// A text that stands in it once.
    from: String,
    /// What takes its place.
    to: String,
    /// The test that must fail, `BINARY` or `BINARY NAME`: a file of `tests`, or `lib` for the tests beside the sources.
    test: String,
}

/// What came of a break.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Came {
    Caught,
    Survived,
    DoesNotCompile,
}

/// Runs all breaks whose name, file or test contains one of `only` (all for none).
pub fn run(only: Vec<String>) -> ExitCode {
    match run_all(&only) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(problem) => {
            eprintln!("xtask: {problem}");
            ExitCode::FAILURE
        }
    }
}

fn run_all(only: &[String]) -> Result<bool, String> {
    let root = crate::root();
    let path = root.join("tests/breaks.toml");
    let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let list: List = toml::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
    let wanted = |b: &Break| {
        let named = |w: &String| [&b.name, &b.file, &b.test].iter().any(|t| t.contains(w));
        only.is_empty() || only.iter().any(named)
    };
    let breaks: Vec<Break> = list.breaks.into_iter().filter(wanted).collect();
    let place = Place::new(&root)?;

    // A test that fails on the unbroken sources would notice everything.
    let mut sound: BTreeMap<&str, bool> = BTreeMap::new();
    for one in &breaks {
        if !sound.contains_key(one.test.as_str()) {
            let passes = place.test(&one.test)? == Came::Survived;
            sound.insert(&one.test, passes);
            if !passes {
                eprintln!("xtask: `{}` fails without any break", one.test);
            }
        }
    }
    let mut missed = sound.values().filter(|passes| !**passes).count();
    println!("| break | file | test | came |\n|---|---|---|---|");
    for one in &breaks {
        let begun = Instant::now();
        let came = place.with(one)?;
        let word = match came {
            Came::Caught => "caught".to_owned(),
            Came::Survived => "**not noticed**".to_owned(),
            Came::DoesNotCompile => "**does not compile**".to_owned(),
        };
        missed += usize::from(came != Came::Caught);
        println!("| {} | {} | {} | {word} |", one.name, one.file, one.test);
        eprintln!(
            "xtask: {word} after {:.0} s: {}",
            begun.elapsed().as_secs_f64(),
            one.name
        );
    }
    let caught = breaks.len() - missed.min(breaks.len());
    println!("\n{caught} of {} caught", breaks.len());
    Ok(missed == 0)
}

/// A copy of the sources.
struct Place {
    folder: PathBuf,
    built: PathBuf,
}

impl Place {
    /// Copies what git knows of `root`, as it stands there now. What has not changed keeps its time, so that little is built anew.
    fn new(root: &Path) -> Result<Self, String> {
        let folder = crate::target().join("breaks/tree");
        let built = crate::target().join("breaks/target");
        let listed = Command::new("git")
            .args([
                "ls-files",
                "--cached",
                "--others",
                "--exclude-standard",
                "-z",
            ])
            .current_dir(root)
            .output()
            .map_err(|e| format!("git does not start: {e}"))?;
        for name in String::from_utf8_lossy(&listed.stdout).split('\0') {
            let from = root.join(name);
            if name.is_empty() || !from.is_file() {
                continue;
            }
            let to = folder.join(name);
            let text = fs::read(&from).map_err(|e| format!("{name}: {e}"))?;
            if fs::read(&to).is_ok_and(|there| there == text) {
                continue;
            }
            let parent = to.parent().unwrap_or(&folder);
            fs::create_dir_all(parent).map_err(|e| format!("{}: {e}", parent.display()))?;
            fs::write(&to, text).map_err(|e| format!("{}: {e}", to.display()))?;
        }
        Ok(Place { folder, built })
    }

    /// Puts a break in, tests, and takes it out again.
    fn with(&self, one: &Break) -> Result<Came, String> {
        let path = self.folder.join(&one.file);
        let sound = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", one.file))?;
        let found = sound.matches(&one.from).count();
        if found != 1 {
            return Err(format!(
                "`{}`: the text {:?} stands {found} times in {}, and must stand there once",
                one.name, one.from, one.file
            ));
        }
        let put = |text: &str| fs::write(&path, text).map_err(|e| format!("{}: {e}", one.file));
        put(&sound.replacen(&one.from, &one.to, 1))?;
        let came = self.test(&one.test);
        put(&sound)?;
        came
    }

    /// Runs a test in the copy.
    fn test(&self, test: &str) -> Result<Came, String> {
        let mut words = test.split_whitespace();
        let binary = words.next().unwrap_or_default();
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut build = Command::new(&cargo);
        build.args([
            "test",
            "--profile",
            "breaks",
            "--package",
            "tyndall",
            "--locked",
            "--no-run",
        ]);
        build.arg("--message-format=json");
        match binary {
            "lib" => build.arg("--lib"),
            _ => build.args(["--test", binary]),
        };
        let built = build
            .current_dir(&self.folder)
            .env("CARGO_TARGET_DIR", &self.built)
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .output()
            .map_err(|e| format!("cargo does not start: {e}"))?;
        if !built.status.success() {
            return Ok(Came::DoesNotCompile);
        }
        let executable = |line: &str| {
            let told: serde_json::Value = serde_json::from_str(line).ok()?;
            told["executable"].as_str().map(PathBuf::from)
        };
        let said = String::from_utf8_lossy(&built.stdout);
        let program = said.lines().filter_map(executable).next_back();
        let program = program.ok_or_else(|| format!("`{binary}`: cargo names no program"))?;
        let mut child = Command::new(&program)
            .args(words)
            .current_dir(&self.folder)
            .env("CARGO_MANIFEST_DIR", &self.folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|e| format!("{}: {e}", program.display()))?;
        let begun = Instant::now();
        loop {
            let over = child
                .try_wait()
                .map_err(|e| format!("`{test}` is lost: {e}"))?;
            match over {
                Some(status) if status.success() => return Ok(Came::Survived),
                Some(_) => return Ok(Came::Caught),
                // A loop that no longer ends has been noticed too.
                None if begun.elapsed() > PATIENCE => {
                    let _ = child.kill().and_then(|()| child.wait());
                    return Ok(Came::Caught);
                }
                None => std::thread::sleep(Duration::from_millis(50)),
            }
        }
    }
}
