//! Where the sun stands at a place and a time, and when it rises and sets there.
//!
//! `cargo run --release --example sun_position -- 48.8584 2.2945 2026-06-21T18:30`

use tyndall::ephemeris::civil::{resolve, zone_for};
use tyndall::ephemeris::{Absence, DayEvents, HORIZON, Instant, Site, Tier, Weather, sun_position};
use tyndall::{Error, Result};

/// The sun at a place [degrees north and east] and a time (with an offset, or by the clock of the place).
pub fn sun(latitude: f64, longitude: f64, time: &str) -> Result<String> {
    let site = Site::new(latitude, longitude, 0.0)?;
    let moment = resolve(time, None, Some(&site), None)?;
    let weather = Weather::standard(&site);
    let sun = sun_position(Tier::Spa, &moment.instant, &site, &weather);

    let date = moment.local().date_naive();
    let zone = zone_for(None, &site, date)?;
    let events = DayEvents::new(date, &zone, &site, Tier::Spa, HORIZON, None)?;
    // On a polar day there is no sunrise: the reason stands where the time would.
    let clock = |event: std::result::Result<Instant, Absence>| match event {
        Ok(instant) => zone.local(instant.to_utc()).format("%H:%M:%S").to_string(),
        Err(absence) => format!("none ({absence:?})"),
    };
    Ok(format!(
        "azimuth {:.3}, elevation {:.3} degrees ({:.3} with refraction)\nsunrise {}, sunset {}",
        sun.azimuth_deg(),
        sun.elevation_true_deg(),
        sun.elevation_apparent_deg(),
        clock(events.day.rise()),
        clock(events.day.set()),
    ))
}

#[allow(dead_code)] // the tests call what is above
fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |text: &String| {
        let wrong = |_| {
            Error::input(
                text.clone(),
                "it is no number",
                "give degrees, as in 48.8584",
            )
        };
        text.parse::<f64>().map_err(wrong)
    };
    let (latitude, longitude, time) = match &arguments[..] {
        [latitude, longitude, time] => (number(latitude)?, number(longitude)?, &**time),
        _ => (48.8584, 2.2945, "now"),
    };
    println!("{}", sun(latitude, longitude, time)?);
    Ok(())
}
