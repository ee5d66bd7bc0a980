//! `tyndall accuracy`: what accuracy costs.

use clap::{Args, ValueEnum};
use serde_json::json;
use tyndall::Result;
use tyndall::studies::{ephemeris, sky};

use crate::arguments::form::FormArgs;
use crate::commands::study::StudyArgs;
use crate::commands::{accuracy_lamps, accuracy_radiosity, accuracy_shafts};
use crate::tables::columns::{Columns, columns, print};
use crate::tables::stdout::Out;
use crate::tell;

/// The flags of `tyndall accuracy`.
#[derive(Args, Debug)]
pub struct AccuracyArgs {
    /// What to measure: ephemeris, sky, shafts, lamps or radiosity
    #[arg(
        long,
        value_enum,
        value_name = "EFFECT",
        default_value = "ephemeris",
        hide_possible_values = true
    )]
    effect: Measured,
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    shafts: accuracy_shafts::ShaftsArgs,
    #[command(flatten)]
    radiosity: accuracy_radiosity::RadiosityArgs,
    #[command(flatten)]
    form: FormArgs,
}

/// What can be measured.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Measured {
    Ephemeris,
    Sky,
    Shafts,
    Lamps,
    Radiosity,
}

/// Runs `tyndall accuracy`.
pub fn run(args: &AccuracyArgs) -> Result<()> {
    let quiet = "other work on this machine lowers the rates, not the errors";
    match args.effect {
        Measured::Ephemeris => {
            args.study.refuse_plot("ephemeris")?;
            tell::line(
                "study",
                format!("four tiers of the sun's position, for about 6 s; {quiet}"),
            );
            let prices = ephemeris::prices();
            let rows = prices.iter().map(ephemeris_columns).collect();
            print(args.form, rows, |out| ephemeris_table(out, &prices))
        }
        Measured::Sky => {
            args.study.refuse_plot("sky")?;
            tell::line(
                "study",
                format!("patches, maps and bands of the sky, for about 8 s; {quiet}"),
            );
            let prices = sky::prices()?;
            let rows = prices.iter().map(sky_columns).collect();
            print(args.form, rows, |out| sky_table(out, &prices))
        }
        Measured::Shafts => accuracy_shafts::run(&args.study, &args.shafts, args.form),
        Measured::Lamps => accuracy_lamps::run(&args.study, args.form),
        Measured::Radiosity => accuracy_radiosity::run(&args.study, &args.radiosity, args.form),
    }
}

fn sky_columns(price: &sky::Price) -> Columns {
    columns([
        ("knob", json!(price.knob)),
        ("setting", json!(price.setting)),
        ("count", json!(price.count)),
        ("seconds", json!(price.seconds)),
        ("illuminance_error", json!(price.illuminance_error)),
        ("detail_error", json!(price.detail_error)),
    ])
}

fn sky_table(out: &mut Out, prices: &[sky::Price]) -> Result<()> {
    let (sun, cores) = (sky::SUN_ELEVATION_DEG, rayon::current_num_threads());
    out.line(&format!(
        "the clear default sky, the sun {sun} degrees high; worst relative error of the illuminance of 13 planes, level and \
         upright,\nand RMS relative error of a direction's luminance; times on one core, of maps on {cores}"
    ))?;
    let mut knob = "";
    for price in prices {
        if price.knob != knob {
            knob = price.knob;
            let titles = match knob {
                "bands" => ["bands of sunlight, 380 to 780 nm", "illuminance", "u'v'"],
                "map" => ["texels of an equirectangular map", "planes", "direction"],
                _ => ["patches of the dome", "planes", "direction"],
            };
            let [what, first, second] = titles;
            out.line(&format!(
                "\n{what:<34}{:>9}{:>12}{first:>13}{second:>12}",
                "", "time"
            ))?;
        }
        out.line(&format!(
            "{:<34}{:>9}{:>12}{:>13.1e}{:>12.1e}",
            price.setting,
            price.count,
            time(price.seconds),
            price.illuminance_error,
            price.detail_error
        ))?;
    }
    Ok(())
}

/// A time in a suitable unit.
fn time(seconds: f64) -> String {
    match seconds {
        s if s >= 1.0 => format!("{s:.2} s"),
        s if s >= 1e-3 => format!("{:.2} ms", 1e3 * s),
        s => format!("{:.2} us", 1e6 * s),
    }
}

fn ephemeris_table(out: &mut Out, prices: &[ephemeris::Price]) -> Result<()> {
    let (samples, cores) = (ephemeris::SAMPLES, rayon::current_num_threads());
    out.line(&format!("error [arcsec]: great circle on the sky, 1900 to 2100; `arcsecond` at {samples} places and times, ERFA at 600"))?;
    out.line(&format!("rate [positions/s]: unordered times, a year of minutes at one place, the same as directions alone; one core / all {cores}"))?;
    out.line("")?;
    out.line("tier         worst and RMS to arcsecond   worst and RMS to ERFA        unordered          year of minutes     directions alone")?;
    for price in prices {
        let (a, e) = (price.against_arcsecond, price.against_erfa);
        let mut line = format!(
            "{:<10} {:>12.4} {:>12.4} {:>12.4} {:>12.4} ",
            price.tier, a.0, a.1, e.0, e.1
        );
        for (one, all) in [price.single, price.series, price.directions] {
            line += &format!(" {:>8} / {:<8}", rate(one), rate(all));
        }
        out.line(line.trim_end())?;
    }
    Ok(())
}

fn ephemeris_columns(price: &ephemeris::Price) -> Columns {
    columns([
        ("tier", json!(price.tier.to_string())),
        ("worst_to_arcsecond", json!(price.against_arcsecond.0)),
        ("rms_to_arcsecond", json!(price.against_arcsecond.1)),
        ("worst_to_erfa", json!(price.against_erfa.0)),
        ("rms_to_erfa", json!(price.against_erfa.1)),
        ("unordered_one_core", json!(price.single.0)),
        ("unordered_all_cores", json!(price.single.1)),
        ("series_one_core", json!(price.series.0)),
        ("series_all_cores", json!(price.series.1)),
        ("directions_one_core", json!(price.directions.0)),
        ("directions_all_cores", json!(price.directions.1)),
    ])
}

/// A rate with its thousands: 3.21 M, 456 k.
fn rate(rate: f64) -> String {
    if rate >= 1e6 {
        format!("{:.2} M", rate / 1e6)
    } else {
        format!("{:.0} k", rate / 1e3)
    }
}
