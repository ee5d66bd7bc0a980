//! Sensors: points on planes and surfaces of a scene, each with the area that it stands for.
//!
//! What a user asks for is a [`GridSpec`]; [`Sensors::new`] finds the planes that it means ([`super::floor`]), divides each into
//! cells, and puts a sensor into the middle of each cell that lies in the plane's outline. Sensors that stand in walls and furniture are
//! left out and counted ([`super::inside`]), and so are those in voids that no daylight comes to, of floors that were found: what is
//! named keeps them, and so do all floors of a scene with lamps. The order is by plane, and in each plane row by row.

use super::floor;
use super::inside::{self, Standing};
use super::opening;
use crate::conditions::Receiver;
use crate::error::{Error, Result};
use crate::scene::{Geometry, Scene};
use serde::Serialize;
use std::collections::{HashMap, HashSet};
use std::fmt;

pub use super::plane::{Plane, Sensor};
pub use super::spec::{GridSpec, On};

/// The most sensors of a scene: far more than a building of a thousand rooms has.
const MOST: usize = 4_000_000;

/// Sensors that are not there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// The plane's name.
    pub plane: String,
    /// How many.
    pub count: usize,
    /// The area that they would stand for [m2]; openings have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// Why: a phrase that follows "sensors".
    pub why: &'static str,
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} sensors", self.plane, self.count)?;
        if let Some(area) = self.area {
            let decimals = usize::from(area < 10.0);
            write!(f, " ({area:.decimals$} m2)")?;
        }
        write!(f, " left out: they {}", self.why)
    }
}

/// A plane, and all of its sensors with how they stand.
struct Looked {
    /// By number among the grids.
    grid: usize,
    plane: Plane,
    sensors: Vec<(Sensor, Standing)>,
    /// Whether they are looked at at all: the points of openings lie in walls.
    may_be_inside: bool,
}

/// The sensors of one or more grids.
#[derive(Debug, Clone, Default)]
pub struct Sensors {
    /// The sensors, by plane and row by row.
    pub points: Vec<Sensor>,
    /// The planes that they are on.
    pub planes: Vec<Plane>,
    /// Those that are not there, and why.
    pub left_out: Vec<LeftOut>,
    /// What else is to be said of them.
    pub notes: Vec<String>,
}

impl Sensors {
    /// The sensors of all grids, in their order.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that nothing has (with the nearest), where no floor is found, and where no sensor is left;
    /// [`Error::Domain`] for more than four million of them.
    pub fn new(scene: &Scene, geometry: &Geometry, specs: &[GridSpec]) -> Result<Self> {
        let mut sensors = Sensors::default();
        let mut all = Vec::new();
        let mut count = 0;
        // By grid.
        let mut left_out: Vec<Vec<LeftOut>> = Vec::new();
        for (grid, spec) in specs.iter().enumerate() {
            let before = sensors.left_out.len();
            let planes = match &spec.on {
                On::Openings(name) => sensors.openings(scene, geometry, name, spec)?,
                _ => floor::planes(scene, geometry, spec)?,
            };
            left_out.push(sensors.left_out[before..].to_vec());
            let may_be_inside = matches!(spec.on, On::Openings(_));
            for plane in planes {
                let sensors = looked_at(scene, geometry, &plane, may_be_inside, &mut count)?;
                all.push(Looked {
                    grid,
                    plane,
                    sensors,
                    may_be_inside,
                });
            }
        }
        // Where daylight comes to none, windows may be closed by opaque faces: voids cannot be told from rooms.
        let looked = all.iter().filter(|looked| !looked.may_be_inside);
        let standing: Vec<Standing> = looked
            .flat_map(|looked| looked.sensors.iter().map(|(_, standing)| *standing))
            .collect();
        let is_dark = !standing.is_empty() && !standing.contains(&Standing::Free);
        let has_lamps = scene.has_lamps();
        let mut numbers = vec![0; specs.len()];
        for looked in all {
            let before = sensors.points.len();
            let grid = looked.grid;
            // Lamps light rooms too, and who names a room means it.
            let keeps_dark = is_dark || has_lamps || specs[grid].on != On::Floors;
            let before_out = sensors.left_out.len();
            sensors.add(looked, keeps_dark);
            left_out[grid].extend_from_slice(&sensors.left_out[before_out..]);
            numbers[grid] += sensors.points.len() - before;
        }
        if let Some(empty) = numbers.iter().position(|count| *count == 0) {
            return Err(nothing_left(&specs[empty], &left_out[empty]));
        }
        if is_dark {
            sensors.notes.push(
                "no daylight comes to any of the sensors: make its windows glass by [[pane]] if their faces are opaque".into(),
            );
        }
        sensors.number_names();
        Ok(sensors)
    }

    /// All points as receivers, in their order.
    pub fn receivers(&self) -> Vec<Receiver> {
        self.points.iter().map(|sensor| sensor.receiver).collect()
    }

    /// The sum of the areas that sensors stand for [m2].
    pub fn area(&self) -> f64 {
        self.points.iter().map(|sensor| sensor.area).sum()
    }

    /// The planes of openings; what panes are none is noted.
    fn openings(
        &mut self,
        scene: &Scene,
        geometry: &Geometry,
        name: &str,
        spec: &GridSpec,
    ) -> Result<Vec<Plane>> {
        let found = opening::openings(scene, geometry, name, spec)?;
        let left_out = found.left_out.into_iter().map(|(count, why)| LeftOut {
            plane: format!("openings of {name}"),
            count,
            area: None,
            why,
        });
        self.left_out.extend(left_out);
        self.notes
            .push("openings: reference points by EN 17037:2018, annex D, told from memory".into());
        if !found.without_floor.is_empty() {
            self.notes.push(format!(
                "no floor and no ground is found below {}: the point lies 0.3 m above the sill, however high that is",
                found.without_floor.join(", ")
            ));
        }
        Ok(found.planes)
    }

    /// Adds a plane with those of its sensors that stand well; those that are closed in too if it `keeps_dark` ones.
    fn add(&mut self, looked: Looked, keeps_dark: bool) {
        let Looked { plane, sensors, .. } = looked;
        let is_kept = |standing: Standing| {
            standing == Standing::Free || keeps_dark && standing == Standing::ClosedIn
        };
        for why in [Standing::InSolid, Standing::Outside, Standing::ClosedIn] {
            let out = sensors.iter().filter(|(_, s)| *s == why && !is_kept(*s));
            let areas: Vec<f64> = out.map(|(sensor, _)| sensor.area).collect();
            if !areas.is_empty() {
                self.left_out.push(LeftOut {
                    plane: plane.name.clone(),
                    count: areas.len(),
                    area: Some(areas.iter().sum()),
                    why: why.phrase(),
                });
            }
        }
        let number = self.planes.len();
        let before = self.points.len();
        let kept = sensors
            .into_iter()
            .filter(|(_, standing)| is_kept(*standing));
        self.points.extend(kept.map(|(sensor, _)| Sensor {
            plane: number,
            ..sensor
        }));
        // A plane without sensors shows nothing.
        if self.points.len() > before {
            self.planes.push(plane);
        }
    }

    /// Planes of one name get numbers, none of which is another's name.
    fn number_names(&mut self) {
        let names: Vec<String> = self.planes.iter().map(|p| p.name.clone()).collect();
        let mut taken: HashSet<String> = names.iter().cloned().collect();
        let mut numbers: HashMap<&str, usize> = HashMap::new();
        for (plane, name) in self.planes.iter_mut().zip(&names) {
            if names.iter().filter(|other| *other == name).count() == 1 {
                continue;
            }
            let number = numbers.entry(name.as_str()).or_insert(0);
            plane.name = loop {
                *number += 1;
                let numbered = format!("{name} {number}");
                if taken.insert(numbered.clone()) {
                    break numbered;
                }
            };
        }
    }
}

/// The sensors of a plane, and how they stand; adds their number to that of all.
fn looked_at(
    scene: &Scene,
    geometry: &Geometry,
    plane: &Plane,
    may_be_inside: bool,
    all: &mut usize,
) -> Result<Vec<(Sensor, Standing)>> {
    let [columns, rows] = plane.cells;
    let count = columns as usize * rows as usize;
    if all.saturating_add(count) > MOST {
        return Err(Error::domain(
            "the number of sensors of all planes",
            all.saturating_add(count),
            format!("at most {MOST}"),
            "choose a wider spacing",
        ));
    }
    let normal = plane.normal();
    let mut points = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let cell = plane.cell([column, row]);
            let middle = 0.5 * (cell[0] + cell[2]);
            if !plane.outline.contains(middle) {
                continue;
            }
            let area = plane.outline.in_box(cell[0], cell[2]).area();
            points.push(Sensor {
                receiver: Receiver::new(plane.at(middle), normal)?,
                area,
                plane: 0,
                cell: [column, row],
            });
        }
    }
    *all += points.len();
    let standing = match may_be_inside {
        true => vec![Standing::Free; points.len()],
        false => inside::standing(scene, geometry, plane, &points),
    };
    Ok(points.into_iter().zip(standing).collect())
}

/// The error where a grid has no sensor.
fn nothing_left(spec: &GridSpec, left_out: &[LeftOut]) -> Error {
    let of = match &spec.on {
        On::Floors => "the floors".to_owned(),
        On::Room(name) | On::Floor(name) | On::Surface(name) | On::Openings(name) => {
            format!("`{name}`")
        }
    };
    let said: Vec<String> = left_out
        .iter()
        .map(|l| format!("{} {}", l.count, l.why))
        .collect();
    let problem = match said.is_empty() {
        true => format!("no sensor finds room on {of}"),
        false => format!("no sensor is left on {of} ({})", said.join(", ")),
    };
    Error::input(
        "--grid",
        problem,
        "choose a smaller inset or spacing, or another height (plane=)",
    )
}
