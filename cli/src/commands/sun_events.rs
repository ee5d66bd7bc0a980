//! What the sun does on a date: rise, set, noon, twilights, golden and blue hours; of one date, or a row a day.

use chrono::{DateTime, NaiveDate, SecondsFormat};
use serde_json::{Map, Value, json};
use tyndall::Result;
use tyndall::ephemeris::{Absence, Almanac, Crossings, DayEvents, Instant, duration_text};

use super::sun_place::Place;
use crate::arguments::form::FormArgs;
use crate::tables::rows::Rows;
use crate::tables::stdout;
use crate::tables::time_text::time_text;

/// The events of a date in their order, as tables and JSON name them, with two lines that head their column; midnight stands in no
/// table that people read.
const EVENTS: [(&str, [&str; 2]); 14] = [
    ("astronomical_dawn", ["astr.", "dawn"]),
    ("nautical_dawn", ["naut.", "dawn"]),
    ("civil_dawn", ["civil", "dawn"]),
    ("blue_hour_end", ["blue", "end"]),
    ("sunrise", ["sun-", "rise"]),
    ("golden_hour_end", ["gold", "end"]),
    ("noon", ["", "noon"]),
    ("golden_hour_begin", ["gold", "begin"]),
    ("sunset", ["sun-", "set"]),
    ("blue_hour_begin", ["blue", "begin"]),
    ("civil_dusk", ["civil", "dusk"]),
    ("nautical_dusk", ["naut.", "dusk"]),
    ("astronomical_dusk", ["astr.", "dusk"]),
    ("midnight", ["", ""]),
];

/// A row for each date from `first` to `last`.
pub fn run(place: &Place, form: FormArgs, first: NaiveDate, last: NaiveDate) -> Result<()> {
    let dates = first.iter_days().take_while(|date| *date <= last);
    let mut out = stdout::lock();
    if form.csv {
        let mut head = Rows::with_capacity(0);
        head.text("date");
        for (name, _) in EVENTS {
            head.text(name);
            head.text(format!("{name}_utc"));
        }
        head.text("day_length_seconds");
        head.end();
        out.bytes(&head.into_bytes())?;
        for date in dates {
            out.bytes(&place.events_csv(&place.events(date)?))?;
        }
        return out.finish();
    }
    if form.json {
        let days = dates.map(|date| Ok(place.events_json(&place.events(date)?)));
        let value = json!({
            "clock": place.clock_json(),
            "place": place.json(),
            "tier": place.tier.to_string(),
            "days": days.collect::<Result<Vec<Value>>>()?,
        });
        out.line(&serde_json::to_string_pretty(&value).unwrap_or_default())?;
        return out.finish();
    }
    let words = place.text();
    let (clock, tier) = (place.clock.source(), place.tier);
    out.line(&format!("{words} ({clock}), tier {tier}"))?;
    for line in 0..2 {
        let mut head = format!("{:<10}", ["", "date"][line]);
        for (_, words) in &EVENTS[..13] {
            head += &format!("  {:<5}", words[line]);
        }
        out.line(&format!(
            "{head}  {:<9}  {}",
            ["length", "of day"][line],
            ["", "clock"][line]
        ))?;
    }
    let mut missing = false;
    for date in dates {
        let events = place.events(date)?;
        let mut row = date.to_string();
        let list = place.event_list(&events);
        missing |= list[..13].iter().any(|(_, times, _)| times.is_empty());
        for (_, times, _) in &list[..13] {
            // Rounded to the minute; of two, the first is shown.
            let time = times
                .first()
                .map(|t| place.clock.local(t.plus_seconds(30.0).to_utc()));
            let text = time.map_or("-".into(), |time| time.format("%H:%M").to_string());
            row += &format!("  {text:<5}");
        }
        let noon = events.noon.first().unwrap_or(&events.span.0).to_utc();
        let offset = place.clock.local(noon).format("UTC%:z").to_string();
        let length = duration_text(events.day_length);
        out.line(&format!("{row}  {length:<9}  {offset}"))?;
    }
    if missing {
        out.line("-: not on that date; --json says why")?;
    }
    out.finish()
}

impl Place {
    /// The events in the order of the day, each with its name, elevation and time or reason.
    fn event_list<'e>(
        &self,
        events: &'e DayEvents,
    ) -> Vec<(&'static str, Vec<Instant>, Option<Absence>)> {
        let rise = |c: &'e Crossings| (c.rising.clone(), c.rise().err());
        let set = |c: &'e Crossings| (c.setting.clone(), c.set().err());
        let transit = |t: &[Instant]| (t.to_vec(), t.is_empty().then_some(Absence::OtherDate));
        let all = [
            rise(&events.astronomical),
            rise(&events.nautical),
            rise(&events.civil),
            rise(&events.blue),
            rise(&events.day),
            rise(&events.golden),
            transit(&events.noon),
            set(&events.golden),
            set(&events.day),
            set(&events.blue),
            set(&events.civil),
            set(&events.nautical),
            set(&events.astronomical),
            transit(&events.midnight),
        ];
        let named = EVENTS.iter().zip(all);
        named
            .map(|((name, _), (times, absence))| (*name, times, absence))
            .collect()
    }

    pub fn events_json(&self, events: &DayEvents) -> Value {
        let mut map = Map::new();
        map.insert("date".into(), json!(events.date.to_string()));
        map.insert("horizon".into(), json!(self.horizon_deg));
        for (name, times, absence) in self.event_list(events) {
            let value = match absence {
                Some(reason) => json!({ "times": [], "reason": reason_text(reason) }),
                None => json!({
                    "times": times.iter().map(|t| self.millis(t)).collect::<Vec<_>>(),
                    "utc": times.iter().map(universal).collect::<Vec<_>>(),
                }),
            };
            map.insert(name.into(), value);
        }
        map.insert("day_length_seconds".into(), json!(events.day_length));
        Value::Object(map)
    }

    /// A row of CSV: each event by the site's clock and in UTC, an empty cell where there is none; two of a kind stand in one cell.
    fn events_csv(&self, events: &DayEvents) -> Vec<u8> {
        let mut row = Rows::with_capacity(1024);
        row.text(events.date.to_string());
        for (_, times, _) in self.event_list(events) {
            let joined = |text: &dyn Fn(&Instant) -> String| {
                times.iter().map(text).collect::<Vec<_>>().join(" ")
            };
            row.text(joined(&|t| self.millis(t)));
            row.text(joined(&universal));
        }
        row.number(events.day_length);
        row.end();
        row.into_bytes()
    }

    fn millis(&self, instant: &Instant) -> String {
        time_text(&self.clock.local(whole_millis(instant)))
    }

    pub fn print_events(&self, out: &mut stdout::Out, events: &DayEvents) -> Result<()> {
        let almanac = Almanac::new(self.tier, &events.span.0, &events.span.1);
        out.line(&format!("events of {}", events.date))?;
        for (name, times, absence) in self.event_list(events) {
            let label = name.replace('_', " ");
            if let Some(reason) = absence {
                out.line(&format!(
                    "  {label:<17} none: {}",
                    self.reason(name, reason)
                ))?;
                continue;
            }
            for time in &times {
                let sun = almanac.sun_position(time, &self.site, &self.weather);
                // Rounded to the second, not cut.
                let rounded = time.plus_seconds(0.5);
                out.line(&format!(
                    "  {label:<17} {}  azimuth {:>6.2}°, elevation {:>6.2}° true",
                    self.clock.local(rounded.to_utc()).format("%H:%M:%S"),
                    // 359.999 is written 0.00, not 360.00.
                    (sun.azimuth_deg() * 100.0).round() % 36_000.0 / 100.0,
                    sun.elevation_true_deg()
                ))?;
            }
        }
        let length = duration_text(events.day_length);
        out.line(&format!("  {:<17} {length}", "day length"))
    }

    fn reason(&self, name: &str, reason: Absence) -> &'static str {
        match (name, reason) {
            ("sunrise" | "sunset", Absence::AboveAllDay) => {
                "polar day, the sun stays above the horizon"
            }
            ("sunrise" | "sunset", Absence::BelowAllDay) => {
                "polar night, the sun stays below the horizon"
            }
            _ => reason_text(reason),
        }
    }
}

/// An instant to the next millisecond.
fn whole_millis(instant: &Instant) -> DateTime<chrono::Utc> {
    let millis = instant.plus_seconds(0.0005).to_utc();
    DateTime::from_timestamp_millis(millis.timestamp_millis()).unwrap_or(millis)
}

fn universal(instant: &Instant) -> String {
    whole_millis(instant).to_rfc3339_opts(SecondsFormat::Millis, true)
}

fn reason_text(reason: Absence) -> &'static str {
    match reason {
        Absence::AboveAllDay => "the sun stays above this elevation all day",
        Absence::BelowAllDay => "the sun stays below this elevation all day",
        Absence::OtherDate => "it falls on a neighbouring date",
    }
}
