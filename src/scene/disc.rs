//! How much of the sun's disc a place sees: exact along chords of the disc.
//!
//! Directions d = w + tan(R) (x X + y Y) around the disc's middle w are the points (x, y) of a plane on which straight edges stay
//! straight lines and the disc is the unit circle. Seen from a place, a triangle with the corners A, B, C there covers the points
//! with (A x B) . d, (B x C) . d and (C x A) . d all of the sign of A . (B x C) (Olano & Greer 1997), also where a corner lies
//! behind the place. Two triangles that share an edge have exactly opposite lines there: no light slips between them.
//!
//! Chords of the disc are cut by these lines into runs, as the curtain cuts a ray; on each chord the light of what is left has a
//! closed form. Across them stands Gauss-Chebyshev quadrature of the second kind, whose weights are those of the circle, so that
//! one edge costs less than 0.3 % whichever way it lies; chords are laid across the edges that are there.

use super::across::{Across, cut};
use super::geometry::Geometry;
use super::shade::{Run, Shade, complement};
use glam::{DVec2, DVec3, Vec3A};
use std::f64::consts::PI;

/// Chords of the disc.
const CHORDS: usize = 16;

/// Directions that chords may have.
const TURNS: usize = 8;

/// Above this tangent of the disc's angular radius its uniform luminance is not uniform on the plane any more.
const WIDE: f64 = 0.01;

/// Steps of the table of what lies before a place of a chord.
const STEPS: usize = 512;

/// A disc infinitely far away that shines.
#[derive(Debug, Clone)]
pub struct Disc {
    toward: DVec3,
    /// Axes of the plane times the tangent of the angular radius.
    axes: [DVec3; 2],
    tan: f64,
    limb: Option<Limb>,
    chords: Vec<Chord>,
    turns: Vec<Turn>,
}

/// Luminance that falls toward the limb as (1 - rho^2)^(exponent / 2).
#[derive(Debug, Clone)]
struct Limb {
    /// The share of a chord's light before each of [`STEPS`] even parts of it, and the same of its light times the place, -1 to 1.
    before: Vec<[DVec3; 2]>,
    /// The share of the disc's light beside a line across it, for the same steps.
    beside: Vec<DVec3>,
}

#[derive(Debug, Clone, Copy)]
struct Chord {
    /// Its distance from the middle, signed, and half its length [radii].
    offset: f64,
    half: f64,
    /// What it stands for: of a uniform disc by length, of a limb-darkened one all of its light.
    weight: DVec3,
}

#[derive(Debug, Clone, Copy)]
struct Turn {
    /// Unit vector across the chords.
    across: DVec2,
    /// Light of the part of the disc above the horizon, in the unit of the chords' weights.
    whole: DVec3,
}

/// A triangle as a place sees it: the lines through two corners each, positive on its side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outline {
    pub lines: [DVec3; 3],
    pub slot: u32,
}

/// What an outline is to the disc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meets {
    Nothing,
    Part,
    All,
}

/// Memory for places that are looked from one after another.
#[derive(Debug, Default)]
pub struct DiscWork {
    outlines: Vec<Outline>,
    /// Those of panes.
    sheets: Vec<Outline>,
    chords: Vec<Shade>,
}

/// How a surface looks at the disc.
#[derive(Debug, Clone, Copy)]
pub struct Facing {
    /// Its own triangle's normal, toward the side that is seen: nothing comes from behind it.
    pub facet: DVec3,
    /// The normal by whose cosine it receives.
    pub normal: DVec3,
}

impl Outline {
    /// That of a triangle by its corners on the plane (x, y, distance along the middle of the disc); `None` edge-on.
    pub fn new([a, b, c]: [DVec3; 3], slot: u32) -> Option<Self> {
        let lines = [b.cross(c), c.cross(a), a.cross(b)];
        let volume = a.dot(lines[0]);
        if volume == 0.0 || !volume.is_finite() {
            return None;
        }
        Some(Outline {
            lines: lines.map(|line| volume.signum() * line),
            slot,
        })
    }

    /// Whether it covers something of the unit circle; a circle near a corner may be taken for a part.
    pub fn meets(&self) -> Meets {
        let mut all = true;
        for line in &self.lines {
            // Squares, for it is asked often.
            let is_across = line.z * line.z < line.x * line.x + line.y * line.y;
            if !is_across && line.z <= 0.0 {
                return Meets::Nothing;
            }
            all &= !is_across;
        }
        if all { Meets::All } else { Meets::Part }
    }
}

impl Disc {
    /// A disc around the unit vector `toward`, of an angular radius [rad] above 0 and below pi / 2, whose luminance falls as
    /// (1 - rho^2)^(exponent / 2) toward the limb, an exponent a channel; 0 is a uniform disc.
    pub fn new(toward: DVec3, angular_radius: f64, limb_exponent: DVec3) -> Self {
        let (x, y) = toward.any_orthonormal_pair();
        let tan = angular_radius.tan();
        let limb = (limb_exponent != DVec3::ZERO).then(|| Limb::new(limb_exponent));
        let angle = |i: usize| PI * (i + 1) as f64 / (CHORDS + 1) as f64;
        let chord = |i: usize| {
            let (half, offset) = angle(i).sin_cos();
            // All of a chord's light goes as half^(1 + exponent); that of a uniform one is its length.
            let weight = match limb_exponent != DVec3::ZERO {
                true => half * powers(half, limb_exponent + 1.0),
                false => DVec3::splat(half),
            };
            Chord {
                offset,
                half,
                weight,
            }
        };
        let mut disc = Disc {
            toward,
            axes: [tan * x, tan * y],
            tan,
            limb,
            chords: (0..CHORDS).map(chord).collect(),
            turns: Vec::new(),
        };
        disc.turns = (0..TURNS)
            .map(|i| {
                let across = DVec2::from_angle(PI * i as f64 / TURNS as f64);
                let turn = Turn {
                    across,
                    whole: DVec3::ONE,
                };
                let whole = disc.light(&[], None, &turn, &[]);
                Turn { across, whole }
            })
            .collect();
        disc
    }

    /// Unit vector toward its middle.
    pub fn toward(&self) -> DVec3 {
        self.toward
    }

    /// Whether any of it lies before the plane of a normal.
    pub fn is_before(&self, normal: DVec3) -> bool {
        normal.dot(self.toward) > -normal.reject_from(self.toward).length() * self.tan
    }

    /// Tangent of its angular radius.
    pub fn tan_radius(&self) -> f64 {
        self.tan
    }

    /// The share of its light that an edge leaves [1], by channel, whose line is `depth` of its radii from its middle: positive where
    /// the middle is hidden.
    ///
    /// 1/2 - (u sqrt(1 - u^2) + asin(u)) / pi of a uniform disc; of a limb-darkened one the integral of (1 - u^2)^((1 + exponent) / 2).
    pub fn beyond(&self, depth: f64) -> DVec3 {
        let u = depth.clamp(-1.0, 1.0);
        match &self.limb {
            Some(limb) => DVec3::ONE - at_place(&limb.beside, u),
            None => DVec3::splat(0.5 - (u * (1.0 - u * u).sqrt() + u.asin()) / PI),
        }
    }

    /// A point relative to a place on the plane, times its distance along the middle of the disc.
    pub(super) fn on_plane(&self, p: DVec3) -> DVec3 {
        let square = self.tan * self.tan;
        DVec3::new(
            p.dot(self.axes[0]) / square,
            p.dot(self.axes[1]) / square,
            p.dot(self.toward),
        )
    }

    /// The line on the plane before which directions make an acute angle with a vector.
    fn line(&self, normal: DVec3) -> DVec3 {
        DVec3::new(
            normal.dot(self.axes[0]),
            normal.dot(self.axes[1]),
            normal.dot(self.toward),
        )
    }

    /// Light of a run of a chord, by channel, and the same times the place on the chord.
    fn of_run(&self, chord: &Chord, [from, to]: Run) -> [DVec3; 2] {
        let light = match &self.limb {
            Some(limb) => {
                let [a, b] = [from, to].map(|l| limb.before(l / chord.half));
                return [
                    chord.weight * (b[0] - a[0]),
                    chord.half * chord.weight * (b[1] - a[1]),
                ];
            }
            None if self.tan < WIDE => to - from,
            // On the plane a uniform disc's illuminance falls as (1 + tan^2(R) rho^2)^-2.
            None => {
                let square = 1.0 + (self.tan * chord.offset).powi(2);
                let root = square.sqrt();
                let before = |l: f64| {
                    let t = self.tan * l;
                    let turned = (t / root).atan() / (root * self.tan);
                    (l / (square + t * t) + turned) / (2.0 * square)
                };
                before(to) - before(from)
            }
        };
        let light = chord.weight * light;
        [light, 0.5 * (from + to) * light]
    }

    /// Light that comes from before all `clips` (lines) and from above the horizon, on a surface with a normal (a line) or on one that
    /// always faces it. `shades` tell what keeps light off the chords; none does where there are none.
    fn light(
        &self,
        clips: &[DVec3],
        normal: Option<DVec3>,
        turn: &Turn,
        shades: &[Shade],
    ) -> DVec3 {
        let horizon = self.line(DVec3::Y);
        let mut sum = DVec3::ZERO;
        for (i, chord) in self.chords.iter().enumerate() {
            let on = |line: &DVec3| on_chord(line, turn.across, chord.offset);
            let mut within = [-chord.half, chord.half];
            for line in clips.iter().chain([&horizon]) {
                within = cut(within, on(line));
            }
            if within[0] >= within[1] {
                continue;
            }
            let of_run = |run: Run| {
                let [light, placed] = self.of_run(chord, run);
                normal.map_or(light, |line| {
                    let [cosine, slope] = on(&line);
                    cosine * light + slope * placed
                })
            };
            let mut add = |[from, to]: Run, pass: DVec3| {
                let run = [
                    (from - chord.half).max(within[0]),
                    (to - chord.half).min(within[1]),
                ];
                if run[1] > run[0] {
                    sum += pass * of_run(run);
                }
            };
            let all = 2.0 * chord.half;
            match shades.get(i) {
                None => add([0.0, all], DVec3::ONE),
                Some(shade) if shade.is_plain() => {
                    complement(&shade.dark, all).for_each(|run| add(run, DVec3::ONE));
                }
                Some(shade) => {
                    for (run, pass) in shade.lit(all) {
                        add(run, pass);
                    }
                }
            }
        }
        sum / turn.whole
    }

    /// The share of its light above the horizon that outlines leave [1], by channel; on a surface with a cosine.
    pub(super) fn left(
        &self,
        geometry: &Geometry,
        outlines: &[Outline],
        panes: Option<(&Geometry, &[Outline])>,
        facing: Option<&Facing>,
        chords: &mut Vec<Shade>,
    ) -> DVec3 {
        let (panes, sheets) = panes.unwrap_or((geometry, &[]));
        let borders = sheets
            .iter()
            .flat_map(|sheet| panes.borders(sheet.slot as usize));
        let borders = borders.map(|along| self.on_plane(along));
        let turn = self.turn(
            outlines.iter().chain(sheets),
            borders.map(|b| DVec2::new(-b.y, b.x)),
        );
        chords.resize_with(CHORDS, Shade::default);
        chords.iter_mut().for_each(|shade| shade.clear());
        for outline in outlines {
            let cut_out = geometry.cut_out(outline.slot as usize);
            let veil = geometry.veil(outline.slot as usize);
            for (chord, shade) in self.chords.iter().zip(chords.iter_mut()) {
                let lines = outline
                    .lines
                    .map(|line| on_chord(&line, turn.across, chord.offset));
                let Some(across) = Across::new(lines, chord.half) else {
                    continue;
                };
                let mut add = |[from, to]: Run| {
                    shade.add(
                        veil,
                        [from + chord.half, to + chord.half],
                        across.span(),
                        0.0,
                    );
                };
                let Some((cut, map)) = cut_out else {
                    add(across.run);
                    continue;
                };
                let spot = |end: usize| cut.spot(across.ends[end].into());
                map.solid_parts([spot(0), spot(1)], [0.0, 1.0], |p, q| {
                    add([across.place(p), across.place(q)]);
                });
            }
        }
        for outline in sheets {
            for (chord, shade) in self.chords.iter().zip(chords.iter_mut()) {
                let lines = outline
                    .lines
                    .map(|line| on_chord(&line, turn.across, chord.offset));
                if let Some(across) = Across::new(lines, chord.half) {
                    panes.tint_chord(outline.slot as usize, &across, self.toward, shade);
                }
            }
        }
        let line = facing.map(|facing| [self.line(facing.facet), self.line(facing.normal)]);
        let clips = line.as_ref().map_or(&[][..], |lines| lines);
        self.light(clips, line.map(|lines| lines[1]), turn, chords)
    }

    /// The direction of chords that lies most across the edges and borders (normals on the plane) which are there.
    fn turn<'a>(
        &self,
        outlines: impl Iterator<Item = &'a Outline>,
        borders: impl Iterator<Item = DVec2>,
    ) -> &Turn {
        let mut least = [1.0f64; TURNS];
        let lines = outlines.flat_map(|outline| &outline.lines);
        // All borders of texels count as if they crossed it.
        let borders = borders.map(|across| across.extend(0.0));
        for line in lines.copied().chain(borders) {
            let size = line.x.hypot(line.y);
            if line.z.abs() < size {
                for (least, turn) in least.iter_mut().zip(&self.turns) {
                    let along = (line.x * -turn.across.y + line.y * turn.across.x).abs();
                    *least = least.min(along / size);
                }
            }
        }
        let best = (1..TURNS).fold(0, |best, i| if least[i] > least[best] { i } else { best });
        &self.turns[best]
    }
}

impl Limb {
    fn new(exponent: DVec3) -> Self {
        let light = integral(exponent);
        let sum = light[STEPS];
        // The integral of s (1 - s^2)^(n / 2) is -(1 - s^2)^(1 + n / 2) / (2 + n).
        let placed = |i: usize| {
            let square = 1.0 - place(i).powi(2);
            -powers(square, 0.5 * exponent + 1.0) / ((exponent + 2.0) * sum)
        };
        let beside = integral(exponent + 1.0);
        Limb {
            before: (0..=STEPS).map(|i| [light[i] / sum, placed(i)]).collect(),
            beside: beside.iter().map(|part| *part / beside[STEPS]).collect(),
        }
    }

    /// What lies before a place of a chord, -1 to 1.
    fn before(&self, at: f64) -> [DVec3; 2] {
        let at = (0.5 * (at + 1.0)).clamp(0.0, 1.0) * STEPS as f64;
        let first = (at as usize).min(STEPS - 1);
        let (a, b) = (self.before[first], self.before[first + 1]);
        let part = at - first as f64;
        [a[0].lerp(b[0], part), a[1].lerp(b[1], part)]
    }
}

/// The place, -1 to 1, of a step of a table.
fn place(step: usize) -> f64 {
    (2.0 * step as f64 / STEPS as f64 - 1.0).clamp(-1.0, 1.0)
}

/// A table's value at a place.
fn at_place(table: &[DVec3], place: f64) -> DVec3 {
    let at = 0.5 * (place + 1.0) * STEPS as f64;
    let first = (at as usize).min(STEPS - 1);
    table[first].lerp(table[first + 1], at - first as f64)
}

/// The integral of (1 - s^2)^(exponent / 2) up to each step of a table.
fn integral(exponent: DVec3) -> Vec<DVec3> {
    const PARTS: usize = 8;
    // With s = sin(angle) it is that of cos^(1 + exponent): smooth but for its ends.
    let power = |angle: f64| powers(angle.cos().max(0.0), exponent + 1.0);
    let mut integral = vec![DVec3::ZERO];
    let mut sum = DVec3::ZERO;
    for i in 0..STEPS {
        let (from, to) = (place(i).asin(), place(i + 1).asin());
        let step = (to - from) / PARTS as f64;
        for part in 0..PARTS {
            let at = from + step * part as f64;
            sum += step / 6.0 * (power(at) + 4.0 * power(at + 0.5 * step) + power(at + step));
        }
        integral.push(sum);
    }
    integral
}

/// A number to the power of each of three.
fn powers(base: f64, exponents: DVec3) -> DVec3 {
    DVec3::from_array(exponents.to_array().map(|n| base.powf(n)))
}

/// A line along a chord: its value in the middle and its slope.
fn on_chord(line: &DVec3, across: DVec2, offset: f64) -> [f64; 2] {
    [
        line.z + offset * (line.x * across.x + line.y * across.y),
        line.y * across.x - line.x * across.y,
    ]
}

impl Geometry {
    /// The share of a disc's light above the horizon that reaches a place, by channel [1]: of a surface, if `facing` is given, times
    /// the cosine of its normal (without the light from behind its facet).
    ///
    /// Exact but for the quadrature across 16 chords: an edge is within 0.3 % of full light; holes that alpha cuts count as
    /// they are.
    pub fn disc_through(
        &self,
        disc: &Disc,
        place: DVec3,
        facing: Option<&Facing>,
        work: &mut DiscWork,
    ) -> DVec3 {
        let DiscWork {
            outlines,
            sheets,
            chords,
        } = work;
        outlines.clear();
        sheets.clear();
        let base = place - self.origin;
        let mut is_dark = false;
        self.in_cone(base, disc.toward, disc.tan, |slot| {
            let corners = self.corners[slot].map(|p| disc.on_plane(p - base));
            let Some(outline) = Outline::new(corners, slot as u32) else {
                return true;
            };
            match outline.meets() {
                Meets::Nothing => {}
                Meets::All if self.veil(slot).is_none() && self.cut_out(slot).is_none() => {
                    is_dark = true;
                }
                _ => outlines.push(outline),
            }
            !is_dark
        });
        if is_dark {
            return DVec3::ZERO;
        }
        let panes = self.panes().map(|panes| panes.tree());
        if let Some(panes) = panes {
            panes.in_cone(place - panes.origin, disc.toward, disc.tan, |slot| {
                let corners =
                    panes.corners[slot].map(|p| disc.on_plane(p - (place - panes.origin)));
                let outline = Outline::new(corners, slot as u32);
                sheets.extend(outline.filter(|outline| outline.meets() != Meets::Nothing));
                true
            });
        }
        if outlines.is_empty() && sheets.is_empty() {
            let whole = |normal: DVec3| {
                let line = disc.line(normal);
                line.z >= line.x.hypot(line.y)
            };
            match facing {
                None => return DVec3::ONE,
                // The mean of the cosines is that of the middle.
                Some(Facing { facet, normal }) => {
                    if whole(*facet) && whole(*normal) && whole(DVec3::Y) {
                        return DVec3::splat(normal.dot(disc.toward));
                    }
                }
            }
        }
        let sheets = panes.map(|panes| (panes, &sheets[..]));
        let left = disc.left(self, outlines, sheets, facing, chords);
        // Of a sliver rounding may leave less than nothing.
        DVec3::select(left.cmplt(DVec3::ZERO), DVec3::ZERO, left)
    }

    /// Calls `found` for the triangles (by slot) whose boxes meet a cone of a place relative to the local origin; it returns whether to
    /// go on.
    pub(super) fn in_cone(
        &self,
        apex: DVec3,
        axis: DVec3,
        tan: f64,
        mut found: impl FnMut(usize) -> bool,
    ) {
        if self.corners.is_empty() {
            return;
        }
        // From just before the scene on, so that a far place costs no digits.
        let skip = (-apex.dot(axis) - self.extent).max(0.0);
        let base = apex + skip * axis;
        let first = (skip * tan) as f32;
        let slack = 1e-6 * (self.extent as f32 + base.length() as f32);
        let (base, tan) = (base.as_vec3a(), tan as f32);
        let axis = axis.as_vec3a();
        let size = axis.abs();
        let tiny = Vec3A::splat(1e-30);
        let inverse = Vec3A::select(size.cmplt(tiny), tiny, axis).recip();
        let mut stack: Vec<u32> = Vec::with_capacity(64);
        stack.push(0);
        while let Some(top) = stack.pop() {
            let node = &self.nodes[top as usize];
            let middle = node.middle - base;
            let far = axis.dot(middle) + size.dot(node.half) + slack;
            if far < 0.0 {
                continue;
            }
            let half = node.half + (first + far * tan + slack);
            let (a, b) = ((middle - half) * inverse, (middle + half) * inverse);
            let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
            if enter > leave || leave < 0.0 {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, node.first + 1]);
                continue;
            }
            for slot in node.first..node.first + node.count {
                if !found(slot as usize) {
                    return;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Ray, from_bytes};
    use crate::split_mix::SplitMix;
    use std::path::Path;

    const RADIUS: f64 = 0.00465;

    /// A scene of triangles.
    fn scene(corners: &[[DVec3; 3]]) -> Geometry {
        let mut text = String::new();
        for p in corners.iter().flatten() {
            text += &format!("v {:?} {:?} {:?}\n", p.x, p.y, p.z);
        }
        for i in 0..corners.len() {
            text += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
        }
        let scene = from_bytes(Path::new("a.obj"), text.as_bytes()).expect("it is sound");
        Geometry::new(&scene)
    }

    /// Points of the disc, as many as lie on a grid: direction and weight by channel.
    fn points(toward: DVec3, radius: f64, exponent: DVec3, side: i32) -> Vec<(DVec3, DVec3)> {
        let (x, y) = toward.any_orthonormal_pair();
        let mut points = Vec::new();
        for i in 0..side * side {
            let at = DVec2::new(f64::from(i % side), f64::from(i / side));
            let at = 2.0 * (at + 0.5) / f64::from(side) - 1.0;
            let square = 1.0 - at.length_squared();
            if square > 0.0 {
                // Even in the illuminance of a surface that faces the middle.
                let offset = radius.sin() * at;
                let sideways = offset.x * x + offset.y * y;
                let direction = (1.0 - offset.length_squared()).sqrt() * toward + sideways;
                let weight = powers(square, 0.5 * exponent);
                points.push((direction, weight));
            }
        }
        points
    }

    fn by_points(
        geometry: &Geometry,
        place: DVec3,
        points: &[(DVec3, DVec3)],
        facing: Option<&Facing>,
    ) -> DVec3 {
        let (mut sum, mut all) = (DVec3::ZERO, DVec3::ZERO);
        for (direction, weight) in points {
            if direction.y <= 0.0 {
                continue;
            }
            all += *weight;
            let ray = Ray {
                origin: place,
                direction: *direction,
            };
            let cosine = facing.map_or(1.0, |facing| match facing.facet.dot(*direction) > 0.0 {
                true => facing.normal.dot(*direction).max(0.0),
                false => 0.0,
            });
            sum += cosine * geometry.transmittance(&ray, 0.0, f64::INFINITY) * *weight;
        }
        sum / all
    }

    #[test]
    fn an_edge_hides_the_share_of_its_circular_segment() {
        let toward = DVec3::new(0.3, 0.8, -0.2).normalize();
        let disc = Disc::new(toward, RADIUS, DVec3::ZERO);
        let (x, y) = toward.any_orthonormal_pair();
        let mut worst = 0.0f64;
        for turn in 0..40 {
            let angle = 0.1 + 0.157 * f64::from(turn);
            let normal = angle.cos() * x + angle.sin() * y;
            let along = normal.cross(toward);
            for step in -24..=24 {
                let u = f64::from(step) / 20.0;
                let distance = 300.0;
                let edge = distance * (toward + u * RADIUS.tan() * normal);
                let far = 1e3;
                let [a, b] = [edge - far * along, edge + far * along];
                let [c, d] = [a - far * normal, b - far * normal];
                let geometry = scene(&[[a, b, d], [a, d, c]]);
                let left =
                    geometry.disc_through(&disc, DVec3::ZERO, None, &mut DiscWork::default());
                let v = u.clamp(-1.0, 1.0);
                let hidden = 0.5 + (v * (1.0 - v * v).sqrt() + v.asin()) / PI;
                worst = worst.max((left.x - (1.0 - hidden)).abs());
            }
        }
        println!("worst {worst:.5}");
        assert!(worst < 0.003, "{worst}");
    }

    #[test]
    fn any_triangles_leave_what_points_say() {
        let mut random = SplitMix(7);
        let mut number = || (random.bits() >> 11) as f64 / (1u64 << 53) as f64;
        for (radius, exponent) in [
            (RADIUS, DVec3::ZERO),
            (RADIUS, DVec3::new(0.44, 0.53, 0.6)),
            (0.3, DVec3::ZERO),
        ] {
            let (mut square, mut count, mut worst) = (0.0, 0, 0.0f64);
            for _ in 0..60 {
                let low = number() < 0.3;
                let height = if low {
                    radius * (number() - 0.3)
                } else {
                    0.1 + number()
                };
                let toward = DVec3::new(1.0, height, number() - 0.5).normalize();
                let disc = Disc::new(toward, radius, exponent);
                let (x, y) = toward.any_orthonormal_pair();
                let mut corner = || {
                    let distance = 50.0 + 300.0 * number();
                    let wide = 2.5 * radius.tan();
                    distance
                        * (toward
                            + wide * ((2.0 * number() - 1.0) * x + (2.0 * number() - 1.0) * y))
                };
                let triangles: Vec<_> = (0..4).map(|_| [corner(), corner(), corner()]).collect();
                let geometry = scene(&triangles);
                let points = points(toward, radius, exponent, 160);
                let facet = (toward + 0.999 * (x - toward)).normalize();
                let facing = Facing {
                    facet,
                    normal: (facet + 0.1 * y).normalize(),
                };
                for facing in [None, Some(&facing)] {
                    let exact = by_points(&geometry, DVec3::ZERO, &points, facing);
                    let found =
                        geometry.disc_through(&disc, DVec3::ZERO, facing, &mut DiscWork::default());
                    let scale = if facing.is_some() { radius } else { 1.0 };
                    let off = ((found - exact) / scale).abs().max_element();
                    square += off * off;
                    count += 1;
                    worst = worst.max(off);
                }
            }
            let rms = (square / f64::from(count)).sqrt();
            println!("radius {radius}: RMS {rms:.5}, worst {worst:.5}");
            assert!(rms < 0.004 && worst < 0.02, "{radius}: {rms} {worst}");
        }
    }
}
