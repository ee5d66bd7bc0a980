//! `tyndall sky`: the sky alone, as an environment map or in numbers.

use crate::arguments::backend::BackendFlag;
use crate::arguments::form::FormArgs;
use crate::arguments::hinted::{SKIES, hinted, text};
use crate::arguments::picture::{
    Exposure, NumbersArgs, SPACES, exposure_flag, output_space, space,
};
use crate::arguments::place_time::{PlaceArgs, SunArgs, TimeArgs, step};
use crate::arguments::scene::pair;
use crate::arguments::size::{SizeFlag, size};
use crate::arguments::steps::Range;
use crate::machine;
use crate::tables::columns::{self, Columns, short};
use crate::tables::printer::{As, Form};
use crate::tables::sky_batch;
use crate::tables::stdout::{self, Out};
use crate::targets::{FormatArgs, Targets};
use crate::tell;
use chrono::{DateTime, TimeDelta, Utc};
use clap::{Args, ValueEnum};
use glam::DVec3;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use tyndall::backend::Backend;
use tyndall::colour::{self, Space, exposure, luminance, xyz_from_working};
use tyndall::ephemeris::civil::{self, Moment};
use tyndall::ephemeris::{Weather, sun_position};
use tyndall::frame::Frame;
use tyndall::output::{self, Format, HALF_MOST, Numbers, OutputSpace, Units};
use tyndall::sky::map::{Map, Projection};
use tyndall::sky::{DEFAULT_TURBIDITY, Irradiance, Model, Sky, SunAt, SunLight, SunPath};
use tyndall::task::Step;
use tyndall::units::DEG;
use tyndall::warning::Warning;
use tyndall::{Error, Result};

/// The sky alone: environment maps, or its values
#[derive(Debug, Args)]
#[command(after_help = "\
Without -o the sky's values are printed alone, with --until in a row for each step of time. A map's colours are photometric (cd/m2); its lower half is a ground of \
--albedo lit by sun and sky. In the equirectangular map the middle column looks north (or --north), and east is to its right.\n\n\
Examples:\n  \
tyndall sky --at 48.8584,2.2945 --time 2026-06-21T21:30 -o evening.exr -o evening.png\n  \
tyndall sky --sun 180,30 --sky cie:12 --json\n  \
tyndall sky --at 48.8584,2.2945 --time 2026-06-21 --until 2026-06-22 --step 30min --csv > day.csv\n  \
tyndall sky --at 48.8584,2.2945 --time 2026-06-21T21:30 -o - | magick - evening.webp\n  \
tyndall sky --batch rows.csv > values.csv")]
pub struct SkyArgs {
    #[command(flatten)]
    place: PlaceArgs,
    #[command(flatten)]
    time: TimeArgs,
    #[command(flatten)]
    ephemeris: SunArgs,
    /// Put the sun there instead: degrees, azimuth from north through east; no refraction is added
    #[arg(long, value_name = "AZ,EL", value_parser = pair, allow_hyphen_values = true, conflicts_with_all = ["at", "place", "time"])]
    sun: Option<[f64; 2]>,
    /// The end of a range that begins at --time: a row of values for each step; it is not in the table itself
    #[arg(long, value_name = "T", allow_hyphen_values = true, requires = "time", conflicts_with_all = ["output", "sun", "batch"])]
    until: Option<String>,
    /// The step of a range: a number of seconds, or with s, min, h or d (24 h), as in 30min [default: 1h]
    #[arg(long, value_name = "STEP", value_parser = step, requires = "until")]
    step: Option<TimeDelta>,
    /// The azimuth that the map's middle faces (0 is north; then east is to its right)
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    north: f64,
    /// The sky: perez, preetham, hosek, cie:1 to cie:16, uniform:CD_PER_M2
    #[arg(long, value_name = "MODEL", default_value = "perez", value_parser = hinted(text, SKIES), hide_possible_values = true)]
    sky: String,
    /// Turbidity of the clear air: 2 is very clear, 3 ordinary, 6 hazy
    #[arg(long, value_name = "T", default_value_t = DEFAULT_TURBIDITY)]
    turbidity: f64,
    /// Direct-normal irradiance in W/m2, for perez and cie
    #[arg(long, value_name = "W", requires = "diffuse_horizontal")]
    direct_normal: Option<f64>,
    /// Diffuse-horizontal irradiance in W/m2, for perez and cie
    #[arg(long, value_name = "W", requires = "direct_normal")]
    diffuse_horizontal: Option<f64>,
    /// Albedo of the ground, 0 to 1
    #[arg(long, value_name = "A", default_value_t = 0.2)]
    albedo: f64,
    /// A file to write, by its ending .exr, .hdr, .png or .jpg, or - for standard output, instead of values; may be repeated
    #[arg(short, long, value_name = "FILE|-")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    format: FormatArgs,
    /// How directions lie in the map
    #[arg(long, value_name = "NAME", default_value = "equirectangular")]
    projection: MapShape,
    /// Width and height of the map in pixels, or one of them: 4096, x2048 [default: 2048x1024, 1024x1024 or 3072x512]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<SizeFlag>,
    /// What paints the map; the CPU finishes one before a graphics adapter is opened
    #[arg(long, value_enum, default_value = "reference")]
    backend: BackendFlag,
    /// Leave the sun's disc out of the map
    #[arg(long)]
    without_sun: bool,
    /// Exposure of the PNG: auto, auto+2 for two stops brighter, or the EV100 whose white is 1.2 * 2^EV cd/m2
    #[arg(long, value_name = "auto[+STOPS]|EV", default_value = "auto", allow_negative_numbers = true, value_parser = hinted(exposure_flag, ["auto"]), hide_possible_values = true)]
    exposure: Exposure,
    /// The colour space of EXR and HDR: rec709, rec2020, acescg or xyz
    #[arg(long, value_name = "NAME", default_value = "rec709", value_parser = hinted(space, SPACES), hide_possible_values = true)]
    color_space: Space,
    #[command(flatten)]
    numbers: NumbersArgs,
    /// Evaluate the models as published for the rows of a CSV (model, sun_elevation, turbidity or direct_normal and
    /// diffuse_horizontal, view_azimuth from the sun's, view_elevation; degrees); - is standard input
    #[arg(long, value_name = "FILE.csv", allow_hyphen_values = true, conflicts_with_all = ["output", "at", "place", "time", "sun"])]
    batch: Option<PathBuf>,
    /// With --batch: stop at the first broken row, and print nothing
    #[arg(long, requires = "batch")]
    strict: bool,
    #[command(flatten)]
    form: FormArgs,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum MapShape {
    /// The whole sphere, twice as wide as high
    Equirectangular,
    /// The sky seen from below, in a circle
    Fisheye,
    /// Six faces side by side: +X -X +Y -Y +Z -Z
    Cube,
}

/// The sky, its sun and what was understood.
struct Subject {
    sky: Sky,
    light: SunLight,
    toward_sun: DVec3,
    facts: Vec<(&'static str, Value)>,
}

/// Runs `tyndall sky`.
pub fn run(args: &SkyArgs) -> Result<()> {
    let prints = match (args.form.json, args.form.csv) {
        (true, _) => Some("what --json prints"),
        (_, true) => Some("what --csv prints"),
        _ => None,
    };
    let targets = Targets::check(&args.output, args.format, prints)?;
    if let Some(path) = &args.batch {
        let form = Form {
            as_what: As::csv_or_json(args.form),
            strict: args.strict,
        };
        return sky_batch::run(path, form);
    }
    if let Some(until) = &args.until {
        return range(args, until);
    }
    let map = map(args)?;
    output::picture::check_size(&targets.formats(), [map.width, map.height])?;
    args.place.say();
    let site = args.place.site();
    let moment = match &site {
        Some(site) => {
            let text = args.time.time.as_deref().unwrap_or("now");
            Some(args.time.moment(text, Some(site))?)
        }
        None => None,
    };
    let subject = subject(args, moment.as_ref())?;
    tell::warnings(subject.sky.warnings());
    let mut facts = facts(args, &subject);
    if args.form.json {
        facts.insert("warnings".into(), json!(subject.sky.warnings()));
        stdout::print_json(&facts)?;
    } else if args.form.csv {
        stdout::print(columns::csv(&[facts]))?;
    } else if !targets.is_piped() {
        let mut text = String::new();
        for (name, value) in &facts {
            let value = match value {
                Value::String(s) => s.clone(),
                Value::Number(n) => short(n.as_f64().unwrap_or(f64::NAN)),
                Value::Array(v) => v
                    .iter()
                    .map(|c| short(c.as_f64().unwrap_or(f64::NAN)))
                    .collect::<Vec<_>>()
                    .join(" "),
                Value::Null => "\u{2014}".into(),
                other => other.to_string(),
            };
            text.push_str(&format!("{name:<38} {value}\n"));
        }
        stdout::print(&text)?;
    }
    if args.output.is_empty() {
        return Ok(());
    }
    let frame = paint(args, &map, &subject)?;
    let ev100 = || match args.exposure {
        Exposure::Ev100(ev) => ev,
        Exposure::Auto(stops) => {
            // A sky is brighter than the grey that a meter expects: one stop more, as is usual in photography.
            exposure::auto((0..frame.pixels()).map(|i| luminance(frame.picture(i))))
                .map_or(0.0, |ev| ev - 1.0 - stops)
        }
    };
    let space = output_space(args.color_space, args.numbers.numbers(true));
    say_clamped(&frame, &space, &targets.formats());
    targets.write(|path, format| {
        // Only what a screen shows has an exposure.
        let ev100 = if format.is_for_screens() {
            ev100()
        } else {
            0.0
        };
        output::picture::write(path, format, &frame, &space, &[], ev100)
    })?;
    tell::files(targets.files());
    Ok(())
}

/// Says which texels a half float cannot hold: clamped, or brighter than programs that read into half floats take.
fn say_clamped(frame: &Frame, space: &OutputSpace, formats: &[Format]) {
    let unclamped = OutputSpace {
        numbers: Numbers {
            clamp_half: false,
            ..space.numbers
        },
        ..*space
    };
    for (format, own) in [
        (Format::Exr, Units::Photometric),
        (Format::Hdr, Units::Radiance),
    ] {
        if !formats.contains(&format) {
            continue;
        }
        let most = |i| unclamped.colour(own, frame.picture(i)).max_element();
        let above = (0..frame.pixels()).into_par_iter().map(most);
        let above = above.filter(|m| *m > HALF_MOST).map(|m| (1, m));
        let (count, most) = above.reduce(|| (0, 0.0), |a, b| (a.0 + b.0, f64::max(a.1, b.1)));
        let what = match (format, space.numbers.clamp_half) {
            (_, true) => "held there: the sun loses light",
            // Its programs read floats.
            (Format::Hdr, _) => continue,
            _ => {
                "overflow where a program reads half floats: --clamp-half, --multiply or --without-sun"
            }
        };
        if count > 0 {
            tell::line(
                "note",
                format!("texels above {HALF_MOST}, of up to {most:.3e}: {count}, {what}"),
            );
        }
    }
}

/// How often it is said how far they are.
const ROWS_AT_ONCE: u64 = 64;

/// Prints a row of values for each step of a range of times.
fn range(args: &SkyArgs, until: &str) -> Result<()> {
    let site = args.place.site();
    let (Some(site), Some(from)) = (&site, &args.time.time) else {
        return Err(Error::input(
            "--until",
            "a range of times has no place",
            "give --at LAT,LON and --time T",
        ));
    };
    args.place.say();
    let range = Range::read(
        [from, until],
        args.step,
        site,
        args.time.tz.as_deref(),
        |text| args.time.moment(text, Some(site)),
    )?;
    let count = range.steps.count;
    let bar = tell::bar();
    let done = AtomicU64::new(0);
    let row = |i: u64| {
        let moment = range.moment(i, &args.time.reading(Some(site)))?;
        let subject = subject(args, Some(&moment))?;
        let mut row = facts(args, &subject);
        let warnings = subject.sky.warnings();
        if args.form.json {
            row.insert("warnings".into(), json!(warnings));
        }
        let done = 1 + done.fetch_add(1, Ordering::Relaxed);
        if done.is_multiple_of(ROWS_AT_ONCE) {
            let share = done as f64 / count as f64;
            bar.step(Step {
                stage: "skies",
                share,
                turn: None,
            });
        }
        let local = civil::local_text(moment.local());
        let warnings = warnings.iter().cloned().map(|w| (local.clone(), w));
        Ok((row, warnings.collect()))
    };
    let rows: Vec<(Columns, Vec<(String, Warning)>)> =
        (0..count).into_par_iter().map(row).collect::<Result<_>>()?;
    drop(bar);
    let (rows, warnings): (Vec<Columns>, Vec<_>) = rows.into_iter().unzip();
    tell::warnings_since(warnings.into_iter().flatten());
    if args.form.json {
        return stdout::print_json(&json!({
            "schema": 1,
            "from": from,
            "until": until,
            "step_seconds": range.steps.step_seconds(),
            "clock": range.clock.source(),
            "latitude": site.latitude_deg(),
            "longitude": site.longitude_deg(),
            "site_elevation": site.elevation(),
            "sky": args.sky,
            "turbidity": args.turbidity,
            "direct_normal": args.direct_normal,
            "diffuse_horizontal": args.diffuse_horizontal,
            "albedo": args.albedo,
            "rows": rows,
        }));
    }
    if args.form.csv {
        return stdout::print(columns::csv(&rows));
    }
    let mut out = stdout::lock();
    table(&mut out, &rows)?;
    out.finish()
}

fn utc_text(utc: DateTime<Utc>) -> String {
    utc.format("%Y-%m-%dT%H:%M:%S%.fZ").to_string()
}

/// The rows of a range for people: what changes most, briefly.
fn table(out: &mut Out, rows: &[Columns]) -> Result<()> {
    const SHOWN: [(&str, &str); 7] = [
        ("sun_azimuth", "azimuth"),
        ("sun_elevation_apparent", "elevation"),
        ("zenith_luminance_cd_m2", "zenith cd/m2"),
        ("sky_horizontal_illuminance_lx", "sky lx"),
        ("sun_normal_illuminance_lx", "sun lx"),
        ("horizontal_illuminance_lx", "ground lx"),
        ("sky_cct_k", "sky K"),
    ];
    columns::table(out, rows, &SHOWN)
}

/// The sun and the sky that the flags ask for, at a moment where they give a place.
fn subject(args: &SkyArgs, moment: Option<&Moment>) -> Result<Subject> {
    if !args.north.is_finite() {
        return Err(Error::domain(
            "--north",
            args.north,
            "finite degrees",
            "give an azimuth",
        ));
    }
    let irradiance = args.direct_normal.zip(args.diffuse_horizontal).map(
        |(direct_normal, diffuse_horizontal)| Irradiance {
            direct_normal,
            diffuse_horizontal,
        },
    );
    let model = Model::named(
        &args.sky.to_ascii_lowercase(),
        args.turbidity,
        irradiance,
        args.albedo,
    )?;
    if !(0.0..=1.0).contains(&args.albedo) {
        return Err(Error::domain(
            "--albedo",
            args.albedo,
            "0 to 1",
            "0.2 is usual",
        ));
    }
    let toward = |azimuth: f64, elevation: f64| {
        let ((sa, ca), (se, ce)) = ((azimuth - args.north * DEG).sin_cos(), elevation.sin_cos());
        DVec3::new(ce * sa, se, -ce * ca)
    };
    let site = args.place.site();
    let place = site.as_ref().zip(moment);
    let (at, path, azimuth, facts) = match (args.sun, place) {
        (Some([azimuth, elevation]), _) => {
            if !(-90.0..=90.0).contains(&elevation) {
                return Err(Error::domain(
                    "the elevation of --sun",
                    format!("{elevation} degrees"),
                    "-90 to 90 degrees",
                    "write azimuth, then elevation",
                ));
            }
            let at = SunAt {
                elevation_true: elevation * DEG,
                ..SunAt::unrefracted(toward(azimuth * DEG, elevation * DEG))
            };
            (
                at,
                SunPath::standard(elevation * DEG, model.turbidity()),
                azimuth,
                Vec::new(),
            )
        }
        (None, Some((site, moment))) => {
            let weather = args.ephemeris.weather(site)?;
            let sun = sun_position(args.ephemeris.tier, &moment.instant, site, &weather);
            let at = SunAt {
                toward_sun: toward(sun.azimuth, sun.elevation_apparent),
                elevation_true: sun.elevation_true,
                distance_au: sun.distance_au,
                site_elevation: site.elevation(),
            };
            let path = SunPath {
                distance_au: sun.distance_au,
                pressure_hpa: Weather::standard(site).pressure_hpa(),
                ..SunPath::standard(sun.elevation_apparent, model.turbidity())
            };
            let facts = vec![
                ("time", json!(civil::exact_local_text(moment.local()))),
                ("utc", json!(utc_text(moment.utc))),
                ("offset_from", json!(moment.offset_source.to_string())),
                ("latitude", json!(site.latitude_deg())),
                ("longitude", json!(site.longitude_deg())),
                ("site_elevation", json!(site.elevation())),
            ];
            (at, path, sun.azimuth / DEG, facts)
        }
        (None, None) => {
            return Err(Error::input(
                "tyndall sky",
                "there is no sun: neither place and time nor --sun is given",
                "give --at LAT,LON and --time T, or --sun AZ,EL",
            ));
        }
    };
    let sky = Sky::new(model, at)?;
    let light = sky.sunlight(&path)?;
    let mut all = facts;
    all.push(("sun_azimuth", json!(azimuth)));
    all.push(("sun_elevation_true", json!(at.elevation_true / DEG)));
    all.push((
        "sun_elevation_apparent",
        json!(path.elevation_apparent / DEG),
    ));
    Ok(Subject {
        sky,
        light,
        toward_sun: at.toward_sun,
        facts: all,
    })
}

/// What is printed: names with values; no number where there is none.
fn facts(args: &SkyArgs, subject: &Subject) -> Columns {
    let Subject { sky, light, .. } = subject;
    let rgb = |v: DVec3| json!((Space::Rec709.from_working() * v).to_array());
    let temperature = |v: DVec3| colour::temperature(xyz_from_working(v));
    let cct = |v: DVec3| json!(temperature(v).map(|t| t.cct));
    let duv = |v: DVec3| json!(temperature(v).map(|t| t.duv));
    let (zenith, dome) = (sky.zenith(), sky.horizontal_illuminance());
    let direct = light.horizontal_illuminance();
    let mut facts: Vec<(&str, Value)> = subject.facts.clone();
    facts.extend([
        ("model", json!(sky.name())),
        ("description", json!(sky.describe())),
        ("zenith_luminance_cd_m2", json!(luminance(zenith))),
        ("zenith_rec709_cd_m2", rgb(zenith)),
        ("zenith_cct_k", cct(zenith)),
        ("zenith_duv", duv(zenith)),
        ("sky_horizontal_illuminance_lx", json!(luminance(dome))),
        ("sky_cct_k", cct(dome)),
        ("sky_duv", duv(dome)),
        (
            "sun_normal_illuminance_lx",
            json!(luminance(light.illuminance)),
        ),
        ("sun_horizontal_illuminance_lx", json!(luminance(direct))),
        ("sun_rec709_lx", rgb(light.illuminance)),
        ("sun_cct_k", cct(light.illuminance)),
        ("sun_duv", duv(light.illuminance)),
        ("sun_visible_share", json!(light.visible_share)),
        ("horizontal_illuminance_lx", json!(luminance(dome + direct))),
        (
            "ground_luminance_cd_m2",
            json!(luminance(ground(args, subject))),
        ),
    ]);
    facts
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

/// Radiance of the ground that the lower half of a map shows: a diffuse plane under sun and sky.
fn ground(args: &SkyArgs, subject: &Subject) -> DVec3 {
    let light = subject.sky.horizontal_illuminance() + subject.light.horizontal_illuminance();
    light * (args.albedo / std::f64::consts::PI)
}

/// The map that the flags ask for.
fn map(args: &SkyArgs) -> Result<Map> {
    let (projection, usual) = match args.projection {
        MapShape::Equirectangular => (Projection::Equirectangular, [2048, 1024]),
        MapShape::Fisheye => (Projection::Fisheye, [1024, 1024]),
        MapShape::Cube => (Projection::Cube, [3072, 512]),
    };
    let Some(flag) = args.size else {
        return Map::new(projection, usual[0], usual[1]);
    };
    let [width, height] = flag.in_shape_of(usual);
    Map::new(projection, width, height).map_err(|error| {
        let nearest = flag.written(projection.nearest(flag.in_shape_of(usual)));
        Error::input(
            format!("--size {flag}"),
            error.problem(),
            format!("the nearest that works is --size {nearest}"),
        )
    })
}

fn paint(args: &SkyArgs, map: &Map, subject: &Subject) -> Result<Frame> {
    let (width, height) = (map.width, map.height);
    let ground = ground(args, subject);
    let mut backend = machine::open(args.backend.wanted())?;
    let mut rgb = match &mut backend {
        Backend::Gpu(gpu) => {
            let painted = gpu.paint(map, &subject.sky, ground)?;
            if let Some(time) = painted.time {
                let milliseconds = 1e3 * time.as_secs_f64();
                tell::line("painted", format!("in {milliseconds:.2} ms on the device"));
            }
            painted.texels
        }
        Backend::Reference(_) => map.paint(&subject.sky, ground)?,
    };
    tell::line("backend", backend.describe());
    if !args.without_sun {
        for (texel, light) in map.disc(&subject.light, subject.toward_sun) {
            rgb[texel] = (rgb[texel].as_dvec3() + light).as_vec3();
        }
    }
    let mut frame = Frame::map(width, height, rgb);
    frame.record.set("version", env!("CARGO_PKG_VERSION"));
    frame.record.set("backend", backend.describe());
    for (name, value) in facts(args, subject) {
        match value {
            Value::String(text) => frame.record.set(name, text),
            Value::Number(number) => frame.record.set(name, number.as_f64().unwrap_or(f64::NAN)),
            _ => {}
        }
    }
    Ok(frame)
}
