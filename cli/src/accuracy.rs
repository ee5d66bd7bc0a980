//! `tyndall accuracy`: what accuracy costs.

use clap::Args;
use serde_json::json;
use tyndall::studies::ephemeris::{Price, SAMPLES, prices};
use tyndall::{Error, Result};

use crate::stdout;

/// The flags of `tyndall accuracy`.
#[derive(Args, Debug)]
pub struct AccuracyArgs {
    /// What to measure
    #[arg(long, value_name = "EFFECT", default_value = "ephemeris")]
    effect: String,
    /// Print JSON
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print CSV
    #[arg(long)]
    csv: bool,
}

/// Runs `tyndall accuracy`.
pub fn run(args: &AccuracyArgs) -> Result<()> {
    match args.effect.as_str() {
        "ephemeris" => ephemeris(args),
        other => Err(Error::input(
            "--effect",
            format!("`{other}` is not known"),
            "write ephemeris",
        )),
    }
}

/// The price list of the ephemeris.
pub fn ephemeris(args: &AccuracyArgs) -> Result<()> {
    eprintln!(
        "measuring four tiers; other work on this machine makes the rates smaller, not the errors"
    );
    let prices = prices();
    let mut out = stdout::lock();
    if args.json {
        let rows: Vec<_> = prices
            .iter()
            .map(|price| {
                json!(
                    columns(price)
                        .into_iter()
                        .collect::<serde_json::Map<_, _>>()
                )
            })
            .collect();
        out.line(&serde_json::to_string_pretty(&rows).unwrap_or_default())?;
    } else if args.csv {
        for (i, price) in prices.iter().enumerate() {
            let columns = columns(price);
            if i == 0 {
                out.line(
                    &columns
                        .iter()
                        .map(|c| c.0.as_str())
                        .collect::<Vec<_>>()
                        .join(","),
                )?;
            }
            let cells: Vec<String> = columns
                .iter()
                .map(|c| c.1.as_str().map_or_else(|| c.1.to_string(), str::to_owned))
                .collect();
            out.line(&cells.join(","))?;
        }
    } else {
        let cores = rayon::current_num_threads();
        out.line(&format!("error [arcsec]: great circle on the sky, 1900 to 2100; `arcsecond` at {SAMPLES} places and times, ERFA at 600"))?;
        out.line(&format!("rate [positions/s]: unordered times, a year of minutes at one place, the same as directions alone; one core / all {cores}"))?;
        out.line("")?;
        out.line("tier         worst and RMS to arcsecond   worst and RMS to ERFA        unordered          year of minutes     directions alone")?;
        for Price {
            tier,
            against_arcsecond: a,
            against_erfa: e,
            single,
            series,
            directions,
        } in &prices
        {
            out.line(&format!(
                "{tier:<10} {:>12.4} {:>12.4} {:>12.4} {:>12.4}  {:>8} / {:<8} {:>8} / {:<8} {:>8} / {:<8}",
                a.0,
                a.1,
                e.0,
                e.1,
                rate(single.0),
                rate(single.1),
                rate(series.0),
                rate(series.1),
                rate(directions.0),
                rate(directions.1)
            ))?;
        }
    }
    out.finish()
}

fn columns(price: &Price) -> Vec<(String, serde_json::Value)> {
    [
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
    ]
    .into_iter()
    .map(|(name, value)| (name.to_owned(), value))
    .collect()
}

/// A rate with its thousands: 3.21 M, 456 k.
fn rate(rate: f64) -> String {
    if rate >= 1e6 {
        format!("{:.2} M", rate / 1e6)
    } else {
        format!("{:.0} k", rate / 1e3)
    }
}
