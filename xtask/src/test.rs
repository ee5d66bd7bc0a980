//! `cargo xtask test`: everything that the tests need, then all of them, then a count.
//!
//! libtest knows no test that could not run. Such a test appends its name and the reason to the file that
//! `TYNDALL_NOT_RUN` names and passes; here it is taken from the passed ones and listed.

mod apt;
mod progress;
mod python;
mod slurm;
mod vulkan;

use progress::{Progress, text};
use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Runs the tests; `arguments` go to `cargo test`.
pub fn run(arguments: Vec<String>) -> Result<bool, String> {
    let target = crate::target();
    fs::create_dir_all(&target).map_err(|e| format!("cannot make {}: {e}", target.display()))?;
    let list = target.join("tests-not-run.txt");
    fs::write(&list, "").map_err(|e| format!("cannot write {}: {e}", list.display()))?;

    let record = target.join("tests-took.txt");
    announce(&target, &progress::kept(&record));
    vulkan::prepare();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(&cargo);
    command
        .args(TEST)
        .args(&arguments)
        .current_dir(crate::root())
        .env("TYNDALL_NOT_RUN", &list)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    match python::prepare(&target) {
        Ok(python) => {
            command.env("TYNDALL_PYTHON", python);
        }
        Err(problem) if set("REQUIRE_PYTHON") => return Err(problem),
        Err(problem) => {
            say(&problem);
            say("the tests that compare with Python packages do not run");
            command.env_remove("TYNDALL_PYTHON");
        }
    }
    if let Some(folder) = runtime_folder(&target) {
        command.env("XDG_RUNTIME_DIR", folder);
    }
    let Some(suites) = compiled(Command::new(&cargo).args(TEST), &arguments)? else {
        return Ok(false);
    };
    // It ends with this function.
    let slurm = slurm::prepare(&target);
    match &slurm {
        Some(slurm) => command.env("TYNDALL_SLURM", slurm.folder()),
        None => command.env_remove("TYNDALL_SLURM"),
    };
    // Tests of different packages run in different folders.
    if let Some(data) = std::env::var_os("TYNDALL_DATA")
        && let Ok(data) = std::path::absolute(data)
    {
        command.env("TYNDALL_DATA", data);
    }

    let mut child = command
        .spawn()
        .map_err(|e| format!("cargo does not start: {e}"))?;
    let progress = Progress::new(suites, &progress::kept(&record));
    let errors = child.stderr.take().expect("stderr is piped");
    let watch = std::thread::spawn(move || watched(errors, progress));
    let mut count = Count::default();
    let mut output = BufReader::new(child.stdout.take().expect("stdout is piped"));
    let mut line = Vec::new();
    while output.read_until(b'\n', &mut line).is_ok_and(|n| n > 0) {
        let mut stdout = std::io::stdout().lock();
        let _ = stdout.write_all(&line).and_then(|()| stdout.flush());
        count.read(&String::from_utf8_lossy(&line));
        line.clear();
    }
    let status = child.wait().map_err(|e| format!("cargo is lost: {e}"))?;
    if let Ok(mut progress) = watch.join() {
        // A run without a record is the same run.
        let _ = fs::write(&record, progress.record());
        let slowest = progress.slowest();
        let slowest = slowest
            .iter()
            .map(|(name, s)| format!("{name} {}", text(*s)));
        say(&format!(
            "the slowest suites: {}",
            slowest.collect::<Vec<_>>().join(", ")
        ));
    }

    let noted = fs::read_to_string(&list).unwrap_or_default();
    let not_run = count.not_run(&noted);
    println!();
    for (test, reason) in &not_run {
        println!("not run: {test}: {reason}");
    }
    if !status.success() && count.failed.is_empty() {
        println!("cargo test failed before or between the tests ({status})");
    }
    for test in &count.failed {
        println!("failed: {test}");
    }
    println!("{}", count.summary(not_run.len()));
    Ok(status.success() && count.failures == 0)
}

/// The command that compiles and runs all tests.
const TEST: [&str; 4] = ["test", "--release", "--workspace", "--no-fail-fast"];

/// Says what will be installed, how large that is, and how long all takes.
fn announce(target: &Path, record: &str) {
    let needs = [vulkan::missing(), python::missing(target), slurm::missing()];
    let needs: Vec<String> = needs.into_iter().flatten().collect();
    match needs.is_empty() {
        true => say("what the tests need is there"),
        false => say(&format!("to be installed first: {}", needs.join("; "))),
    }
    let run = match progress::expected(record) {
        Some(all) => format!("run, {} the last time", text(all)),
        None => "run, about 35 minutes on two cores".into(),
    };
    say(&format!(
        "then the tests are compiled (some 6 GB under {} and about 10 minutes on two cores where nothing is there yet) and {run}",
        target.display()
    ));
}

/// Compiles the tests: the files of their suites, documentation apart; nothing where they do not compile.
fn compiled(cargo: &mut Command, arguments: &[String]) -> Result<Option<Vec<String>>, String> {
    let arguments = arguments.split(|argument| argument == "--").next();
    let arguments = arguments.unwrap_or_default();
    // Examples in the documentation are compiled as they are run.
    if arguments.iter().any(|argument| argument == "--doc") {
        return Ok(Some(Vec::new()));
    }
    let begun = Instant::now();
    let output = cargo
        .args(arguments)
        .args(["--no-run", "--message-format=json-render-diagnostics"])
        .current_dir(crate::root())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo does not start: {e}"))?;
    if !output.status.success() {
        println!("the tests do not compile ({})", output.status);
        return Ok(None);
    }
    let told = String::from_utf8_lossy(&output.stdout);
    let suites: Vec<String> = told.lines().filter_map(suite).collect();
    say(&format!(
        "{} suites, compiled in {}",
        suites.len(),
        text(begun.elapsed().as_secs_f64())
    ));
    Ok(Some(suites))
}

/// The file of the program of tests that a message of cargo's is about, from its package.
fn suite(message: &str) -> Option<String> {
    let told: serde_json::Value = serde_json::from_str(message).ok()?;
    let is_suite = told["executable"].is_string() && told["profile"]["test"] == true;
    let package = Path::new(told["manifest_path"].as_str()?).parent()?;
    let file = Path::new(told["target"]["src_path"].as_str()?);
    let file = file.strip_prefix(package).unwrap_or(file);
    is_suite.then(|| file.display().to_string())
}

/// Passes on what cargo and the tests say on standard error, and says how far they are.
fn watched(errors: impl Read, mut progress: Progress) -> Progress {
    let mut errors = BufReader::new(errors);
    let mut line = Vec::new();
    while errors.read_until(b'\n', &mut line).is_ok_and(|n| n > 0) {
        let _ = std::io::stderr().write_all(&line);
        if let Some(far) = progress.read(&String::from_utf8_lossy(&line)) {
            say(&far);
        }
        line.clear();
    }
    progress
}

/// What libtest reported, over all test binaries.
#[derive(Debug, Default)]
struct Count {
    passed: usize,
    failures: usize,
    ignored: usize,
    failed: Vec<String>,
}

impl Count {
    /// Takes a line of output into account.
    fn read(&mut self, line: &str) {
        let line = line.trim_end();
        if let Some(result) = line.strip_prefix("test result: ") {
            for part in result.split(['.', ';']) {
                let Some((number, what)) = part.trim().split_once(' ') else {
                    continue;
                };
                let Ok(number) = number.parse::<usize>() else {
                    continue;
                };
                match what {
                    "passed" => self.passed += number,
                    "failed" => self.failures += number,
                    "ignored" => self.ignored += number,
                    _ => {}
                }
            }
        } else if let Some(test) = line.strip_prefix("test ")
            && let Some(name) = test.strip_suffix(" ... FAILED")
        {
            self.failed.push(name.to_owned());
        }
    }

    /// The tests that noted that they could not run, each once with its first reason, less those that failed.
    fn not_run(&self, noted: &str) -> BTreeMap<String, String> {
        let short = |name: &str| name.rsplit("::").next().unwrap_or(name).to_owned();
        let failed: Vec<String> = self.failed.iter().map(|name| short(name)).collect();
        let mut tests = BTreeMap::new();
        for line in noted.lines() {
            let (name, reason) = line.split_once('\t').unwrap_or((line, "no reason given"));
            if !name.is_empty() && !failed.contains(&short(name)) {
                let reason = reason.to_owned();
                tests.entry(name.to_owned()).or_insert(reason);
            }
        }
        tests
    }

    /// The last line.
    fn summary(&self, not_run: usize) -> String {
        format!(
            "{} passed, {} failed, {} skipped",
            self.passed.saturating_sub(not_run),
            self.failures,
            self.ignored + not_run
        )
    }
}

/// A private folder for drivers that insist on one; `None` where the system gives it.
fn runtime_folder(target: &Path) -> Option<PathBuf> {
    let given = std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
    if cfg!(not(target_os = "linux")) || given.is_some_and(|folder| folder.is_dir()) {
        return None;
    }
    let folder = target.join("xdg-runtime");
    fs::create_dir_all(&folder).ok()?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(&folder, fs::Permissions::from_mode(0o700)).ok()?;
    }
    Some(folder)
}

/// Whether the variable is there and neither empty nor 0.
fn set(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|value| !value.is_empty() && value != "0")
}

fn say(words: &str) {
    eprintln!("xtask: {words}");
}

/// Runs `command` without input; its output is shown only when it fails.
fn quietly(command: &mut Command) -> Result<(), String> {
    let output = command
        .stdin(Stdio::null())
        .output()
        .map_err(|e| format!("{:?} does not start: {e}", command.get_program()))?;
    if output.status.success() {
        return Ok(());
    }
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8_lossy(&text).trim().to_owned();
    Err(format!("{command:?} failed ({}):\n{text}", output.status))
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTPUT: &str = "\
running 3 tests
test a::b ... ok
test c::d ... FAILED
test e ... ignored
test result: FAILED. 41 passed; 1 failed; 1 ignored; 0 measured; 7 filtered out; finished in 0.00s
test result: ok. 2 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 1.50s
a test that prints 9 failed; and 8 passed
";

    #[test]
    fn results_are_summed_over_binaries() {
        let mut count = Count::default();
        OUTPUT.lines().for_each(|line| count.read(line));
        assert_eq!(count.failed, ["c::d"]);
        // Noted twice, and one that failed all the same.
        let noted = "tests::b\tno GPU\ntests::b\tno Python\nother::d\tno GPU\n";
        let not_run = count.not_run(noted);
        assert_eq!(not_run.len(), 1);
        assert_eq!(not_run["tests::b"], "no GPU");
        assert_eq!(count.summary(1), "42 passed, 1 failed, 2 skipped");
    }

    #[test]
    fn suites_are_programs_of_tests() {
        let message = |executable: &str, test: bool| {
            format!(
                r#"{{"reason": "compiler-artifact", "manifest_path": "/x/cli/Cargo.toml", "executable": {executable},
                "target": {{"src_path": "/x/cli/tests/sun.rs"}}, "profile": {{"test": {test}}}}}"#
            )
        };
        let found = suite(&message("\"/x/target/sun\"", true));
        assert_eq!(found.as_deref(), Some("tests/sun.rs"));
        for other in [
            message("\"/x/target/tyndall\"", false),
            message("null", true),
            "no JSON".into(),
        ] {
            assert_eq!(suite(&other), None, "{other}");
        }
    }

    #[test]
    fn nothing_ran() {
        assert_eq!(Count::default().summary(0), "0 passed, 0 failed, 0 skipped");
    }
}
