//! EULUMDAT, also known as LDT (Stockmar 1990, 1998): one value a line.

use super::grid::{Next, angles, intensities};
use super::luminaire::{Opening, Photometry, Standard};
use super::planes::{Measured, Symmetry};
use super::table::Goniometer;
use super::words::{Words, number};
use crate::error::{Error, Result};
use crate::warning::Warning;
use std::sync::Arc;

/// Each number has its line.
const NEXT: Next = |words, what| words.line_number(what, None);

/// Planes are taken for those of round angles this near [degrees].
const ROUND: f64 = 0.05;

/// Lines that each set of lamps has.
const OF_A_SET: usize = 6;

/// Whether a text can be one: its third line is a symmetry and its fourth a number of planes.
pub(super) fn looks_so(text: &str) -> bool {
    let mut words = Words::new("", text);
    let (_, _) = (words.line(), words.line());
    words.line_count("", 0, 4).is_ok() && words.line_count("", 1, usize::MAX).is_ok()
}

/// Reads a file with one of its sets of lamps, from 1.
pub(super) fn read(name: &str, text: &str, lamp_set: usize) -> Result<(Photometry, Vec<Warning>)> {
    let mut warnings = Vec::new();
    let mut words = Words::new(name, text);
    let mut description = vec![words.text("the company")?];
    words.text("the type of luminaire")?;
    let symmetry = match words.line_count("the symmetry", 0, 4)? {
        0 => Symmetry::None,
        1 => Symmetry::Axis,
        2 => Symmetry::Across0,
        3 => Symmetry::Across90,
        _ => Symmetry::Quadrants,
    };
    let planes = words.line_count("the number of C planes", 1, usize::MAX)?;
    let parts = match symmetry {
        Symmetry::Quadrants | Symmetry::Across90 => 4,
        Symmetry::Across0 => 2,
        Symmetry::Axis | Symmetry::None => 1,
    };
    if !planes.is_multiple_of(parts) {
        return Err(words.wrong(format!(
            "there are {planes} C planes; expected a multiple of {parts} with this symmetry"
        )));
    }
    words.line_number(|| "the distance between C planes".into(), Some(0.0))?;
    let rows = words.line_count("the number of intensities in a plane", 2, usize::MAX)?;
    let columns = match symmetry {
        Symmetry::None => planes,
        Symmetry::Axis => 1,
        Symmetry::Quadrants => planes / 4 + 1,
        Symmetry::Across0 | Symmetry::Across90 => planes / 2 + 1,
    };
    let angles_too = rows.saturating_add(planes);
    if !words.has_room_for(rows.saturating_mul(columns).saturating_add(angles_too)) {
        return Err(words.wrong(format!(
            "{planes} planes of {rows} intensities are more than the file has lines"
        )));
    }
    words.line_number(|| "the distance between intensities".into(), Some(0.0))?;
    for what in [
        "the report",
        "the luminaire's name",
        "its number",
        "the file's name",
        "the date",
    ] {
        description.push(words.text(what)?);
    }
    let description = description
        .into_iter()
        .filter(|line| !line.is_empty())
        .map(|line| line.chars().filter(|c| !c.is_control()).collect())
        .collect();
    for what in ["length", "width", "height"] {
        words.line_number(|| format!("the {what} of the luminaire"), Some(0.0))?;
    }
    let mut opening = [0.0; 6];
    for (side, what) in opening.iter_mut().zip([
        "length",
        "width",
        "height at C0",
        "height at C90",
        "height at C180",
        "height at C270",
    ]) {
        let what = || format!("the {what} of the luminous area");
        *side = words.line_number(what, Some(0.0))? / 1000.0;
    }
    words.line_number(|| "the share of light that goes down".into(), Some(0.0))?;
    let efficiency = words.line_number(|| "the light output ratio".into(), Some(0.0))?;
    let conversion =
        words.line_number(|| "the conversion factor of intensities".into(), Some(1.0))?;
    let conversion = match conversion {
        c if c > 0.0 => c,
        0.0 => {
            warnings.push(Warning::Photometry {
                file: name.to_owned(),
                problem: format!(
                    "the conversion factor in line {} is 0; 1 is taken",
                    words.number_of_line()
                ),
                remedy: "check that intensities are as they should be".into(),
            });
            1.0
        }
        c => {
            return Err(words.wrong(format!(
                "the conversion factor of intensities is {c}; expected a number above 0"
            )));
        }
    };
    let tilt = words.line_number(|| "the tilt during the measurement".into(), Some(0.0))?;
    if tilt != 0.0 {
        warnings.push(Warning::Photometry {
            file: name.to_owned(),
            problem: format!(
                "the luminaire was measured at a tilt of {tilt} degrees, which is not undone"
            ),
            remedy: "turn the lamp's axis if its light points beside".into(),
        });
    }
    let lamps = lamps(&mut words, lamp_set)?;
    for i in 1..=10 {
        words.line_number(|| format!("direct ratio {i} of 10"), Some(0.0))?;
    }

    let horizontal = c_angles(&mut words, planes, symmetry)?;
    let vertical = angles(&mut words, NEXT, "gamma angle", rows, [0.0, 180.0])?;
    let scale = 1e-3 * lamps.lumens * conversion;
    let what = |i: usize, j: usize| {
        let (c, gamma) = (f64::rem_euclid(horizontal[i], 360.0), vertical[j]);
        format!("the intensity at gamma {gamma} in the plane C{c}")
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
        goniometer: Goniometer::C,
        horizontal,
        vertical,
        candela,
    };
    let table = measured.complete(symmetry).map_err(|e| words.because(e))?;
    let photometry = Photometry {
        standard: Standard::Eulumdat,
        description,
        table: Arc::new(table),
        symmetry,
        measured: [columns, rows],
        lamp_sets: [lamps.sets, lamp_set],
        lamp_lumens: (!lamps.absolute).then_some(lamps.lumens),
        luminaire_lumens: match efficiency > 0.0 {
            true => Some(1e-2 * efficiency * lamps.lumens),
            false => lamps.absolute.then_some(lamps.lumens),
        },
        watts: (lamps.watts > 0.0).then_some(lamps.watts),
        opening: luminous_area(opening),
        tilt: None,
    };
    Ok((photometry, warnings))
}

/// One of the sets of lamps.
struct Lamps {
    /// How many sets there are.
    sets: usize,
    /// Whether the luminaire was measured without its lamps: their number is negative.
    absolute: bool,
    lumens: f64,
    watts: f64,
}

/// Line 26 and what follows for each set: number, kind, lumens, colour, rendering, watts. Some write set after set, others
/// each of these lines for all sets.
fn lamps(words: &mut Words, chosen: usize) -> Result<Lamps> {
    let sets = words.line_count("the number of sets of lamps", 1, 1000)?;
    if !(1..=sets).contains(&chosen) {
        return Err(Error::domain(
            "lamp_set",
            chosen,
            format!("1 to {sets}, the sets of lamps of {}", words.place()),
            "choose one of them",
        ));
    }
    let start = words.clone();
    let mut lines = Vec::new();
    for i in 0..sets * OF_A_SET {
        lines.push(words.text(&format!("line {} of {} on lamps", i + 1, sets * OF_A_SET))?);
    }
    let value = |at: usize| number(&lines[at].replace(',', "."));
    // Which reading finds numbers of lamps and lumens where they should be; if both do, the one whose kinds are words.
    let likely = |at: &dyn Fn(usize, usize) -> usize| {
        let of = |set: usize| {
            let fits = value(at(set, 0)).is_some() && value(at(set, 2)).is_some_and(|lm| lm > 0.0);
            usize::from(fits) * (1 + usize::from(value(at(set, 1)).is_none()))
        };
        (0..sets).map(of).min()
    };
    let by_set = |set: usize, part: usize| set * OF_A_SET + part;
    let by_part = |set: usize, part: usize| part * sets + set;
    let at: &dyn Fn(usize, usize) -> usize = match likely(&by_part) > likely(&by_set) {
        true => &by_part,
        false => &by_set,
    };
    let take = |part: usize, what: &str, empty: Option<f64>| {
        let mut words = start.clone();
        for _ in 0..at(chosen - 1, part) {
            words.line();
        }
        let found = words.line_number(|| format!("{what} of lamp set {chosen}"), empty)?;
        Ok::<_, Error>((found, words))
    };
    let (count, _) = take(0, "the number of lamps", None)?;
    let (lumens, there) = take(2, "the luminous flux", None)?;
    if lumens <= 0.0 {
        return Err(there.wrong(format!(
            "the luminous flux of lamp set {chosen} is {lumens}; expected lumens above 0, since intensities are per 1000 of them"
        )));
    }
    let (watts, _) = take(5, "the power", Some(0.0))?;
    Ok(Lamps {
        sets,
        absolute: count < 0.0,
        lumens,
        watts,
    })
}

/// The C angles of the planes that are there [degrees], of all that are listed.
fn c_angles(words: &mut Words, planes: usize, symmetry: Symmetry) -> Result<Vec<f64>> {
    let all = angles(words, NEXT, "C angle", planes, [0.0, 360.0])?;
    let must = |at: usize, angle: f64| match (all[at] - angle).abs() <= ROUND {
        true => Ok(()),
        false => Err(words.wrong_before(
            planes - 1 - at,
            format!(
                "C angle {} of {planes} is {}; expected {angle} with this symmetry",
                at + 1,
                all[at]
            ),
        )),
    };
    if symmetry == Symmetry::Axis {
        return Ok(vec![0.0]);
    }
    let (start, count, ends) = match symmetry {
        Symmetry::Quadrants => (0, planes / 4 + 1, Some([0.0, 90.0])),
        Symmetry::Across0 => (0, planes / 2 + 1, Some([0.0, 180.0])),
        // From C270 over C0 to C90.
        Symmetry::Across90 => (3 * planes / 4, planes / 2 + 1, Some([-90.0, 90.0])),
        Symmetry::Axis | Symmetry::None => (0, planes, None),
    };
    let mut list: Vec<f64> = (start..start + count)
        .map(|i| all[i % planes] - if start > 0 && i < planes { 360.0 } else { 0.0 })
        .collect();
    if let Some([first, last]) = ends {
        must(start, f64::rem_euclid(first, 360.0))?;
        must((start + count - 1) % planes, last)?;
        list[0] = first;
        list[count - 1] = last;
    }
    Ok(list)
}

/// The luminous area by its length or diameter, its width (0 where it is round) and its heights [m].
fn luminous_area([length, width, heights @ ..]: [f64; 6]) -> Opening {
    let height = heights.into_iter().fold(0.0, f64::max);
    let shape = match (length > 0.0, width > 0.0, height > 0.0) {
        (false, false, false) => "point",
        (true, true, false) => "rectangle",
        (true, true, true) => "box",
        (true, false, false) => "disc",
        (true, false, true) => "cylinder",
        _ => "other",
    };
    let width = if shape == "disc" || shape == "cylinder" {
        length
    } else {
        width
    };
    Opening {
        shape,
        size: [width, length, height],
    }
}
