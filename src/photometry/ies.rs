//! IES LM-63, editions of 1986 to 2019.

use super::grid::{Next, angles, intensities};
use super::luminaire::{Opening, Photometry, Standard, Tilt};
use super::planes::{Measured, Symmetry};
use super::table::Goniometer;
use super::words::{Words, decoded, shown};
use crate::error::{Error, Result};
use crate::file;
use crate::warning::Warning;
use std::path::Path;
use std::sync::Arc;

/// Numbers may stand in any line.
const NEXT: Next = |words, what| words.number(what);

/// A foot [m].
const FOOT: f64 = 0.3048;

/// The most that a file of tilts may hold [bytes].
const LARGEST_TILT: u64 = 1 << 20;

/// Horizontal angles are taken for round ones this near [degrees].
const ROUND: f64 = 1e-3;

/// Whether a line of a text begins as the one does that every IES file has.
pub(super) fn has_tilt_line(text: &str) -> bool {
    text.split(['\n', '\r']).any(|line| tilt_of(line).is_some())
}

/// What stands behind `TILT=`.
fn tilt_of(line: &str) -> Option<&str> {
    let line = line.trim();
    let rest = match line.get(..4) {
        Some(word) if word.eq_ignore_ascii_case("TILT") => &line[4..],
        _ => return None,
    };
    rest.trim_start().strip_prefix('=').map(str::trim)
}

/// Reads a file; `path` names it, and files of tilts are looked for beside it.
pub(super) fn read(path: &Path, name: &str, text: &str) -> Result<(Photometry, Vec<Warning>)> {
    let mut warnings = Vec::new();
    let mut words = Words::new(name, text);
    let (standard, description, tilt) = header(&mut words, name, &mut warnings)?;
    let tilt = match tilt {
        t if t.eq_ignore_ascii_case("NONE") => None,
        t if t.eq_ignore_ascii_case("INCLUDE") => Some(tilts(&mut words)?),
        t => Some(tilts_beside(path, &words, t)?),
    };

    let lamps = words.count("the number of lamps", 0, 100_000)?;
    let lumens = words.number(|| "the lumens of a lamp".into())?;
    if lumens < 0.0 && lumens != -1.0 {
        return Err(words.wrong(format!(
            "the lumens of a lamp are {lumens}; expected a number from 0, or -1 for absolute photometry"
        )));
    }
    let multiplier = factor(&mut words, "the multiplier of intensities")?;
    let rows = words.count("the number of vertical angles", 2, usize::MAX)?;
    let columns = words.count("the number of horizontal angles", 1, usize::MAX)?;
    let angles_too = rows.saturating_add(columns);
    if !words.has_room_for(rows.saturating_mul(columns).saturating_add(angles_too)) {
        return Err(words.wrong(format!(
            "{rows} vertical and {columns} horizontal angles are more than the file has numbers"
        )));
    }
    let goniometer = match words.count("the type of photometry", 1, 3)? {
        1 => Goniometer::C,
        2 => Goniometer::B,
        _ => Goniometer::A,
    };
    let unit = match words.count("the unit of lengths (feet or metres)", 1, 2)? {
        1 => FOOT,
        _ => 1.0,
    };
    let mut size = [0.0; 3];
    for (side, name) in size.iter_mut().zip(["width", "length", "height"]) {
        *side = unit * words.number(|| format!("the {name} of the luminous opening"))?;
    }
    let ballast = factor(&mut words, "the ballast factor")?;
    let second = second_factor(&mut words, standard, name, &mut warnings)?;
    let watts = words.number(|| "the input watts".into())?;

    let range = match goniometer {
        Goniometer::A => [-90.0, 90.0],
        Goniometer::B => [-180.0, 180.0],
        Goniometer::C => [0.0, 180.0],
    };
    let vertical = angles(&mut words, NEXT, "vertical angle", rows, range)?;
    let range = match goniometer {
        Goniometer::A => [-180.0, 180.0],
        Goniometer::B => [-90.0, 90.0],
        Goniometer::C => [-360.0, 720.0],
    };
    let mut horizontal = angles(&mut words, NEXT, "horizontal angle", columns, range)?;
    let symmetry = match goniometer {
        Goniometer::C => symmetry(&mut horizontal, &words, name, &mut warnings)?,
        _ if columns == 1 => {
            return Err(words.wrong("there is one horizontal angle; expected two or more, since the photometry is not of type C"));
        }
        _ if horizontal[0].abs() < ROUND => {
            horizontal[0] = 0.0;
            Symmetry::Across0
        }
        _ => Symmetry::None,
    };

    let scale = multiplier * ballast * second;
    let what = |i: usize, j: usize| {
        let (h, v) = (horizontal[i], vertical[j]);
        format!("the candela at vertical angle {v}, horizontal angle {h}")
    };
    let candela = intensities(
        &mut words,
        NEXT,
        scale,
        [columns, rows],
        what,
        &mut warnings,
    )?;
    let measured = Measured {
        goniometer,
        horizontal,
        vertical,
        candela,
    };
    let table = measured.complete(symmetry).map_err(|e| words.because(e))?;
    let photometry = Photometry {
        standard,
        description,
        table: Arc::new(table),
        symmetry,
        measured: [columns, rows],
        lamp_sets: [1, 1],
        lamp_lumens: (lumens > 0.0 && lamps > 0)
            .then_some(lumens * lamps as f64 * ballast * second),
        luminaire_lumens: None,
        watts: (watts > 0.0).then_some(watts),
        opening: opening(size),
        tilt,
    };
    Ok((photometry, warnings))
}

/// A factor on all intensities.
fn factor(words: &mut Words, what: &str) -> Result<f64> {
    let found = words.number(|| what.to_owned())?;
    match found > 0.0 {
        true => Ok(found),
        false => Err(words.wrong(format!("{what} is {found}; expected a number above 0"))),
    }
}

/// The number after the ballast factor: until 1991 a factor too (of ballast and lamp together), then kept free, since 2019 how the
/// file was made.
fn second_factor(
    words: &mut Words,
    standard: Standard,
    name: &str,
    warnings: &mut Vec<Warning>,
) -> Result<f64> {
    if standard <= (Standard::Lm63 { year: 1991 }) {
        return factor(words, "the ballast-lamp photometric factor");
    }
    let found = words.number(|| "the number for future use".into())?;
    if standard < (Standard::Lm63 { year: 2019 }) && found != 1.0 {
        warnings.push(Warning::Photometry {
            file: name.to_owned(),
            problem: format!(
                "the number after the ballast factor, in line {}, is {found}, where {standard} has 1; intensities are not multiplied by it",
                words.number_of_line()
            ),
            remedy: "if it is a factor, put it into the multiplier".into(),
        });
    }
    Ok(1.0)
}

/// What the horizontal angles of type C say of symmetry; ends that are round but for rounding are made so.
fn symmetry(
    horizontal: &mut [f64],
    words: &Words,
    name: &str,
    warnings: &mut Vec<Warning>,
) -> Result<Symmetry> {
    let count = horizontal.len();
    let [first, last] = [horizontal[0], horizontal[count - 1]];
    if count == 1 {
        return Ok(Symmetry::Axis);
    }
    let forms = [
        (0.0, 90.0, Symmetry::Quadrants),
        (0.0, 180.0, Symmetry::Across0),
        (90.0, 270.0, Symmetry::Across90),
        (-90.0, 90.0, Symmetry::Across90),
        (270.0, 450.0, Symmetry::Across90),
        (0.0, 360.0, Symmetry::None),
        (first, first + 360.0, Symmetry::None),
    ];
    let near = |a: f64, b: f64| (a - b).abs() < ROUND;
    if let Some((start, end, symmetry)) = forms
        .into_iter()
        .find(|(start, end, _)| near(first, *start) && near(last, *end))
    {
        horizontal[0] = start;
        horizontal[count - 1] = end;
        return Ok(symmetry);
    }
    // LM-63-1995 lets planes end anywhere above 180 degrees: those of a whole turn whose last is not the first again.
    let step = horizontal
        .windows(2)
        .fold(0.0, |step: f64, pair| step.max(pair[1] - pair[0]));
    let open = first + 360.0 - last;
    if open > 0.0 && open <= 1.5 * step && last - first > 180.0 {
        warnings.push(Warning::Photometry {
            file: name.to_owned(),
            problem: format!(
                "horizontal angles end at {last} degrees; the plane of {first} degrees closes the turn"
            ),
            remedy: format!("if that is not meant, add the plane of {} degrees", first + 360.0),
        });
        return Ok(Symmetry::None);
    }
    Err(words.wrong(format!(
        "horizontal angles run from {first} to {last} degrees; expected 0 alone, 0 to 90, 0 to 180, 90 to 270 or 0 to 360"
    )))
}

/// The luminous opening by its sides [m], of which negative ones are those of round shapes (the 2002 edition's table and what is left
/// of that of 1995).
fn opening(size: [f64; 3]) -> Opening {
    let sign = |x: f64| if x == 0.0 { 0 } else { x.signum() as i8 };
    let [w, l, h] = size;
    let shape = match size.map(sign) {
        [0, 0, 0] => "point",
        [1, _, 0] | [0, 1, 0] => "rectangle",
        [1, _, 1] | [0, 1, 1] | [1, 1, _] => "box",
        [-1, 0, 0] => "disc",
        [-1, -1, 0] if w == l => "disc",
        [-1, -1, 0] => "ellipse",
        [-1, -1, -1] if w == l && l == h => "sphere",
        [-1, 0, -1] => "sphere",
        [-1, -1 | 0, 1] => "cylinder",
        _ => "other",
    };
    Opening {
        shape,
        size: size.map(f64::abs),
    }
}

/// The edition, the description, and what stands behind `TILT=`.
fn header<'a>(
    words: &mut Words<'a>,
    name: &str,
    warnings: &mut Vec<Warning>,
) -> Result<(Standard, Vec<String>, &'a str)> {
    let mut year = None;
    let mut description = Vec::new();
    loop {
        let Some(line) = words.line() else {
            return Err(words.wrong("the file ends without a line that begins with TILT="));
        };
        if let Some(tilt) = tilt_of(line) {
            let year = year.unwrap_or(1986);
            return Ok((Standard::Lm63 { year }, description, tilt));
        }
        let line = line.trim();
        if line.is_empty() {
            continue;
        }
        let is_first = year.is_none() && description.is_empty();
        match (is_first && line.starts_with("IES")).then(|| edition(line)) {
            None => description.push(line.chars().filter(|c| !c.is_control()).collect()),
            Some(Some(found)) => year = Some(found),
            Some(None) => {
                year = Some(2002);
                warnings.push(Warning::Photometry {
                    file: name.to_owned(),
                    problem: format!(
                        "`{}` names no edition that is known; read as LM-63-2002",
                        shown(line)
                    ),
                    remedy: "check that intensities are as they should be".into(),
                });
            }
        }
    }
}

/// The edition that a first line names: `IESNA91`, `IESNA:LM-63-1995`, `IES:LM-63-2019`.
fn edition(line: &str) -> Option<u16> {
    let digits = line
        .trim_end()
        .rsplit(|c: char| !c.is_ascii_digit())
        .next()?;
    match digits {
        "1986" | "86" => Some(1986),
        "1991" | "91" => Some(1991),
        "1995" | "95" => Some(1995),
        "2002" | "02" => Some(2002),
        "2019" | "19" => Some(2019),
        _ => None,
    }
}

/// The four lines of tilts.
fn tilts(words: &mut Words) -> Result<Tilt> {
    let lamp = words.count("the lamp's position in the luminaire", 1, 3)?;
    let count = words.count("the number of tilts", 1, usize::MAX)?;
    if !words.has_room_for(count.saturating_mul(2)) {
        return Err(words.wrong(format!("{count} tilts are more than the file has numbers")));
    }
    let mut angles: Vec<f64> = Vec::new();
    for i in 1..=count {
        let angle = words.number(|| format!("tilt {i} of {count}"))?;
        if !(0.0..=180.0).contains(&angle) || angles.last().is_some_and(|last| angle <= *last) {
            return Err(words.wrong(format!(
                "tilt {i} of {count} is {angle}; expected ascending angles from 0 to 180"
            )));
        }
        angles.push(angle);
    }
    let mut factors = Vec::new();
    for i in 1..=count {
        let factor = words.number(|| format!("factor {i} of {count} for tilts"))?;
        if factor < 0.0 {
            return Err(words.wrong(format!(
                "factor {i} of {count} for tilts is {factor}; expected a number from 0"
            )));
        }
        factors.push(factor);
    }
    Ok(Tilt {
        lamp,
        angles,
        factors,
    })
}

/// The tilts of a file of their own, which lies beside the luminaire's whatever folders stand before its name.
fn tilts_beside(path: &Path, words: &Words, named: &str) -> Result<Tilt> {
    let name = named.rsplit(['/', '\\']).next().unwrap_or_default();
    if name.is_empty() || name == ".." || name == "." {
        return Err(words.wrong(format!(
            "`TILT={}` names no file; expected NONE, INCLUDE or the name of a file",
            shown(named)
        )));
    }
    let beside = path.with_file_name(name);
    let bytes = file::read(&beside, LARGEST_TILT).map_err(|error| {
        Error::input(
            words.place(),
            format!(
                "the tilts of `{}` cannot be read: {}",
                shown(named),
                error.problem()
            ),
            "put the file of tilts beside this one, or write TILT=NONE",
        )
    })?;
    let text = decoded(name, &bytes)?;
    tilts(&mut Words::new(name, &text))
}
