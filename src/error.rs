//! One error for the whole library: what was wrong, where, the valid range and what to do.

use std::path::{Path, PathBuf};

/// The result of everything in this library that can fail.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What went wrong, where, and what to do about it.
///
/// Errors are values: the library never prints, exits, panics on input or bends a value into its range.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A quantity outside the range in which its equations hold.
    #[error("{quantity} is {value}, outside {valid}; {remedy}")]
    Domain {
        /// The quantity, by its name in the documentation and the scene file.
        quantity: String,
        /// The value that was given, with its unit.
        value: String,
        /// The valid range, with its unit.
        valid: String,
        /// What the user can do.
        remedy: String,
    },
    /// Something that the user wrote (a file, a flag, a row) cannot be used as it stands.
    #[error("{place}: {problem}; {remedy}")]
    Input {
        /// Where it stands: the file with line and key, or the flag.
        place: String,
        /// What is wrong there.
        problem: String,
        /// What the user can do.
        remedy: String,
    },
    /// A file could not be read or written.
    #[error("cannot {} {}: {source}", if *.writing { "write" } else { "read" }, path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Whether it was being written (the work failed) or read (the name may be wrong).
        writing: bool,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The work could not be done although nothing that the user wrote is wrong.
    #[error("{problem}; {remedy}")]
    Failed {
        /// What happened.
        problem: String,
        /// What the user can do.
        remedy: String,
    },
    /// A part of the work is left to be done, here or elsewhere (exit status 75, `EX_TEMPFAIL`).
    #[error("{problem}; {remedy}")]
    Unfinished {
        /// What is left.
        problem: String,
        /// How it is done.
        remedy: String,
    },
    /// The work was stopped by whoever had asked for it.
    #[error("the work was stopped before it was done; start it again")]
    Stopped,
}

impl Error {
    /// An [`Error::Domain`].
    pub fn domain(
        quantity: impl Into<String>,
        value: impl std::fmt::Display,
        valid: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Error::Domain {
            quantity: quantity.into(),
            value: with_short_numbers(value.to_string()),
            valid: valid.into(),
            remedy: remedy.into(),
        }
    }

    /// An [`Error::Input`].
    pub fn input(
        place: impl Into<String>,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Error::Input {
            place: place.into(),
            problem: with_short_numbers(problem.into()),
            remedy: remedy.into(),
        }
    }

    /// An [`Error::Failed`].
    pub fn failed(problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Error::Failed {
            problem: with_short_numbers(problem.into()),
            remedy: remedy.into(),
        }
    }

    /// An [`Error::File`] met while reading.
    pub fn reading(path: &Path, source: std::io::Error) -> Self {
        Error::File {
            path: path.to_owned(),
            writing: false,
            source,
        }
    }

    /// An [`Error::File`] met while writing.
    pub fn writing(path: &Path, source: std::io::Error) -> Self {
        Error::File {
            path: path.to_owned(),
            writing: true,
            source,
        }
    }

    /// Whether something that the user wrote must change (exit status 2), rather than the work having failed (1).
    pub fn is_input(&self) -> bool {
        !matches!(
            self,
            Error::Failed { .. }
                | Error::Unfinished { .. }
                | Error::Stopped
                | Error::File { writing: true, .. }
        )
    }

    /// What was wrong and where, without the remedy.
    pub fn problem(&self) -> String {
        match self {
            Error::Domain {
                quantity,
                value,
                valid,
                ..
            } => format!("{quantity} is {value}, outside {valid}"),
            Error::Input { place, problem, .. } => format!("{place}: {problem}"),
            Error::File { .. } => self.to_string(),
            Error::Stopped => "the work was stopped before it was done".into(),
            Error::Failed { problem, .. } | Error::Unfinished { problem, .. } => problem.clone(),
        }
    }

    /// What to do about it.
    pub fn remedy(&self) -> String {
        match self {
            Error::Domain { remedy, .. }
            | Error::Input { remedy, .. }
            | Error::Failed { remedy, .. }
            | Error::Unfinished { remedy, .. } => remedy.clone(),
            Error::Stopped => "start it again".into(),
            Error::File { writing: true, .. } => {
                "check that the folder exists, may be written and has room".into()
            }
            Error::File { writing: false, .. } => {
                "check the spelling of the name and that the file may be read".into()
            }
        }
    }
}

/// More digits than these are no help to anyone.
const DIGITS: usize = 24;

/// A text in which numbers of very many digits are written with an exponent: 1e300 has 301 as it is printed.
pub fn with_short_numbers(text: String) -> String {
    let is_part = |c: char| c.is_ascii_digit() || c == '.';
    let mut short = String::new();
    let mut rest = text.as_str();
    while let Some(start) = rest.find(is_part) {
        let (before, number) = rest.split_at(start);
        let end = number.find(|c| !is_part(c)).unwrap_or(number.len());
        let (number, after) = number.split_at(end);
        short.push_str(before);
        match number.parse::<f64>() {
            Ok(value) if number.len() > DIGITS && value.is_finite() => {
                short.push_str(&format!("{value:e}"));
            }
            _ if number.len() > DIGITS => short.push_str(&format!("{}...", &number[..DIGITS])),
            _ => short.push_str(number),
        }
        rest = after;
    }
    short + rest
}

/// The candidate that a misspelt word most likely stands for, if any is near.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    candidates
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(word, candidate), candidate))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(score, _)| *score > 0.7)
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_message_has_a_number_of_three_hundred_digits() {
        for (value, words) in [
            (1e300, "is 1e300 m, outside"),
            (-2.5e-200, "is -2.5e-200 m, outside"),
            (f64::MAX, "is 1.7976931348623157e308 m, outside"),
            (0.1, "is 0.1 m, outside"),
            (123_456_789.125, "is 123456789.125 m, outside"),
        ] {
            let error = Error::domain("it", format!("{value} m"), "what is sane", "mend it");
            assert!(error.problem().contains(words), "{error}");
        }
        let beside = Error::input(
            "x.csv:7",
            format!("`a{}b` is no number", "9".repeat(400)),
            "",
        );
        assert_eq!(
            beside.problem(),
            format!("x.csv:7: `a{}...b` is no number", "9".repeat(24))
        );
        let plain = "v1.2.3 at 12:30:05.25, 3 of 4...";
        assert_eq!(Error::failed(plain, "").problem(), plain);
    }
}
