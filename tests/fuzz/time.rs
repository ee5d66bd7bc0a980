//! Any text as a time: at a place, in a zone, on its own; the first 17 bytes are the place and how a repeated hour is read.

#![no_main]

use libfuzzer_sys::fuzz_target;
use tyndall::ephemeris::civil::{self, Fold, Reading};
use tyndall::ephemeris::{Site, Tier, Weather, sun_position};

fuzz_target!(|bytes: &[u8]| {
    let Some((place, text)) = bytes.split_at_checked(17) else {
        return;
    };
    let Ok(text) = str::from_utf8(text) else {
        return;
    };
    let number = |at: usize| {
        let eight: [u8; 8] = std::array::from_fn(|i| place[at + i]);
        f64::from_le_bytes(eight)
    };
    let site = Site::new(number(0), number(8), 0.0).ok();
    let fold = [None, Some(Fold::Earlier), Some(Fold::Later)][usize::from(place[16] % 3)];
    // A zone may stand before the time.
    let (zone, text) = match text.split_once('|') {
        Some((zone, text)) => (Some(zone), text),
        None => (None, text),
    };
    let reading = Reading {
        zone,
        site: site.as_ref(),
        fold,
        ..Reading::default()
    };
    let _ = civil::date_alone(text);
    let Ok(moment) = civil::resolve_with(text, &reading) else {
        return;
    };
    let site = site.unwrap_or(Site::new(0.0, 0.0, 0.0).expect("a place"));
    let weather = Weather::standard(&site);
    let sun = sun_position(Tier::Minute, &moment.instant, &site, &weather);
    assert!(sun.elevation_true.is_finite(), "{text}");
});
