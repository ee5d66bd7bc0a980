//! `tyndall sun`: where the sun is.

use clap::Args;
use tyndall::ephemeris::sun_position;
use tyndall::units::DEG;
use tyndall::{Error, Result};

use crate::place_time;

/// The flags of `tyndall sun`.
#[derive(Args, Debug)]
pub struct SunArgs {
    #[command(flatten)]
    place: place_time::PlaceArgs,
    #[command(flatten)]
    time: place_time::TimeArgs,
    #[command(flatten)]
    sun: place_time::SunArgs,
}

/// Runs `tyndall sun`.
pub fn run(args: &SunArgs) -> Result<()> {
    let site = args
        .place
        .at
        .ok_or_else(|| Error::input("--at", "no place is given", "write --at LAT,LON"))?;
    let moment = args
        .time
        .moment(args.time.time.as_deref().unwrap_or("now"), Some(&site))?;
    let sun = sun_position(args.sun.tier, &moment.instant, &site, &args.sun.air(&site)?);
    println!("{} ({})", moment.local().to_rfc3339(), moment.offset_source);
    println!(
        "azimuth {:.6} elevation {:.6} {:.6}",
        sun.azimuth_deg(),
        sun.elevation_true / DEG,
        sun.elevation_apparent_deg()
    );
    Ok(())
}
