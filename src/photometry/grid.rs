//! What files of both kinds have: ascending angles, and an intensity for each pair of them.

use super::words::{Words, shown};
use crate::error::Result;
use crate::memory;
use crate::warning::{Lines, Warning};

/// No lamp is brighter [cd]: sums of such values are numbers.
const BRIGHTEST: f64 = 1e30;

/// How the next number is taken from a text; the second argument names it.
pub(super) type Next = fn(&mut Words, &dyn Fn() -> String) -> Result<f64>;

/// Ascending angles of a range [degrees]; `which` names them.
pub(super) fn angles(
    words: &mut Words,
    next: Next,
    which: &str,
    count: usize,
    [least, greatest]: [f64; 2],
) -> Result<Vec<f64>> {
    let mut list = memory::filled("the angles of a lamp", count, 0.0)?;
    let mut last = f64::NEG_INFINITY;
    for (i, place) in list.iter_mut().enumerate() {
        let name = || format!("{which} {} of {count}", i + 1);
        let angle = next(words, &name)?;
        let expected = if !(least..=greatest).contains(&angle) {
            format!("is {angle}; expected {least} to {greatest} degrees")
        } else if angle <= last {
            format!("is {angle} after {last}; expected ascending angles")
        } else {
            *place = angle;
            last = angle;
            continue;
        };
        return Err(words.wrong(format!("{} {expected}", name())));
    }
    Ok(list)
}

/// The intensities [cd] of all pairs of so many planes and vertical angles, `scale` times what is written, and what is doubtful about
/// them. `what` names the intensity of a pair.
pub(super) fn intensities(
    words: &mut Words,
    next: Next,
    scale: f64,
    [columns, rows]: [usize; 2],
    what: impl Fn(usize, usize) -> String,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<f64>> {
    let mut candela = memory::filled("the values of a lamp", columns * rows, 0.0)?;
    let mut negative: Option<Lines> = None;
    for (i, value) in candela.iter_mut().enumerate() {
        let name = || what(i / rows, i % rows);
        let found = scale * next(words, &name)?;
        let fits = found.abs() <= BRIGHTEST;
        if !fits {
            let problem = format!("{} is {found:e} cd; expected at most {BRIGHTEST:e}", name());
            return Err(words.wrong(problem));
        }
        if found < 0.0 {
            note(&mut negative, words.number_of_line(), found);
        }
        *value = found.max(0.0);
    }
    let file = words.file().to_owned();
    warnings.extend(negative.map(|lines| Warning::DoubtfulLines {
        file: file.clone(),
        lines,
        problem: "negative intensities, taken as 0".into(),
    }));
    if let Some(word) = words.word() {
        warnings.push(Warning::Photometry {
            file,
            problem: format!(
                "`{}` in line {} and what follows stand after the last value and are not read",
                shown(word),
                words.number_of_line()
            ),
            remedy: "check symmetry and numbers of angles".into(),
        });
    }
    Ok(candela)
}

/// Adds a line to those that have a negative value.
fn note(lines: &mut Option<Lines>, line: usize, value: f64) {
    const FIRST: usize = 5;
    let lines = lines.get_or_insert_with(|| Lines {
        count: 0,
        first: Vec::new(),
        example: format!("{value} cd"),
    });
    // Many values stand in one line.
    if lines.first.last().is_none_or(|last| *last < line) {
        lines.count += 1;
        if lines.first.len() < FIRST {
            lines.first.push(line);
        }
    }
}
