//! A grid as a user asks for it.

use crate::error::{Error, Result, nearest};
use serde::Serialize;

/// Which faces a grid lies on or over.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase", tag = "kind", content = "name")]
pub enum On {
    /// All floors that are found: horizontal faces with room for people above.
    Floors,
    /// The floors that are found among the faces of an object or a group of objects, by name.
    Room(String),
    /// All horizontal faces of an object or a material, by name.
    Floor(String),
    /// The faces of an object or a material, by name, whatever way they face.
    Surface(String),
    /// The openings that panes of an object or a material close, by name, each with its reference point; `all`: all panes.
    Openings(String),
}

/// A grid as a user asks for it: `plane=0.85,spacing=0.5,inset=0.5,room=NAME`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GridSpec {
    /// Which faces it lies on or over.
    pub on: On,
    /// Height above the floor, distance in front of the surface, or inward from the pane [m], 0 to 100.
    pub plane: f64,
    /// Greatest distance between neighbours [m], 0.01 to 1000.
    pub spacing: f64,
    /// Width of the band along walls and edges that has no sensors [m], 0 to 100.
    pub inset: f64,
    /// Only floors within 0.25 m of this height in the scene [m]: one storey.
    pub level: Option<f64>,
    /// Whether sensors of a surface look from its back.
    pub back: bool,
}

impl Default for GridSpec {
    /// All floors, 0.85 m above them, every 0.5 m: EN 17037's plane without its band along walls.
    fn default() -> Self {
        GridSpec {
            on: On::Floors,
            plane: 0.85,
            spacing: 0.5,
            inset: 0.0,
            level: None,
            back: false,
        }
    }
}

/// The keys of a grid.
const KEYS: [&str; 9] = [
    "plane", "spacing", "inset", "level", "room", "floor", "surface", "opening", "side",
];

impl GridSpec {
    /// Reads `key=value` pairs with commas between them; a name may hold commas when it stands last.
    ///
    /// # Errors
    /// [`Error::Input`] for a key that is not known, given twice, or without a value; [`Error::Domain`] for a number out of its range.
    pub fn parse(text: &str) -> Result<Self> {
        let place = || format!("--grid {text}");
        let wrong = |problem: String, remedy: &str| Error::input(place(), problem, remedy);
        let example = "write it like plane=0.85,spacing=0.5,inset=0.5,room=Kitchen";
        let mut spec = GridSpec::default();
        let (mut seen, mut plane, mut side) = (Vec::new(), None, None);
        let mut rest = text.trim();
        while !rest.is_empty() {
            let Some((key, after)) = rest.split_once('=') else {
                return Err(wrong(format!("`{rest}` is no key with a value"), example));
            };
            let key = key.trim();
            if !KEYS.contains(&key) {
                let keys = KEYS.join(", ");
                let remedy = match nearest(key, KEYS) {
                    Some(near) => format!("did you mean `{near}`? The keys are {keys}"),
                    None => format!("the keys are {keys}"),
                };
                return Err(wrong(format!("there is no key `{key}`"), &remedy));
            }
            if seen.contains(&key) {
                return Err(wrong(format!("`{key}` stands twice"), "give it once"));
            }
            seen.push(key);
            let (value, after) = value_of(after);
            rest = after;
            let number = |low: f64, high: f64| -> Result<f64> {
                let number: f64 = (value.parse())
                    .map_err(|_| wrong(format!("{key}: `{value}` is no number"), example))?;
                match (low..=high).contains(&number) {
                    true => Ok(number),
                    false => Err(Error::domain(
                        format!("--grid {key}"),
                        format!("{number} m"),
                        format!("{low} to {high} m"),
                        "lengths are metres",
                    )),
                }
            };
            let named = |on: fn(String) -> On| match (value, &spec.on) {
                ("", _) => Err(wrong(format!("`{key}` names nothing"), "give a name")),
                (_, On::Floors) => Ok(on(value.to_owned())),
                _ => Err(wrong(
                    "only one of room, floor, surface and opening can be given".into(),
                    "give --grid several times",
                )),
            };
            match key {
                "plane" => plane = Some(number(0.0, 100.0)?),
                "spacing" => spec.spacing = number(0.01, 1000.0)?,
                "inset" => spec.inset = number(0.0, 100.0)?,
                "level" => spec.level = Some(number(-1e9, 1e9)?),
                "room" => spec.on = named(On::Room)?,
                "floor" => spec.on = named(On::Floor)?,
                "surface" => spec.on = named(On::Surface)?,
                "opening" => spec.on = named(On::Openings)?,
                _ => {
                    side = Some(match value {
                        "front" => false,
                        "back" => true,
                        _ => {
                            let problem = format!("side: `{value}` is neither front nor back");
                            return Err(wrong(problem, "give one of the two"));
                        }
                    });
                }
            }
        }
        let is_surface = matches!(spec.on, On::Surface(_));
        let is_opening = matches!(spec.on, On::Openings(_));
        let not_of_openings = ["spacing", "inset", "level", "side"];
        if let Some(key) = not_of_openings
            .iter()
            .find(|key| is_opening && seen.contains(key))
        {
            return Err(wrong(
                format!("`{key}` is not of openings"),
                "leave it out: an opening has one point, which faces outward; plane= is how far inward from the pane it lies",
            ));
        }
        if side.is_some() && !is_surface {
            return Err(wrong(
                "`side` is of surfaces".into(),
                "leave it out: planes over floors look up",
            ));
        }
        if spec.level.is_some() && is_surface {
            return Err(wrong(
                "`level` is of floors".into(),
                "leave it out: a surface is named",
            ));
        }
        spec.back = side.unwrap_or(false);
        spec.plane = plane.unwrap_or(match is_surface || is_opening {
            true => 0.0,
            false => spec.plane,
        });
        Ok(spec)
    }
}

/// What stands up to the next comma that a key follows, and what is behind that comma.
fn value_of(text: &str) -> (&str, &str) {
    for (at, _) in text.match_indices(',') {
        let after = &text[at + 1..];
        let key = after.split('=').next().unwrap_or_default().trim();
        if after.contains('=') && !key.contains(',') {
            return (text[..at].trim(), after.trim_start());
        }
    }
    (text.trim(), "")
}
