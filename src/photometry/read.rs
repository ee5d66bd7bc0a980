//! Reading photometric files of either kind, and what of them is doubtful.

use super::luminaire::Photometry;
use super::table::{Goniometer, Table};
use super::words::{decoded, shown};
use super::{eulumdat, ies};
use crate::error::{Error, Result};
use crate::file;
use crate::warning::Warning;
use std::path::Path;

/// The most that a photometric file may hold [bytes].
const LARGEST: u64 = 16 << 20;

/// Stated and integrated flux may differ by this share.
const FLUX: f64 = 0.03;

/// Light of at least this share of the greatest that ends at the last angle is doubtful.
const CUT: f64 = 0.05;

/// Values of the planes at their common pole may differ by this share of the greatest.
const POLE: f64 = 0.02;

/// Reads an IES or EULUMDAT file (told by its content) with one of its sets of lamps, from 1. A file of tilts that an IES file
/// names is looked for beside it.
///
/// # Errors
/// [`Error::File`] when it cannot be read; [`Error::Input`], with the line, for what is broken; [`Error::Domain`] for a `lamp_set` that
/// is not there; [`Error::Failed`] when memory does not suffice.
pub fn read(path: &Path, lamp_set: usize) -> Result<(Photometry, Vec<Warning>)> {
    from_bytes(path, &file::read(path, LARGEST)?, lamp_set)
}

/// Reads a file from its content; `path` names it in messages, and files of tilts are looked for beside it.
///
/// # Errors
/// As [`read`].
pub fn from_bytes(
    path: &Path,
    bytes: &[u8],
    lamp_set: usize,
) -> Result<(Photometry, Vec<Warning>)> {
    let name = path.display().to_string();
    let text = decoded(&name, bytes)?;
    let named = |endings: [&str; 2]| {
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        endings.iter().any(|e| ending.eq_ignore_ascii_case(e))
    };
    let is_ies = ies::has_tilt_line(&text) || text.starts_with("IES") || named(["ies", "iesna"]);
    let (photometry, mut warnings) = if is_ies {
        if lamp_set != 1 {
            return Err(Error::domain(
                "lamp_set",
                lamp_set,
                "1: an IES file has one set of lamps",
                "leave it out",
            ));
        }
        ies::read(path, &name, &text)?
    } else if eulumdat::looks_so(&text) || named(["ldt", "eul"]) {
        eulumdat::read(&name, &text, lamp_set)?
    } else {
        let first = text.lines().next().unwrap_or_default();
        return Err(Error::input(
            format!("{name}:1"),
            format!(
                "`{}`: no line begins with TILT=, as one of an IES file does, and lines 3 and 4 are not the symmetry and the number of planes of an EULUMDAT file",
                shown(first)
            ),
            "name a file of one of these kinds",
        ));
    };
    let doubts = doubts(&photometry).into_iter();
    warnings.extend(doubts.map(|(problem, remedy)| Warning::Photometry {
        file: name.clone(),
        problem,
        remedy: remedy.to_owned(),
    }));
    Ok((photometry, warnings))
}

/// What does not go together, and what to do.
fn doubts(photometry: &Photometry) -> Vec<(String, &'static str)> {
    let table = &photometry.table;
    let peak = table.peak().candela;
    if peak == 0.0 {
        return vec![(
            "it gives no light in any direction".into(),
            "name another file",
        )];
    }
    let mut doubts = Vec::new();
    let flux = table.flux();
    if let Some(stated) = photometry.luminaire_lumens {
        if (flux / stated - 1.0).abs() > FLUX {
            doubts.push((
                format!("intensities sum to {flux:.0} lm, {:.2} times the {stated:.0} lm that it states", flux / stated),
                "check lumens, light output ratio and angles",
            ));
        }
    } else if let Some(lamps) = photometry.lamp_lumens
        && !(0.1..=1.0 + FLUX).contains(&(flux / lamps))
    {
        doubts.push((
            format!(
                "intensities sum to {flux:.0} lm, {:.2} times the {lamps:.0} lm of its lamps",
                flux / lamps
            ),
            "check lumens, multiplier and ballast factor",
        ));
    }
    doubts.extend(cut(table, peak).map(|problem| {
        (
            problem,
            "if there is light, measure or write the other angles too",
        )
    }));
    if let Some(spread) = spread_at_poles(table)
        && spread > POLE * peak
    {
        doubts.push((
            format!("its planes differ by {spread:.0} cd where they meet"),
            "check that all planes were measured with one alignment",
        ));
    }
    doubts
}

/// Where light ends at the last angles of a table, if it does.
fn cut(table: &Table, peak: f64) -> Option<String> {
    let (h, v) = (table.horizontal(), table.vertical());
    let rows = v.len();
    let row = |j: usize| {
        table
            .candela()
            .iter()
            .skip(j)
            .step_by(rows)
            .fold(0.0, |a: f64, b| a.max(*b))
    };
    let plane = |i: usize| {
        table.candela()[i * rows..(i + 1) * rows]
            .iter()
            .fold(0.0, |a: f64, b| a.max(*b))
    };
    let mut ends = vec![
        ("vertical", v[0], row(0)),
        ("vertical", v[rows - 1], row(rows - 1)),
    ];
    // Half a sphere is as it should be.
    let whole: &[f64] = match table.goniometer() {
        Goniometer::C => &[0.0, 90.0, 180.0],
        Goniometer::A => &[-90.0, 90.0],
        Goniometer::B => &[-180.0, -90.0, 90.0, 180.0],
    };
    ends.retain(|(_, angle, _)| !whole.contains(angle));
    if table.goniometer() != Goniometer::C {
        let last = h.len() - 1;
        let sides = [
            ("horizontal", h[0], plane(0)),
            ("horizontal", h[last], plane(last)),
        ];
        ends.extend(
            sides
                .into_iter()
                .filter(|(_, angle, _)| ![90.0, 180.0].contains(&angle.abs())),
        );
    }
    let (which, angle, candela) = ends.into_iter().max_by(|a, b| a.2.total_cmp(&b.2))?;
    (candela > CUT * peak).then(|| {
        format!("there are {candela:.0} cd at {which} angle {angle} degrees, and nothing is taken to be beyond")
    })
}

/// How far apart the values at the poles of type C are, where they have none [cd].
fn spread_at_poles(table: &Table) -> Option<f64> {
    if table.goniometer() != Goniometer::C {
        return None;
    }
    let rows = table.vertical().len();
    let at = |pole: f64| table.vertical().iter().position(|v| *v == pole);
    let spread = |row: usize| {
        let values = table.candela().iter().skip(row).step_by(rows);
        let ends = values.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], v| {
            [low.min(*v), high.max(*v)]
        });
        ends[1] - ends[0]
    };
    [0.0, 180.0]
        .into_iter()
        .filter_map(at)
        .map(spread)
        .reduce(f64::max)
}
