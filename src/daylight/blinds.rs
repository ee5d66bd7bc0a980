//! Blinds that are operated: closed by window groups in hours with too much sun, as LM-83 asks for its autonomy.
//!
//! In an occupied hour a group of windows ([`WindowShade`]) is closed while more than 2 % of the plane of any room get 1 000 lx or more
//! of direct sun through that group, with all groups open: the sun that sensors lose where something opaque hangs behind its panes. Groups
//! go by themselves (IES LM-83-12, 2.2.6, as guides tell it: not read in print. LightStanza's of 2016, "Blinds operations", has both "2 % or more" and "up to
//! 2 %" left open). Points count by the area that they stand for.
//!
//! Light through a blind is light like any other, so that nothing is scaled: for each set of closed groups that occurs who sees whom is
//! found anew, with the blinds as surfaces right behind the innermost panes. They stop light but for their openness, reflect on both
//! sides, and shine into the room: with E the illuminance of the back of one of their patches, behind the glass, by sun, sky, ground
//! and other blinds, its front has the exitance tau E and sends it as matt surfaces do. That is exact for light between groups too. Light
//! that goes out through a closed blind is lost; of a glass's colour nothing is left behind it.

use super::direct_sun::DirectSun;
use super::hours::{Hour, Hours};
use super::opening::{Sheet, sheets};
use super::table::Table;
use super::year::{Fineness, Year};
use crate::colour::luminance;
use crate::conditions::{Conditions, Receiver, View};
use crate::error::{Error, Result};
use crate::memory;
use crate::scene::disc::DiscWork;
use crate::scene::{AlphaMode, Geometry, Material, Scene, Triangle, WindowShade};
use crate::task::Task;
use crate::warning::Warning;
use glam::{DVec2, DVec3, DVec4};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// Direct sun that closes a group [lx], and on how much more than this share of a plane (LM-83).
pub const CLOSES: (f64, f64) = (1000.0, 0.02);

/// How far behind its pane a blind hangs, over the scene's extent [1]: next to nothing, and told apart from the wall's plane.
const BEHIND: f64 = 1e-6;

/// Light goes to and fro between blinds so often at most.
const TURNS: usize = 16;

/// It is followed until it changes by less than this share [1].
const ENOUGH: f64 = 1e-4;

/// A set of closed groups: one bit each.
type Closed = u32;

/// A group of windows and where its blind hangs.
struct Group {
    shade: WindowShade,
    /// Triangles whose fronts show inward, on the panes.
    places: Vec<[DVec3; 3]>,
    /// Unit normals outward, one for each.
    outward: Vec<DVec3>,
}

/// The blinds of a scene.
pub struct Blinds {
    groups: Vec<Group>,
    /// How far behind its pane a blind hangs [m].
    lift: f64,
    /// The materials of outer panes that are in no group, where there are groups: they stay open.
    pub open: Vec<String>,
    /// What hangs nowhere.
    pub warnings: Vec<Warning>,
}

impl Blinds {
    /// Finds where the blinds of a scene hang: behind the innermost panes of each opening of their group.
    ///
    /// # Errors
    /// [`Error::Input`] for a group none of whose panes leads outside.
    pub fn new(scene: &Scene, geometry: &Geometry) -> Result<Self> {
        let mut blinds = Blinds {
            groups: Vec::new(),
            lift: BEHIND * geometry.extent(),
            open: Vec::new(),
            warnings: Vec::new(),
        };
        let mut grouped: HashSet<u32> = HashSet::new();
        let mut shaded: Vec<Sheet> = Vec::new();
        for shade in &scene.shades {
            let panes = shade
                .windows
                .iter()
                .flat_map(|name| scene.panes_named(name));
            let panes: Vec<u32> = panes.collect();
            grouped.extend(panes.iter().copied());
            let (found, inner) = sheets(scene, geometry, &panes);
            if found.is_empty() {
                return Err(Error::input(
                    format!("[[shade]] {}", shade.name()),
                    "none of its panes leads outside: no sky is free on either side",
                    "name the panes of outer windows, or leave the table out",
                ));
            }
            if inner > 0 {
                blinds.warnings.push(Warning::Mended {
                    problem: format!(
                        "[[shade]] {}: {inner} panes have no free sky on either side",
                        shade.name()
                    ),
                    instead: "no blind hangs there".into(),
                });
            }
            let is_inmost = |sheet: &&Sheet| {
                let is_behind = |other: &Sheet| {
                    let inward = (sheet.centre - other.centre).dot(sheet.outward);
                    sheet.is_over(other) && inward > 1e-9
                };
                !found.iter().any(is_behind)
            };
            let mut group = Group {
                shade: shade.clone(),
                places: Vec::new(),
                outward: Vec::new(),
            };
            for sheet in found.iter().filter(is_inmost) {
                for triangle in &sheet.triangles {
                    let [a, b, c] = scene.mesh.corners(*triangle);
                    let is_inward = (b - a).cross(c - a).dot(sheet.outward) < 0.0;
                    group.places.push(match is_inward {
                        true => [a, b, c],
                        false => [a, c, b],
                    });
                    group.outward.push(sheet.outward);
                }
            }
            blinds.groups.push(group);
            shaded.extend(found);
        }
        if let Some(panes) = geometry.panes().filter(|_| !blinds.is_empty()) {
            let others = panes.triangles().iter().copied();
            let others: Vec<u32> = others.filter(|pane| !grouped.contains(pane)).collect();
            let (others, _) = sheets(scene, geometry, &others);
            // Another pane of a window with a blind is shaded too.
            let is_open = |sheet: &&Sheet| !shaded.iter().any(|own: &Sheet| own.is_over(sheet));
            for sheet in others.iter().filter(is_open) {
                let first = scene.mesh.triangles[sheet.triangles[0] as usize];
                let name = &scene.materials[first.material as usize].name;
                if !blinds.open.contains(name) {
                    blinds.open.push(name.clone());
                }
            }
        }
        Ok(blinds)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// A scene in which the blinds of some groups hang, its triangles that are theirs, and the group of each of these. `solid`: they stop
    /// all light.
    fn hung(&self, scene: &Scene, closed: Closed, solid: bool) -> (Scene, Range<u32>, Vec<usize>) {
        let mut scene = scene.clone();
        let first = scene.mesh.triangles.len() as u32;
        let mut group_of = Vec::new();
        for (number, group) in self.groups.iter().enumerate() {
            let openness = if solid { 0.0 } else { group.shade.openness };
            if closed & (1 << number) == 0 || openness >= 1.0 {
                continue;
            }
            let material = scene.materials.len() as u32;
            // Of a surface with holes the shares are those of what is there.
            let reflectance = (group.shade.reflectance / (1.0 - openness)).min(1.0);
            let mut fabric = Material::of("closed blind", DVec3::splat(reflectance));
            if openness > 0.0 {
                fabric.alpha = 1.0 - openness;
                fabric.alpha_mode = AlphaMode::Blend;
            }
            scene.materials.push(fabric);
            for (corners, outward) in group.places.iter().zip(&group.outward) {
                let mesh = &mut scene.mesh;
                let vertex = mesh.positions.len() as u32;
                (mesh.positions).extend(corners.map(|p| p - self.lift * outward));
                mesh.normals.extend([DVec3::ZERO; 3]);
                mesh.uvs.extend([DVec2::ZERO; 3]);
                if !mesh.colors.is_empty() {
                    mesh.colors.extend([DVec4::ONE; 3]);
                }
                mesh.triangles.push(Triangle {
                    vertices: [vertex, vertex + 1, vertex + 2],
                    material,
                });
                group_of.push(number);
            }
        }
        let last = scene.mesh.triangles.len() as u32;
        (scene, first..last, group_of)
    }
}

/// Sensors with the area and the plane of each.
#[derive(Clone, Copy)]
pub struct Rooms<'a> {
    /// The sensors, in the order of the table.
    pub sensors: &'a [Receiver],
    /// The area that each stands for [m2].
    pub areas: &'a [f64],
    /// The plane that each is on, from 0.
    pub planes: &'a [usize],
}

/// The hours of a year in which blinds are operated.
pub struct Operated {
    /// The table of the year, with blinds in occupied hours.
    pub table: Table,
    /// Of each group its name, and for each lit hour of the table whether it is closed then.
    pub groups: Vec<(String, Vec<bool>)>,
    /// The materials of outer panes without blinds.
    pub open: Vec<String>,
}

impl Operated {
    /// Occupied hours in which a group is closed.
    pub fn hours(&self, group: usize) -> usize {
        let closed = self.groups[group].1.iter();
        closed.filter(|is_closed| **is_closed).count()
    }
}

/// Blinds at work: what was found for a set of closed groups serves other years of the same model too.
pub struct Operator<'a> {
    /// Whether that is kept for them: memory for each set that occurs.
    pub keeps: bool,
    blinds: &'a Blinds,
    year: &'a Year,
    rooms: Rooms<'a>,
    fineness: &'a Fineness,
    /// The scene with each group alone behind something that stops all light.
    without: Vec<Conditions>,
    closed: BTreeMap<Closed, Shaded>,
}

/// A scene with some groups closed.
struct Shaded {
    year: Year,
    /// What of the illuminance of its back each shining patch has as exitance [1].
    sent: Vec<f64>,
}

impl<'a> Operator<'a> {
    /// Prepares them for the sensors of a year.
    ///
    /// # Errors
    /// Those of [`Conditions::new`].
    pub fn new(
        blinds: &'a Blinds,
        year: &'a Year,
        rooms: Rooms<'a>,
        fineness: &'a Fineness,
    ) -> Result<Self> {
        let base = year.conditions();
        let without = (0..blinds.groups.len()).map(|group| {
            let (scene, ..) = blinds.hung(&base.scene, 1 << group, true);
            let conditions = Conditions::new(scene, base.request())?;
            conditions.seen_from(View::of_points(rooms.sensors))
        });
        Ok(Operator {
            keeps: true,
            without: without.collect::<Result<_>>()?,
            blinds,
            year,
            rooms,
            fineness,
            closed: BTreeMap::new(),
        })
    }

    /// The table of a year's hours, made without blinds, with them.
    ///
    /// # Errors
    /// Those of [`Year::new`].
    pub fn operate(&mut self, hours: &Hours, table: &Table, task: Task<'_>) -> Result<Operated> {
        memory::check(
            "the table of hours with blinds",
            4 * table.total.len() as u64,
        )?;
        let pieces = task.stage("sun through windows").pieces(hours.lit.len());
        let states: Result<Vec<Closed>> = (0..hours.lit.len())
            .into_par_iter()
            .map(|number| {
                pieces.begin()?;
                Ok(match table.stamps[number].is_occupied() {
                    true => self.closed_in(&hours.lit[number], number, table),
                    false => 0,
                })
            })
            .collect();
        let states = states?;
        let mut by_state: BTreeMap<Closed, Vec<usize>> = BTreeMap::new();
        for (number, state) in states.iter().enumerate().filter(|(_, state)| **state != 0) {
            by_state.entry(*state).or_default().push(number);
        }
        let mut with = table.clone();
        let of = by_state.len();
        for (turn, (state, numbers)) in (1..).zip(by_state) {
            let task = task.turn(turn, of);
            self.prepare(state, task)?;
            let Some(shaded) = self.closed.get(&state) else {
                continue;
            };
            let points = table.points;
            let pieces = task.stage("hours with blinds").pieces(numbers.len());
            let rows: Result<Vec<Vec<f32>>> = numbers
                .par_iter()
                .map(|number| {
                    pieces.begin()?;
                    let row = shaded.hour(&hours.lit[*number], points);
                    Ok(row.into_iter().map(|e| e as f32).collect())
                })
                .collect();
            for (number, row) in numbers.iter().zip(rows?) {
                with.total[number * points..(number + 1) * points].copy_from_slice(&row);
            }
            if !self.keeps {
                self.closed.remove(&state);
            }
        }
        let groups = self.blinds.groups.iter().enumerate().map(|(bit, group)| {
            let closed = states.iter().map(|state| state & (1 << bit) != 0);
            (group.shade.name(), closed.collect())
        });
        Ok(Operated {
            table: with,
            groups: groups.collect(),
            open: self.blinds.open.clone(),
        })
    }

    /// The groups that are closed in an hour.
    fn closed_in(&self, hour: &Hour, number: usize, table: &Table) -> Closed {
        let (least, _) = CLOSES;
        let sun = |sensor: usize| table.sun_at(number, sensor);
        if !is_too_much(&self.rooms, |sensor| sun(sensor) >= least) {
            return 0;
        }
        let mut closed = 0;
        for (bit, conditions) in self.without.iter().enumerate() {
            let mut now = conditions.clone();
            now.sun = hour.sun;
            now.sky = Some(hour.sky.clone());
            let Some(direct) = DirectSun::new(&now) else {
                continue;
            };
            let mut work = DiscWork::default();
            let mut through = vec![false; self.rooms.sensors.len()];
            for (sensor, through) in through.iter_mut().enumerate() {
                if sun(sensor) >= least {
                    let rest = luminance(direct.on(&self.rooms.sensors[sensor], &mut work));
                    *through = sun(sensor) - rest >= least;
                }
            }
            if is_too_much(&self.rooms, |sensor| through[sensor]) {
                closed |= 1 << bit;
            }
        }
        closed
    }

    /// Finds who sees whom with some groups closed, unless that is known.
    fn prepare(&mut self, state: Closed, task: Task<'_>) -> Result<()> {
        if self.closed.contains_key(&state) {
            return Ok(());
        }
        let base = self.year.conditions();
        let (scene, own, group_of) = self.blinds.hung(&base.scene, state, false);
        let conditions = Conditions::new(scene, base.request())?;
        let sensors: Arc<[Receiver]> = self.rooms.sensors.into();
        let year = Year::shining(&conditions, sensors, own.clone(), self.fineness, task)?;
        let sent = year.shining_triangles().iter().map(|triangle| {
            let shade = &self.blinds.groups[group_of[(triangle - own.start) as usize]].shade;
            // What is there of a surface with holes sends all of it.
            shade.transmittance / (1.0 - shade.openness)
        });
        let shaded = Shaded {
            sent: sent.collect(),
            year,
        };
        self.closed.insert(state, shaded);
        Ok(())
    }
}

/// Whether more of the plane of any room than may be is sunny.
fn is_too_much(rooms: &Rooms<'_>, is_sunny: impl Fn(usize) -> bool) -> bool {
    let (_, share) = CLOSES;
    let planes = rooms.planes.iter().max().map_or(0, |last| last + 1);
    let mut parts = vec![[0.0f64; 2]; planes];
    for (sensor, (plane, area)) in rooms.planes.iter().zip(rooms.areas).enumerate() {
        parts[*plane][0] += *area;
        parts[*plane][1] += if is_sunny(sensor) { *area } else { 0.0 };
    }
    parts.iter().any(|[all, sunny]| *sunny > share * all)
}

impl Shaded {
    /// What the sensors receive in an hour [lx].
    fn hour(&self, hour: &Hour, points: usize) -> Vec<f64> {
        let [from_elsewhere, _] = self.year.hour(hour);
        let mut all = from_elsewhere.clone();
        for _ in 0..TURNS {
            let backs = &all[points..];
            let exitances = backs.iter().zip(&self.sent).map(|(e, sent)| e * sent);
            let exitances: Vec<f64> = exitances.collect();
            let mut next = from_elsewhere.clone();
            self.year.add_shining(&exitances, &mut next);
            let change = all.iter().zip(&next).map(|(a, b)| (a - b).abs());
            let (change, whole) = (change.sum::<f64>(), next.iter().sum::<f64>());
            all = next;
            if change <= ENOUGH * whole {
                break;
            }
        }
        all.truncate(points);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A room of 75 m2 with two sensors of one square metre, and one of 100 m2: each square metre is 1.3 % of its room and 0.6 % of the
    /// house.
    #[test]
    fn more_than_two_percent_of_any_room_are_too_much() {
        let (areas, planes) = ([1.0, 1.0, 73.0, 2.0, 98.0], [0, 0, 0, 1, 1]);
        let rooms = Rooms {
            sensors: &[],
            areas: &areas,
            planes: &planes,
        };
        for (sunny, closes) in [
            (vec![], false),
            (vec![0], false),
            (vec![0, 1], true),
            (vec![2], true),
            // Two percent are not more than two percent, and rooms do not add up.
            (vec![3], false),
            (vec![0, 3], false),
            (vec![1, 4], true),
        ] {
            let found = is_too_much(&rooms, |sensor| sunny.contains(&sensor));
            assert_eq!(found, closes, "{sunny:?}");
        }
    }
}
