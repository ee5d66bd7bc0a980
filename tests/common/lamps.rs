//! Photometric files for tests, and what reading them says.

use std::path::Path;
use tyndall::Warning;
use tyndall::photometry::{Photometry, from_bytes};

/// A file of type C, of four planes and five vertical angles, in which every number differs.
pub const IES: &str = "IESNA:LM-63-1995
[TEST] 17
[MANUFAC] nobody
TILT=NONE
2 1000 2 5 4 1 2 0.1 0.2 0.3
0.5 1 60
0 30 60 90 120
0 30 60 90
100 90 80 40 5
100 91 82 43 6
100 93 84 45 7
100 95 86 47 8
";

/// It, read.
pub fn ies(text: &str) -> (Photometry, Vec<Warning>) {
    from_bytes(Path::new("lamp.ies"), text.as_bytes(), 1).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// What is said of a file that is refused, and how to mend it.
pub fn refused(name: &str, text: &str) -> String {
    match from_bytes(Path::new(name), text.as_bytes(), 1) {
        Ok((photometry, _)) => panic!("it was read: {photometry:?}\n{text}"),
        Err(error) => {
            assert!(error.is_input() && !error.remedy().is_empty(), "{error}");
            error.to_string()
        }
    }
}

/// A text in which the first occurrence of something is something else.
pub fn with(text: &str, what: &str, instead: &str) -> String {
    assert!(text.contains(what), "{what}");
    text.replacen(what, instead, 1)
}

/// Whether a warning says so.
pub fn says(warnings: &[Warning], words: &str) -> bool {
    warnings.iter().any(|w| w.message().contains(words))
}

/// An EULUMDAT file: intensities per 1000 lm of planes at C angles, all of them listed.
pub fn ldt(symmetry: u32, all: &[f64], planes: &[Vec<f64>], gammas: &[f64]) -> String {
    let mut lines: Vec<String> = vec!["Nobody".into(), "3".into(), symmetry.to_string()];
    lines.extend([
        all.len().to_string(),
        "0".into(),
        gammas.len().to_string(),
        "0".into(),
    ]);
    lines.extend(["17", "A lamp", "4", "a.ldt", "today"].map(String::from));
    lines.extend(["100", "100", "50", "80", "0", "0", "0", "0", "0"].map(String::from));
    lines.extend(["100", "50", "1,0", "0"].map(String::from));
    lines.extend(["1", "2", "LED", "2000", "white", "80", "25,5"].map(String::from));
    lines.extend(std::iter::repeat_n("0.5".to_owned(), 10));
    lines.extend(all.iter().chain(gammas).map(f64::to_string));
    lines.extend(
        planes
            .iter()
            .flatten()
            .map(|v| v.to_string().replace('.', ",")),
    );
    lines.join("\r\n") + "\r\n"
}

/// A plain file of one plane.
pub fn plain() -> String {
    ldt(1, &[0.0], &[vec![100.0, 80.5, 3.25]], &[0.0, 60.0, 90.0])
}
