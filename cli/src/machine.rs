//! What the program needs of the machine that it runs on: memory, threads, drivers that keep quiet, files that may be full.

use std::io::Write;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::process::ExitCode;

use crate::tell;
use tyndall::backend::{Backend, Wanted};
use tyndall::{Result, memory};

/// Without this much there is no use in starting [bytes]: threads, their stacks, the tables of zones and skies.
const LEAST: u64 = 48 << 20;

/// A driver maps libraries and compiles shaders: with less address space than this it may end the program [bytes].
const LEAST_FOR_A_DRIVER: u64 = 1 << 30;

/// Memory to begin with, and threads: fewer where the system has no more, the one at hand where it has none.
pub fn prepare() -> Result<()> {
    memory::check("the program itself", LEAST)?;
    #[cfg(unix)]
    refuse_to_die_of_full_files();
    let pool = || rayon::ThreadPoolBuilder::new();
    if pool().build_global().is_err() && pool().num_threads(2).build_global().is_err() {
        // It is there already, or this thread does all the work.
        let _ = pool().num_threads(1).use_current_thread().build_global();
    }
    Ok(())
}

/// A file that has reached its limit (`ulimit -f`) is an error of the write, not the end of the program.
#[cfg(unix)]
fn refuse_to_die_of_full_files() {
    // A signal that is handled does nothing else. Where it cannot be, the old behaviour stays.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Default::default());
}

/// Runs everything; a panic is told as an error: that memory has run out, or a defect.
pub fn run(all: impl FnOnce() -> ExitCode) -> ExitCode {
    panic::set_hook(Box::new(tell_panic));
    panic::catch_unwind(AssertUnwindSafe(all)).unwrap_or(ExitCode::FAILURE)
}

fn tell_panic(info: &PanicHookInfo) {
    let payload = info.payload();
    let words = payload.downcast_ref::<String>().map(String::as_str);
    let words = words.or_else(|| payload.downcast_ref::<&str>().copied());
    let words = words.unwrap_or("no reason is known");
    let of_memory = [
        "allocat",
        "capacity overflow",
        "spawn thread",
        "ThreadPoolBuildError",
    ];
    let (problem, remedy) = if of_memory.iter().any(|sign| words.contains(sign)) {
        (
            format!("not enough memory ({words})"),
            "end other programs, raise the limit on memory (ulimit -v), or ask for less",
        )
    } else {
        let place = info
            .location()
            .map_or(String::new(), |at| format!(" ({at})"));
        (
            format!("tyndall has a defect: {words}{place}"),
            "please report it with the command and the scene",
        )
    };
    // Standard error may be closed.
    let _ = writeln!(std::io::stderr(), "error: {problem}\n  help: {remedy}");
}

/// Opens what computes. What drivers complain about is only passed on where that fails.
pub fn open(wanted: Wanted) -> Result<Backend> {
    let cramped = memory::within_limit().is_some_and(|left| left < LEAST_FOR_A_DRIVER);
    match wanted {
        Wanted::Gpu if cramped => {
            return Err(memory::not_enough("a graphics driver", LEAST_FOR_A_DRIVER));
        }
        Wanted::Auto if cramped => {
            tell::line(
                "note",
                "too little memory for a graphics driver; the reference renders",
            );
            return Backend::open(Wanted::Reference);
        }
        _ => {}
    }
    if wanted == Wanted::Reference {
        return Backend::open(wanted);
    }
    quietly(|| Backend::open(wanted))
}

/// Does `work` while standard error goes into a file; what it holds is passed on if the work fails.
#[cfg(unix)]
pub fn quietly<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    use std::io::{Read, Seek};

    let Some((mut said, redirected)) = Redirected::begin() else {
        return work();
    };
    let result = work();
    drop(redirected);
    if result.is_err() {
        let mut words = Vec::new();
        if said.rewind().is_ok() && said.read_to_end(&mut words).is_ok() {
            let _ = std::io::stderr().write_all(&words);
        }
    }
    result
}

/// Does `work`.
#[cfg(not(unix))]
pub fn quietly<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    work()
}

/// Standard error as it was, to be put back.
#[cfg(unix)]
struct Redirected(std::os::fd::OwnedFd);

#[cfg(unix)]
impl Redirected {
    /// Standard error goes into the file from here on; nothing where that cannot be.
    fn begin() -> Option<(std::fs::File, Self)> {
        use std::os::fd::AsFd;

        let file = tempfile::tempfile().ok()?;
        let before = std::io::stderr().as_fd().try_clone_to_owned().ok()?;
        rustix::stdio::dup2_stderr(&file).ok()?;
        Some((file, Self(before)))
    }
}

#[cfg(unix)]
impl Drop for Redirected {
    fn drop(&mut self) {
        let _ = rustix::stdio::dup2_stderr(&self.0);
    }
}
