//! How far the tests are: which suite of how many, how long so far, and about how long still.
//!
//! Cargo names each suite on standard error as it begins. How long each took is kept under `target` for the next run; one of which
//! nothing is known is taken to last as long as the mean of the others.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// A run of the suites of tests.
pub struct Progress {
    /// The suites, each by its own name.
    suites: Vec<String>,
    begun: Instant,
    /// How long suites took before [s].
    before: BTreeMap<String, f64>,
    /// How long those of this run took [s], in their order.
    took: Vec<(String, f64)>,
    running: Option<(String, Instant)>,
}

impl Progress {
    /// Of suites by their files; `record` is what [`Progress::record`] was when they ran before.
    pub fn new(files: impl IntoIterator<Item = String>, record: &str) -> Self {
        let mut suites = Vec::new();
        for file in files {
            let name = own_name(&file, suites.iter());
            suites.push(name);
        }
        Progress {
            suites,
            begun: Instant::now(),
            before: seconds(record),
            took: Vec::new(),
            running: None,
        }
    }

    /// Takes a line of cargo's into account: what is to be said of the suite that it begins.
    pub fn read(&mut self, line: &str) -> Option<String> {
        let name = suite(line)?;
        self.end();
        let name = own_name(&name, self.took.iter().map(|(name, _)| name));
        let number = self.took.len() + 1;
        let left = self
            .left()
            .map_or(String::new(), |left| format!(", about {} left", text(left)));
        let said = format!(
            "suite {number} of {}, {name}, after {}{left}",
            self.suites.len().max(number),
            text(self.begun.elapsed().as_secs_f64()),
        );
        self.running = Some((name, Instant::now()));
        Some(said)
    }

    /// How long each suite took: those of this run, and of earlier ones that did not run this time.
    pub fn record(&mut self) -> String {
        self.end();
        self.before.extend(self.took.iter().cloned());
        let line = |(name, seconds): (&String, &f64)| format!("{name}\t{seconds:.1}\n");
        self.before.iter().map(line).collect()
    }

    /// The slowest suites of this run, slowest first, with their seconds.
    pub fn slowest(&self) -> Vec<(String, f64)> {
        let mut slowest = self.took.clone();
        slowest.sort_by(|a, b| b.1.total_cmp(&a.1));
        slowest.truncate(5);
        slowest
    }

    fn end(&mut self) {
        if let Some((name, begun)) = self.running.take() {
            self.took.push((name, begun.elapsed().as_secs_f64()));
        }
    }

    /// How long the suites take that have not run [s]; nothing as long as nothing is known of any.
    fn left(&self) -> Option<f64> {
        let known = self.before.values().chain(self.took.iter().map(|(_, s)| s));
        let (sum, count) = known.fold((0.0, 0), |(sum, count), s| (sum + s, count + 1));
        let is_over = |name: &String| self.took.iter().any(|(over, _)| over == name);
        let to_come = self.suites.iter().filter(|name| !is_over(name));
        let mean = sum / f64::from(count);
        (count > 0).then(|| {
            to_come
                .map(|name| self.before.get(name).unwrap_or(&mean))
                .sum()
        })
    }
}

/// A name that is none of those `before` it: two packages may have a suite of the same file.
fn own_name<'a>(file: &str, before: impl Iterator<Item = &'a String>) -> String {
    let is_of = |name: &&String| {
        let rest = name.strip_prefix(file);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(" #"))
    };
    match before.filter(is_of).count() {
        0 => file.to_owned(),
        n => format!("{file} #{}", n + 1),
    }
}

/// A record, read.
fn seconds(record: &str) -> BTreeMap<String, f64> {
    let line = |line: &str| {
        let (name, seconds) = line.split_once('\t')?;
        Some((name.to_owned(), seconds.parse().ok()?))
    };
    record.lines().filter_map(line).collect()
}

/// The suite that a line of cargo's begins.
fn suite(line: &str) -> Option<String> {
    let line = line.trim();
    if let Some(package) = line.strip_prefix("Doc-tests ") {
        return Some(format!("examples in the documentation of {package}"));
    }
    let (name, _) = line.strip_prefix("Running ")?.split_once(" (")?;
    Some(name.strip_prefix("unittests ").unwrap_or(name).to_owned())
}

/// A span in words, as exact as anyone wants it.
pub fn text(seconds: f64) -> String {
    match seconds.round() as u64 {
        s @ 0..90 => format!("{s} s"),
        s => format!("{} min", (s + 30) / 60),
    }
}

/// What an earlier run has left in `path`.
pub fn kept(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

/// How long a record says that all suites take [s].
pub fn expected(record: &str) -> Option<f64> {
    let all: f64 = seconds(record).values().sum();
    (all > 0.0).then_some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn running(name: &str) -> String {
        format!("     Running {name} (target/release/deps/x-0123456789abcdef)")
    }

    fn suites(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| name.to_string()).collect()
    }

    #[test]
    fn suites_are_counted_and_their_times_kept() {
        let four = suites(&["src/lib.rs", "tests/sun.rs", "tests/sun.rs", "tests/sky.rs"]);
        let mut progress = Progress::new(four, "");
        assert_eq!(progress.read("   Compiling tyndall v0.1.0 (/x)"), None);
        assert_eq!(progress.read("test a ... ok"), None);
        let said = progress.read(&running("unittests src/lib.rs"));
        assert_eq!(said.as_deref(), Some("suite 1 of 4, src/lib.rs, after 0 s"));
        let mut next = |line: &str| progress.read(line).expect("a suite");
        let said = next(&running("tests/sun.rs"));
        assert_eq!(
            said,
            "suite 2 of 4, tests/sun.rs, after 0 s, about 0 s left"
        );
        let said = next(&running("tests/sun.rs"));
        assert!(
            said.starts_with("suite 3 of 4, tests/sun.rs #2, "),
            "{said}"
        );
        next("   Doc-tests tyndall");
        // One more than was counted.
        let said = next("   Doc-tests other");
        assert!(said.starts_with("suite 5 of 5, "), "{said}");
        let record = progress.record();
        assert_eq!(record.lines().count(), 5);
        assert!(record.contains("tests/sun.rs #2\t0.0\n"), "{record}");
        assert_eq!(progress.slowest().len(), 5);
    }

    #[test]
    fn what_is_left_goes_by_the_run_before() {
        let record = "src/lib.rs\t100\ntests/a.rs\t30\ntests/b.rs\t500\n";
        let three = suites(&["src/lib.rs", "tests/a.rs", "tests/b.rs"]);
        let mut progress = Progress::new(three, record);
        let mut next = |name| progress.read(&running(name)).expect("a suite");
        assert!(next("unittests src/lib.rs").ends_with(", about 11 min left"));
        assert!(next("tests/a.rs").ends_with(", about 9 min left"));
        assert!(next("tests/b.rs").ends_with(", about 8 min left"));
        assert_eq!(expected(record), Some(630.0));
        assert_eq!(expected(""), None);
        // Of some of the suites those alone count, a new one as much as the mean; what did not run is still known.
        let mut some = Progress::new(suites(&["tests/a.rs", "tests/new.rs"]), record);
        let said = some.read(&running("tests/a.rs")).expect("a suite");
        assert!(
            said.ends_with("suite 1 of 2, tests/a.rs, after 0 s, about 4 min left"),
            "{said}"
        );
        assert!(some.record().contains("tests/b.rs\t500.0"));
    }

    #[test]
    fn spans_are_said_as_people_say_them() {
        assert_eq!(
            [0.4, 89.0, 90.0, 149.0, 2100.0].map(text),
            ["0 s", "89 s", "2 min", "2 min", "35 min"]
        );
    }
}
