//! Times as people write them, and the events of a day by the site's clock.

use chrono::{DateTime, NaiveDate, Utc};
use tyndall::Error;
use tyndall::ephemeris::civil::{Fold, Zone, date_alone, resolve};
use tyndall::ephemeris::*;
use tyndall::units::{ARCSEC, DEG};

fn site(latitude: f64, longitude: f64) -> Site {
    Site::new(latitude, longitude, 0.0).unwrap()
}

fn utc(text: &str) -> DateTime<Utc> {
    DateTime::parse_from_rfc3339(text).unwrap().to_utc()
}

#[test]
fn a_time_is_read_in_each_of_its_forms() {
    let paris = site(48.8584, 2.2945);
    for (text, zone, expected, source) in [
        (
            "2026-06-21T18:30:00+02:00",
            None,
            "2026-06-21T16:30:00Z",
            "written in the time",
        ),
        (
            "2026-06-21 18:30:00.25Z",
            None,
            "2026-06-21T18:30:00.25Z",
            "written in the time",
        ),
        (
            "2026-06-21T18:30",
            None,
            "2026-06-21T16:30:00Z",
            "zone Europe/Paris, looked up from the coordinates",
        ),
        (
            "2026-06-21T18:30[Asia/Tokyo]",
            None,
            "2026-06-21T09:30:00Z",
            "zone Asia/Tokyo",
        ),
        (
            "2026-06-21T18:30",
            Some("america/new_york"),
            "2026-06-21T22:30:00Z",
            "zone America/New_York",
        ),
        (
            "2026-06-21T18:30:00+02:00[Europe/Paris][u-ca=gregory]",
            None,
            "2026-06-21T16:30:00Z",
            "zone Europe/Paris",
        ),
        (
            "2026-06-21T16:30:00Z[Europe/Paris]",
            None,
            "2026-06-21T16:30:00Z",
            "zone Europe/Paris",
        ),
        (
            "2026-06-21T18:30",
            Some("+05:30"),
            "2026-06-21T13:00:00Z",
            "offset +05:30",
        ),
        ("JD2451545.0", Some("UTC"), "2000-01-01T12:00:00Z", "UTC"),
        ("jd 2451545.25", Some("UTC"), "2000-01-01T18:00:00Z", "UTC"),
        (
            "1850-06-21T12:00",
            None,
            "1850-06-21T11:50:39Z",
            "zone Europe/Paris, looked up from the coordinates",
        ),
    ] {
        let moment = resolve(text, zone, Some(&paris), None)
            .unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!(moment.utc, utc(expected), "{text}");
        assert_eq!(moment.offset_source, source, "{text}");
    }
    let leap = resolve("2017-01-01T00:59:60+01:00", None, None, None).unwrap();
    assert_eq!(leap.utc.to_string(), "2016-12-31 23:59:60 UTC");
    // Far years, proleptic Gregorian: Meeus's -1000 July 12.5 of the Julian calendar is July 3 of the Gregorian.
    assert_eq!(
        resolve("-1000-07-03T12:00Z", None, None, None)
            .unwrap()
            .instant
            .ut()
            .jd(),
        1_356_001.0
    );
    assert_eq!(
        resolve("+6000-12-31T12:00Z", None, None, None)
            .unwrap()
            .utc
            .to_string(),
        "6000-12-31 12:00:00 UTC"
    );
}

#[test]
fn a_warning_for_a_clock_that_is_far_from_the_sun() {
    let sydney = site(-33.86, 151.2);
    let odd = resolve("2026-06-21T12:00:00-05:00", None, Some(&sydney), None).unwrap();
    assert_eq!(odd.warnings.len(), 1);
    assert!(
        resolve("2026-06-21T12:00", None, Some(&sydney), None)
            .unwrap()
            .warnings
            .is_empty()
    );
    assert!(
        resolve(
            "2026-06-21T12:00:00+13:00",
            None,
            Some(&site(-17.0, -179.5)),
            None
        )
        .unwrap()
        .warnings
        .is_empty()
    );
}

#[test]
fn gaps_and_folds() {
    for (zone, local, earlier, later) in [
        (
            "Europe/Paris",
            "2026-03-29T02:30:00",
            "2026-03-29T00:30:00Z",
            "2026-03-29T01:30:00Z",
        ),
        (
            "Europe/Paris",
            "2026-10-25T02:30:00",
            "2026-10-25T00:30:00Z",
            "2026-10-25T01:30:00Z",
        ),
        (
            "Australia/Lord_Howe",
            "2026-10-04T02:15:00",
            "2026-10-03T15:15:00Z",
            "2026-10-03T15:45:00Z",
        ),
        (
            "Pacific/Apia",
            "2011-12-30T12:00:00",
            "2011-12-29T22:00:00Z",
            "2011-12-30T22:00:00Z",
        ),
    ] {
        assert!(
            matches!(
                resolve(local, Some(zone), None, None),
                Err(Error::Input { .. })
            ),
            "{zone}"
        );
        assert_eq!(
            resolve(local, Some(zone), None, Some(Fold::Earlier))
                .unwrap()
                .utc,
            utc(earlier),
            "{zone}"
        );
        assert_eq!(
            resolve(local, Some(zone), None, Some(Fold::Later))
                .unwrap()
                .utc,
            utc(later),
            "{zone}"
        );
    }
}

#[test]
fn what_is_no_time_is_an_error_that_the_user_can_mend() {
    for text in [
        "",
        "tomorrow",
        "2026-06-21",
        "2026-13-01T00:00Z",
        "2026-02-29T12:00Z",
        "2026-06-21T24:00Z",
        "2026-06-21T12:60Z",
        "JD",
        "JDx",
        "JD1.2.3",
        "2026-06-21T12:00",
        "2026-06-21T12:00+2",
        "2026-06-21T12:00+99:00",
        "2026-06-21T12:00Z[Europe/Paris",
        "2026-06-21T12:00Z[Mars/Olympus]",
        "2026-06-21T12:00Z[u-ca=hebrew]",
        "2026-06-21T12:59:60Z",
        "9999-01-01T00:00Z",
        "-3000-01-01T00:00Z",
        "2026-06-21T12:00+05:00[Europe/Paris]",
        "26-06-21T12:00Z",
        "２０２６-06-21T12:00Z",
    ] {
        let error = resolve(text, None, None, None).expect_err(text);
        assert!(error.is_input() && !error.remedy().is_empty(), "{text}");
    }
    assert!(date_alone("2026-02-30").is_err());
    assert_eq!(
        date_alone("2026-02-28").unwrap(),
        NaiveDate::from_ymd_opt(2026, 2, 28)
    );
}

fn events(date: &str, zone: &str, site: &Site, tier: Tier) -> DayEvents {
    DayEvents::new(
        date.parse().unwrap(),
        &Zone::named(zone).unwrap(),
        site,
        tier,
        HORIZON,
        None,
    )
    .unwrap()
}

#[test]
fn at_each_event_the_sun_is_where_it_says() {
    let mut found = 0;
    for (latitude, longitude, zone) in [
        (48.86, 2.29, "Europe/Paris"),
        (-33.86, 151.2, "Australia/Sydney"),
        (0.0, -78.5, "America/Guayaquil"),
        (64.1, -21.9, "Atlantic/Reykjavik"),
        (69.65, 18.96, "Europe/Oslo"),
        (-17.7, 178.0, "Pacific/Fiji"),
        (71.3, -156.8, "America/Anchorage"),
        (40.7, -74.0, "America/New_York"),
    ] {
        let site = site(latitude, longitude);
        let weather = Weather::standard(&site);
        for month in 1..=12 {
            for tier in [Tier::Spa, Tier::Arcsecond] {
                let events = events(&format!("2026-{month:02}-21"), zone, &site, tier);
                for (crossings, level) in [
                    (&events.day, -0.8333),
                    (&events.civil, -6.0),
                    (&events.nautical, -12.0),
                    (&events.astronomical, -18.0),
                    (&events.golden, 6.0),
                    (&events.blue, -4.0),
                ] {
                    for instant in crossings.rising.iter().chain(&crossings.setting) {
                        let sun = sun_position(tier, instant, &site, &weather);
                        assert!(
                            (sun.elevation_true - level * DEG).abs() < 0.1 * ARCSEC,
                            "{latitude} {month} {level}"
                        );
                        found += 1;
                    }
                    for instant in &crossings.rising {
                        assert!(
                            sun_position(tier, &instant.plus_seconds(10.0), &site, &weather)
                                .elevation_true
                                > level * DEG
                        );
                    }
                }
                for instant in &events.noon {
                    let sun = sun_position(tier, instant, &site, &weather);
                    assert!(sun.hour_angle.abs() < 0.1 * ARCSEC);
                }
                assert_eq!(events.noon.len(), 1);
            }
        }
    }
    assert!(found > 1500, "{found}");
}

#[test]
fn the_report_s_sunrises_and_sunsets() {
    // Reda & Andreas 2004, table A6.1: geocentric and with the seconds cut; ours are topocentric (8.8" later and earlier).
    for (date, latitude, rise, set) in [
        ("1994-01-02", 35.0, "07:08:12", "16:59:55"),
        ("1996-07-05", -35.0, "07:08:15", "17:01:04"),
        ("2004-12-04", -35.0, "04:38:57", "19:02:02"),
    ] {
        let site = site(latitude, 0.0);
        let events = DayEvents::new(
            date.parse().unwrap(),
            &Zone::utc(),
            &site,
            Tier::Spa,
            HORIZON,
            None,
        )
        .unwrap();
        for (instant, text) in [
            (events.day.rise().unwrap(), rise),
            (events.day.set().unwrap(), set),
        ] {
            let published = utc(&format!("{date}T{text}Z"));
            let seconds = (instant.to_utc() - published).num_milliseconds() as f64 / 1000.0;
            assert!((-1.0..2.0).contains(&seconds), "{date} {text}: {seconds}");
        }
    }
}

#[test]
fn polar_days_and_their_edges_are_told() {
    let tromso = site(69.65, 18.96);
    let summer = events("2026-06-21", "Europe/Oslo", &tromso, Tier::Spa);
    assert_eq!(summer.day.rise(), Err(Absence::AboveAllDay));
    assert!((summer.day_length - 86_400.0).abs() < 1e-3);
    let winter = events("2026-12-21", "Europe/Oslo", &tromso, Tier::Spa);
    assert_eq!(winter.day.set(), Err(Absence::BelowAllDay));
    assert_eq!(winter.day_length, 0.0);
    // From day to day through the year: what rises must set. Every passage is seen once, by one date.
    let mut balance = 0_i32;
    let mut edges = 0;
    let mut date: NaiveDate = "2026-01-01".parse().unwrap();
    while date < "2027-01-01".parse().unwrap() {
        let day = events(&date.to_string(), "Europe/Oslo", &tromso, Tier::Spa).day;
        for _ in &day.rising {
            balance += 1;
        }
        for _ in &day.setting {
            balance -= 1;
        }
        assert!((-1..=1).contains(&balance), "{date}");
        edges += i32::from(day.rising.len() != day.setting.len());
        date = date.succ_opt().unwrap();
    }
    assert_eq!(balance, 0);
    assert!(edges >= 2, "the polar day begins and ends: {edges}");
    // At the pole the sun rises once a year.
    let pole = site(90.0, 0.0);
    let day = DayEvents::new(
        "2026-03-18".parse().unwrap(),
        &Zone::utc(),
        &pole,
        Tier::Arcsecond,
        HORIZON,
        None,
    )
    .unwrap();
    assert!(day.day.rising.len() + day.day.setting.len() <= 1);
}

#[test]
fn a_date_has_the_hours_that_its_clock_gives_it() {
    let paris = site(48.86, 2.29);
    for (date, hours) in [
        ("2026-03-29", 23.0),
        ("2026-10-25", 25.0),
        ("2026-06-21", 24.0),
    ] {
        let (start, end) = events(date, "Europe/Paris", &paris, Tier::Spa).span;
        assert!((end.ut().seconds_since(start.ut()) - hours * 3600.0).abs() < 1e-6);
    }
    let skipped = Zone::named("Pacific/Apia")
        .unwrap()
        .day("2011-12-30".parse().unwrap());
    assert!(skipped.unwrap_err().to_string().contains("skipped"));
}
