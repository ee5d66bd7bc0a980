//! Places by name: the principal place of each time zone, mostly its largest city.
//!
//! Source: `zone.tab` and `iso3166.tab` of the IANA Time Zone Database, to the minute of arc (1.9 km).

use super::site::Site;
use crate::error::{Error, Result, nearest};
use std::sync::LazyLock;

/// Name, country, zone, latitude and longitude [degrees].
const TABLE: &str = include_str!("../../data/places.csv");

/// Latitude, longitude [degrees] and zone of all places.
static ZONES: LazyLock<Vec<([f64; 2], &str)>> = LazyLock::new(|| {
    let place = |line: &'static str| {
        let [_, _, zone, latitude, longitude] = fields(line)?;
        let degrees = |text: &str| text.parse::<f64>().ok();
        Some(([degrees(latitude)?, degrees(longitude)?], zone))
    };
    TABLE.lines().skip(1).filter_map(place).collect()
});

/// Coordinates are those of a place if they differ by less [degrees].
const SAME: f64 = 1e-9;

/// A place that has a name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPlace {
    /// Its name, without accents.
    pub name: String,
    /// Its country.
    pub country: &'static str,
    /// Its IANA zone.
    pub zone: &'static str,
    /// Where it is; at sea level, as its elevation is not known.
    pub site: Site,
}

/// The names of all places, in alphabetic order, with underscores for spaces.
pub fn names() -> impl Iterator<Item = &'static str> {
    TABLE
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').next())
}

/// The place of a name, in any case, with spaces or underscores.
///
/// # Errors
/// [`Error::Input`] for a name that is not in the table, with the nearest one that is.
pub fn named(name: &str) -> Result<NamedPlace> {
    let wanted = plain(name);
    let mut lines = TABLE.lines().skip(1);
    let found = lines.find_map(|line| {
        let [name, country, zone, latitude, longitude] = fields(line)?;
        let is_wanted = plain(name) == wanted || plain(zone) == wanted;
        let degrees = |text: &str| text.parse::<f64>().ok();
        is_wanted.then_some((name, country, zone, degrees(latitude)?, degrees(longitude)?))
    });
    let Some((name, country, zone, latitude, longitude)) = found else {
        let plain_names: Vec<String> = names().map(plain).collect();
        let near = nearest(&wanted, plain_names.iter().map(String::as_str));
        let near = near.and_then(|near| names().find(|name| plain(name) == near));
        let near = near.map_or(String::new(), |near| {
            format!("did you mean `{near}`? else ")
        });
        return Err(Error::input(
            format!("the place `{name}`"),
            format!(
                "it is not among the {} principal places of time zones",
                names().count()
            ),
            format!("{near}give its coordinates, --at LAT,LON"),
        ));
    };
    Ok(NamedPlace {
        name: name.replace('_', " "),
        country,
        zone,
        site: Site::new(latitude, longitude, 0.0)?,
    })
}

/// The zone of a place that the table has at just these coordinates.
pub fn zone_of(site: &Site) -> Option<&'static str> {
    let is_there = |at: &[f64; 2]| {
        (at[0] - site.latitude_deg()).abs() < SAME && (at[1] - site.longitude_deg()).abs() < SAME
    };
    let place = ZONES.iter().find(|(at, _)| is_there(at));
    place.map(|(_, zone)| *zone)
}

/// A name as it is compared.
fn plain(name: &str) -> String {
    name.trim().replace(['_', '-'], " ").to_lowercase()
}

fn fields(line: &'static str) -> Option<[&'static str; 5]> {
    let fields: Vec<&str> = line.split(',').collect();
    fields.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ephemeris::civil::{Zone, resolve};
    use crate::warning::Warning;
    use chrono::DateTime;

    #[test]
    fn every_place_is_found_by_its_name_and_lies_in_its_zone() {
        for name in names() {
            let place = named(&name.to_uppercase()).expect(name);
            assert_eq!(place.name, name.replace('_', " "));
            // Zones have other names: clocks are compared. No place looks swapped, those in the Antarctic neither.
            let utc = DateTime::UNIX_EPOCH + chrono::TimeDelta::days(20_000);
            let own = Zone::named(place.zone).expect(name).offset_seconds(utc);
            let at = Zone::at(&place.site, utc).expect(name);
            assert_eq!(at.offset_seconds(utc), own, "{name}");
            let moment = resolve("2026-06-21T12:00", None, Some(&place.site), None).expect(name);
            let is_swapped = |warning: &Warning| matches!(warning, Warning::PerhapsSwapped { .. });
            assert!(!moment.warnings.iter().any(is_swapped), "{name}");
        }
        assert!(names().count() > 400);
        let paris = named("europe/paris").expect("a zone is a name too");
        assert_eq!((&*paris.name, paris.country), ("Paris", "France"));
        assert!((paris.site.longitude_deg() - 2.333).abs() < 1e-3);
        let new_york = named("new york").expect("with a space");
        assert!((new_york.site.longitude_deg() + 74.006).abs() < 0.01);
        for (written, meant) in [
            ("Chicgo", "Chicago"),
            ("chicgo", "Chicago"),
            ("NEW YROK", "New_York"),
        ] {
            let error = named(written).unwrap_err();
            assert!(error.remedy().contains(&format!("`{meant}`")), "{error}");
        }
        assert!(named("48.8,2.3").is_err());
    }
}
