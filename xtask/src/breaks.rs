//! `cargo xtask breaks`: small breaks, put into a copy of the sources one at a time, and whether the test that must notice does.
//!
//! The list is `tests/breaks.toml`. A break that goes unnoticed is a hole in the tests; one whose text is no longer found, or found
//! twice, has gone stale. The sources themselves are never touched.
//!
//! What costs time is building, so that it is done as little as can be: a shader or a table stands in a program as it is written, and
//! is broken there; a suite that needs few modules is built with these alone ([`crate::cut`]). A test program is stopped at its first failure. What failed must pass without the break: a test that fails anyway
//! would notice everything.

use crate::cut::{self, Part};
use serde::Deserialize;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc;
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
#[derive(Debug, Clone, PartialEq)]
enum Came {
    /// The test of this name failed, or the whole program for none.
    Caught(Option<String>),
    Survived,
    DoesNotCompile,
    /// This test fails without the break.
    FailsAnyway(Option<String>),
    /// The program has no test of the name.
    NoSuchTest,
}

/// Programs without any break, and with what arguments they pass.
type Passing = BTreeSet<(PathBuf, String)>;

impl std::fmt::Display for Came {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = |name: &Option<String>| name.clone().unwrap_or_else(|| "the whole".into());
        match self {
            Came::Caught(by) => write!(f, "caught by `{}`", name(by)),
            Came::Survived => f.write_str("**not noticed**"),
            Came::DoesNotCompile => f.write_str("**does not compile**"),
            Came::FailsAnyway(test) => write!(f, "**`{}` fails anyway**", name(test)),
            Came::NoSuchTest => f.write_str("**no such test**"),
        }
    }
}

impl Came {
    /// What it is when what failed of `one` runs in `sound`, which has no break, too; `passing` holds what has passed there before.
    fn checked(
        self,
        one: &Break,
        sound: &Path,
        folder: &Path,
        passing: &mut Passing,
    ) -> Result<Came, String> {
        let Came::Caught(name) = &self else {
            return Ok(self);
        };
        // What ended or hung named no test: all of it must pass.
        let arguments = match name {
            Some(name) => vec!["--exact", name.as_str()],
            None => one.part(),
        };
        let key = (sound.to_owned(), arguments.join(" "));
        if !passing.contains(&key) {
            if test(sound, folder, &arguments)? != Came::Survived {
                return Ok(Came::FailsAnyway(name.clone()));
            }
            passing.insert(key);
        }
        Ok(self)
    }
}

/// Runs all breaks whose name, file or test contains one of the words of `arguments` (all for none).
///
/// `--built FOLDER` among them names a folder of test programs, such as `target/release/deps`, that need not be built once more for shaders
/// and data: what stands in one of these as it is written is broken in a copy of it.
pub fn run(arguments: Vec<String>) -> Result<bool, String> {
    let (mut only, mut built) = (Vec::new(), None);
    let mut arguments = arguments.into_iter();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--built" => built = Some(arguments.next().ok_or("--built needs a folder")?),
            _ => only.push(argument),
        }
    }
    let built = built.as_deref().map(Path::new);
    let root = crate::root();
    let list: List = crate::list("tests/breaks.toml")?;
    let wanted = |b: &Break| {
        let named = |w: &String| [&b.name, &b.file, &b.test].iter().any(|t| t.contains(w));
        only.is_empty() || only.iter().any(named)
    };
    let mut breaks: Vec<Break> = list.breaks.into_iter().filter(wanted).collect();
    // First what needs no build, then what shares a program.
    breaks.sort_by_key(|one| (!one.is_embedded(), one.place()));
    let mut places: BTreeMap<String, Place> = BTreeMap::new();
    let (mut caught, mut passing) = (0, Passing::new());
    println!("| break | file | came |\n|---|---|---|");
    for one in &breaks {
        let begun = Instant::now();
        let came = match one.in_built(&root, built, &mut passing)? {
            Some(came) => came,
            None => {
                let place = match places.entry(one.place()) {
                    Entry::Occupied(there) => there.into_mut(),
                    Entry::Vacant(new) => new.insert(Place::new(&root, one)?),
                };
                place.with(one, &mut passing)?
            }
        };
        caught += usize::from(matches!(came, Came::Caught(_)));
        println!("| {} | {} | {came} |", one.name, one.file);
        let seconds = begun.elapsed().as_secs_f64();
        eprintln!("xtask: {came} after {seconds:.0} s: {}", one.name);
    }
    println!("\n{caught} of {} caught", breaks.len());
    Ok(caught == breaks.len())
}

impl Break {
    /// The program of its test.
    fn binary(&self) -> &str {
        self.test.split_whitespace().next().unwrap_or_default()
    }

    /// Its module of the library, if it is of one.
    fn module(&self) -> Option<&str> {
        self.file.strip_prefix("src/")?.split(['/', '.']).next()
    }

    /// What its test is built of: unit tests with their module, a suite by itself.
    fn place(&self) -> String {
        match self.binary() {
            "lib" => format!("lib-{}", self.module().unwrap_or_default()),
            suite => suite.to_owned(),
        }
    }

    /// Whether its file stands in a program as it is written.
    fn is_embedded(&self) -> bool {
        !self.file.ends_with(".rs")
    }

    /// Tests it in the program of its suite in the folder `built`; `None` where there is no program that holds its file.
    fn in_built(
        &self,
        root: &Path,
        built: Option<&Path>,
        passing: &mut Passing,
    ) -> Result<Option<Came>, String> {
        let found = built
            .filter(|_| self.is_embedded())
            .and_then(|folder| newest(folder, self.binary()));
        let Some(program) = found else {
            return Ok(None);
        };
        let path = root.join(&self.file);
        let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", self.file))?;
        let copy = kept()?.join(format!("{}-broken", self.place()));
        if !patch(&program, &text, &self.broken(&text)?, &copy)? {
            return Ok(None);
        }
        let came = self.tested(&copy, root)?;
        // The command line may have a suite of the same name.
        if came == Came::NoSuchTest {
            return Ok(None);
        }
        came.checked(self, &program, root, passing).map(Some)
    }

    /// Runs its test in a program that has it in.
    fn tested(&self, program: &Path, folder: &Path) -> Result<Came, String> {
        test(program, folder, &self.part())
    }

    /// What of that program is run.
    fn part(&self) -> Vec<&str> {
        self.test.split_whitespace().skip(1).collect()
    }

    /// Its file with it in.
    fn broken(&self, sound: &str) -> Result<String, String> {
        match sound.matches(&self.from).count() {
            1 => Ok(sound.replacen(&self.from, &self.to, 1)),
            found => Err(format!(
                "`{}`: the text {:?} stands {found} times in {}, and must stand there once",
                self.name, self.from, self.file
            )),
        }
    }
}

/// A copy of the sources, and a test program of it.
struct Place {
    folder: PathBuf,
    /// The program without any break.
    sound: PathBuf,
}

impl Place {
    /// Copies what the test of `one` needs, and builds it.
    fn new(root: &Path, one: &Break) -> Result<Self, String> {
        let modules: Vec<&str> = one.module().into_iter().collect();
        let suites: Vec<&str> = [one.binary()].into_iter().filter(|s| *s != "lib").collect();
        let whole = crate::target().join("breaks");
        let (folder, part) = match cut::is_whole(root, &modules, &suites)? {
            true => (whole.join("tree"), Part::Whole),
            false => (
                whole.join("cut").join(one.place()),
                Part::Cut {
                    modules: &modules,
                    suites: &suites,
                },
            ),
        };
        cut::copy(root, &folder, part)?;
        let mut place = Place {
            folder,
            sound: PathBuf::new(),
        };
        let program = place
            .program(one.binary())?
            .ok_or_else(|| format!("`{}` does not compile without any break", one.test))?;
        place.sound = kept()?.join(one.place());
        fs::copy(&program, &place.sound).map_err(|e| format!("{}: {e}", place.sound.display()))?;
        Ok(place)
    }

    /// Puts a break in, tests, and takes it out again.
    fn with(&self, one: &Break, passing: &mut Passing) -> Result<Came, String> {
        let path = self.folder.join(&one.file);
        let wrong = |e: std::io::Error| format!("{}: {e}", one.file);
        let text = fs::read_to_string(&path).map_err(wrong)?;
        let broken = one.broken(&text)?;
        let sound = &self.sound;
        if one.is_embedded() {
            let copy = sound.with_extension("broken");
            if patch(sound, &text, &broken, &copy)? {
                let came = one.tested(&copy, &self.folder)?;
                return came.checked(one, sound, &self.folder, passing);
            }
        }
        let time = path.metadata().and_then(|m| m.modified()).map_err(wrong)?;
        fs::write(&path, &broken).map_err(wrong)?;
        let program = match one.is_embedded() {
            // The test reads the file itself.
            true => Ok(Some(sound.clone())),
            false => self.program(one.binary()),
        };
        let came = match program {
            Ok(Some(program)) => one.tested(&program, &self.folder),
            Ok(None) => Ok(Came::DoesNotCompile),
            Err(problem) => Err(problem),
        };
        fs::write(&path, &text).map_err(wrong)?;
        if one.is_embedded() {
            // Nothing was built of it: it is as it was.
            let file = fs::File::options().write(true).open(&path);
            file.and_then(|file| file.set_modified(time))
                .map_err(wrong)?;
        }
        came?.checked(one, sound, &self.folder, passing)
    }

    /// Builds the program of a test in the copy; `None` where it does not compile.
    fn program(&self, binary: &str) -> Result<Option<PathBuf>, String> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut build = Command::new(&cargo);
        build.args(["test", "--profile", "breaks", "--package", "tyndall"]);
        build.args(["--no-run", "--message-format=json"]);
        match binary {
            "lib" => build.arg("--lib"),
            _ => build.args(["--test", binary]),
        };
        let built = build
            .current_dir(&self.folder)
            .env("CARGO_TARGET_DIR", crate::target().join("breaks/target"))
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .output()
            .map_err(|e| format!("cargo does not start: {e}"))?;
        if !built.status.success() {
            return Ok(None);
        }
        let executable = |line: &str| {
            let told: serde_json::Value = serde_json::from_str(line).ok()?;
            told["executable"].as_str().map(PathBuf::from)
        };
        let said = String::from_utf8_lossy(&built.stdout);
        let program = said.lines().filter_map(executable).next_back();
        let program = program.ok_or_else(|| format!("`{binary}`: cargo names no program"))?;
        Ok(Some(program))
    }
}

/// Runs a test program in a folder up to its first failure.
///
/// # Errors
/// In words, where it does not start.
fn test(program: &Path, folder: &Path, arguments: &[&str]) -> Result<Came, String> {
    let wrong = |e: std::io::Error| format!("{}: {e}", program.display());
    let mut child = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .env("CARGO_MANIFEST_DIR", folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(wrong)?;
    let (tell, told) = mpsc::channel();
    let lines = child.stdout.take().map(BufReader::new);
    std::thread::spawn(move || {
        for line in lines
            .into_iter()
            .flat_map(BufRead::lines)
            .map_while(Result::ok)
        {
            if tell.send(line).is_err() {
                break;
            }
        }
    });
    let begun = Instant::now();
    loop {
        let left = PATIENCE.saturating_sub(begun.elapsed());
        match told.recv_timeout(left) {
            Ok(line) if line == "running 0 tests" => {
                child.wait().map_err(wrong)?;
                return Ok(Came::NoSuchTest);
            }
            Ok(line) => {
                let failed = line.strip_suffix(" ... FAILED");
                if let Some(name) = failed.and_then(|line| line.strip_prefix("test ")) {
                    let _ = child.kill().and_then(|()| child.wait());
                    return Ok(Came::Caught(Some(name.to_owned())));
                }
            }
            // A loop that no longer ends has been noticed too.
            Err(mpsc::RecvTimeoutError::Timeout) => {
                let _ = child.kill().and_then(|()| child.wait());
                return Ok(Came::Caught(None));
            }
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                let passed = child.wait().map_err(wrong)?.success();
                return Ok(if passed {
                    Came::Survived
                } else {
                    Came::Caught(None)
                });
            }
        }
    }
}

/// Where programs are kept.
fn kept() -> Result<PathBuf, String> {
    let folder = crate::target().join("breaks/sound");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    Ok(folder)
}

/// The newest program of a suite in a folder where Cargo puts them, with a hash at their names' ends.
fn newest(folder: &Path, suite: &str) -> Option<PathBuf> {
    let is_of_suite = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str());
        let hash = name.and_then(|name| name.strip_prefix(suite)?.strip_prefix('-'));
        hash.is_some_and(|hash| hash.chars().all(|c| c.is_ascii_hexdigit()))
    };
    let programs = folder.read_dir().ok()?.flatten().map(|entry| entry.path());
    programs
        .filter(is_of_suite)
        .max_by_key(|path| path.metadata().and_then(|m| m.modified()).ok())
}

/// Writes `program` to `copy` with `broken` in place of `sound`; `false` where it does not hold that.
fn patch(program: &Path, sound: &str, broken: &str, copy: &Path) -> Result<bool, String> {
    let wrong = |e: std::io::Error| format!("{}: {e}", program.display());
    let broken = as_long(broken, sound.len())
        .ok_or("a broken file is longer than it was by more than its comments")?;
    let mut bytes = fs::read(program).map_err(wrong)?;
    let mut found = 0;
    while let Some(at) = find(&bytes, sound.as_bytes()) {
        bytes[at..at + broken.len()].copy_from_slice(broken.as_bytes());
        found += 1;
    }
    if found > 0 {
        // With the rights of a program.
        fs::copy(program, copy).map_err(wrong)?;
        fs::write(copy, bytes).map_err(wrong)?;
    }
    Ok(found > 0)
}

/// Where `part` begins in `whole`.
fn find(whole: &[u8], part: &[u8]) -> Option<usize> {
    let first = *part.first()?;
    let mut from = 0;
    while let Some(next) = whole[from..].iter().position(|byte| *byte == first) {
        if whole[from + next..].starts_with(part) {
            return Some(from + next);
        }
        from += next + 1;
    }
    None
}

/// `text` with spaces at its end, or with less of its comments, so that it has `length` bytes.
fn as_long(text: &str, length: usize) -> Option<String> {
    let mut excess = text.len().saturating_sub(length);
    let mut made = String::new();
    for line in text.split_inclusive('\n') {
        match line.find("//") {
            Some(at) if excess > 0 => {
                let end = line.trim_end_matches('\n').len();
                excess = excess.saturating_sub(end - at);
                made += &line[..at];
                made += &line[end..];
            }
            _ => made += line,
        }
    }
    made += &" ".repeat(length.checked_sub(made.len())?);
    Some(made)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_text_is_as_long_as_it_was() {
        assert_eq!(as_long("a = 1;", 8).as_deref(), Some("a = 1;  "));
        let longer = as_long("// a word\na = 100; // b\n", 20).expect("comments suffice");
        assert_eq!(longer, "\na = 100; // b\n     ");
        assert_eq!(as_long("a = 100;", 6), None);
        assert_eq!(find(b"aabaac", b"aac"), Some(3));
        assert_eq!(find(b"aabaac", b"aad"), None);
    }
}
