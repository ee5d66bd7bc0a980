//! Any bytes as a EULUMDAT file of a luminaire; the first says which set of lamps.

#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::Path;
use tyndall::photometry::{Distribution, from_bytes};

fuzz_target!(|bytes: &[u8]| {
    let Some((set, bytes)) = bytes.split_first() else {
        return;
    };
    let Ok((lamp, _)) = from_bytes(Path::new("a.ldt"), bytes, usize::from(set % 4)) else {
        return;
    };
    assert!(lamp.table.flux() >= 0.0);
    let lamp = Distribution::Table(lamp.table);
    for (theta, phi) in [(0.0, 0.0), (1.0, -2.0), (2.5, 9.0)] {
        let value = lamp.relative(theta, phi);
        assert!((0.0..=lamp.peak()).contains(&value), "{value}");
    }
});
