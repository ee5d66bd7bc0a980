//! `cargo xtask test`: everything that the tests need, then all of them, then a count.
//!
//! libtest knows no test that could not run. Such a test appends its name and the reason to the file that
//! `TYNDALL_NOT_RUN` names and passes; here it is taken from the passed ones and listed.

mod apt;
mod python;
mod slurm;
mod vulkan;

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// Runs the tests; `arguments` go to `cargo test`.
pub fn run(arguments: Vec<String>) -> ExitCode {
    match run_all(arguments) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(problem) => {
            say(&problem);
            ExitCode::FAILURE
        }
    }
}

fn run_all(arguments: Vec<String>) -> Result<bool, String> {
    let target = crate::target();
    fs::create_dir_all(&target).map_err(|e| format!("cannot make {}: {e}", target.display()))?;
    let list = target.join("tests-not-run.txt");
    fs::write(&list, "").map_err(|e| format!("cannot write {}: {e}", list.display()))?;

    vulkan::prepare();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .args(["test", "--release", "--workspace", "--no-fail-fast"])
        .args(arguments)
        .current_dir(crate::root())
        .env("TYNDALL_NOT_RUN", &list)
        .stdout(Stdio::piped());
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
    fn nothing_ran() {
        assert_eq!(Count::default().summary(0), "0 passed, 0 failed, 0 skipped");
    }
}
