//! `tyndall photometry`: what a photometric file says, and whether it goes together.

use crate::arguments::form::FormArgs;
use crate::tables::columns::{self, Columns};
use crate::tables::stdout;
use crate::tell;
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use tyndall::photometry::{self, Goniometer, Photometry};

/// What an IES or EULUMDAT file of a luminaire says: type, symmetry, flux, peak
#[derive(Debug, Args)]
pub struct PhotometryArgs {
    /// The file: IES LM-63 or EULUMDAT (LDT)
    file: PathBuf,
    /// Which set of lamps of an EULUMDAT file, from 1
    #[arg(long, value_name = "N", default_value_t = 1)]
    lamp_set: usize,
    #[command(flatten)]
    form: FormArgs,
}

/// Prints it.
pub fn run(args: &PhotometryArgs) -> tyndall::Result<()> {
    let (lamp, warnings) = photometry::read(&args.file, args.lamp_set)?;
    tell::warnings(&warnings);
    let facts = facts(&lamp);
    if args.form.json {
        let mut object = facts;
        object.insert("description".into(), json!(lamp.description));
        object.insert("warnings".into(), json!(warnings));
        return stdout::print_json(&object);
    }
    if args.form.csv {
        // What is not stated is an empty cell.
        let mut facts = facts;
        for value in facts.values_mut().filter(|value| value.is_null()) {
            *value = json!("");
        }
        return stdout::print(columns::csv(&[facts]));
    }
    stdout::print(table(&lamp))
}

fn letter(goniometer: Goniometer) -> &'static str {
    match goniometer {
        Goniometer::A => "A",
        Goniometer::B => "B",
        Goniometer::C => "C",
    }
}

/// One value a column; lengths in metres, angles in degrees.
fn facts(lamp: &Photometry) -> Columns {
    let table = &lamp.table;
    let ends = |angles: &[f64]| [angles[0], angles[angles.len() - 1]];
    let ([first, last], peak) = (ends(table.vertical()), table.peak());
    let [width, length, height] = lamp.opening.size;
    let pairs: [(&str, Value); 22] = [
        ("standard", json!(lamp.standard.to_string())),
        ("type", json!(letter(table.goniometer()))),
        ("symmetry", json!(lamp.symmetry.words(table.goniometer()))),
        ("horizontal_angles", json!(lamp.measured[0])),
        ("vertical_angles", json!(lamp.measured[1])),
        ("vertical_first", json!(first)),
        ("vertical_last", json!(last)),
        ("lamp_set", json!(lamp.lamp_sets[1])),
        ("lamp_sets", json!(lamp.lamp_sets[0])),
        ("lamp_lumens", json!(lamp.lamp_lumens)),
        ("luminaire_lumens", json!(lamp.luminaire_lumens)),
        ("integrated_lumens", json!(table.flux())),
        ("peak_candela", json!(peak.candela)),
        ("peak_horizontal", json!(peak.horizontal_deg)),
        ("peak_vertical", json!(peak.vertical_deg)),
        ("cone", json!(table.cone().to_degrees())),
        ("watts", json!(lamp.watts)),
        (
            "tilts",
            json!(lamp.tilt.as_ref().map_or(0, |t| t.angles.len())),
        ),
        ("opening", json!(lamp.opening.shape)),
        ("opening_width", json!(width)),
        ("opening_length", json!(length)),
        ("opening_height", json!(height)),
    ];
    columns::columns(pairs)
}

fn table(lamp: &Photometry) -> String {
    let table = &lamp.table;
    let goniometer = table.goniometer();
    let peak = table.peak();
    let lumens =
        |stated: Option<f64>| stated.map_or("not stated".into(), |lm| format!("{lm:.1} lm"));
    // To a tenth of a millimetre: feet make long numbers.
    let [width, length, height] = lamp.opening.size.map(|m| (1e4 * m).round() / 1e4);
    let [planes, lines] = lamp.measured;
    let v = table.vertical();
    let mut rows = vec![
        ("standard", lamp.standard.to_string()),
        (
            "photometry",
            format!(
                "type {}, symmetry {}",
                letter(goniometer),
                lamp.symmetry.words(goniometer)
            ),
        ),
        (
            "angles",
            format!(
                "{planes} horizontal, {lines} vertical ({} to {} degrees)",
                v[0],
                v[v.len() - 1]
            ),
        ),
        ("lamps", lumens(lamp.lamp_lumens)),
        ("luminaire", lumens(lamp.luminaire_lumens)),
        ("integrated", format!("{:.1} lm", table.flux())),
        (
            "peak",
            format!(
                "{:.1} cd at horizontal {}, vertical {} degrees",
                peak.candela, peak.horizontal_deg, peak.vertical_deg
            ),
        ),
        (
            "cone",
            format!("{:.1} degrees from the axis", table.cone().to_degrees()),
        ),
        (
            "power",
            lamp.watts
                .map_or("not stated".into(), |watts| format!("{watts} W")),
        ),
        (
            "opening",
            format!("{}, {width} x {length} x {height} m", lamp.opening.shape),
        ),
    ];
    if lamp.lamp_sets[0] > 1 {
        rows.push((
            "lamp set",
            format!("{} of {}", lamp.lamp_sets[1], lamp.lamp_sets[0]),
        ));
    }
    if let Some(tilt) = &lamp.tilt {
        let pairs = tilt.angles.iter().zip(&tilt.factors);
        let list: Vec<String> = pairs
            .map(|(angle, factor)| format!("{angle}: {factor}"))
            .collect();
        rows.push(("tilt", list.join(", ")));
    }
    let mut text = String::new();
    for (name, value) in rows {
        let _ = writeln!(text, "{name:<12}{value}");
    }
    for line in &lamp.description {
        let _ = writeln!(text, "  {}", tell::clean(line));
    }
    text
}
