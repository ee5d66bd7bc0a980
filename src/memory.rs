//! Memory for what may be large: asked for before it is touched, and an error where there is not enough.
//!
//! A list that grows asks the allocator, which ends the program when it has nothing left. What can be large (pictures, maps,
//! textures) is therefore made by [`filled`], and asked of the system first: what is promised to many programs at once is found
//! to be missing only when it is used.

use crate::error::{Error, Result};
use std::fs;

/// What is left alone, for everything that is small [bytes].
const SPARE: u64 = 16 << 20;

/// A list of `count` times the same value; `what` names it to the user.
///
/// # Errors
/// [`Error::Failed`] when there is not enough memory.
pub fn filled<T: Clone>(what: &str, count: usize, value: T) -> Result<Vec<T>> {
    let bytes = count.saturating_mul(size_of::<T>()) as u64;
    check(what, bytes)?;
    let mut list = Vec::new();
    list.try_reserve_exact(count)
        .map_err(|_| not_enough(what, bytes))?;
    list.resize(count, value);
    Ok(list)
}

/// Whether so many bytes can be had; `what` names what they are for.
///
/// # Errors
/// [`Error::Failed`] when they cannot.
pub fn check(what: &str, bytes: u64) -> Result<()> {
    match available() {
        Some(most) if bytes.saturating_add(SPARE) > most => Err(not_enough(what, bytes)),
        _ => Ok(()),
    }
}

/// What the system would still give to this program [bytes], where it says so (on Linux): within the limit on its address space
/// and within the memory and swap space that are free.
pub fn available() -> Option<u64> {
    let system = fs::read_to_string("/proc/meminfo").ok();
    let free = system.and_then(|text| free(&text));
    within_limit().into_iter().chain(free).min()
}

/// What the limit on the address space (`ulimit -v`) leaves to this program [bytes], if there is one.
pub fn within_limit() -> Option<u64> {
    let limit = address_space(&fs::read_to_string("/proc/self/limits").ok()?)?;
    let used = pages(&fs::read_to_string("/proc/self/statm").ok()?)?;
    Some(limit.saturating_sub(used))
}

/// The limit on the address space [bytes] that `/proc/self/limits` tells, if there is one.
fn address_space(limits: &str) -> Option<u64> {
    let line = limits
        .lines()
        .find_map(|l| l.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// The address space in use [bytes] that `/proc/self/statm` tells, in pages of 4 KiB or more.
fn pages(statm: &str) -> Option<u64> {
    Some(4096 * statm.split_whitespace().next()?.parse::<u64>().ok()?)
}

/// Free memory and swap space [bytes] that `/proc/meminfo` tells in KiB.
fn free(meminfo: &str) -> Option<u64> {
    let of = |name: &str| {
        let line = meminfo.lines().find_map(|line| line.strip_prefix(name))?;
        line.split_whitespace().next()?.parse::<u64>().ok()
    };
    Some(1024 * (of("MemAvailable:")? + of("SwapFree:").unwrap_or(0)))
}

/// The error that says so.
pub fn not_enough(what: &str, bytes: u64) -> Error {
    Error::failed(
        format!(
            "not enough memory for {what} ({} MiB)",
            (bytes >> 20).max(1)
        ),
        "make it smaller, end other programs, or raise the limit on memory (ulimit -v)",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_had_is_an_error() {
        let error = filled("the picture", usize::MAX / 16, 0.0_f64).unwrap_err();
        assert!(!error.is_input());
        assert!(
            error
                .problem()
                .starts_with("not enough memory for the picture")
        );
        assert_eq!(filled("three", 3, 7).unwrap(), [7, 7, 7]);
        assert!(check("nothing", 0).is_ok());
    }

    #[test]
    fn the_system_is_understood() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units     \n\
            Max address space         409600000            unlimited            bytes     \n";
        assert_eq!(address_space(limits), Some(409_600_000));
        assert_eq!(
            address_space(&limits.replace("409600000", "unlimited")),
            None
        );
        assert_eq!(pages("12 3 4 5 6 7 8\n"), Some(49_152));
        let text = "MemTotal: 9 kB\nMemAvailable:   100 kB\nSwapFree: 5 kB\n";
        assert_eq!(free(text), Some(105 * 1024));
    }
}
