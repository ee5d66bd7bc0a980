//! Places by name: the principal place of each time zone, mostly its largest city.
//!
//! Source: `zone.tab` and `iso3166.tab` of the IANA Time Zone Database, to the minute of arc (1.9 km).

use super::site::Site;
use crate::error::{Error, Result, nearest};

/// Name, country, zone, latitude and longitude [degrees].
const TABLE: &str = include_str!("../../data/places.csv");

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
    let plain = |name: &str| name.trim().replace(['_', '-'], " ").to_lowercase();
    let wanted = plain(name);
    let mut lines = TABLE.lines().skip(1);
    let found = lines.find_map(|line| {
        let [name, country, zone, latitude, longitude] = fields(line)?;
        let is_wanted = plain(name) == wanted || plain(zone) == wanted;
        let degrees = |text: &str| text.parse::<f64>().ok();
        is_wanted.then_some((name, country, zone, degrees(latitude)?, degrees(longitude)?))
    });
    let Some((name, country, zone, latitude, longitude)) = found else {
        let near = nearest(name, names()).map_or(String::new(), |near| {
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

fn fields(line: &'static str) -> Option<[&'static str; 5]> {
    let fields: Vec<&str> = line.split(',').collect();
    fields.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ephemeris::civil::Zone;
    use chrono::DateTime;

    #[test]
    fn every_place_is_found_by_its_name_and_lies_in_its_zone() {
        let mut count = 0;
        for name in names() {
            let place = named(&name.to_uppercase()).expect(name);
            assert_eq!(place.name, name.replace('_', " "));
            // Their clocks agree with those at the coordinates: zones have other names, and places on borders the neighbours' zone.
            let utc = DateTime::UNIX_EPOCH + chrono::TimeDelta::days(20_000);
            let own = Zone::named(place.zone).expect(name).offset_seconds(utc);
            let apart =
                Zone::at(&place.site, utc).map_or(0, |at| (at.offset_seconds(utc) - own).abs());
            count += usize::from(apart > 0);
        }
        assert!(names().count() > 400);
        assert!(count <= 4, "{count} places lie elsewhere");
        let paris = named("europe/paris").expect("a zone is a name too");
        assert_eq!((&*paris.name, paris.country), ("Paris", "France"));
        assert!((paris.site.longitude_deg() - 2.333).abs() < 1e-3);
        let new_york = named("new york").expect("with a space");
        assert!((new_york.site.longitude_deg() + 74.006).abs() < 0.01);
        let error = named("Chicgo").unwrap_err();
        assert!(error.remedy().contains("`Chicago`"), "{error}");
        assert!(named("48.8,2.3").is_err());
    }
}
