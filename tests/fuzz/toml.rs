//! Any bytes as a TOML scene file, with a mesh beside it.

#![no_main]

use libfuzzer_sys::fuzz_target;
use tyndall::scene::from_bytes;

fuzz_target!(|bytes: &[u8]| {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/beside/a.toml");
    let _ = from_bytes(path.as_ref(), bytes);
});
