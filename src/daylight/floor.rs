//! The planes that a grid lies on: floors that are found or named, and surfaces by name.
//!
//! A floor is a level area that people can stand on. Level faces of one height, whatever side they show, are put together; of their
//! connected areas that are 1 m2 or more, and 0.8 m wide somewhere, a floor is one
//!
//! - of which a quarter or more has 1.8 m of air above it, so that no shelf, no ground under a building and no void above a ceiling is one;
//! - of which most lies under something, a roof or glass, where there is any such area: roofs and the land around a house are floors of no room.
//!   Where nothing is covered, the lowest area and those up to 1.8 m above it are floors;
//! - of which no more than half lies less than 1.8 m over another floor: tables and platforms stand on floors.

use super::outline::Outline;
use super::plane::Plane;
use super::section::cut;
use super::spec::{GridSpec, On};
use crate::error::{Error, Result};
use crate::scene::{Geometry, Ray, Scene};
use glam::{DVec2, DVec3, dvec2, dvec3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Cosine of the greatest slope of a level face: 1 degree.
const LEVEL: f64 = 0.999_85;
/// Faces whose heights differ by no more than this are one floor [m].
const SAME_HEIGHT: f64 = 0.02;
/// What people need above a floor [m].
const HEADROOM: f64 = 1.8;
/// The least floor that is found [m2].
const LEAST_FLOOR: f64 = 1.0;
/// The least width of a floor that is found: what is narrower are voids in walls [m].
const LEAST_WIDTH: f64 = 0.8;
/// Rays start so far above a floor [m].
const CLEAR: f64 = 1e-3;
/// Places of an area, each way, that are asked what is above them.
const PROBES: u32 = 16;
/// Walls are what is steep at this height above the floor: above tables and below lintels [m].
const WALL: f64 = 1.8;
/// Floors of a storey lie within this of its level [m].
const STOREY: f64 = 0.25;
/// A surface of more planes than this is curved.
const MOST_PLANES: usize = 2000;

/// The planes of a grid, in order of height and then of the faces in the file; areas alone, without sensors. None of openings, which are
/// no part of it.
///
/// # Errors
/// [`Error::Input`] for a name that nothing has, and where no floor is found.
pub fn planes(scene: &Scene, geometry: &Geometry, spec: &GridSpec) -> Result<Vec<Plane>> {
    let everything = || (0..scene.mesh.triangles.len() as u32).collect::<Vec<_>>();
    let (areas, name) = match &spec.on {
        On::Surface(name) => return surfaces(scene, &named(scene, name)?, name, spec),
        On::Openings(_) => return Ok(Vec::new()),
        On::Floors => (found(geometry, levels(scene, &everything())), None),
        On::Room(name) => (
            found(geometry, levels(scene, &named(scene, name)?)),
            Some(name),
        ),
        On::Floor(name) => (all(levels(scene, &named(scene, name)?)), Some(name)),
    };
    let areas = of_storey(areas, spec)?;
    if areas.is_empty() {
        let (of, remedy) = match name {
            Some(name) => (
                format!("no level face of `{name}` is a floor"),
                "name another object or material with floor=, or give --points",
            ),
            None => (
                "no floor is found: a level area of 1 m2 and more with 1.8 m of air above it"
                    .into(),
                "is Z up in the mesh, or its unit not the metre (--up z, --scale)? Or name it with floor=",
            ),
        };
        return Err(Error::input("--grid", of, remedy));
    }
    let planes = areas.into_iter().filter_map(|area| {
        let name = name.map_or_else(|| area.name(scene), Clone::clone);
        let band = match spec.inset > 0.0 {
            true => Outline::around(
                area.outline.sides().chain(walls(scene, &area, spec)),
                spec.inset,
            ),
            false => Outline::default(),
        };
        let frame = Frame {
            at: DVec3::Y * area.height,
            u: DVec3::X,
            v: DVec3::NEG_Z,
        };
        let plane = divided(&name, &area.outline, &band, &frame, spec)?;
        Some(Plane {
            is_over_floor: true,
            ..plane
        })
    });
    Ok(planes.collect())
}

/// The triangles of an object or a material.
pub(super) fn named(scene: &Scene, name: &str) -> Result<Vec<u32>> {
    let triangles = scene.triangles_named(name);
    if triangles.is_empty() {
        let remedy = match scene.nearest_name(name) {
            Some(near) => format!("did you mean `{near}`?"),
            None => names(scene),
        };
        let problem = format!("the scene has no object and no material `{name}`");
        return Err(Error::input("--grid", problem, remedy));
    }
    Ok(triangles)
}

/// All floors that are found in a scene.
pub(super) struct Floors(Vec<Area>);

impl Floors {
    pub fn of(scene: &Scene, geometry: &Geometry) -> Self {
        let everything: Vec<u32> = (0..scene.mesh.triangles.len() as u32).collect();
        Floors(found(geometry, levels(scene, &everything)))
    }

    /// The height of the highest below a place [m].
    pub fn below(&self, place: DVec3) -> Option<f64> {
        let is_below = |area: &&Area| area.height < place.y && area.outline.contains(plan(place));
        let heights = self.0.iter().filter(is_below).map(|area| area.height);
        heights.max_by(f64::total_cmp)
    }
}

/// The areas of the storey that a grid asks for, if it asks for one.
fn of_storey(mut areas: Vec<Area>, spec: &GridSpec) -> Result<Vec<Area>> {
    let Some(level) = spec.level.filter(|_| !areas.is_empty()) else {
        return Ok(areas);
    };
    let mut heights: Vec<String> = areas.iter().map(|a| format!("{:.2}", a.height)).collect();
    areas.retain(|area| (area.height - level).abs() <= STOREY);
    if areas.is_empty() {
        heights.dedup();
        return Err(Error::input(
            "--grid",
            format!("no floor lies within {STOREY} m of level={level}"),
            format!("there are floors at {} m", heights.join(", ")),
        ));
    }
    Ok(areas)
}

/// What can be named, for people; the first few.
fn names(scene: &Scene) -> String {
    const MOST: usize = 12;
    let mut names: Vec<&str> = scene.names().collect();
    let more = names.len().saturating_sub(MOST);
    names.truncate(MOST);
    match (names.is_empty(), more) {
        (true, _) => "the mesh names nothing: leave the name out, or give --points".into(),
        (_, 0) => format!("there are {}", names.join(", ")),
        _ => format!("there are {} and {more} more", names.join(", ")),
    }
}

/// A connected level area, in plan: x, and -z.
struct Area {
    height: f64,
    outline: Outline,
    /// The faces of its height.
    triangles: Vec<u32>,
}

impl Area {
    /// The name of the object that has the largest face in it.
    fn name(&self, scene: &Scene) -> String {
        let inside = |triangle: &&u32| {
            let [a, b, c] = scene.mesh.corners(**triangle).map(plan);
            self.outline.contains((a + b + c) / 3.0)
        };
        let size = |triangle: &u32| {
            let [a, b, c] = scene.mesh.corners(*triangle);
            (b - a).cross(c - a).length()
        };
        let own = self.triangles.iter().filter(inside);
        let largest = own.max_by(|a, b| size(a).total_cmp(&size(b)));
        match largest.map(|triangle| scene.name_of(*triangle)) {
            Some(name) if !name.is_empty() => name.to_owned(),
            _ => "floor".to_owned(),
        }
    }

    /// Places all over it.
    fn probes(&self) -> Vec<DVec2> {
        let Some([low, high]) = self.outline.bounds() else {
            return Vec::new();
        };
        let step = (high - low) / f64::from(PROBES);
        let place = |i: u32| {
            // Off the middle, where edges of other things like to be.
            let at = dvec2(f64::from(i % PROBES) + 0.47, f64::from(i / PROBES) + 0.53);
            low + step * at
        };
        let places = (0..PROBES * PROBES).map(place);
        places.filter(|p| self.outline.contains(*p)).collect()
    }
}

/// A place in plan.
fn plan(place: DVec3) -> DVec2 {
    dvec2(place.x, -place.z)
}

/// The connected areas of the level faces among some triangles, from the lowest.
fn levels(scene: &Scene, triangles: &[u32]) -> Vec<Area> {
    let height = |triangle: u32| {
        let [a, b, c] = scene.mesh.corners(triangle);
        (a.y + b.y + c.y) / 3.0
    };
    let is_level = |triangle: &u32| {
        let [a, b, c] = scene.mesh.corners(*triangle);
        let material = scene.mesh.triangles[*triangle as usize].material;
        let is_glass = scene.materials[material as usize].pane.is_some();
        !is_glass && (b - a).cross(c - a).normalize_or_zero().y.abs() > LEVEL
    };
    let mut level: Vec<(f64, u32)> = (triangles.iter().filter(|t| is_level(t)))
        .map(|triangle| (height(*triangle), *triangle))
        .collect();
    level.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut areas = Vec::new();
    for faces in level.chunk_by(|a, b| b.0 - a.0 <= SAME_HEIGHT) {
        let own: Vec<u32> = faces.iter().map(|(_, triangle)| *triangle).collect();
        // The height of most of it.
        let size = |triangle: u32| {
            let [a, b, c] = scene.mesh.corners(triangle);
            (b - a).cross(c - a).length()
        };
        let all: f64 = own.iter().map(|t| size(*t)).sum();
        let height = faces.iter().map(|(h, t)| h * size(*t)).sum::<f64>() / all;
        let outline = Outline::union(
            own.iter()
                .map(|t| scene.mesh.corners(*t).map(plan).to_vec()),
        );
        for shape in 0..outline.shapes().len() {
            areas.push(Area {
                height,
                outline: outline.only(shape),
                triangles: own.clone(),
            });
        }
    }
    areas
}

/// The areas of a name, of which those that lie close above one another are one: a slab has two sides. A table on a floor has the floor's
/// name and hides little of it: both stay.
fn all(areas: Vec<Area>) -> Vec<Area> {
    let mut kept: Vec<Area> = Vec::new();
    for area in areas {
        let is_over = |lower: &Area| {
            let probes = lower.probes();
            let under = probes.iter().filter(|p| area.outline.contains(**p)).count();
            area.height - lower.height < HEADROOM && 2 * under > probes.len()
        };
        kept.retain(|lower| !is_over(lower));
        kept.push(area);
    }
    kept
}

/// Those of some areas that are floors.
fn found(geometry: &Geometry, areas: Vec<Area>) -> Vec<Area> {
    let mut standing: Vec<(Area, bool)> = Vec::new();
    for area in areas {
        let edge = || Outline::around(area.outline.sides(), 0.5 * LEAST_WIDTH);
        if area.outline.area() < LEAST_FLOOR || area.outline.without(&edge()).is_empty() {
            continue;
        }
        let probes = area.probes();
        let above: Vec<Above> = (probes.iter())
            .map(|p| Above::of(geometry, dvec3(p.x, area.height + CLEAR, -p.y)))
            .collect();
        let high = above.iter().filter(|a| a.air >= HEADROOM - CLEAR).count();
        let covered = above.iter().filter(|a| a.is_covered).count();
        // Under a roof not all of a floor is high.
        if 4 * high >= above.len() && high > 0 {
            standing.push((area, 2 * covered > above.len()));
        }
    }
    let any_covered = standing.iter().any(|(_, is_covered)| *is_covered);
    let lowest = standing
        .iter()
        .map(|(area, _)| area.height)
        .fold(f64::INFINITY, f64::min);
    let mut floors: Vec<Area> = Vec::new();
    for (area, is_covered) in standing {
        let belongs = match any_covered {
            true => is_covered,
            false => area.height <= lowest + HEADROOM,
        };
        let probes = area.probes();
        let is_over = |floor: &Area| {
            let over = probes
                .iter()
                .filter(|p| floor.outline.contains(**p))
                .count();
            area.height - floor.height < HEADROOM && 2 * over > probes.len()
        };
        if belongs && !floors.iter().any(is_over) {
            floors.push(area);
        }
    }
    floors
}

/// What is above a place.
pub(super) struct Above {
    /// The way up to the next surface [m]; infinite where there is none.
    pub air: f64,
    /// Whether anything, glass too, lies between the place and the sky.
    pub is_covered: bool,
}

impl Above {
    pub fn of(geometry: &Geometry, place: DVec3) -> Self {
        let up = Ray {
            origin: place,
            direction: DVec3::Y,
        };
        let hit = geometry.closest(&up, 0.0, f64::INFINITY);
        let through = geometry.transmittance(&up, 0.0, f64::INFINITY);
        Above {
            air: hit.map_or(f64::INFINITY, |hit| hit.distance),
            is_covered: hit.is_some() || through != DVec3::ONE,
        }
    }
}

/// Where steep faces cut the height of walls above an area.
fn walls(scene: &Scene, area: &Area, spec: &GridSpec) -> Vec<[DVec2; 2]> {
    let height = area.height + spec.plane.max(WALL);
    let Some([low, high]) = area.outline.bounds() else {
        return Vec::new();
    };
    let [low, high] = [low - spec.inset, high + spec.inset];
    let steep = |triangle: u32| {
        let [a, b, c] = scene.mesh.corners(triangle);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        (normal.y.abs() < 0.5)
            .then(|| cut([a, b, c], DVec3::Y * height, DVec3::Y))
            .flatten()
            .map(|ends| ends.map(plan))
    };
    let all = (0..scene.mesh.triangles.len() as u32).filter_map(steep);
    let is_near = |[a, b]: &[DVec2; 2]| a.max(*b).cmpge(low).all() && a.min(*b).cmple(high).all();
    all.filter(is_near).collect()
}

/// A plane's own axes.
struct Frame {
    at: DVec3,
    u: DVec3,
    v: DVec3,
}

/// The plane over an area, in cells along its longest sides; `None` where no area is left.
fn divided(
    name: &str,
    whole: &Outline,
    band: &Outline,
    frame: &Frame,
    spec: &GridSpec,
) -> Option<Plane> {
    let outline = whole.without(band);
    let angle = direction(&outline);
    let back = DVec2::from_angle(-angle);
    let [outline, whole] = [&outline, whole].map(|o| o.mapped(|p| back.rotate(p)));
    let [low, high] = outline.bounds()?;
    let [outline, whole] = [outline, whole].map(|o| o.mapped(|p| p - low));
    let (sin, cos) = angle.sin_cos();
    let (u, v) = (cos * frame.u + sin * frame.v, cos * frame.v - sin * frame.u);
    let size = high - low;
    let count = |length: f64| ((length - 1e-6) / spec.spacing).ceil().clamp(1.0, 1e6);
    let cells = size.to_array().map(count);
    Some(Plane {
        name: name.to_owned(),
        origin: frame.at + low.x * u + low.y * v + spec.plane * u.cross(v),
        u,
        v,
        above: spec.plane,
        is_over_floor: false,
        step: [size.x / cells[0], size.y / cells[1]],
        cells: cells.map(|c| c as u32),
        outline,
        whole,
    })
}

/// The direction that most of an outline's sides have, or are square to: an angle within an eighth of a turn of 0.
fn direction(outline: &Outline) -> f64 {
    let sides: Vec<(f64, f64)> = (outline.sides())
        .map(|[a, b]| ((b - a).length(), (b - a).to_angle().rem_euclid(FRAC_PI_2)))
        .collect();
    let near = |angle: f64, other: f64| {
        let off = (angle - other).rem_euclid(FRAC_PI_2);
        off.min(FRAC_PI_2 - off) < 1e-3
    };
    let along = |angle: f64| -> f64 {
        (sides
            .iter()
            .filter(|(_, other)| near(angle, *other))
            .map(|side| side.0))
        .sum()
    };
    // Round outlines have many sides; the longest tell.
    let mut longest = sides.clone();
    longest.sort_by(|a, b| b.0.total_cmp(&a.0));
    longest.truncate(64);
    let mut best = (along(0.0), 0.0);
    for (_, angle) in longest {
        let length = along(angle);
        if length > best.0 * (1.0 + 1e-9) {
            best = (length, angle);
        }
    }
    match best.1 {
        angle if angle < 1e-3 || FRAC_PI_2 - angle < 1e-3 => 0.0,
        angle if angle > TAU / 8.0 => angle - FRAC_PI_2,
        angle => angle,
    }
}

/// The planes of a surface: its faces by the planes that they lie in.
fn surfaces(scene: &Scene, triangles: &[u32], name: &str, spec: &GridSpec) -> Result<Vec<Plane>> {
    let mut groups: Vec<(DVec3, f64, Vec<u32>)> = Vec::new();
    for triangle in triangles {
        let [a, b, c] = scene.mesh.corners(*triangle);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let normal = if spec.back { -normal } else { normal };
        let offset = normal.dot(a);
        let is_same = |group: &&mut (DVec3, f64, Vec<u32>)| {
            group.0.dot(normal) > 1.0 - 1e-6 && (group.1 - offset).abs() < 5e-3
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => group.2.push(*triangle),
            None => groups.push((normal, offset, vec![*triangle])),
        }
        if groups.len() > MOST_PLANES {
            return Err(Error::input(
                "--grid",
                format!("the faces of `{name}` lie in more than {MOST_PLANES} planes"),
                "name a plainer surface, or give --points with their normals",
            ));
        }
    }
    let plane = |(normal, offset, triangles): (DVec3, f64, Vec<u32>)| {
        let up = match normal.y.abs() > LEVEL {
            true => DVec3::NEG_Z,
            false => DVec3::Y,
        };
        let v = (up - up.dot(normal) * normal).normalize();
        let frame = Frame {
            at: offset * normal,
            u: v.cross(normal),
            v,
        };
        let flat = |p: DVec3| dvec2(p.dot(frame.u), p.dot(frame.v));
        let whole = Outline::union(
            triangles
                .iter()
                .map(|t| scene.mesh.corners(*t).map(flat).to_vec()),
        );
        let band = match spec.inset > 0.0 {
            true => Outline::around(whole.sides(), spec.inset),
            false => Outline::default(),
        };
        let planes = (0..whole.shapes().len())
            .filter_map(|shape| divided(name, &whole.only(shape), &band, &frame, spec));
        planes.collect::<Vec<_>>()
    };
    Ok(groups.into_iter().flat_map(plane).collect())
}
