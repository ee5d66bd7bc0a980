//! The variants of a year: several glazings, weather files and orientations of one model. Those of one glazing share who sees whom.

use crate::tell;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use tyndall::daylight::epw::WeatherFile;
use tyndall::daylight::glazing::Glazing;
use tyndall::daylight::page;
use tyndall::daylight::report::Report;
use tyndall::{Error, Result};

/// Figures that the table of variants has.
const SHOWN: [(&str, &str); 6] = [
    ("mean", "mean lx"),
    ("sda", "sDA %"),
    ("ase", "ASE %"),
    ("udi_300_3000", "UDI %"),
    ("en17037_year_minimum_target", "EN 300 lx %"),
    ("factor_mean", "factor %"),
];

/// A glazing with a weather file and an orientation.
pub struct Variant<'a> {
    /// Which of the glazings, from 0.
    pub glazing: usize,
    /// The weather.
    pub file: &'a WeatherFile,
    /// By how much the model is turned [degrees], from north through east.
    pub turn_deg: f64,
    /// What tells it from the others, for names of files; empty where there is one alone.
    pub tag: String,
}

impl Variant<'_> {
    /// A file of its own beside one that is asked for: the tag goes before the ending.
    pub fn named(&self, path: &Path) -> PathBuf {
        match (self.tag.as_str(), path.extension()) {
            ("", _) => path.to_owned(),
            (tag, Some(ending)) => {
                path.with_extension(format!("{tag}.{}", ending.to_string_lossy()))
            }
            (tag, None) => path.with_extension(tag),
        }
    }
}

/// All glazings with all weather files with all turns, in this order.
///
/// # Errors
/// [`Error::Input`] for two files of one name, for a turn or a glazing that is given twice and for a turn that is no number.
pub fn variants<'a>(
    files: &'a [(PathBuf, WeatherFile)],
    turns: &[f64],
    glazings: &[Glazing],
) -> Result<Vec<Variant<'a>>> {
    let names: Vec<String> = files.iter().map(|(path, _)| stem(path)).collect();
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            return Err(Error::input(
                "--weather",
                format!("two weather files are called {name}"),
                "give them other names: files of results are named after them",
            ));
        }
    }
    for (i, turn) in turns.iter().enumerate() {
        if !turn.is_finite() || turns[..i].contains(turn) {
            return Err(Error::input(
                "--turn",
                format!("{turn} degrees is given twice, or no number"),
                "give each turn once, as in --turn 0,90,180,270",
            ));
        }
    }
    let glasses: Vec<String> = glazings.iter().map(Glazing::tag).collect();
    for (i, tag) in glasses.iter().enumerate() {
        if glasses[..i].contains(tag) {
            return Err(Error::input(
                "--glazing",
                format!("{tag} is given twice"),
                "give each glazing once",
            ));
        }
    }
    let turns = if turns.is_empty() { &[0.0][..] } else { turns };
    let mut all = Vec::new();
    for glazing in 0..glasses.len().max(1) {
        for ((_, file), name) in files.iter().zip(&names) {
            for turn in turns {
                let mut parts = Vec::new();
                if glasses.len() > 1 {
                    parts.push(glasses[glazing].clone());
                }
                if files.len() > 1 {
                    parts.push(name.clone());
                }
                if turns.len() > 1 {
                    parts.push(format!("turn{turn}"));
                }
                all.push(Variant {
                    glazing,
                    file,
                    turn_deg: *turn,
                    tag: parts.join("."),
                });
            }
        }
    }
    Ok(all)
}

/// The shard, from 0, of a variant by its place among all: neighbours are together, so that each glazing lies in as few shards as can be.
pub fn shard_of(place: usize, variants: usize, shards: u64) -> u64 {
    let share = place as u128 * u128::from(shards) / variants.max(1) as u128;
    share as u64
}

/// The name of a file without folder and ending.
fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// A variant that is done.
pub struct Done {
    /// Its tag.
    pub tag: String,
    /// The name of its weather.
    pub weather: String,
    /// The azimuth that the scene's -Z axis faces [degrees].
    pub north_deg: f64,
    /// What it took once who sees whom was known without blinds [s].
    pub seconds: f64,
    /// What is told of it.
    pub report: Report,
}

/// The table of variants for people.
pub fn table(all: &[Done]) -> String {
    let wide = |of: &dyn Fn(&Done) -> usize| all.iter().map(of).max().unwrap_or(0);
    let names = wide(&|d| tell::clean(&d.tag).chars().count()).max(7);
    let rooms = |d: &Done| {
        let rooms = d.report.rooms.iter();
        rooms.map(|r| r.name.chars().count()).max().unwrap_or(0)
    };
    let rooms = wide(&rooms).max(4);
    let mut text = format!("{:<names$} {:<rooms$} {:>6}", "variant", "room", "s");
    for (_, name) in SHOWN {
        let _ = write!(text, " {name:>11}");
    }
    text.push('\n');
    for done in all {
        for room in &done.report.rooms {
            let (tag, name) = (tell::clean(&done.tag), tell::clean(&room.name));
            let _ = write!(text, "{tag:<names$} {name:<rooms$} {:>6.1}", done.seconds);
            for (key, _) in SHOWN {
                let value = room.figures.iter().find(|figure| figure.key == key);
                let value = value.and_then(|figure| figure.value);
                let _ = write!(text, " {:>11}", value.map_or("-".into(), page::shown));
            }
            text.push('\n');
        }
    }
    text += "mean lx: over the plane and the occupied hours, 8 to 18 o'clock; s: seconds of work for the hours, and for sets of closed blinds that no variant before had\n";
    text
}

/// The figures of all variants as CSV: those of one, behind the variant's name.
pub fn csv(all: &[Done]) -> String {
    let mut text = String::new();
    for done in all {
        let north = done.north_deg.to_string();
        let own = [("variant", done.tag.as_str()), ("north_degrees", &north)];
        let rows = done.report.figures_csv(&own);
        // One header, which no name of a room is part of.
        let header = rows.find('\n').map_or(0, |end| end + 1);
        text += if text.is_empty() {
            &rows[..]
        } else {
            &rows[header..]
        };
    }
    text
}

/// All variants for programs.
pub fn json(all: &[Done]) -> Value {
    let variant = |done: &Done| json!({"variant": done.tag, "weather": done.weather, "north_degrees": done.north_deg, "seconds": done.seconds, "report": done.report});
    json!({"schema": 1, "variants": all.iter().map(variant).collect::<Vec<_>>()})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_glazings_as_little_as_can_be() {
        // Four glazings, each with six variants: of so many shards each has so many glazings at most.
        let (glazings, each) = (4, 6);
        let all = glazings * each;
        for (shards, most) in [(1, 4), (2, 2), (4, 1), (8, 1), (24, 1), (3, 2), (100, 1)] {
            let mut count = 0;
            for shard in 0..shards {
                let own = (0..all).filter(|place| shard_of(*place, all, shards) == shard);
                let own: Vec<usize> = own.collect();
                count += own.len();
                let mut of: Vec<usize> = own.iter().map(|place| place / each).collect();
                of.dedup();
                assert!(of.len() <= most, "{shard} of {shards}: {own:?}");
                assert!(own.len() as u64 <= (all as u64).div_ceil(shards));
            }
            assert_eq!(count, all, "each is in one of {shards}");
        }
    }
}
