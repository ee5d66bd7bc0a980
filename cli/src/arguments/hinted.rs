//! Values that shells complete: names that a flag takes, beside whatever else its parser takes.

use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, Command};
use std::ffi::OsStr;
use tyndall::effect::ALL;
use tyndall::ephemeris::civil;

/// A parser with names that complete. The flag's help says them in its own words: `hide_possible_values`.
#[derive(Clone)]
pub struct Hinted<P> {
    parser: P,
    names: Vec<&'static str>,
}

/// What `parser` takes, completed by `names`.
pub fn hinted<P>(parser: P, names: impl IntoIterator<Item = &'static str>) -> Hinted<P> {
    Hinted {
        parser,
        names: names.into_iter().collect(),
    }
}

impl<P: TypedValueParser> TypedValueParser for Hinted<P> {
    type Value = P::Value;

    fn parse_ref(
        &self,
        command: &Command,
        argument: Option<&Arg>,
        value: &OsStr,
    ) -> Result<P::Value, clap::Error> {
        self.parser.parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let values = self.names.iter().map(|name| PossibleValue::new(*name));
        Some(Box::new(values))
    }
}

/// Any text.
pub fn text(text: &str) -> Result<String, std::convert::Infallible> {
    Ok(text.to_owned())
}

/// The models of the sky.
pub const SKIES: [&str; 19] = [
    "perez", "preetham", "hosek", "cie:1", "cie:2", "cie:3", "cie:4", "cie:5", "cie:6", "cie:7",
    "cie:8", "cie:9", "cie:10", "cie:11", "cie:12", "cie:13", "cie:14", "cie:15", "cie:16",
];

/// Names of effects as flags take them.
pub fn effects() -> impl Iterator<Item = &'static str> {
    ALL.iter().map(|effect| effect.name).chain(["shafts"])
}

/// Time zones by their places: `Europe/Paris`, without the other names that some of them have.
pub fn zones() -> impl Iterator<Item = &'static str> {
    const AREAS: [&str; 10] = [
        "Africa",
        "America",
        "Antarctica",
        "Arctic",
        "Asia",
        "Atlantic",
        "Australia",
        "Europe",
        "Indian",
        "Pacific",
    ];
    let of_area = |name: &&str| {
        let area = name.split_once('/').map_or("", |(area, _)| area);
        AREAS.contains(&area)
    };
    civil::zone_names().filter(of_area).chain(["UTC"])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use tyndall::sky::{DEFAULT_TURBIDITY, Model, Sky, SunAt};

    /// Their flags take any text, and read it later.
    #[test]
    fn skies_and_zones_are_what_there_is() {
        let is_sky = |name: &str| {
            let model = Model::named(name, DEFAULT_TURBIDITY, None, 0.2);
            let at = SunAt::unrefracted(DVec3::new(0.0, 0.6, -0.8));
            model.and_then(|model| Sky::new(model, at)).is_ok()
        };
        for name in SKIES {
            assert!(is_sky(name), "{name}");
        }
        assert!(!is_sky("cie:17") && !is_sky("perez2"));
        assert!(zones().count() > 300);
        for name in zones().filter(|name| *name != "UTC") {
            assert!(civil::Zone::named(name).is_ok(), "{name}");
        }
    }
}
