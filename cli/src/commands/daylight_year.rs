//! `tyndall daylight --weather` and `--sun-hours`: a year of hours with its metrics, and the hours of sun on a day.

use super::daylight_files::{self, Kind};
use super::daylight_variants::{self, Done, Variant, variants};
use crate::arguments::form::FormArgs;
use crate::arguments::place_time;
use crate::arguments::scene::{PlanArgs, SceneArgs};
use crate::tables::printer::As;
use crate::tables::stdout;
use crate::tell;
use chrono::{NaiveDate, NaiveTime, TimeDelta};
use clap::Args;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::time::Instant;
use tyndall::conditions::{CameraChoice, Conditions, Request};
use tyndall::daylight::assumed;
use tyndall::daylight::blinds::{Blinds, Operator, Rooms};
use tyndall::daylight::epw::WeatherFile;
use tyndall::daylight::factor;
use tyndall::daylight::glazing::Glazing;
use tyndall::daylight::grid::{GridSpec, On, Sensors};
use tyndall::daylight::hours::Hours;
use tyndall::daylight::map::{self, Caption};
use tyndall::daylight::metrics::{ByPoint, Metrics};
use tyndall::daylight::page::{self, Picture};
use tyndall::daylight::raster;
use tyndall::daylight::report::{Line, Of, Report, hours_csv};
use tyndall::daylight::sun_hours::{self, Span, SunHours};
use tyndall::daylight::table::Table;
use tyndall::daylight::view::Views;
use tyndall::daylight::year::{self, Fineness, Year};
use tyndall::ephemeris::{Site, civil};
use tyndall::output::drawing::Drawing;
use tyndall::output::scale::Scale;
use tyndall::output::{self, atomic};
use tyndall::plan::Plan;
use tyndall::scene::{Camera, Scene};
use tyndall::timelapse::select::Shard;
use tyndall::{Error, Result};

/// Flags that neither has a use for: weather and quality say all that they do.
const UNUSED: [&str; 12] = [
    "sky",
    "direct_normal",
    "diffuse_horizontal",
    "report",
    "backend",
    "max_memory",
    "method",
    "max_error",
    "within",
    "tolerance",
    "force",
    "without",
];

/// A year of weather, or the hours of sun on a day.
#[derive(Debug, Args)]
pub struct YearArgs {
    /// A year of weather (.epw): the metrics of LM-83, UDI and EN 17037 of all sensors of --grid; repeat it to compare files
    #[arg(long, value_name = "FILE.epw", requires = "grid", conflicts_with_all = ["points", "time", "sun", "factor", "sun_hours"], conflicts_with_all = UNUSED)]
    pub weather: Vec<PathBuf>,
    /// With --weather: the model turned so many degrees from north through east, each a variant, as in 0,90,180,270
    #[arg(
        long,
        value_name = "DEG",
        requires = "weather",
        conflicts_with = "sun_hours",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    turn: Vec<f64>,
    /// With --weather: other glass, MATERIAL=TRANSMITTANCE at normal incidence, all panes together; repeat it to compare glazings
    #[arg(long, value_name = "MATERIAL=T,...", requires = "weather", conflicts_with = "sun_hours", value_parser = glazing)]
    glazing: Vec<Glazing>,
    /// With --weather: only the variants of shard I of N, for clusters: neighbours in the order of glazings, files, turns
    #[arg(long, value_name = "I/N", requires = "weather", conflicts_with = "sun_hours", value_parser = shard)]
    shard: Option<Shard>,
    /// With --weather: how finely the sky is divided: 1 (145 patches), 2 (577) or 4 (2305)
    #[arg(
        long,
        value_name = "1|2|4",
        default_value_t = 2,
        requires = "weather",
        conflicts_with = "sun_hours"
    )]
    patches: u32,
    /// With --weather: write the illuminance of each sensor in each hour of the year
    #[arg(
        long,
        value_name = "FILE.csv",
        requires = "weather",
        conflicts_with = "sun_hours"
    )]
    hours: Option<PathBuf>,
    /// With --weather: take the sun so many hours later than the file's labels say [default: found from the irradiance]
    #[arg(
        long,
        value_name = "H",
        requires = "weather",
        conflicts_with = "sun_hours",
        allow_negative_numbers = true
    )]
    label_shift: Option<f64>,
    /// With --weather: the ground has the mean albedo of the weather file, not the scene's
    #[arg(long, requires = "weather", conflicts_with = "sun_hours")]
    weather_albedo: bool,
    /// With --weather: what a map shows, a column of the table [default: da300_blinds_pct, without blinds da300_pct]
    #[arg(
        long,
        value_name = "COLUMN",
        requires = "weather",
        conflicts_with = "sun_hours"
    )]
    show: Option<String>,
    /// The hours of sun of each sensor of --grid on a day, clouds left out
    #[arg(long, value_name = "YYYY-MM-DD", requires = "grid", value_parser = date, conflicts_with_all = ["points", "time", "sun", "factor", "set"], conflicts_with_all = UNUSED)]
    pub sun_hours: Option<NaiveDate>,
    /// With --sun-hours: from this time of the local clock on
    #[arg(long, value_name = "HH:MM", requires = "sun_hours", value_parser = time, default_value = "00:00", conflicts_with = "weather")]
    from: NaiveTime,
    /// With --sun-hours: to this time of the local clock [default: midnight]
    #[arg(long, value_name = "HH:MM", requires = "sun_hours", value_parser = time, conflicts_with = "weather")]
    to: Option<NaiveTime>,
    /// With --sun-hours: how long a step is
    #[arg(long, value_name = "STEP", requires = "sun_hours", value_parser = step, default_value = "5min", conflicts_with = "weather")]
    every: u32,
    /// With --sun-hours: the sun counts from this height on, in degrees (EN 17037 has one for each place)
    #[arg(
        long,
        value_name = "DEG",
        requires = "sun_hours",
        conflicts_with = "weather",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    least_elevation: f64,
}

impl YearArgs {
    /// Whether anything of it is asked for.
    pub fn is_asked(&self) -> bool {
        !self.weather.is_empty() || self.sun_hours.is_some()
    }
}

fn date(text: &str) -> Result<NaiveDate, String> {
    let date = text.trim().parse();
    date.map_err(|_| "it is no date; write YYYY-MM-DD, as in 2026-03-21".into())
}

fn time(text: &str) -> Result<NaiveTime, String> {
    NaiveTime::parse_from_str(text, "%H:%M").map_err(|_| "write it like 07:30".into())
}

fn glazing(text: &str) -> Result<Glazing, String> {
    Glazing::parse(text).map_err(|e| format!("{}; {}", e.problem(), e.remedy()))
}

fn shard(text: &str) -> Result<Shard, String> {
    text.parse().map_err(|e: Error| e.remedy())
}

/// A step in seconds.
fn step(text: &str) -> Result<u32, String> {
    let step = place_time::step(text)?;
    let seconds = u32::try_from(step.num_seconds()).unwrap_or(0);
    match step == TimeDelta::seconds(seconds.into()) && (1..=3600).contains(&seconds) {
        true => Ok(seconds),
        false => Err("write whole seconds, 1s to 1h, as in 5min".into()),
    }
}

/// What the command's other flags say.
pub struct Asked<'a> {
    /// The scene.
    pub scene: &'a SceneArgs,
    /// Quality and knobs.
    pub plan: &'a PlanArgs,
    /// The grids.
    pub grids: &'a [GridSpec],
    /// Files to write.
    pub files: &'a [PathBuf],
    /// The scale of maps, if it is not to be found from the values.
    pub scale: Option<&'a Scale>,
    /// How the summary is printed.
    pub form: FormArgs,
}

fn no_page(file: &Path) -> Error {
    Error::input(
        format!("-o {}", file.display()),
        "there is no page of hours of sun",
        "write .csv, .json, .svg or .png",
    )
}

/// Runs what is asked for.
///
/// # Errors
/// Those of scenes, weather files, grids and of writing.
pub fn run(args: &YearArgs, asked: &Asked) -> Result<()> {
    let mut scene = asked.scene.load()?;
    let mut in_use = asked.scene.files(&scene);
    in_use.extend(args.weather.iter().map(|f| (f.clone(), "the weather file")));
    for file in asked.files {
        if Kind::of(file, true)? == Kind::Page && args.sun_hours.is_some() {
            return Err(no_page(file));
        }
    }
    if let Some(date) = args.sun_hours {
        for file in asked.files {
            daylight_files::claim(file, &mut in_use)?;
        }
        assumed::reflectances(&mut scene);
        return of_day(args, asked, scene, date);
    }
    let is_opening = |spec: &GridSpec| matches!(spec.on, On::Openings(_));
    if asked.grids.iter().any(is_opening) {
        return Err(Error::input(
            "--grid opening= with --weather",
            "points of openings face outward: sDA, ASE, UDI and EN 17037's illuminances are those of planes in rooms",
            "give --sun-hours with openings, or a grid over floors; surface= gives the light on glass",
        ));
    }
    let files: Result<Vec<(PathBuf, WeatherFile)>> = (args.weather.iter())
        .map(|path| Ok((path.clone(), WeatherFile::read(path)?)))
        .collect();
    let files = files?;
    let mut variants = variants(&files, &args.turn, &args.glazing)?;
    if let Some(shard) = args.shard {
        let all = variants.len();
        let mut places = 0..all;
        variants.retain(|_| {
            let place = places.next().unwrap_or(0);
            daylight_variants::shard_of(place, all, shard.of) == shard.number - 1
        });
        if variants.is_empty() {
            tell::line(
                "shard",
                "it has no variant: there are fewer of them than shards",
            );
        }
    }
    for variant in &variants {
        for file in asked.files.iter().chain(&args.hours) {
            daylight_files::claim(&variant.named(file), &mut in_use)?;
        }
        for file in asked.files {
            if Kind::of(file, true)? == Kind::Csv {
                daylight_files::claim(&figures_file(&variant.named(file)), &mut in_use)?;
            }
        }
    }
    assumed::reflectances(&mut scene);
    of_year(args, asked, scene, &variants)
}

/// The column of autonomy: where there are blinds it is with them.
fn autonomy(has_blinds: bool) -> &'static str {
    match has_blinds {
        true => "da300_blinds_pct",
        false => "da300_pct",
    }
}

/// Where the figures go that belong to a table of sensors.
fn figures_file(sensors: &Path) -> PathBuf {
    sensors.with_extension("figures.csv")
}

fn of_year(args: &YearArgs, asked: &Asked, mut scene: Scene, variants: &[Variant]) -> Result<()> {
    let mut stages = Vec::new();
    let mut begin = Instant::now();
    let mut done = |name: &str| {
        let seconds = begin.elapsed().as_secs_f64();
        stages.push((name.to_owned(), seconds));
        begin = Instant::now();
        seconds
    };
    let usual = autonomy(!scene.shades.is_empty());
    let show = args.show.as_deref().unwrap_or(usual);
    let column = ByPoint::NAMES.iter().position(|name| *name == show);
    let column = column.ok_or_else(|| {
        Error::input(
            format!("--show {show}"),
            "there is no such column",
            format!("the columns are {}", ByPoint::NAMES.join(", ")),
        )
    })?;
    let Some(Variant { file: first, .. }) = variants.first() else {
        if As::table_or(asked.form) == As::Json {
            stdout::print_json(&daylight_variants::json(&[]))?;
        }
        return Ok(());
    };
    if args.weather_albedo {
        let albedo = first.mean_albedo().filter(|_| args.weather.len() == 1);
        scene.ground.albedo = albedo.ok_or_else(|| {
            Error::input(
                "--weather-albedo",
                match args.weather.len() {
                    1 => format!("{} has no albedo", first.file),
                    _ => "weather files that are compared share one ground".into(),
                },
                "leave it out: the ground then has the scene's",
            )
        })?;
    }
    let turbidity = scene.sky.turbidity;
    let site = scene.site.clone();
    let overrules = asked.plan.overrules();
    // What is wrong with a glazing or a blind is said before the work begins.
    for glazing in &args.glazing {
        glazing.put(&mut scene.clone())?;
    }
    let model = |number: usize| -> Result<(Conditions, Blinds)> {
        let mut scene = scene.clone();
        if let Some(glazing) = args.glazing.get(number) {
            glazing.put(&mut scene)?;
        }
        let mut conditions = year::conditions(scene, &asked.scene.request(), first)?;
        let blinds = Blinds::new(&conditions.scene, &conditions.geometry)?;
        conditions.warnings.extend(blinds.warnings.iter().cloned());
        Ok((conditions, blinds))
    };
    // Sensors and views are those of the first glazing, whichever shard this is.
    let common = model(0)?;
    let conditions = &common.0;
    // Knobs that do not exist are told.
    Plan::new(conditions, &overrules)?;
    let sensors = Sensors::new(&conditions.scene, &conditions.geometry, asked.grids)?;
    tell::warnings(&conditions.warnings);
    crate::commands::daylight_grid::tell(&sensors);
    // Of each weather file once; orientations turn them.
    let mut hours_of: Vec<(&WeatherFile, Hours)> = Vec::new();
    for Variant { file, .. } in variants {
        if hours_of
            .iter()
            .any(|(other, _)| std::ptr::eq(*file, *other))
        {
            continue;
        }
        let north = conditions.scene.north_deg;
        let mut hours = Hours::new(file, north, turbidity, args.label_shift)?;
        hours.warnings.extend(year::elsewhere(site.as_ref(), file));
        tell::warnings(&hours.warnings);
        hours_of.push((*file, hours));
    }
    done("read");
    let fineness = Fineness {
        patches: args.patches,
        ..Fineness::new(overrules.quality, &overrules.set)
    };
    let views = tell::watched(None, |task| Views::new(conditions, &sensors, task))?;
    done("view out");
    let receivers = sensors.receivers();
    let areas: Vec<f64> = sensors.points.iter().map(|sensor| sensor.area).collect();
    let planes: Vec<usize> = sensors.points.iter().map(|sensor| sensor.plane).collect();
    let rooms = Rooms {
        sensors: &receivers,
        areas: &areas,
        planes: &planes,
    };
    let mut all = Vec::new();
    let mut common = Some(common);
    for number in 0..args.glazing.len().max(1) {
        let own = variants.iter().filter(|variant| variant.glazing == number);
        let own: Vec<&Variant> = own.collect();
        if own.is_empty() {
            continue;
        }
        let (conditions, blinds) = match common.take().filter(|_| number == 0) {
            Some(model) => model,
            None => model(number)?,
        };
        let year = tell::watched(None, |task| {
            Year::new(&conditions, receivers.clone(), &fineness, task)
        })?;
        done("coefficients");
        let factors = year.factors(16)?;
        if let Some(warning) = factor::no_daylight(factors.iter().copied()) {
            tell::warnings(&[warning]);
        }
        done("daylight factors");
        let mut operator = match blinds.is_empty() {
            true => None,
            false => Some(Operator::new(&blinds, &year, rooms, &fineness)?),
        };
        if let Some(operator) = &mut operator {
            operator.keeps = own.len() > 1;
        }
        for variant in own {
            let is_own = |(file, _): &&(&WeatherFile, Hours)| std::ptr::eq(*file, variant.file);
            let Some((_, hours)) = hours_of.iter().find(is_own) else {
                continue;
            };
            let hours = &hours.turned(variant.turn_deg);
            let file = variant.file;
            let clock = |hour: &tyndall::daylight::hours::Hour| {
                f64::from(hour.hour) - 0.5
                    + hours.clock_shift_h()
                    + f64::from(u8::from(file.is_summer(hour.date)))
            };
            let table = tell::watched(None, |task| year.table(hours, clock, task))?;
            let mut metrics = Metrics::new(&table, &factors).with_views(&views);
            if let Some(operator) = &mut operator {
                let operated = tell::watched(None, |task| operator.operate(hours, &table, task))?;
                metrics = metrics.with_blinds(&operated);
            }
            let mut inputs = Vec::new();
            if let Some(glazing) = args.glazing.get(number) {
                let said = glazing
                    .panes
                    .iter()
                    .map(|(name, t)| format!("{name} = {t}"));
                inputs.push(Line {
                    name: "glazing".into(),
                    value: said.collect::<Vec<_>>().join(", "),
                });
            }
            let quality = Line {
                name: "quality".into(),
                value: match overrules.set.is_empty() {
                    true => overrules.quality.name().into(),
                    false => format!("{}, {:?}", overrules.quality.name(), overrules.set),
                },
            };
            inputs.push(quality);
            let mut scene = Cow::Borrowed(&*conditions.scene);
            if variant.turn_deg != 0.0 {
                scene.to_mut().north_deg += variant.turn_deg;
            }
            let report = Report::new(Of {
                year: &year,
                sensors: &sensors,
                file,
                hours,
                north_deg: scene.north_deg,
                table: &table,
                metrics: &metrics,
                fineness: &fineness,
                inputs,
            });
            let seconds = done(format!("hours {}", variant.tag).trim_end());
            let made = Made {
                variant,
                scene: &scene,
                sensors: &sensors,
                table: &table,
                metrics: &metrics,
                report: &report,
            };
            let written = made.write(args, asked, column)?;
            done(format!("files {}", variant.tag).trim_end());
            if !written.is_empty() {
                tell::files(&written);
            }
            all.push(Done {
                tag: variant.tag.clone(),
                weather: file.name.clone(),
                north_deg: scene.north_deg,
                seconds,
                report,
            });
        }
    }
    match (all.as_slice(), As::table_or(asked.form)) {
        ([one], As::Csv) if one.tag.is_empty() => stdout::print(one.report.figures_csv(&[]))?,
        ([one], As::Json) if one.tag.is_empty() => stdout::print_json(&one.report)?,
        ([one], As::Table) if one.tag.is_empty() => stdout::print(figures(&one.report))?,
        (all, As::Csv) => stdout::print(daylight_variants::csv(all))?,
        (all, As::Json) => stdout::print_json(&daylight_variants::json(all))?,
        (all, As::Table) => stdout::print(daylight_variants::table(all))?,
    }
    tell::stages(&stages);
    Ok(())
}

/// A variant that is to be written.
struct Made<'a> {
    variant: &'a Variant<'a>,
    scene: &'a Scene,
    sensors: &'a Sensors,
    table: &'a Table,
    metrics: &'a Metrics,
    report: &'a Report,
}

impl Made<'_> {
    /// A map of a column.
    fn map(&self, column: usize, scale: Option<&Scale>) -> Drawing {
        let points = self.metrics.points.iter();
        let values: Vec<f64> = points.map(|p| p.values()[column]).collect();
        let scale = scale_of(ByPoint::NAMES[column], &values, scale);
        let caption = Caption {
            title: scale.title(),
            lines: vec![format!("weather: {}", self.variant.file.name)],
        };
        map::draw(self.scene, self.sensors, &values, &scale, &caption)
    }

    /// The maps of a page; where there are blinds autonomy is with them.
    fn maps(&self) -> Vec<Picture> {
        let usual = autonomy(!self.metrics.blinds.is_empty());
        let shown = [usual, "sun1000_h", "udi_300_3000_pct", "factor_pct"];
        let names = ByPoint::NAMES.iter().enumerate();
        let columns = shown.iter().flat_map(|shown| {
            let own = names.clone().find(|(_, name)| *name == shown);
            own.map(|(column, _)| column)
        });
        let picture = |column: usize| Picture {
            title: ByPoint::NAMES[column].into(),
            svg: self.map(column, None).svg(),
        };
        columns.map(picture).collect()
    }

    /// Writes the files that are asked for, maps of a column; which they are.
    fn write(&self, args: &YearArgs, asked: &Asked, column: usize) -> Result<Vec<PathBuf>> {
        let mut written = Vec::new();
        for path in asked.files {
            let own = self.variant.named(path);
            match Kind::of(path, true)? {
                Kind::Map => {
                    let name = ByPoint::NAMES[column];
                    if (self.metrics.points.iter()).all(|p| p.values()[column].is_nan()) {
                        return Err(Error::input(
                            format!("--show {name}"),
                            "it was not assessed: the figures say why",
                            "show another column",
                        ));
                    }
                    self.map(column, asked.scale).save(&own)?;
                }
                Kind::Csv => {
                    write(&own, &self.report.sensors_csv())?;
                    write(&figures_file(&own), &self.report.figures_csv(&[]))?;
                    written.push(figures_file(&own));
                }
                Kind::Raster => {
                    let of = |(at, name): (usize, &&str)| {
                        let values = self.metrics.points.iter().map(|p| p.values()[at]);
                        ((*name).to_owned(), values.collect())
                    };
                    let columns: Vec<_> = ByPoint::NAMES.iter().enumerate().map(of).collect();
                    raster::write(&own, self.sensors, &columns)?;
                }
                Kind::Json => output::report::write(&own, self.report)?,
                Kind::Page => write(&own, &page::html(self.report, &self.maps()))?,
            }
            written.push(own);
        }
        if let Some(path) = &args.hours {
            let own = self.variant.named(path);
            let file = self.variant.file;
            atomic::write(&own, |to| hours_csv(file, self.table, BufWriter::new(to)))?;
            written.push(own);
        }
        Ok(written)
    }
}

/// The scale of a column.
fn scale_of(column: &str, values: &[f64], given: Option<&Scale>) -> Scale {
    let (name, unit) = match column.rsplit_once('_') {
        Some((name, "pct")) => (name, "%"),
        Some((name, unit)) => (name, unit),
        None => (column, ""),
    };
    match given {
        Some(scale) => scale.clone().named(name, unit),
        None if unit == "%" && name != "factor" => Scale::new(name, unit, 0.0, 100.0)
            .unwrap_or_else(|_| Scale::of(name, unit, values.iter().copied())),
        // No hour of sun is a result like any other.
        None if unit == "h" => Scale::from_zero(name, unit, values.iter().copied()),
        None => Scale::of(name, unit, values.iter().copied()),
    }
}

fn write(path: &Path, text: &str) -> Result<()> {
    atomic::write(path, |file| file.write_all(text.as_bytes()))
}

/// The figures for people.
fn figures(report: &Report) -> String {
    let mut text = String::new();
    for room in &report.rooms {
        let name = tell::clean(&room.name);
        let _ = writeln!(
            text,
            "{name}: {} sensors, {:.2} m2",
            room.sensors, room.area
        );
        let width = room.figures.iter().map(|f| f.name.chars().count()).max();
        let width = width.unwrap_or(0);
        for figure in &room.figures {
            let value = figure.value.map_or("-".into(), page::shown);
            let _ = writeln!(
                text,
                "  {:width$}  {value:>7} {:<15} {}",
                figure.name, figure.unit, figure.verdict
            );
        }
    }
    text
}

fn of_day(args: &YearArgs, asked: &Asked, mut scene: Scene, date: NaiveDate) -> Result<()> {
    let Some(entry) = scene.site.clone() else {
        return Err(Error::input(
            "--sun-hours",
            "the scene has no place",
            "give --at LAT,LON, or [site] in the scene file",
        ));
    };
    let site = Site::new(entry.latitude_deg, entry.longitude_deg, entry.elevation)?;
    scene.sun = None;
    scene.time = Some(format!("{date}T12:00"));
    let request = asked.scene.request();
    let zone = request.timezone.as_deref().or(entry.timezone.as_deref());
    let zone = civil::zone_for(zone, &site, date)?;
    let origin = Camera::look_at(glam::DVec3::ZERO, glam::DVec3::NEG_Z, 1.0);
    let request = Request {
        camera: CameraChoice::Given(origin),
        ..request
    };
    let conditions = Conditions::new(scene, &request)?;
    tell::warnings(&conditions.warnings);
    let sensors = Sensors::new(&conditions.scene, &conditions.geometry, asked.grids)?;
    crate::commands::daylight_grid::tell(&sensors);
    let span = Span {
        from: args.from,
        to: args.to,
        step_s: args.every,
        least_elevation_deg: args.least_elevation,
        ..Span::of_day(date)
    };
    let receivers = sensors.receivers();
    let found = tell::watched(None, |task| {
        SunHours::new(&conditions, &receivers, &site, &zone, &span, task)
    })?;
    let report = day_report(&sensors, &found, &span, &conditions, zone.name());
    for path in asked.files {
        match Kind::of(path, true)? {
            Kind::Map => {
                let scale = scale_of("hours of sun_h", &found.hours, asked.scale);
                let caption = Caption {
                    title: format!("hours of sun on {date}"),
                    lines: vec!["clouds left out".into()],
                };
                map::draw(&conditions.scene, &sensors, &found.hours, &scale, &caption)
                    .save(path)?;
            }
            Kind::Csv => write(path, &day_csv(&sensors, &found))?,
            Kind::Raster => {
                raster::write(path, &sensors, &[("sun_h".into(), found.hours.clone())])?;
            }
            Kind::Json => output::report::write(path, &report)?,
            Kind::Page => return Err(no_page(path)),
        }
    }
    match As::table_or(asked.form) {
        As::Csv => stdout::print(day_csv(&sensors, &found))?,
        As::Json => stdout::print_json(&report)?,
        As::Table => stdout::print(day_table(&sensors, &found))?,
    }
    if !asked.files.is_empty() {
        tell::files(asked.files);
    }
    Ok(())
}

/// One row a sensor.
fn day_csv(sensors: &Sensors, found: &SunHours) -> String {
    let mut text = "room,x_m,y_m,z_m,nx,ny,nz,area_m2,sun_h,first,last\n".to_owned();
    for (i, sensor) in sensors.points.iter().enumerate() {
        let (p, n) = (sensor.receiver.position, sensor.receiver.normal);
        let ends = found.first_last[i].map_or([String::new(), String::new()], |ends| {
            ends.map(|end| end.format("%H:%M:%S").to_string())
        });
        let name = sensors.planes[sensor.plane].name.replace('"', "\"\"");
        let _ = writeln!(
            text,
            "\"{name}\",{},{},{},{},{},{},{},{},{},{}",
            // 0 has no sign.
            p.x + 0.0,
            p.y + 0.0,
            p.z + 0.0,
            n.x + 0.0,
            n.y + 0.0,
            n.z + 0.0,
            sensor.area,
            found.hours[i],
            ends[0],
            ends[1]
        );
    }
    text
}

/// Least, mean and greatest of each plane, and the share of it that has the hours of each level.
fn of_planes(sensors: &Sensors, found: &SunHours) -> Vec<(String, [f64; 6])> {
    let of = |(number, plane): (usize, &tyndall::daylight::grid::Plane)| {
        let own = sensors.points.iter().zip(&found.hours);
        let own: Vec<(f64, f64)> = own
            .filter(|(sensor, _)| sensor.plane == number)
            .map(|(sensor, hours)| (sensor.area, *hours))
            .collect();
        let whole: f64 = own.iter().map(|(area, _)| area).sum();
        let least = own.iter().map(|(_, h)| *h).fold(f64::INFINITY, f64::min);
        let most = own.iter().map(|(_, h)| *h).fold(0.0, f64::max);
        // The sum of nothing is -0.
        let mean = (0.0 + own.iter().map(|(area, h)| area * h).sum::<f64>()) / whole;
        let [a, b, c] = sun_hours::LEVELS.map(|(_, asked)| {
            let enough = own.iter().filter(|(_, h)| *h >= asked - 1e-9);
            100.0 * (0.0 + enough.map(|(area, _)| area).sum::<f64>()) / whole
        });
        (plane.name.clone(), [least, mean, most, a, b, c])
    };
    sensors.planes.iter().enumerate().map(of).collect()
}

fn day_table(sensors: &Sensors, found: &SunHours) -> String {
    let mut text = String::new();
    for (name, [least, mean, most, a, b, c]) in of_planes(sensors, found) {
        let _ = writeln!(
            text,
            "{}: {least:.2} to {most:.2} h of sun, mean {mean:.2} h; 1.5 h or more on {a:.0} %, 3 h on {b:.0} %, 4 h on {c:.0} % of the plane",
            tell::clean(&name)
        );
    }
    text
}

fn day_report(
    sensors: &Sensors,
    found: &SunHours,
    span: &Span,
    conditions: &Conditions,
    zone: Option<&str>,
) -> Value {
    let planes = of_planes(sensors, found).into_iter().map(|(name, v)| {
        json!({"name": name, "least_h": v[0], "mean_h": v[1], "greatest_h": v[2],
            "share_1_5h_pct": v[3], "share_3h_pct": v[4], "share_4h_pct": v[5]})
    });
    let points = sensors.points.iter().enumerate().map(|(i, sensor)| {
        json!({"room": sensors.planes[sensor.plane].name, "position": sensor.receiver.position,
            "normal": sensor.receiver.normal, "area_m2": sensor.area, "sun_h": found.hours[i],
            "first": found.first_last[i].map(|ends| ends[0].to_rfc3339()),
            "last": found.first_last[i].map(|ends| ends[1].to_rfc3339())})
    });
    json!({
        "schema": 1,
        "date": span.date.to_string(),
        "step_s": span.step_s,
        "least_elevation_deg": span.least_elevation_deg,
        "zone": zone,
        "method": "steps of the local clock whose sun's middle the sensor faces and sees; clouds are left out",
        "edition": "EN 17037:2018+A1:2021, not read in print",
        "warnings": conditions.warnings,
        "left_out": sensors.left_out,
        "assumptions": sensors.notes,
        "planes": planes.collect::<Vec<_>>(),
        "sensors": points.collect::<Vec<_>>(),
    })
}
