//! What is told of a year: inputs, figures with their methods, sensors, and what was assumed.
//!
//! A page, a table and a file of numbers are made of the same [`Report`], so that each figure of one is in the others.

use super::epw::WeatherFile;
use super::factor::no_daylight;
use super::figures::Figure;
use super::grid::Sensors;
use super::hours::{Hours, ShiftFrom};
use super::metrics::{ByPoint, Metrics};
use super::table::Table;
use super::year::{Fineness, Year};
use crate::colour::{Space, luminance};
use crate::scene::Scene;
use glam::DVec3;
use serde::Serialize;
use std::fmt::Write as _;
use std::io;

/// An input: what it is, and what it was.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// What it is.
    pub name: String,
    /// What it was.
    pub value: String,
}

/// A material of the scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Surface {
    /// Its name.
    pub name: String,
    /// The luminance of its base colour [1]: its reflectance, where no picture lies on it.
    pub reflectance: f64,
    /// What a pane lets through at normal incidence, as luminance [1].
    pub transmittance: Option<f64>,
}

/// A room, floor or surface with its figures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Room {
    /// Its name.
    pub name: String,
    /// Its sensors.
    pub sensors: usize,
    /// The area that they stand for [m2].
    pub area: f64,
    /// The figures.
    pub figures: Vec<Figure>,
}

/// A sensor with what it has.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OfSensor {
    /// The room's name.
    pub room: String,
    /// Where it is [m], scene axes.
    pub position: DVec3,
    /// The side that receives.
    pub normal: DVec3,
    /// The area that it stands for [m2].
    pub area: f64,
    /// Its metrics.
    #[serde(flatten)]
    pub metrics: ByPoint,
}

/// All that is told of a year.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The form of this report.
    pub schema: u32,
    /// The program with its version.
    pub program: String,
    /// What went in.
    pub inputs: Vec<Line>,
    /// The header of the weather file as it stands.
    pub weather_header: Vec<String>,
    /// The materials.
    pub materials: Vec<Surface>,
    /// The rooms.
    pub rooms: Vec<Room>,
    /// What was assumed.
    pub assumptions: Vec<String>,
    /// What is doubtful.
    pub warnings: Vec<String>,
    /// The mean over all sensors in each hour of the year [lx], from 1 January, standard time.
    pub hourly_mean_lx: Vec<f64>,
    /// The sensors.
    pub sensors: Vec<OfSensor>,
}

/// What a report is made of.
pub struct Of<'a> {
    /// The scene's sensors in a year.
    pub year: &'a Year,
    /// Where they are.
    pub sensors: &'a Sensors,
    /// The weather.
    pub file: &'a WeatherFile,
    /// Its lit hours.
    pub hours: &'a Hours,
    /// The azimuth that the scene's -Z axis faces then [degrees].
    pub north_deg: f64,
    /// The illuminances.
    pub table: &'a Table,
    /// The metrics.
    pub metrics: &'a Metrics,
    /// How finely it was found.
    pub fineness: &'a Fineness,
    /// Inputs that come first: flags, quality.
    pub inputs: Vec<Line>,
}

impl Report {
    /// Makes one.
    pub fn new(of: Of<'_>) -> Self {
        let Of {
            year,
            sensors,
            file,
            hours,
            north_deg,
            table,
            metrics,
            fineness,
            mut inputs,
        } = of;
        let conditions = year.conditions();
        let scene = &conditions.scene;
        let areas: Vec<f64> = sensors.points.iter().map(|sensor| sensor.area).collect();
        let mut rooms: Vec<Room> = sensors
            .planes
            .iter()
            .enumerate()
            .map(|(number, plane)| {
                let of_plane = |i: &usize| sensors.points[*i].plane == number;
                let points: Vec<usize> = (0..sensors.points.len()).filter(of_plane).collect();
                room(&plane.name, &points, &areas, metrics)
            })
            .collect();
        if rooms.len() > 1 {
            let all: Vec<usize> = (0..areas.len()).collect();
            rooms.push(room("all", &all, &areas, metrics));
        }
        let mut line = |name: &str, value: String| {
            inputs.push(Line {
                name: name.into(),
                value,
            });
        };
        line("scene", scene.name.clone());
        line(
            "place",
            format!(
                "{}, {} ({} m above sea level), of the weather file: {}",
                angle(file.latitude_deg, "N", "S"),
                angle(file.longitude_deg, "E", "W"),
                file.elevation,
                file.name
            ),
        );
        line(
            "north",
            format!("the scene's -Z axis faces {north_deg} degrees from north through east"),
        );
        line("weather file", file.file.clone());
        line(
            "standard time",
            format!("{:+} h from Greenwich", file.zone_h),
        );
        line(
            "sun against labels",
            format!(
                "{:+.2} h: the sun is taken so much later than the middle of the labelled hour; {}",
                hours.shift_h,
                match hours.shift_from {
                    ShiftFrom::Given => "given by the user",
                    ShiftFrom::Found => "found from the irradiance",
                    ShiftFrom::NotFound =>
                        "not found, as there is too little irradiance: the labels are trusted",
                }
            ),
        );
        line(
            "ground's albedo",
            match conditions.ground {
                Some(ground) => format!("{:.2}", luminance(ground.albedo)),
                None => "there is no ground".into(),
            },
        );
        line(
            "sky",
            format!(
                "{} patches of Reinhart's division",
                144 * fineness.patches.pow(2) + 1
            ),
        );
        line(
            "surfaces",
            format!(
                "{} patches give light to sensors; at most {} in all, size {} of what they are part of",
                year.coefficients().patches(),
                fineness.detail.patches,
                fineness.detail.patch
            ),
        );
        for shade in &scene.shades {
            line(
                "blinds",
                format!(
                    "{}: closed they scatter {} of the light, let {} straight through and reflect {}",
                    shade.name(),
                    shade.transmittance,
                    shade.openness,
                    shade.reflectance
                ),
            );
        }
        let mut hourly_mean_lx = vec![0.0; table.hours];
        for (stamp, mean) in table.stamps.iter().zip(table.means(&areas)) {
            hourly_mean_lx[stamp.number] = mean;
        }
        let of_sensor = |(i, sensor): (usize, &super::grid::Sensor)| OfSensor {
            room: sensors.planes[sensor.plane].name.clone(),
            position: sensor.receiver.position,
            normal: sensor.receiver.normal,
            area: sensor.area,
            metrics: metrics.points[i],
        };
        let mut warnings: Vec<String> = hours.warnings.iter().map(ToString::to_string).collect();
        warnings.extend(conditions.warnings.iter().map(ToString::to_string));
        let dark = no_daylight(metrics.points.iter().map(|point| point.factor_pct));
        warnings.extend(dark.map(|warning| warning.to_string()));
        warnings.extend(sensors.left_out.iter().map(ToString::to_string));
        let spacing = sensors
            .planes
            .iter()
            .flat_map(|plane| plane.step)
            .fold(0.0, f64::max);
        if spacing > 0.6 + 1e-9 {
            warnings.push(format!(
                "sensors are {spacing:.2} m apart: LM-83 asks for at most 0.6 m, so sDA and ASE are not by its rules"
            ));
        }
        Report {
            schema: 1,
            program: format!("tyndall {}", env!("CARGO_PKG_VERSION")),
            inputs,
            weather_header: file.header.clone(),
            materials: materials(scene),
            rooms,
            assumptions: assumptions(file, hours, scene),
            warnings,
            hourly_mean_lx,
            sensors: sensors.points.iter().enumerate().map(of_sensor).collect(),
        }
    }

    /// The figures of all rooms as CSV; behind columns of the same value in each row, by name.
    pub fn figures_csv(&self, before: &[(&str, &str)]) -> String {
        let mut text = String::new();
        for (name, _) in before {
            let _ = write!(text, "{},", quoted(name));
        }
        text += "room,key,name,value,unit,verdict,method,edition\n";
        for room in &self.rooms {
            for figure in &room.figures {
                let value = figure
                    .value
                    .map_or(String::new(), |value| value.to_string());
                let cells = [
                    &room.name,
                    &figure.key,
                    &figure.name,
                    &value,
                    figure.unit,
                    &figure.verdict,
                    &figure.method,
                    figure.edition,
                ];
                let before = before.iter().map(|(_, value)| quoted(value));
                let cells: Vec<String> = before
                    .chain(cells.iter().map(|cell| quoted(cell)))
                    .collect();
                let _ = writeln!(text, "{}", cells.join(","));
            }
        }
        text
    }

    /// The sensors as CSV, units in the names.
    pub fn sensors_csv(&self) -> String {
        let mut text = format!(
            "room,x_m,y_m,z_m,nx,ny,nz,area_m2,{}\n",
            ByPoint::NAMES.join(",")
        );
        for sensor in &self.sensors {
            let places = sensor
                .position
                .to_array()
                .into_iter()
                .chain(sensor.normal.to_array());
            let numbers = places.chain([sensor.area]).chain(sensor.metrics.values());
            let cells: Vec<String> = std::iter::once(quoted(&sensor.room))
                // 0 has no sign.
                .chain(numbers.map(|number| match number.is_nan() {
                    true => String::new(),
                    false => (number + 0.0).to_string(),
                }))
                .collect();
            let _ = writeln!(text, "{}", cells.join(","));
        }
        text
    }
}

/// Writes the hourly table as CSV: a row an hour of the year, standard time, a column a sensor [lx].
///
/// # Errors
/// Those of writing.
pub fn hours_csv(file: &WeatherFile, table: &Table, mut to: impl io::Write) -> io::Result<()> {
    let names: Vec<String> = (0..table.points)
        .map(|i| format!("sensor_{i}_lx"))
        .collect();
    writeln!(to, "month,day,hour,open_diffuse_lx,{}", names.join(","))?;
    let mut lit = table.stamps.iter().enumerate().peekable();
    for (number, row) in file.rows.iter().enumerate() {
        write!(to, "{},{},{}", row.date.month, row.date.day, row.hour)?;
        match lit.next_if(|(_, stamp)| stamp.number == number) {
            Some((hour, stamp)) => {
                write!(to, ",{:.1}", stamp.diffuse)?;
                for lux in table.row(hour) {
                    write!(to, ",{lux:.1}")?;
                }
            }
            None => (0..=table.points).try_for_each(|_| write!(to, ",0"))?,
        }
        writeln!(to)?;
    }
    to.flush()
}

fn room(name: &str, points: &[usize], areas: &[f64], metrics: &Metrics) -> Room {
    Room {
        name: name.into(),
        sensors: points.len(),
        area: points.iter().map(|i| areas[*i]).sum(),
        figures: metrics.figures(points, areas),
    }
}

fn materials(scene: &Scene) -> Vec<Surface> {
    let to_working = Space::Rec709.to_working();
    let used: std::collections::BTreeSet<u32> =
        scene.mesh.triangles.iter().map(|t| t.material).collect();
    let of = |number: &u32| {
        let material = scene.materials.get(*number as usize)?;
        Some(Surface {
            name: material.name.clone(),
            reflectance: luminance(to_working * material.base_color),
            transmittance: material.pane.as_ref().map(|pane| {
                let tint = if pane.is_tinted {
                    material.base_color
                } else {
                    DVec3::ONE
                };
                luminance(to_working * (pane.transmittance * tint))
            }),
        })
    };
    used.iter().filter_map(of).collect()
}

fn assumptions(file: &WeatherFile, hours: &Hours, scene: &Scene) -> Vec<String> {
    let clock = match file.summer {
        Some([from, to]) => format!(
            "Occupied hours are 8 to 18 o'clock by the local clock, with summer time from {}/{} to {}/{} as the weather file says.",
            from.month, from.day, to.month, to.day
        ),
        None => "Occupied hours are 8 to 18 o'clock in standard time all the year: the weather file names no summer time.".into(),
    };
    let labels = match hours.clock_shift_h() {
        0.0 => "Which hours are occupied goes by the labels of the weather file: they are off by less than half an hour.".into(),
        shift => format!(
            "Which hours are occupied goes by the labels of the weather file, {shift:+.2} h: by so much they are off."
        ),
    };
    vec![
        "The sky of each hour is that of Perez et al. 1993 by the direct normal and diffuse horizontal irradiance of the weather file, \
         with the luminous efficacies of Perez et al. 1990 and 2 cm of water in the air. Illuminance columns are not used."
            .into(),
        "An hour has one sky and one sun, in the middle of the part of the hour in which it is up.".into(),
        "Surfaces are matt. Glass lets light straight through, by its angle, and reflects none.".into(),
        match scene.shades.is_empty() {
            true => "There are no blinds: none are operated, as LM-83 asks for sDA.".into(),
            false => "Blinds are closed in sDA alone; in all other figures they are open. A closed blind scatters the light that it lets \
                 through evenly to all sides, without the glass's colour, and what goes out through it is lost."
                .into(),
        },
        clock,
        labels,
        "Lamps give no light. Rooms are empty of people, and glass is clean.".into(),
    ]
}

fn angle(degrees: f64, positive: &str, negative: &str) -> String {
    let side = if degrees < 0.0 { negative } else { positive };
    format!("{:.4} degrees {side}", degrees.abs())
}

/// A cell of a CSV.
fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}
