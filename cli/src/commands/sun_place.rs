//! A place with its clock and its air, and how the sun is found there.

use chrono::NaiveDate;
use serde_json::{Value, json};
use tyndall::Result;
use tyndall::ephemeris::civil::{self, Zone};
use tyndall::ephemeris::{DayEvents, Site, Tier, Weather};
use tyndall::units::DEG;

/// A place as the flags have it.
pub struct Place {
    pub site: Site,
    pub weather: Weather,
    pub clock: Zone,
    pub tier: Tier,
    /// The true elevation of the sun's centre that counts as rise and set.
    pub horizon_deg: f64,
    /// TT - UT1 [s], where a flag says it.
    pub delta_t: Option<f64>,
}

impl Place {
    /// What the sun does on a date.
    ///
    /// # Errors
    /// Those of [`DayEvents::new`].
    pub fn events(&self, date: NaiveDate) -> Result<DayEvents> {
        DayEvents::new(
            date,
            &self.clock,
            &self.site,
            self.tier,
            self.horizon_deg * DEG,
            self.delta_t,
        )
    }

    /// The place, as JSON.
    pub fn json(&self) -> Value {
        json!({
            "latitude": self.site.latitude_deg(),
            "longitude": self.site.longitude_deg(),
            "elevation": self.site.elevation(),
            "pressure": self.weather.pressure_hpa(),
            "temperature": self.weather.temperature_c(),
        })
    }

    /// The clock, as JSON.
    pub fn clock_json(&self) -> Value {
        json!({
            "zone": self.clock.name(),
            "source": self.clock.source(),
            "tz_database": self.clock.name().map(|_| civil::tz_database()),
        })
    }

    /// The place and its air, in words.
    pub fn text(&self) -> String {
        format!(
            "{}, {} m; air of {:.1} hPa and {:.1} °C",
            self.site.coordinates(),
            self.site.elevation(),
            self.weather.pressure_hpa(),
            self.weather.temperature_c()
        )
    }
}
