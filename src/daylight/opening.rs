//! Openings: where panes let daylight in, and the point of each that stands for it.
//!
//! Panes that touch each other are one opening, and those that lie over each other, one pane behind another. The outside is the side from which more of
//! the sky is free; panes from which no sky is free on either side lead to no outside and are left out.
//!
//! The reference point (EN 17037:2018, annex D, told from memory) lies in the middle of the width, 0.3 m above the sill and at least 1.2 m above the
//! floor; of openings in roofs in the middle. It is to lie on the inner surface of the wall, which the model's panes do not tell: it
//! lies on the pane, or as far behind it as is asked for.

use super::outline::Outline;
use super::plane::Plane;
use super::spec::GridSpec;
use crate::scene::{Geometry, Ray, Scene};
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
/// Directions each way that look for the sky on each side.
const LOOKS: u32 = 8;
/// How far behind a pane the floor is looked for [m].
const INSIDE: f64 = 0.6;

/// The openings of panes among some triangles, each a plane that faces outward with one place for a sensor; in the order of the mesh.
pub(super) fn planes(
    scene: &Scene,
    geometry: &Geometry,
    triangles: &[u32],
    spec: &GridSpec,
) -> Vec<Plane> {
    let is_pane = |t: &&u32| {
        let material = scene.mesh.triangles[**t as usize].material as usize;
        scene.materials[material].pane.is_some()
    };
    let panes: Vec<u32> = triangles.iter().filter(is_pane).copied().collect();
    let mut found: Vec<Plane> = Vec::new();
    for group in touching(scene, &panes) {
        let Some(plane) = opening(scene, geometry, &group, spec) else {
            continue;
        };
        let is_over = |other: &Plane| {
            let way = middle(&plane) - middle(other);
            let across = way.dot(other.normal());
            let aside = (way - across * other.normal()).length();
            plane.normal().dot(other.normal()).abs() > 0.99
                && across.abs() < BEHIND
                && aside < 0.1 * plane.outline.area().sqrt()
        };
        if !found.iter().any(is_over) {
            found.push(plane);
        }
    }
    let count = found.len();
    for (number, plane) in (1..).zip(&mut found) {
        if count > 1 {
            plane.name = format!("{} {number}", plane.name);
        }
    }
    found
}

fn corners(scene: &Scene, triangle: u32) -> [DVec3; 3] {
    let vertices = scene.mesh.triangles[triangle as usize].vertices;
    vertices.map(|v| scene.mesh.positions[v as usize])
}

/// Triangles in groups that share corners.
fn touching(scene: &Scene, triangles: &[u32]) -> Vec<Vec<u32>> {
    let mut group: Vec<usize> = (0..triangles.len()).collect();
    fn root(group: &mut [usize], mut of: usize) -> usize {
        while group[of] != of {
            group[of] = group[group[of]];
            of = group[of];
        }
        of
    }
    let mut first: HashMap<[i64; 3], usize> = HashMap::new();
    for (i, triangle) in triangles.iter().enumerate() {
        for corner in corners(scene, *triangle) {
            let key = (corner / SAME).round().to_array().map(|x| x as i64);
            let other = *first.entry(key).or_insert(i);
            let (a, b) = (root(&mut group, i), root(&mut group, other));
            group[a.max(b)] = a.min(b);
        }
    }
    let mut groups: Vec<Vec<u32>> = vec![Vec::new(); triangles.len()];
    for (i, triangle) in triangles.iter().enumerate() {
        groups[root(&mut group, i)].push(*triangle);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// The middle of a plane's cells [m].
fn middle(plane: &Plane) -> DVec3 {
    let [low, _, high, _] = plane.cell([0, 0]);
    plane.at(0.5 * (low + high))
}

/// One opening; `None` for panes without area and those that lead to no outside.
fn opening(scene: &Scene, geometry: &Geometry, group: &[u32], spec: &GridSpec) -> Option<Plane> {
    let facet = |t: &u32| {
        let [a, b, c] = corners(scene, *t);
        (b - a).cross(c - a)
    };
    let facets = group.iter().map(facet);
    let largest = facets.max_by(|a, b| a.length().total_cmp(&b.length()))?;
    let normal = largest.try_normalize()?;
    let flat: Vec<u32> = (group.iter().copied())
        .filter(|t| facet(t).normalize_or_zero().dot(normal).abs() > 0.99)
        .collect();
    let points = || flat.iter().flat_map(|t| corners(scene, *t));
    let centre = points().sum::<DVec3>() / points().count() as f64;
    let free = [1.0, -1.0].map(|side| free_sky(geometry, centre, side * normal));
    let normal = match free {
        [0, 0] => return None,
        [front, back] if front >= back => normal,
        _ => -normal,
    };
    let is_roof = normal.y.abs() > ROOF;
    let up = if is_roof && normal.y.abs() > 0.999 {
        DVec3::NEG_Z
    } else {
        DVec3::Y
    };
    let v = (up - up.dot(normal) * normal).try_normalize()?;
    let u = v.cross(normal);
    let place = |p: DVec3| dvec2((p - centre).dot(u), (p - centre).dot(v));
    let outline = Outline::union(flat.iter().map(|t| corners(scene, *t).map(place).to_vec()));
    let [low, high] = outline.bounds()?;
    let mut at = 0.5 * (low + high);
    if !is_roof {
        let sill = (centre + low.y * v).y;
        let mut wanted = sill + ABOVE[0];
        let inside = centre + at.x * u - INSIDE * normal;
        let down = Ray {
            origin: inside,
            direction: DVec3::NEG_Y,
        };
        if let Some(floor) = geometry.closest(&down, 0.0, f64::INFINITY) {
            wanted = wanted.max(inside.y - floor.distance + ABOVE[1]);
        }
        // An opening that ends below has it at its upper edge.
        at.y = (low.y + (wanted - sill) / v.y).min(high.y - SAME);
    }
    // A cell around the point, so that it is the cell's middle.
    let half = (high - at).max(at - low);
    let names = &scene.materials[scene.mesh.triangles[flat[0] as usize].material as usize].name;
    let moved = |outline: &Outline| outline.mapped(|p: DVec2| p - (at - half));
    Some(Plane {
        name: format!("opening {names}").trim_end().to_owned(),
        origin: centre + (at.x - half.x) * u + (at.y - half.y) * v - spec.plane * normal,
        u,
        v,
        above: -spec.plane,
        step: (2.0 * half).to_array(),
        cells: [1, 1],
        whole: moved(&outline),
        outline: moved(&outline),
    })
}

/// Of directions spread over the upper half before a side of a pane, how many end in the sky.
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
            if direction.dot(side) > 0.0 && !geometry.occluded(&ray, 0.0, f64::INFINITY) {
                free += 1;
            }
        }
    }
    free
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Mesh, Pane, Triangle};
    use glam::dvec3;

    /// A room 4 m deep behind glass from a sill to 2 m above the floor, in so many sheets, under a ceiling; everything turned around the
    /// vertical by an angle.
    fn scene(sill: f64, sheets: u32, turn: f64) -> Scene {
        let mut mesh = Mesh::default();
        let mut quad = |corners: [DVec3; 4], material: u32| {
            let first = mesh.positions.len() as u32;
            let turned = corners.map(|p| glam::DQuat::from_rotation_y(turn) * p);
            mesh.positions.extend(turned);
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                mesh.triangles.push(Triangle {
                    vertices: [first + a, first + b, first + c],
                    material,
                });
            }
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
            let found = planes(&scene, &geometry, &all, &spec);
            assert_eq!(found.len(), 1, "{sheets} sheets are one opening");
            let quat = glam::DQuat::from_rotation_y(turn);
            let wanted = quat * dvec3(2.0, height, -inward);
            assert!((found[0].normal() - quat * DVec3::Z).length() < 1e-9);
            assert!(middle(&found[0]).distance(wanted) < 2e-3, "{sill}");
            assert!((found[0].outline.area() - 2.0 * (2.0 - sill)).abs() < 1e-6);
            assert!(found[0].outline.contains(DVec2::from(found[0].step) / 2.0));
        }
    }
}
