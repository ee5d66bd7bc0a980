//! `tyndall render --until`: what pictures over a range of times would be like, in a row of numbers for each.

use crate::arguments::steps::Range;
use crate::commands::render_args::RenderArgs;
use crate::machine;
use crate::signals;
use crate::tables::columns::{self, Columns, columns};
use crate::tables::stdout;
use crate::tell;
use chrono::SecondsFormat;
use serde_json::json;
use std::mem::discriminant;
use tyndall::backend::choose::choose;
use tyndall::backend::{Backend, Limits};
use tyndall::colour::{exposure, luminance};
use tyndall::conditions::{Conditions, Receiver, View};
use tyndall::ephemeris::Site;
use tyndall::ephemeris::civil::{self, Reading};
use tyndall::plan::{Overrules, Plan};
use tyndall::warning::Warning;
use tyndall::{Error, Result};

/// No more pictures than these of a range.
const MOST_PICTURES: u64 = 10_000;

/// What the table for people shows, below which titles: what changes most.
const SHOWN: [(&str, &str); 7] = [
    ("sun_azimuth", "azimuth"),
    ("sun_elevation_apparent", "elevation"),
    ("sun_normal_illuminance_lx", "sun lx"),
    ("sky_horizontal_illuminance_lx", "sky lx"),
    ("eye_illuminance_lx", "eye lx"),
    ("mean_luminance_cd_m2", "mean cd/m2"),
    ("ev100", "EV100"),
];

/// Prints a row for each step from --time up to `until`.
pub fn run(args: &RenderArgs, until: &str) -> Result<()> {
    if !args.output.is_empty() || args.check.report.is_some() || args.check.is_asked() {
        return Err(Error::input(
            "--until",
            "a range of times is printed in numbers, without pictures, reports and checks",
            "leave out -o, --report and --check; pictures over a range: tyndall timelapse --from A --to B --every STEP -o 'f_##.png'",
        ));
    }
    let mut scene = args.view.scene.load()?;
    let (Some(entry), Some(from), None) = (&scene.site, scene.time.clone(), &scene.sun) else {
        return Err(Error::input(
            "--until",
            "a range of times needs a place and a time to begin with, and no sun that stands still",
            "give --at LAT,LON and --time T, and leave out --sun",
        ));
    };
    let site = Site::new(entry.latitude_deg, entry.longitude_deg, entry.elevation)?;
    let request = args.view.scene.request();
    let zone = request.timezone.or(entry.timezone.clone());
    let reading = Reading {
        zone: zone.as_deref(),
        site: Some(&site),
        fold: request.fold,
        scale: request.time_scale,
        delta_t: request.delta_t,
    };
    let range = Range::read([&from, until], args.step, &site, zone.as_deref(), |text| {
        args.view.scene.time.moment_by(text, &reading)
    })?;
    let count = range.steps.count;
    if count > MOST_PICTURES {
        return Err(Error::domain(
            "the number of pictures",
            count,
            format!("1 to {MOST_PICTURES}"),
            "give a larger --step, or a part of the range",
        ));
    }
    let utc = |number: u64| {
        let utc = range.steps.at(number);
        utc.to_rfc3339_opts(SecondsFormat::AutoSi, true)
    };
    scene.time = Some(range.text(0));
    let first = args.view.conditions_of(scene)?;
    let layers = args.picture.layers(&first, &args.plan.overrules())?;
    Plan::new(&first, &args.plan.overrules())?;
    tell::conditions_without(&first, &["instant", "sun", "day", "sky"]);
    let limits = Limits {
        stop: Some(signals::asked_to_end()),
        ..args.memory.limits()
    };
    let mut backend = machine::open(args.picture.backend.wanted())?;
    let bar = tell::bar();
    let mut overrules = args.plan.overrules();
    if let Some(goal) = args.plan.goal() {
        let step = |step| bar.step(step);
        let chosen = choose(&mut backend, &first, &overrules, goal, &limits, &step)?;
        bar.apart(|| tell::chosen(&chosen.why));
        overrules = chosen.overrules;
    }
    tell::line("backend", backend.describe());
    let mut rows = Vec::new();
    let mut later = Vec::new();
    let mut out = stdout::lock();
    let mut width = 0;
    for number in 0..count {
        let words = format!("time {} of {count}", number + 1);
        bar.show(&words, number as f64 / count as f64);
        let conditions = first.at(&range.text(number))?;
        let moment = range.moment(number, &reading)?;
        let local = civil::exact_local_text(moment.local());
        let mut row = columns([("time", json!(local)), ("utc", json!(utc(number)))]);
        row.extend(values(
            &conditions,
            &mut backend,
            &overrules,
            &limits,
            &layers,
        )?);
        let is_new = |warning: &&Warning| {
            let is_alike = |told: &Warning| discriminant(told) == discriminant(*warning);
            !first.warnings.iter().any(is_alike)
        };
        let warnings = conditions.warnings.iter().filter(is_new);
        later.extend(warnings.map(|warning| (local.clone(), warning.clone())));
        if args.json {
            row.insert("warnings".into(), json!(conditions.warnings));
            rows.push(row);
            continue;
        }
        // A row takes a while: each is printed as it comes.
        bar.apart(|| -> Result<()> {
            if args.csv {
                let rows = [row];
                let text = match number {
                    0 => columns::csv(&rows),
                    _ => columns::csv_below(&rows),
                };
                out.bytes(&text)?;
            } else {
                if number == 0 {
                    width = local.len().max(25) + 5;
                    out.line(&columns::titles(width, &SHOWN))?;
                }
                out.line(&columns::line(&row, width, &SHOWN))?;
            }
            out.flush()
        })?;
        if out.closed() {
            break;
        }
    }
    drop(bar);
    out.finish()?;
    tell::warnings_since(later.into_iter());
    let [width, height] = first.view.size;
    if args.json {
        stdout::print_json(&json!({
            "schema": 1,
            "scene": first.scene.name,
            "from": from,
            "until": until,
            "step_seconds": range.steps.step_seconds(),
            "clock": range.clock.source(),
            "latitude": site.latitude_deg(),
            "longitude": site.longitude_deg(),
            "site_elevation": site.elevation(),
            "size": [width, height],
            "quality": overrules.quality.name(),
            "warnings": first.warnings,
            "rows": rows,
        }))?;
    }
    Ok(())
}

/// The values of one picture; none is of a file.
fn values(
    conditions: &Conditions,
    backend: &mut Backend,
    overrules: &Overrules,
    limits: &Limits,
    layers: &[&'static str],
) -> Result<Columns> {
    let mut luminances = |conditions: &Conditions| -> Result<_> {
        let plan = Plan::new(conditions, overrules)?;
        let frame = backend.render(&plan, limits, &|_| {})?.frame;
        let all = (0..frame.pixels()).map(|i| luminance(frame.picture(i)));
        Ok((all.collect::<Vec<f64>>(), frame))
    };
    let (picture, frame) = luminances(conditions)?;
    let mean =
        |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / frame.pixels().max(1) as f64;
    let camera = &conditions.view.camera;
    let eye = Receiver::new(camera.eye, camera.forward)?;
    let (at_eye, _) = luminances(&conditions.seen_from(View::of_points(vec![eye]))?)?;
    let sky = conditions.sky.as_ref();
    let sky = sky.map_or(0.0, |sky| luminance(sky.horizontal_illuminance()));
    let mut row = columns([
        ("sun_azimuth", json!(conditions.sun_azimuth_deg())),
        (
            "sun_elevation_apparent",
            json!(conditions.sun_elevation_deg()),
        ),
        (
            "sun_normal_illuminance_lx",
            json!(conditions.sun.illuminance_lux()),
        ),
        ("sky_horizontal_illuminance_lx", json!(sky)),
        ("eye_illuminance_lx", json!(at_eye.first())),
        ("ev100", json!(exposure::auto(picture.iter().copied()))),
        (
            "mean_luminance_cd_m2",
            json!(mean(&mut picture.iter().copied())),
        ),
        (
            "max_luminance_cd_m2",
            json!(picture.iter().copied().fold(0.0, f64::max)),
        ),
    ]);
    // Those that the scene can hold something in, whatever the hour: no column comes and goes.
    for name in layers {
        if let Some(layer) = frame.layers.iter().find(|layer| layer.name == *name) {
            let mut own = layer.rgb.iter().map(|rgb| luminance(rgb.as_dvec3()));
            row.insert(format!("mean_{name}_cd_m2"), json!(mean(&mut own)));
        } else if tyndall::frame::Field::layers().any(|field| field.name() == *name) {
            row.insert(format!("mean_{name}_cd_m2"), json!(0.0));
        }
    }
    Ok(row)
}
