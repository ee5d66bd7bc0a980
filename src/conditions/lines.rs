//! Conditions in words, for people and for files.

use super::{Conditions, Lamp, Sun};
use crate::colour::luminance;
use crate::ephemeris::{self, Absence, DayEvents, HORIZON, civil};
use crate::frame::Value;
use crate::units::{DEG, brief};

impl Conditions {
    /// What was understood, as labels and sentences.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = vec![(
            "scene",
            format!(
                "{} ({} triangles)",
                self.scene.name,
                self.scene.mesh.triangles.len()
            ),
        )];
        if let Some(instant) = &self.instant {
            let (site, moment) = (&instant.site, &instant.moment);
            lines.push((
                "place",
                format!(
                    "{}, {} m above the sea",
                    site.coordinates(),
                    site.elevation()
                ),
            ));
            lines.push((
                "instant",
                format!(
                    "{} UTC, {} local ({})",
                    moment.utc.format("%Y-%m-%d %H:%M:%S"),
                    moment.local().format("%Y-%m-%d %H:%M:%S %:z"),
                    moment.offset_source
                ),
            ));
        }
        let has_sun = self.sun != Sun::ABSENT;
        let azimuth = self.sun_azimuth_deg();
        let elevation = self.sun_elevation_deg();
        let how = match &self.instant {
            Some(instant) => format!("apparent, tier {}", instant.tier),
            None => "as given".into(),
        };
        let sun = match has_sun {
            true => format!(
                "azimuth {azimuth:.3}, elevation {elevation:.3} degrees ({how}); {} lx facing it",
                brief(self.sun.illuminance_lux())
            ),
            false => "none".to_owned(),
        };
        lines.push(("sun", sun));
        if !self.lamps.is_empty() {
            let flux: f64 = self.lamps.iter().map(Lamp::flux).sum();
            lines.push((
                "lamps",
                format!("{}, {flux:.0} lm together", self.lamps.len()),
            ));
        }
        if let Some(day) = self.day_line() {
            lines.push(("day", day));
        }
        if let Some(sky) = &self.sky {
            lines.push((
                "sky",
                format!(
                    "{}; {} lx on open ground",
                    sky.describe(),
                    brief(luminance(sky.horizontal_illuminance()))
                ),
            ));
        }
        let clear = self.air.media.iter().filter(|m| m.is_clear_air());
        let extinction = luminance(clear.map(|medium| medium.extinction()).sum());
        if extinction > 0.0 {
            // Koschmieder 1924: contrast falls to 2 % over ln 50 / extinction.
            let range = 50f64.ln() / extinction / 1000.0;
            lines.push((
                "air",
                format!("clear air with a visual range of {range:.0} km at the site"),
            ));
        }
        lines
    }

    /// Azimuth of the sun [degrees], from north through east, 0 to 360.
    pub fn sun_azimuth_deg(&self) -> f64 {
        let toward = self.sun.toward;
        (toward.x.atan2(-toward.z) / DEG + self.scene.north_deg).rem_euclid(360.0)
    }

    /// Apparent elevation of the sun [degrees].
    pub fn sun_elevation_deg(&self) -> f64 {
        let toward = self.sun.toward;
        toward.y.atan2(toward.x.hypot(toward.z)) / DEG
    }

    /// What a picture file says about itself: names and values.
    pub fn facts(&self) -> Vec<(&'static str, Value)> {
        let mut facts: Vec<(&'static str, Value)> = vec![("scene", self.scene.name.clone().into())];
        if let Some(instant) = &self.instant {
            let utc = instant
                .moment
                .utc
                .format("%Y-%m-%dT%H:%M:%S%.fZ")
                .to_string();
            facts.push(("utc", utc.into()));
            let local = civil::local_text(instant.moment.local());
            facts.push(("local_time", local.into()));
            facts.push(("latitude_deg", instant.site.latitude_deg().into()));
            facts.push(("longitude_deg", instant.site.longitude_deg().into()));
            facts.push(("elevation_m", instant.site.elevation().into()));
            facts.push(("ephemeris_tier", instant.tier.to_string().into()));
            facts.push((
                "sun_elevation_true_deg",
                instant.position.elevation_true_deg().into(),
            ));
        }
        facts.push(("north_deg", self.scene.north_deg.into()));
        if self.sun != Sun::ABSENT {
            facts.push(("sun_azimuth_deg", self.sun_azimuth_deg().into()));
            facts.push(("sun_elevation_deg", self.sun_elevation_deg().into()));
            facts.push(("sun_illuminance_lx", self.sun.illuminance_lux().into()));
            facts.push((
                "sun_angular_diameter_deg",
                (2.0 * self.sun.angular_radius() / DEG).into(),
            ));
        }
        // None shine where all are too faint now, which is a number too: no fact comes and goes with the hour.
        if !self.all_lamps.is_empty() {
            facts.push(("lamps", (self.lamps.len() as f64).into()));
            let flux: f64 = self.lamps.iter().map(Lamp::flux).sum();
            facts.push(("lamps_flux_lm", flux.into()));
        }
        match &self.sky {
            None => facts.push(("sky", "none".into())),
            Some(sky) => {
                facts.push(("sky", sky.name().into()));
                facts.push(("sky_description", sky.describe().into()));
            }
        }
        if !self.air.media.is_empty() {
            facts.push(("media", self.media_phrase().into()));
        }
        if self.view.points().is_none() {
            let camera = &self.view.camera;
            let [width, height] = self.view.size.map(f64::from);
            facts.push(("camera", camera.to_toml().into()));
            facts.push(("worldToCamera", camera.world_to_camera().into()));
            if let Some(to_picture) = camera.world_to_ndc(width / height) {
                facts.push(("worldToNDC", to_picture.into()));
            }
        }
        facts
    }

    /// Sunrise and sunset of the site's date.
    fn day_line(&self) -> Option<String> {
        let instant = self.instant.as_ref()?;
        let clock = &instant.moment.clock;
        let date = clock.local(instant.moment.utc).date_naive();
        let tier = instant.tier;
        let events = DayEvents::new(date, clock, &instant.site, tier, HORIZON, None).ok()?;
        let local =
            |at: ephemeris::Instant| clock.local(at.to_utc()).format("%H:%M:%S").to_string();
        let event = |name: &str, found: Result<ephemeris::Instant, Absence>| match found {
            Ok(at) => format!("{name} {}", local(at)),
            Err(Absence::AboveAllDay) => format!("no {name} (the sun stays up)"),
            Err(Absence::BelowAllDay) => format!("no {name} (the sun stays down)"),
            Err(Absence::OtherDate) => format!("no {name} on this date"),
        };
        Some(format!(
            "{}, {} (local time)",
            event("sunrise", events.day.rise()),
            event("sunset", events.day.set())
        ))
    }
}
