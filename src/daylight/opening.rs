//! Openings: where panes let daylight in, and the point of each that stands for it.
//!
//! Panes that touch each other and lie in one plane are one opening, and those that lie over each other, one pane behind another. The
//! outside is the side from which more of the sky is free; panes from which no sky is free on either side, but through other panes, lead to no
//! outside.
//!
//! The reference point (EN 17037:2018, annex D, told from memory) lies in the middle of the width, 0.3 m above the sill and at least 1.2 m above the
//! floor; of openings in roofs in the middle. It is to lie on the inner surface of the wall, which the model's panes do not tell: it
//! lies on the pane, or as far behind it as is asked for.
//!
//! The floor is the highest below the opening's middle of those that are found ([`Floors`]) 1 to 1.5 m behind the pane, else nearer, so that no
//! desk, no sill and no thick wall is one; where there is none, the ground.

use super::floor::{self, Floors};
use super::outline::Outline;
use super::plane::Plane;
use super::spec::GridSpec;
use crate::error::{Error, Result};
use crate::scene::{Geometry, Ray, Scene};
use crate::warning::Warning;
use glam::{DVec2, DVec3, dvec2};
use std::collections::HashMap;

/// How far above the sill and above the floor the point lies [m].
const ABOVE: [f64; 2] = [0.3, 1.2];
/// Steeper openings are those of walls, by the height of their normal [1].
const ROOF: f64 = 0.7;
/// Corners that are nearer to each other are one [m].
const SAME: f64 = 1e-3;
/// Panes that are nearer to each other across their planes belong together [m].
const BEHIND: f64 = 0.2;
/// The cosine between normals of one plane: 8 degrees.
const FLAT: f64 = 0.99;
/// What is narrower are edges of panes that have a thickness [m].
const NARROW: f64 = 0.1;
/// Directions each way that look for the sky on each side.
const LOOKS: u32 = 8;
/// How far behind a pane the floor is looked for: from and to, and in what steps [m]; nearer where there is none, as sills are broad.
const INSIDE: [f64; 3] = [1.0, 1.5, 0.1];

/// What panes close.
#[derive(Default)]
pub(super) struct Openings {
    /// Planes that face outward with one place for a sensor each, in the order of the mesh.
    pub planes: Vec<Plane>,
    /// Panes that are none: how many, and a phrase that follows their number.
    pub left_out: Vec<(usize, &'static str)>,
    /// Openings without a floor below.
    pub without_floor: Vec<String>,
}

/// The openings that panes of a name close; `all`: all panes.
///
/// # Errors
/// [`Error::Input`] for a name that nothing has, and where no pane leads to the outside.
pub(super) fn openings(
    scene: &Scene,
    geometry: &Geometry,
    name: &str,
    spec: &GridSpec,
) -> Result<Openings> {
    let triangles = match name {
        "all" => (0..scene.mesh.triangles.len() as u32).collect(),
        name => floor::named(scene, name)?,
    };
    let found = among(scene, geometry, &triangles, spec);
    if found.planes.is_empty() {
        let veils = geometry
            .warnings()
            .iter()
            .find_map(|warning| match warning {
                Warning::PartlySeeThrough { materials } => Some(materials.join("`, `")),
                _ => None,
            });
        let see_through = match veils {
            Some(names) => format!("`{names}` is see-through: [[pane]] makes it glass"),
            None => "[[pane]] makes a see-through material glass".to_owned(),
        };
        return Err(Error::input(
            "--grid",
            format!("no pane of `{name}` leads to the outside"),
            format!(
                "openings are told by glass, [[pane]] or KHR_materials_transmission ({see_through}); or give a surface in the opening with surface="
            ),
        ));
    }
    Ok(found)
}

/// The openings of panes among some triangles.
fn among(scene: &Scene, geometry: &Geometry, triangles: &[u32], spec: &GridSpec) -> Openings {
    let is_pane = |t: &&u32| {
        let material = scene.mesh.triangles[**t as usize].material as usize;
        scene.materials[material].pane.is_some()
    };
    let panes: Vec<u32> = triangles.iter().filter(is_pane).copied().collect();
    let floors = Floors::of(scene, geometry);
    let mut found = Openings::default();
    let (mut inner, mut narrow) = (0, 0);
    for group in flat(scene, &panes) {
        let (plane, has_floor) = match opening(scene, geometry, &floors, &group, spec) {
            Found::Opening(plane, has_floor) => (plane, has_floor),
            Found::Inner => {
                inner += 1;
                continue;
            }
            Found::Narrow => {
                narrow += 1;
                continue;
            }
        };
        let is_over = |other: &Plane| {
            let way = middle(&plane) - middle(other);
            let normals = [other.normal(), plane.normal()];
            lie_over(way, normals, plane.outline.area())
        };
        if !found.planes.iter().any(is_over) {
            if !has_floor {
                found.without_floor.push(plane.name.clone());
            }
            found.planes.push(plane);
        }
    }
    let reasons = [
        (inner, "have no free sky on either side"),
        (
            narrow,
            "are narrower than 0.1 m: edges of panes that have a thickness",
        ),
    ];
    found.left_out = reasons
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .collect();
    found
}

/// Twice the area of a triangle along its normal [m2].
fn facet(scene: &Scene, triangle: u32) -> DVec3 {
    let [a, b, c] = scene.mesh.corners(triangle);
    (b - a).cross(c - a)
}

/// Triangles in groups that are connected by shared corners and lie in the plane of their largest; in the order of their first ones. Those without area
/// are in none.
fn flat(scene: &Scene, triangles: &[u32]) -> Vec<Vec<u32>> {
    let keys = |triangle: u32| {
        scene
            .mesh
            .corners(triangle)
            .map(|corner| (corner / SAME).round().to_array().map(|x| x as i64))
    };
    let mut at: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for triangle in triangles {
        for key in keys(*triangle) {
            at.entry(key).or_default().push(*triangle);
        }
    }
    let mut sizes: Vec<(f64, u32)> = (triangles.iter())
        .map(|t| (facet(scene, *t).length(), *t))
        .filter(|(size, _)| *size > 0.0)
        .collect();
    let mut is_free: HashMap<u32, bool> = sizes.iter().map(|(_, t)| (*t, true)).collect();
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut groups = Vec::new();
    for (_, first) in sizes {
        let (normal, place) = (
            facet(scene, first).normalize(),
            scene.mesh.corners(first)[0],
        );
        let mut belongs = |triangle: u32| {
            let is_level = facet(scene, triangle).normalize_or_zero().dot(normal).abs() > FLAT;
            let off = scene
                .mesh
                .corners(triangle)
                .map(|corner| (corner - place).dot(normal).abs());
            let own = is_level && off.iter().all(|off| *off < BEHIND);
            own && is_free.insert(triangle, false) == Some(true)
        };
        let mut group = Vec::new();
        let mut open: Vec<u32> = Some(first).filter(|t| belongs(*t)).into_iter().collect();
        while let Some(triangle) = open.pop() {
            group.push(triangle);
            for key in keys(triangle) {
                open.extend(at[&key].iter().copied().filter(|t| belongs(*t)));
            }
        }
        if !group.is_empty() {
            group.sort_unstable();
            groups.push(group);
        }
    }
    groups.sort();
    groups
}

/// The middle of a plane's cells [m].
fn middle(plane: &Plane) -> DVec3 {
    let [low, _, high, _] = plane.cell([0, 0]);
    plane.at(0.5 * (low + high))
}

/// What panes are.
enum Found {
    /// An opening, and whether there is a floor below; always of those in roofs.
    Opening(Plane, bool),
    /// They lead to no outside.
    Inner,
    Narrow,
}

/// How panes in one plane lie.
struct Facing {
    centre: DVec3,
    /// Unit normal on the side with more free sky.
    outward: DVec3,
    /// Whether any sky is free on either side.
    leads_out: bool,
    /// Unit vectors along the plane: level, and as far upward as can be.
    axes: [DVec3; 2],
}

impl Facing {
    fn of(scene: &Scene, geometry: &Geometry, group: &[u32]) -> Self {
        let facets = group.iter().map(|t| facet(scene, *t));
        let largest = facets.max_by(|a, b| a.length().total_cmp(&b.length()));
        let normal = largest.unwrap_or_default().normalize_or(DVec3::Y);
        let points = || group.iter().flat_map(|t| scene.mesh.corners(*t));
        let centre = points().sum::<DVec3>() / points().count() as f64;
        let free = [1.0, -1.0].map(|side| free_sky(geometry, centre, side * normal));
        let outward = match free {
            [front, back] if front >= back => normal,
            _ => -normal,
        };
        let up = if outward.y.abs() > 0.999 {
            DVec3::NEG_Z
        } else {
            DVec3::Y
        };
        let v = (up - up.dot(outward) * outward).normalize();
        Facing {
            centre,
            outward,
            leads_out: free != [0, 0],
            axes: [v.cross(outward), v],
        }
    }

    /// A place along the axes [m].
    fn flat(&self, place: DVec3) -> DVec2 {
        let way = place - self.centre;
        dvec2(way.dot(self.axes[0]), way.dot(self.axes[1]))
    }
}

/// Panes in one plane that lead outside.
pub(super) struct Sheet {
    /// Their triangles.
    pub triangles: Vec<u32>,
    /// Unit normal toward the outside.
    pub outward: DVec3,
    /// The mean of their corners [m].
    pub centre: DVec3,
    /// Their size [m2].
    pub area: f64,
}

impl Sheet {
    /// Whether another lies before it or behind it: panes of one opening.
    pub fn is_over(&self, other: &Sheet) -> bool {
        let way = other.centre - self.centre;
        lie_over(way, [self.outward, other.outward], self.area)
    }
}

/// Whether two panes lie one before the other, by the way between their middles [m], their normals and the area of one [m2].
fn lie_over(way: DVec3, [normal, other]: [DVec3; 2], area: f64) -> bool {
    let across = way.dot(normal);
    let aside = (way - across * normal).length();
    normal.dot(other).abs() > FLAT && across.abs() < BEHIND && aside < 0.1 * area.sqrt()
}

/// Those of some panes that lead outside, sheet by sheet, and how many sheets lead nowhere. Edges of panes that are boxes are left out.
pub(super) fn sheets(scene: &Scene, geometry: &Geometry, panes: &[u32]) -> (Vec<Sheet>, usize) {
    let (mut found, mut inner) = (Vec::new(), 0);
    for triangles in flat(scene, panes) {
        let facing = Facing::of(scene, geometry, &triangles);
        let corners = triangles.iter().flat_map(|t| scene.mesh.corners(*t));
        let (low, high) = corners
            .map(|p| facing.flat(p))
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
                (low.min(p), high.max(p))
            });
        if (high - low).min_element() < NARROW {
            continue;
        }
        if !facing.leads_out {
            inner += 1;
            continue;
        }
        found.push(Sheet {
            area: triangles
                .iter()
                .map(|t| 0.5 * facet(scene, *t).length())
                .sum(),
            triangles,
            outward: facing.outward,
            centre: facing.centre,
        });
    }
    (found, inner)
}

/// One opening.
fn opening(
    scene: &Scene,
    geometry: &Geometry,
    floors: &Floors,
    group: &[u32],
    spec: &GridSpec,
) -> Found {
    let facing = Facing::of(scene, geometry, group);
    let (centre, normal, [u, v]) = (facing.centre, facing.outward, facing.axes);
    let is_roof = normal.y.abs() > ROOF;
    let place = |p: DVec3| facing.flat(p);
    let outline = Outline::union(
        group
            .iter()
            .map(|t| scene.mesh.corners(*t).map(place).to_vec()),
    );
    let Some([low, high]) = outline.bounds() else {
        return Found::Narrow;
    };
    if (high - low).min_element() < NARROW {
        return Found::Narrow;
    }
    if !facing.leads_out {
        return Found::Inner;
    }
    let mut at = 0.5 * (low + high);
    let mut has_floor = true;
    if !is_roof {
        let sill = (centre + low.y * v).y;
        let mut wanted = sill + ABOVE[0];
        let floor = floor_behind(floors, centre + at.x * u, normal);
        let ground = || {
            let lowest = geometry.bounds().0.y;
            let ground = scene.ground.enabled;
            ground.then(|| scene.ground.height.unwrap_or(lowest))
        };
        match floor.or_else(ground) {
            Some(floor) => wanted = wanted.max(floor + ABOVE[1]),
            None => has_floor = false,
        }
        // An opening that ends below has it at its upper edge.
        at.y = (low.y + (wanted - sill) / v.y).min(high.y - SAME);
    }
    // A cell around the point, so that it is the cell's middle.
    let half = (high - at).max(at - low);
    let name = &scene.materials[scene.mesh.triangles[group[0] as usize].material as usize].name;
    let moved = |outline: &Outline| outline.mapped(|p: DVec2| p - (at - half));
    let plane = Plane {
        name: format!("opening {name}").trim_end().to_owned(),
        origin: centre + (at.x - half.x) * u + (at.y - half.y) * v - spec.plane * normal,
        u,
        v,
        above: -spec.plane,
        is_over_floor: false,
        step: (2.0 * half).to_array(),
        cells: [1, 1],
        whole: moved(&outline),
        outline: moved(&outline),
    };
    Found::Opening(plane, has_floor)
}

/// The height of the highest floor behind a pane that faces outward, below a place on it [m].
fn floor_behind(floors: &Floors, place: DVec3, outward: DVec3) -> Option<f64> {
    let [near, far] = [INSIDE[0], INSIDE[1]].map(|way| (way / INSIDE[2]).round() as u32);
    let level = DVec3::new(outward.x, 0.0, outward.z).normalize_or_zero();
    let at = |i: u32| floors.below(place - (f64::from(i) * INSIDE[2] + SAME) * level);
    let highest = (near..=far).filter_map(at).max_by(f64::total_cmp);
    highest.or_else(|| (0..near).rev().find_map(at))
}

/// Of directions spread over the upper half before a side of a pane, how many end in the sky without other panes on the way.
fn free_sky(geometry: &Geometry, centre: DVec3, side: DVec3) -> usize {
    let mut free = 0;
    for i in 0..LOOKS {
        for j in 0..4 * LOOKS {
            let height = (f64::from(i) + 0.5) / f64::from(LOOKS);
            let turn = f64::from(j) / f64::from(4 * LOOKS) * std::f64::consts::TAU;
            let level = (1.0 - height * height).sqrt();
            let direction = DVec3::new(level * turn.cos(), height, level * turn.sin());
            let ray = Ray {
                origin: centre + SAME * side,
                direction,
            };
            let cosine = direction.dot(side);
            if cosine <= 0.0 || geometry.occluded(&ray, 0.0, f64::INFINITY) {
                continue;
            }
            // Not through another opening; sheets of this one lie close before it.
            let beyond = BEHIND / cosine;
            let is_clear = geometry
                .panes()
                .is_none_or(|panes| panes.transmittance(&ray, beyond, f64::INFINITY) == DVec3::ONE);
            free += usize::from(is_clear);
        }
    }
    free
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Mesh, Pane, Triangle};
    use glam::dvec3;

    /// Quads of four corners, each with the number of its material: 0 a wall, 1 glass.
    fn of_quads(quads: &[([DVec3; 4], u32)]) -> Scene {
        let mut mesh = Mesh::default();
        for (corners, material) in quads {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(corners);
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                mesh.triangles.push(Triangle {
                    vertices: [first + a, first + b, first + c],
                    material: *material,
                });
            }
        }
        mesh.normals = vec![DVec3::ZERO; mesh.positions.len()];
        mesh.uvs = vec![DVec2::ZERO; mesh.positions.len()];
        Scene {
            materials: vec![
                Material::of("wall", DVec3::splat(0.5)),
                Material {
                    pane: Some(Pane::CLEAR),
                    ..Material::of("glass", DVec3::ONE)
                },
            ],
            mesh,
            ..Scene::default()
        }
    }

    /// A room 4 m deep behind glass from a sill to 2 m above the floor, in so many sheets, under a ceiling; everything turned around the
    /// vertical by an angle.
    fn scene(sill: f64, sheets: u32, turn: f64) -> Scene {
        let mut quads = Vec::new();
        let mut quad = |corners: [DVec3; 4], material: u32| {
            let turned = corners.map(|p| glam::DQuat::from_rotation_y(turn) * p);
            quads.push((turned, material));
        };
        for height in [0.0, 3.0] {
            let at = |x: f64, z: f64| dvec3(x, height, z);
            quad(
                [at(0.0, 0.0), at(0.0, -4.0), at(4.0, -4.0), at(4.0, 0.0)],
                0,
            );
        }
        for sheet in 0..sheets {
            let at = |x: f64, y: f64| dvec3(x, y, -0.016 * f64::from(sheet));
            quad(
                [at(1.0, sill), at(3.0, sill), at(3.0, 2.0), at(1.0, 2.0)],
                1,
            );
        }
        of_quads(&quads)
    }

    /// A level rectangle from and to places in plan.
    fn level(x: [f64; 2], z: [f64; 2], y: f64) -> ([DVec3; 4], u32) {
        let at = |x: f64, z: f64| dvec3(x, y, z);
        let [[x0, x1], [z0, z1]] = [x, z];
        ([at(x0, z0), at(x0, z1), at(x1, z1), at(x1, z0)], 0)
    }

    /// An upright pane between two places in plan.
    fn upright(from: [f64; 2], to: [f64; 2], heights: [f64; 2]) -> ([DVec3; 4], u32) {
        let at = |[x, z]: [f64; 2], y: f64| dvec3(x, y, z);
        let [low, high] = heights;
        (
            [at(from, low), at(to, low), at(to, high), at(from, high)],
            1,
        )
    }

    fn all_of(scene: &Scene) -> Openings {
        let all: Vec<u32> = (0..scene.mesh.triangles.len() as u32).collect();
        let spec = GridSpec {
            plane: 0.0,
            ..GridSpec::default()
        };
        among(scene, &Geometry::new(scene), &all, &spec)
    }

    #[test]
    fn the_point_of_a_window_lies_above_sill_and_floor() {
        for (sill, sheets, turn, inward, height) in [
            (0.5, 1, 0.0, 0.0, 1.2),
            (1.0, 1, 0.0, 0.25, 1.3),
            (0.5, 2, 0.7, 0.0, 1.2),
            (1.8, 1, 2.0, 0.0, 2.0),
        ] {
            let scene = scene(sill, sheets, turn);
            let geometry = Geometry::new(&scene);
            let spec = GridSpec {
                plane: inward,
                ..GridSpec::default()
            };
            let all: Vec<u32> = (0..scene.mesh.triangles.len() as u32).collect();
            let found = among(&scene, &geometry, &all, &spec).planes;
            assert_eq!(found.len(), 1, "{sheets} sheets are one opening");
            let quat = glam::DQuat::from_rotation_y(turn);
            let wanted = quat * dvec3(2.0, height, -inward);
            assert!((found[0].normal() - quat * DVec3::Z).length() < 1e-9);
            assert!(middle(&found[0]).distance(wanted) < 2e-3, "{sill}");
            assert!((found[0].outline.area() - 2.0 * (2.0 - sill)).abs() < 1e-6);
            assert!(found[0].outline.contains(DVec2::from(found[0].step) / 2.0));
        }
    }

    #[test]
    fn desks_and_thick_walls_are_no_floors() {
        let window = upright([1.0, 0.0], [3.0, 0.0], [0.2, 2.4]);
        let ceiling = level([0.0, 4.0], [-5.0, 0.0], 3.0);
        let height = |quads: &[_], ground: Option<f64>| {
            let mut scene = of_quads(quads);
            scene.ground.enabled = ground.is_some();
            scene.ground.height = ground;
            let found = all_of(&scene);
            assert_eq!(found.planes.len(), 1);
            (middle(&found.planes[0]).y, found.without_floor.len())
        };
        let floor = level([0.0, 4.0], [-5.0, 0.0], 0.0);
        let desk = level([1.0, 3.0], [-1.0, -0.1], 0.75);
        let (with_desk, none) = height(&[window, ceiling, floor, desk], None);
        assert!((with_desk - 1.2).abs() < 1e-9 && none == 0, "{with_desk}");
        // A wall 0.8 m thick: a sill behind the pane, and the floor behind it.
        let sill = level([0.9, 3.1], [-0.8, 0.0], 0.2);
        let behind = level([0.0, 4.0], [-5.0, -0.8], 0.0);
        let (thick, none) = height(&[window, ceiling, behind, sill], None);
        assert!((thick - 1.2).abs() < 1e-9 && none == 0, "{thick}");
        // The ground alone, and nothing.
        let (on_ground, none) = height(&[window], Some(-0.3));
        assert!((on_ground - 0.9).abs() < 1e-9 && none == 0, "{on_ground}");
        let (on_nothing, none) = height(&[window], None);
        assert!((on_nothing - 0.5).abs() < 1e-9 && none == 1, "{on_nothing}");
    }

    #[test]
    fn walls_of_glass_that_touch_are_openings_of_their_own() {
        let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, -3.0], [0.0, -3.0]];
        let wall = |i: usize| upright(corners[i], corners[(i + 1) % 4], [0.0, 2.5]);
        let floor = level([0.0, 4.0], [-3.0, 0.0], 0.0);
        let mut roof = level([0.0, 4.0], [-3.0, 0.0], 2.5);
        roof.1 = 1;
        for (quads, count) in [
            (vec![wall(0), wall(1), wall(2), wall(3), roof, floor], 5),
            (vec![wall(0), wall(1), floor], 2),
        ] {
            let scene = of_quads(&quads);
            let found = all_of(&scene);
            assert_eq!(found.planes.len(), count);
            assert!(found.left_out.is_empty(), "{:?}", found.left_out);
            let area: f64 = found.planes.iter().map(|p| p.outline.area()).sum();
            let whole: f64 = (0..scene.mesh.triangles.len() as u32)
                .filter(|t| scene.mesh.triangles[*t as usize].material == 1)
                .map(|t| 0.5 * facet(&scene, t).length())
                .sum();
            assert!((area - whole).abs() < 1e-6, "{area} {whole}");
            for plane in &found.planes {
                // On the glass, and outward.
                let (place, normal) = (middle(plane), plane.normal());
                let way = place - dvec3(2.0, 1.25, -1.5);
                let reach = dvec3(2.0, 1.25, 1.5).dot(normal.abs());
                assert!((way.dot(normal) - reach).abs() < 1e-9, "{place} {normal}");
            }
        }
        // A pane that is a box of glass 24 mm thick is one opening; its edges are counted.
        let back = -0.024;
        let strip = |from, to| upright(from, to, [0.5, 2.0]);
        let pane = [
            strip([0.0, 0.0], [2.0, 0.0]),
            strip([2.0, 0.0], [2.0, back]),
            strip([2.0, back], [0.0, back]),
            strip([0.0, back], [0.0, 0.0]),
        ];
        let found = all_of(&of_quads(&pane));
        assert_eq!(found.planes.len(), 1);
        assert_eq!(found.left_out.len(), 1);
        assert_eq!(found.left_out[0].0, 2);
    }
}
