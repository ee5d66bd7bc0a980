//! Faces by material, and what walls are made of: outlines, sheets with holes, reveals, lathes, sweeps.

use glam::{DVec2, DVec3};
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Faces that meet at less than this share one normal: cos 35 degrees.
const CREASE: f64 = 0.819;

/// A triangle with flat shading, before smoothing.
struct Face {
    corners: [DVec3; 3],
    uvs: [DVec2; 3],
    color: DVec3,
}

/// Vertices and triangles of one material, as they go into the file.
#[derive(Default)]
pub struct Part {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub colors: Vec<[u8; 4]>,
    pub indices: Vec<u32>,
}

/// A mesh in the making: faces by material.
#[derive(Default)]
pub struct Mesh {
    faces: BTreeMap<usize, Vec<Face>>,
    /// The material of what comes next.
    pub material: usize,
    /// The colour, linear Rec. 709, of what comes next.
    pub color: DVec3,
}

/// To the nearest 1/8192: 0.1 mm, so that the last bits of a platform's sine do not show in the file.
fn rounded(x: f64) -> f32 {
    ((x * 8192.0).round() / 8192.0) as f32
}

impl Mesh {
    /// A mesh that begins with `material`, white.
    pub fn of(material: usize) -> Self {
        Mesh {
            material,
            color: DVec3::ONE,
            ..Mesh::default()
        }
    }

    /// A flat polygon, convex, counter-clockwise from its front; texture coordinates are metres along its main plane.
    pub fn polygon(&mut self, corners: &[DVec3]) {
        let normal = area_vector(corners).abs();
        let uvs: Vec<DVec2> = corners
            .iter()
            .map(|p| {
                if normal.y >= normal.x.max(normal.z) {
                    DVec2::new(p.x, p.z)
                } else if normal.x >= normal.z {
                    DVec2::new(p.z, -p.y)
                } else {
                    DVec2::new(p.x, -p.y)
                }
            })
            .collect();
        self.polygon_with(corners, &uvs);
    }

    /// A flat polygon with texture coordinates in metres.
    pub fn polygon_with(&mut self, corners: &[DVec3], uvs: &[DVec2]) {
        for i in 2..corners.len() {
            let face = Face {
                corners: [corners[0], corners[i - 1], corners[i]],
                uvs: [uvs[0], uvs[i - 1], uvs[i]],
                color: self.color,
            };
            if area_vector(&face.corners).length() > 1e-8 {
                self.faces.entry(self.material).or_default().push(face);
            }
        }
    }

    /// A quad, turned so that its front looks along `toward`.
    pub fn quad_toward(&mut self, mut corners: [DVec3; 4], mut uvs: [DVec2; 4], toward: DVec3) {
        if area_vector(&corners).dot(toward) < 0.0 {
            corners.reverse();
            uvs.reverse();
        }
        self.polygon_with(&corners, &uvs);
    }

    /// A box between two corners.
    pub fn block(&mut self, min: DVec3, max: DVec3) {
        let at = |i: usize| {
            DVec3::new(
                if i & 1 == 0 { min.x } else { max.x },
                if i & 2 == 0 { min.y } else { max.y },
                if i & 4 == 0 { min.z } else { max.z },
            )
        };
        for side in [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ] {
            self.polygon(&side.map(at));
        }
    }

    /// A surface of revolution about the vertical through `foot`; `profile` is (radius, height) from below.
    pub fn lathe(&mut self, foot: DVec3, profile: &[DVec2], segments: usize) {
        self.turned(foot, [0.0, TAU], segments, profile.len(), |row, _| {
            profile[row]
        });
    }

    /// Rings of `radius_and_height(row, angle)` about the vertical through `foot`, joined, from one angle to another;
    /// angle 0 is +X, a quarter turn -Z.
    pub fn turned(
        &mut self,
        foot: DVec3,
        arc: [f64; 2],
        segments: usize,
        rows: usize,
        radius_and_height: impl Fn(usize, f64) -> DVec2,
    ) {
        let point = |row: usize, i: usize| {
            let angle = arc[0] + (arc[1] - arc[0]) * i as f64 / segments as f64;
            let p = radius_and_height(row, angle);
            (
                foot + DVec3::new(p.x * angle.cos(), p.y, -p.x * angle.sin()),
                DVec2::new(angle * 0.5, -p.y),
            )
        };
        for row in 1..rows {
            for i in 0..segments {
                let quad = [
                    point(row - 1, i),
                    point(row - 1, i + 1),
                    point(row, i + 1),
                    point(row, i),
                ];
                self.polygon_with(&quad.map(|q| q.0), &quad.map(|q| q.1));
            }
        }
    }

    /// Sweeps `section` (along the normal in the curve's plane, along the binormal) along a plane curve.
    pub fn sweep(&mut self, curve: &[DVec3], binormal: DVec3, section: &[DVec2]) {
        let rings: Vec<Vec<DVec3>> = (0..curve.len())
            .map(|i| {
                let before = curve[i.saturating_sub(1)];
                let after = curve[(i + 1).min(curve.len() - 1)];
                let normal = binormal.cross(after - before).normalize();
                section
                    .iter()
                    .map(|s| curve[i] + normal * s.x + binormal * s.y)
                    .collect()
            })
            .collect();
        let mut along = 0.0;
        for (i, pair) in rings.windows(2).enumerate() {
            let next = along + curve[i].distance(curve[i + 1]);
            for k in 1..section.len() {
                let across = |k: usize| section[k].y;
                let corners = [pair[0][k - 1], pair[0][k], pair[1][k], pair[1][k - 1]];
                let uvs = [
                    DVec2::new(across(k - 1), along),
                    DVec2::new(across(k), along),
                    DVec2::new(across(k), next),
                    DVec2::new(across(k - 1), next),
                ];
                let middle = (curve[i] + curve[i + 1]) / 2.0;
                let outward = corners.iter().sum::<DVec3>() / 4.0 - middle;
                self.quad_toward(corners, uvs, outward);
            }
            along = next;
        }
    }

    /// The parts by material, with normals smoothed across edges that are no creases, equal vertices shared.
    pub fn finish(&self, metres: &[f64]) -> Vec<(usize, Part)> {
        self.faces
            .iter()
            .map(|(&material, faces)| (material, smooth(faces, metres[material])))
            .collect()
    }
}

fn smooth(faces: &[Face], metres: f64) -> Part {
    let key = |p: DVec3| p.to_array().map(|x| (x * 8192.0).round() as i64);
    let mut around: HashMap<[i64; 3], Vec<DVec3>> = HashMap::new();
    for face in faces {
        for corner in face.corners {
            around
                .entry(key(corner))
                .or_default()
                .push(area_vector(&face.corners));
        }
    }
    let mut part = Part::default();
    let mut known: HashMap<([i64; 3], [u32; 8]), u32> = HashMap::new();
    for face in faces {
        let own = area_vector(&face.corners).normalize();
        for (corner, uv) in face.corners.into_iter().zip(face.uvs) {
            let close = around[&key(corner)]
                .iter()
                .filter(|n| n.normalize().dot(own) > CREASE);
            let normal = close.sum::<DVec3>().normalize().to_array().map(rounded);
            let uv = (uv / metres).to_array().map(rounded);
            let color = face
                .color
                .to_array()
                .map(|c| (c * 255.0).round().clamp(0.0, 255.0) as u8);
            let color = [color[0], color[1], color[2], 255];
            let rest = [
                normal[0].to_bits(),
                normal[1].to_bits(),
                normal[2].to_bits(),
                uv[0].to_bits(),
                uv[1].to_bits(),
                u32::from_le_bytes(color),
                0,
                0,
            ];
            let index = *known.entry((key(corner), rest)).or_insert_with(|| {
                part.positions.push(corner.to_array().map(rounded));
                part.normals.push(normal);
                part.uvs.push(uv);
                part.colors.push(color);
                part.positions.len() as u32 - 1
            });
            part.indices.push(index);
        }
    }
    part
}

fn area_vector(corners: &[DVec3]) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for i in 2..corners.len() {
        sum += (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
    }
    sum / 2.0
}

/// A region of a wall between a lower and an upper line, both from left to right.
#[derive(Clone)]
pub struct Outline {
    lower: Vec<DVec2>,
    upper: Vec<DVec2>,
}

impl Outline {
    pub fn rectangle(left: f64, right: f64, bottom: f64, top: f64) -> Self {
        Outline {
            lower: vec![DVec2::new(left, bottom), DVec2::new(right, bottom)],
            upper: vec![DVec2::new(left, top), DVec2::new(right, top)],
        }
    }

    /// A pointed arch over an opening of half width `w`: `pointed` is the distance of the arcs' centres from the
    /// middle [m]; 0 is a round arch. Arches of the same `pointed` and another `w` are concentric.
    pub fn arch(middle: f64, w: f64, sill: f64, spring: f64, pointed: f64, steps: usize) -> Self {
        let radius = w + pointed;
        let last = (pointed / radius).acos();
        let half: Vec<DVec2> = (0..=steps)
            .map(|i| {
                let angle = last * i as f64 / steps as f64;
                DVec2::new(radius * angle.cos() - pointed, radius * angle.sin())
            })
            .collect();
        let mut upper: Vec<DVec2> = half
            .iter()
            .map(|p| DVec2::new(middle - p.x.max(0.0), spring + p.y))
            .collect();
        upper.extend(
            half.iter()
                .rev()
                .skip(1)
                .map(|p| DVec2::new(middle + p.x.max(0.0), spring + p.y)),
        );
        Outline {
            lower: vec![DVec2::new(middle - w, sill), DVec2::new(middle + w, sill)],
            upper,
        }
    }

    pub fn circle(center: DVec2, radius: f64, steps: usize) -> Self {
        let line = |sign: f64| -> Vec<DVec2> {
            (0..=steps)
                .map(|i| {
                    let angle = 2.0 * FRAC_PI_2 * i as f64 / steps as f64;
                    let end = i == 0 || i == steps;
                    let y = if end { 0.0 } else { angle.sin() };
                    center + radius * DVec2::new(-angle.cos(), sign * y)
                })
                .collect()
        };
        Outline {
            lower: line(-1.0),
            upper: line(1.0),
        }
    }

    /// The points around, counter-clockwise.
    pub fn around(&self) -> Vec<DVec2> {
        let mut points = self.lower.clone();
        points.extend(self.upper.iter().rev());
        points.dedup();
        if points.first() == points.last() {
            points.pop();
        }
        points
    }

    fn span(&self) -> [f64; 2] {
        [self.lower[0].x, self.lower[self.lower.len() - 1].x]
    }
}

/// The index of the end of that piece of a line which `x` is in.
fn segment(line: &[DVec2], x: f64) -> usize {
    line.partition_point(|p| p.x < x).clamp(1, line.len() - 1)
}

/// The height of a line at `x`.
fn height(line: &[DVec2], x: f64) -> f64 {
    let i = segment(line, x);
    let (a, b) = (line[i - 1], line[i]);
    if (x - a.x).abs() < 1e-12 {
        a.y
    } else if (x - b.x).abs() < 1e-12 {
        b.y
    } else {
        a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x)
    }
}

/// Where a wall stands: `x` runs along it, `depth` into it.
#[derive(Clone, Copy)]
pub struct Frame {
    pub origin: DVec3,
    pub x: DVec3,
    pub depth: DVec3,
}

impl Frame {
    pub fn at(&self, p: DVec2, depth: f64) -> DVec3 {
        self.origin + self.x * p.x + DVec3::Y * p.y + self.depth * depth
    }

    /// The face of a wall at a depth, without its holes; it looks out of the wall (`outward` -1) or into it (+1).
    pub fn sheet(
        &self,
        mesh: &mut Mesh,
        outer: &Outline,
        holes: &[&Outline],
        depth: f64,
        outward: f64,
    ) {
        let shapes: Vec<&Outline> = std::iter::once(outer)
            .chain(holes.iter().copied())
            .collect();
        let mut stops: Vec<f64> = shapes
            .iter()
            .flat_map(|s| s.lower.iter().chain(&s.upper))
            .map(|p| p.x)
            .collect();
        stops.sort_by(f64::total_cmp);
        stops.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        // Between two stops the region is a stack of quads; a quad goes on while neither of its lines bends.
        type Piece<'a> = (&'a [DVec2], usize);
        let mut open: Vec<([Piece; 2], f64)> = Vec::new();
        let mut close = |[low, high]: [Piece; 2], from: f64, to: f64| {
            let mut corners = [(low, from), (low, to), (high, to), (high, from)]
                .map(|((line, _), x)| self.at(DVec2::new(x, height(line, x)), depth));
            if area_vector(&corners).dot(self.depth * outward) < 0.0 {
                corners.reverse();
            }
            mesh.polygon(&corners);
        };
        for stop in stops.windows(2) {
            let middle = (stop[0] + stop[1]) / 2.0;
            let mut lines: Vec<&[DVec2]> = shapes
                .iter()
                .filter(|s| s.span()[0] < middle && middle < s.span()[1])
                .flat_map(|s| [&s.lower[..], &s.upper[..]])
                .collect();
            lines.sort_by(|a, b| height(a, middle).total_cmp(&height(b, middle)));
            let piece = |line| (line, segment(line, middle));
            let quads: Vec<[Piece; 2]> = lines
                .chunks_exact(2)
                .map(|pair| [piece(pair[0]), piece(pair[1])])
                .collect();
            let same = |a: &[Piece; 2], b: &[Piece; 2]| {
                (0..2).all(|k| std::ptr::eq(a[k].0, b[k].0) && a[k].1 == b[k].1)
            };
            open.retain(|(quad, from)| {
                let goes_on = quads.iter().any(|q| same(q, quad));
                if !goes_on {
                    close(*quad, *from, stop[0]);
                }
                goes_on
            });
            for quad in quads {
                if !open.iter().any(|(q, _)| same(q, &quad)) {
                    open.push((quad, stop[0]));
                }
            }
        }
        for (quad, from) in open {
            close(quad, from, stops[stops.len() - 1]);
        }
    }

    /// The inner side of a hole, from one outline at one depth to another with as many points. An arch that springs
    /// from its own lower line has no sill.
    pub fn reveal(&self, mesh: &mut Mesh, a: (&Outline, f64), b: (&Outline, f64)) {
        let (from, to) = (a.0.around(), b.0.around());
        let center = self.at(
            from.iter().sum::<DVec2>() / from.len() as f64,
            (a.1 + b.1) / 2.0,
        );
        let mut along = 0.0;
        for i in 0..from.len() {
            let j = (i + 1) % from.len();
            let next = along + from[i].distance(from[j]);
            let corners = [
                self.at(from[i], a.1),
                self.at(from[j], a.1),
                self.at(to[j], b.1),
                self.at(to[i], b.1),
            ];
            let uvs = [
                DVec2::new(a.1, along),
                DVec2::new(a.1, next),
                DVec2::new(b.1, next),
                DVec2::new(b.1, along),
            ];
            let sill = i == 0 && a.0.lower.len() == 2 && a.0.lower[0] == a.0.upper[0];
            if sill {
                along = next;
                continue;
            }
            let toward = center - corners.iter().sum::<DVec3>() / 4.0;
            mesh.quad_toward(corners, uvs, toward);
            along = next;
        }
    }

    /// A slab with holes between two depths.
    pub fn plate(
        &self,
        mesh: &mut Mesh,
        outer: &Outline,
        holes: &[&Outline],
        front: f64,
        back: f64,
    ) {
        self.sheet(mesh, outer, holes, front, -1.0);
        self.sheet(mesh, outer, holes, back, 1.0);
        for hole in holes {
            self.reveal(mesh, (hole, front), (hole, back));
        }
    }
}
