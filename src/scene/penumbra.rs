//! Where along a ray a disc is seen in part, and how much of it: the curtain's soft edges.
//!
//! Seen from the ray's place at t, a triangle's corner is A + t D on the plane of the disc (see the module `disc`), with the same
//! D for all corners, so that the line through two corners is U + t V: linear in t. It touches the disc where
//! L_z^2 = L_x^2 + L_y^2, a quadratic equation in t. So every edge has exact places between which it crosses the disc: its
//! penumbra. Elsewhere the disc is seen whole or not at all, as its middle is, and the curtain's runs hold.
//!
//! Within penumbrae the share of the disc that is seen is smooth between the places where edges come and go. It is found at a few
//! Gauss-Legendre nodes from all triangles that cover something of the disc there, however they overlap. There is no step, and
//! an edge need not cross the ray: what lies beside it, ends in it or runs along it counts by its own distance from the sun.
//!
//! An edge that two triangles share from two sides is no edge: the disc does not show between them. So a triangle that hides the
//! disc's middle hides all of it as long as no edge where the surface ends is nearer, seen along the light, than the disc is wide
//! there. What could only hide what is hidden already is skipped, as by the curtain.

use super::Ray;
use super::across::cut;
use super::disc::{Meets, Outline};
use super::edges::{Edges, Margin};
use super::geometry::{Geometry, Node};
use super::shade::{Run, Shade, gaps, holds, insert};
use glam::{DVec3, Vec3A};
use std::f64::consts::FRAC_PI_2;

/// Nodes of Gauss-Legendre quadrature within a penumbra, in 0 to 1, and their weights.
pub const NODES: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Where more penumbrae than this lie along a ray, as in leaves, edges are not told apart.
const PIECES: usize = 128;

/// The same of triangles.
const TRIANGLES: usize = 512;

/// A part of a ray in a penumbra.
#[derive(Debug, Clone, Copy)]
pub struct Ramp {
    /// From where to where [m].
    pub run: Run,
    /// The share of the disc's light that arrives at each of [`NODES`], by channel.
    pub shares: [DVec3; NODES.len()],
}

/// What of a disc reaches a ray.
#[derive(Debug, Default)]
pub struct SoftShade {
    /// Runs that the whole disc lights, and the share of its light that surfaces let through.
    pub lit: Vec<(Run, f64)>,
    /// Runs that a part of it lights.
    pub ramps: Vec<Ramp>,
    found: Vec<Found>,
    /// Edges that cross the disc, and from where to where.
    crossing: Vec<Crossing>,
    ends: Vec<f64>,
    soft: Vec<Run>,
    /// Runs that one triangle shades from all of it.
    dark: Vec<Run>,
    outlines: Vec<Outline>,
    chords: Vec<Shade>,
    /// What shades the disc's middle.
    middle: Shade,
    pieces: Vec<Run>,
}

impl SoftShade {
    /// How many times an edge crosses the disc on the way of the ray, as far as it was sought.
    pub fn penumbrae(&self) -> usize {
        self.crossing.len()
    }
}

/// A triangle that covers a part of the disc as seen from a run of the ray.
#[derive(Debug, Clone, Copy)]
struct Found {
    /// Lines through two corners at the ray's place 0, and what they change by in a metre; positive inside.
    lines: [[DVec3; 2]; 3],
    slot: u32,
    run: Run,
}

/// An edge that crosses the disc as seen from a run of the ray.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    /// As those of `Found`.
    line: [DVec3; 2],
    run: Run,
}

impl Crossing {
    /// Signed distance of the disc's middle from it [radii of the disc], positive where the triangle hides the middle.
    fn depth(&self, t: f64) -> f64 {
        let line = self.line[0] + t * self.line[1];
        line.z / (line.x * line.x + line.y * line.y).sqrt()
    }

    /// The same line as another one's, seen from a place of the ray.
    fn is_line_of(&self, other: &Crossing, t: f64) -> bool {
        let [a, b] = [self, other].map(|edge| {
            let line = edge.line[0] + t * edge.line[1];
            line / (line.x * line.x + line.y * line.y).sqrt()
        });
        (a - b).abs().max_element() < SAME_LINE
    }
}

/// Edges of two triangles that differ by less on the disc [its radii] are one edge.
const SAME_LINE: f64 = 1e-6;

impl Geometry {
    /// What of a disc reaches the first `far` metres of a ray: `shade` is overwritten; no ramp goes beyond one of `borders` [m].
    /// Whether it was found: not where alpha cuts holes into what stands in the way, or too many edges do.
    pub fn soft_shade(
        &self,
        ray: &Ray,
        far: f64,
        edges: &Edges,
        borders: impl Iterator<Item = f64>,
        shade: &mut SoftShade,
    ) -> bool {
        shade.lit.clear();
        shade.ramps.clear();
        shade.crossing.clear();
        if far <= 0.0 {
            return true;
        }
        if self.corners.is_empty() {
            shade.lit.push(([0.0, far], 1.0));
            return true;
        }
        shade.found.clear();
        shade.ends.clear();
        shade.soft.clear();
        shade.dark.clear();
        shade.middle.clear();
        let near = (self.origin - ray.origin)
            .dot(ray.direction)
            .clamp(0.0, far);
        let mut search = Search {
            geometry: self,
            edges,
            base: (ray.origin - self.origin) + near * ray.direction,
            drift: -edges.disc().on_plane(ray.direction),
            span: [-near, far - near],
            height: 0.0,
            slope: 0.0,
            together: 1e-13 * (near + self.extent),
            wedge: None,
            shade,
        };
        if !search.run(ray) {
            return false;
        }
        let together = 1e-13 * (near + self.extent);
        let soft = std::mem::take(&mut shade.soft);
        // From the place 0 on, as it wants them.
        let moved = |run: Run| run.map(|t| t + near);
        shade
            .middle
            .dark
            .iter_mut()
            .for_each(|run| *run = moved(*run));
        shade
            .middle
            .veiled
            .iter_mut()
            .for_each(|veil| veil.run = moved(veil.run));
        for ([from, to], pass) in shade.middle.lit_in_part(far) {
            shade.pieces.clear();
            gaps(&soft, from - near, to - near, &mut shade.pieces);
            let pieces = shade.pieces.iter();
            shade
                .lit
                .extend(pieces.map(|[a, b]| ([(a + near).max(0.0), (b + near).min(far)], pass)));
        }
        if !soft.is_empty() {
            shade.ends.extend(borders.map(|t| t - near));
            shade.ends.sort_unstable_by(f64::total_cmp);
        }
        shade.pieces.clear();
        for run in &soft {
            gaps(&shade.dark, run[0], run[1], &mut shade.pieces);
        }
        let pieces = std::mem::take(&mut shade.pieces);
        for [from, to] in &pieces {
            let mut next = shade.ends.partition_point(|end| *end <= *from);
            let mut at = *from;
            while at < *to {
                let end = shade.ends.get(next).map_or(*to, |end| end.min(*to));
                next += 1;
                if end - at <= together && end < *to {
                    continue;
                }
                let shares = self.shares([at, end], edges, shade);
                if shares.iter().any(|share| *share != DVec3::ZERO) {
                    shade.ramps.push(Ramp {
                        run: [(at + near).max(0.0), (end + near).min(far)],
                        shares,
                    });
                }
                at = end;
            }
        }
        shade.pieces = pieces;
        shade.soft = soft;
        true
    }

    /// The shares of the disc's light at the nodes of a run on which no edge comes or goes.
    fn shares(&self, run: Run, edges: &Edges, shade: &mut SoftShade) -> [DVec3; NODES.len()] {
        let SoftShade {
            found,
            crossing,
            outlines,
            chords,
            ..
        } = shade;
        let [from, to] = run;
        let place = |node: f64| from + node * (to - from);
        let is_there = |run: Run| run[0] < place(0.5) && place(0.5) < run[1];
        let mut exact = |t: f64| {
            outlines.clear();
            // What ends at no edge may come and go on the way.
            let there = found
                .iter()
                .filter(|found| found.run[0] <= t && t <= found.run[1]);
            outlines.extend(there.map(|found| Outline {
                lines: found.lines.map(|[line, change]| line + t * change),
                slot: found.slot,
            }));
            edges.disc().left(self, outlines, None, None, chords)
        };
        // One edge alone: all else hides what it leaves, or nothing of it.
        let mut there = crossing.iter().filter(|edge| is_there(edge.run));
        if let Some(edge) = there.next()
            && there.all(|other| edge.is_line_of(other, place(0.5)))
        {
            let [one, other] = [NODES[0].0, NODES[NODES.len() - 1].0].map(place);
            let open = if edge.depth(one) < edge.depth(other) {
                one
            } else {
                other
            };
            let (left, alone) = (exact(open), edges.disc().beyond(edge.depth(open)));
            if left == DVec3::ZERO {
                return [DVec3::ZERO; NODES.len()];
            }
            if (left - alone).abs().max_element() < ALONE {
                return NODES.map(|(node, _)| edges.disc().beyond(edge.depth(place(node))));
            }
        }
        NODES.map(|(node, _)| exact(place(node)))
    }
}

/// An edge hides what it would alone, within the error of chords [1].
const ALONE: f64 = 0.003;

struct Search<'a> {
    geometry: &'a Geometry,
    edges: &'a Edges,
    /// Where the ray's place 0 is, relative to the local origin.
    base: DVec3,
    /// What corners move by on the disc's plane in a metre of the ray.
    drift: DVec3,
    span: Run,
    /// How far toward the light the ray's place 0 is [m], and by how much more a metre on.
    height: f64,
    slope: f64,
    together: f64,
    wedge: Option<Wedge>,
    shade: &'a mut SoftShade,
}

/// What lies between a ray and a disc, in the curtain's frame (n, m, r).
#[derive(Clone, Copy)]
struct Wedge {
    frame: [DVec3; 3],
    /// A place of the ray sees the disc over y within x = aslant y, and between z = y steep and z = y flat.
    aslant: f64,
    steep: f64,
    flat: f64,
    slack: f64,
}

impl Wedge {
    /// The run of the ray that three corners, relative to its place 0, can shade.
    fn run(&self, corners: &[DVec3; 3], span: Run) -> Run {
        let mut run = [f64::INFINITY, f64::NEG_INFINITY];
        let mut x = run;
        let (mut highest, mut below, mut all) = (f64::NEG_INFINITY, false, run);
        for p in corners {
            let p = self.frame.map(|axis| axis.dot(*p));
            x = [x[0].min(p[0]), x[1].max(p[0])];
            all = [all[0].min(p[2]), all[1].max(p[2])];
            highest = highest.max(p[1]);
            below |= p[1] < 0.0;
            let y = p[1].max(0.0);
            run = [
                run[0].min(p[2] - y * self.steep),
                run[1].max(p[2] - y * self.flat),
            ];
        }
        if highest < 0.0 || x[0].max(-x[1]) > self.aslant * highest + self.slack {
            return [0.0; 2];
        }
        if below {
            run = [run[0].min(all[0]), run[1].max(all[1])];
        }
        [
            (run[0] - self.slack).max(span[0]),
            (run[1] + self.slack).min(span[1]),
        ]
    }
}

impl Search<'_> {
    /// Visits all triangles that may cover something of the disc; false if there are too many, or one that it cannot tell of.
    fn run(&mut self, ray: &Ray) -> bool {
        let disc = self.edges.disc();
        let (r, toward, tan) = (ray.direction, disc.toward(), disc.tan_radius());
        let aside = toward - r * toward.dot(r);
        let (sine, cosine) = (aside.length(), toward.dot(r));
        (self.height, self.slope) = (toward.dot(self.base), cosine);
        if sine < 4.0 * tan {
            return self.run_along(ray, sine, cosine);
        }
        let once = aside / sine;
        let m = (once - r * once.dot(r)).normalize();
        let n = m.cross(r);
        let (na, ma, ra) = (n.as_vec3a(), m.as_vec3a(), r.as_vec3a());
        let sizes = [na.abs(), ma.abs(), ra.abs()];
        let base = self.base.as_vec3a();
        let slack = 1e-6 * (self.geometry.extent as f32 + base.length());
        let aslant = tan / (sine - tan * cosine.abs());
        let theta = sine.atan2(cosine);
        let radius = tan.atan();
        let cot = |angle: f64| (FRAC_PI_2 - angle).tan();
        let (steep, flat) = (cot(theta - radius), cot(theta + radius));
        self.wedge = Some(Wedge {
            frame: [n, m, r],
            aslant,
            steep,
            flat,
            slack: 1e-12
                * (self.geometry.extent + self.base.length())
                * (1.0 + steep.abs().max(flat.abs())),
        });
        let (aslant, steep, flat) = (aslant as f32, steep as f32, flat as f32);
        let margin = slack * (1.0 + steep.abs().max(flat.abs()));
        let span = self.span;
        let reach = move |node: &Node| -> Option<Run> {
            let c: Vec3A = node.middle - base;
            let x = na.dot(c).abs() - sizes[0].dot(node.half) - slack;
            let (y, y_half) = (ma.dot(c), sizes[1].dot(node.half) + slack);
            let high = y + y_half;
            if high < 0.0 || x > aslant * high + slack {
                return None;
            }
            let low = (y - y_half).max(0.0);
            let (z, z_half) = (ra.dot(c), sizes[2].dot(node.half) + slack);
            let most = (low * steep).max(high * steep);
            let least = (low * flat).min(high * flat);
            let from = f64::from(z - z_half - most - margin).max(span[0]);
            let to = f64::from(z + z_half - least + margin).min(span[1]);
            (from < to).then_some([from, to])
        };
        let nodes = &self.geometry.nodes;
        let mut stack: Vec<(u32, Run)> = Vec::with_capacity(64);
        stack.extend(reach(&nodes[0]).map(|reach| (0, reach)));
        while let Some((top, [from, to])) = stack.pop() {
            if holds(&self.shade.dark, from, to) {
                continue;
            }
            let node = &nodes[top as usize];
            if node.count > 0 {
                for slot in node.first..node.first + node.count {
                    if !self.triangle(slot as usize) {
                        return false;
                    }
                }
                continue;
            }
            let children = [node.first, node.first + 1];
            let reaches = children.map(|child| reach(&nodes[child as usize]));
            // The child that may darken most comes first, so last onto the stack.
            let length = |i: usize| reaches[i].map_or(0.0, |[from, to]| to - from);
            let order = if length(0) > length(1) {
                [1, 0]
            } else {
                [0, 1]
            };
            for i in order {
                stack.extend(reaches[i].map(|reach| (children[i], reach)));
            }
        }
        true
    }

    /// The same of a ray that runs nearly toward the disc, or away from it: all that can cover the disc lies in a cone.
    fn run_along(&mut self, ray: &Ray, sine: f64, cosine: f64) -> bool {
        let disc = self.edges.disc();
        let (toward, tan) = (disc.toward(), disc.tan_radius());
        let end = if cosine > 0.0 {
            self.span[0]
        } else {
            self.span[1]
        };
        let apex = self.base + end * ray.direction;
        let wide = tan.max(sine / cosine.abs());
        let geometry = self.geometry;
        let mut is_told = true;
        geometry.in_cone(apex, toward, wide, |slot| {
            is_told = self.triangle(slot);
            is_told
        });
        is_told
    }

    /// Takes in where one triangle covers the disc's middle.
    fn middle(
        &mut self,
        slot: usize,
        lines: &[[DVec3; 2]; 3],
        span: Run,
        volume: f64,
        growth: f64,
    ) -> bool {
        let geometry = self.geometry;
        let turn = -volume / growth;
        let sides = if turn > span[0] && turn < span[1] {
            [[span[0], turn], [turn, span[1]]]
        } else {
            [span, [0.0; 2]]
        };
        for side in sides {
            let sign = (volume + 0.5 * (side[0] + side[1]) * growth).signum();
            let run = lines.iter().fold(side, |run, [line, change]| {
                cut(run, [sign * line.z, sign * change.z])
            });
            if run[0] >= run[1] {
                continue;
            }
            if geometry.cut_out(slot).is_some() {
                return false;
            }
            let veil = geometry.veil(slot);
            let SoftShade { middle, dark, .. } = &mut *self.shade;
            middle.add(veil, run, self.span, self.together);
            if veil.is_some() || holds(dark, run[0], run[1]) {
                continue;
            }
            let Margin { width, top } = self.edges.margin(geometry, slot);
            // As long as the disc is not wider than the margin: top - height - slope t <= width / tan.
            let most = f64::from(width) / self.edges.disc().tan_radius();
            let run = cut(run, [most - f64::from(top) + self.height, self.slope]);
            if run[0] < run[1] {
                insert(dark, run, self.together);
            }
        }
        true
    }

    /// Takes in what one triangle covers of the disc.
    fn triangle(&mut self, slot: usize) -> bool {
        let disc = self.edges.disc();
        let geometry = self.geometry;
        let corners = geometry.corners[slot].map(|p| p - self.base);
        let span = match &self.wedge {
            Some(wedge) => wedge.run(&corners, self.span),
            None => self.span,
        };
        if span[0] >= span[1] || holds(&self.shade.dark, span[0], span[1]) {
            return true;
        }
        let corners = corners.map(|p| disc.on_plane(p));
        let drift = self.drift;
        let [a, b, c] = corners;
        let lines = [(b, c), (c, a), (a, b)].map(|(p, q)| [p.cross(q), (p - q).cross(drift)]);
        // The volume of the corners, linear in t as well.
        let volume = a.dot(lines[0][0]);
        let growth = drift.dot(lines[0][0] + lines[1][0] + lines[2][0]);
        if !self.middle(slot, &lines, span, volume, growth) {
            return false;
        }
        // Where something may change.
        let mut places = [0.0; 9];
        let mut count = 0;
        let mut add = |t: f64| {
            if t > span[0] && t < span[1] {
                places[count] = t;
                count += 1;
            }
        };
        if growth != 0.0 {
            add(-volume / growth);
        }
        for [line, change] in &lines {
            for root in touches(*line, *change).into_iter().flatten() {
                add(root);
            }
        }
        let places = &mut places[..count];
        places.sort_unstable_by(f64::total_cmp);
        let is_plain = geometry.veil(slot).is_none() && geometry.cut_out(slot).is_none();
        let mut from = span[0];
        for i in 0..=count {
            let to = places.get(i).copied().unwrap_or(span[1]);
            let run = [from, to];
            from = to;
            if run[0] >= run[1] || holds(&self.shade.dark, run[0], run[1]) {
                continue;
            }
            let t = 0.5 * (run[0] + run[1]);
            let sign = (volume + t * growth).signum();
            let there = Outline {
                lines: lines.map(|[line, change]| sign * (line + t * change)),
                slot: slot as u32,
            };
            match there.meets() {
                Meets::Nothing => {}
                Meets::All if is_plain => insert(&mut self.shade.dark, run, 0.0),
                _ => {
                    if geometry.cut_out(slot).is_some() {
                        return false;
                    }
                    self.shade.found.push(Found {
                        lines: lines.map(|line| line.map(|part| sign * part)),
                        slot: slot as u32,
                        run,
                    });
                    let mut any = false;
                    for (i, line) in there.lines.iter().enumerate() {
                        let is_open = self.edges.is_open(slot, i);
                        if is_open && line.z * line.z < line.x * line.x + line.y * line.y {
                            any = true;
                            self.shade.crossing.push(Crossing {
                                line: lines[i].map(|part| sign * part),
                                run,
                            });
                        }
                    }
                    if !is_plain && growth != 0.0 {
                        // What lets light through ends where the ray passes it, in the middle of a penumbra too.
                        self.shade.ends.push(-volume / growth);
                    }
                    if any {
                        self.shade.ends.extend(run);
                        insert(&mut self.shade.soft, run, 0.0);
                    }
                }
            }
        }
        self.shade.found.len() <= TRIANGLES && self.shade.ends.len() <= 2 * PIECES
    }
}

/// Where a line U + t V touches the unit circle.
fn touches(line: DVec3, change: DVec3) -> [Option<f64>; 2] {
    let product = |p: DVec3, q: DVec3| p.z * q.z - p.x * q.x - p.y * q.y;
    let (a, b, c) = (
        product(change, change),
        product(line, change),
        product(line, line),
    );
    let square = b * b - a * c;
    if square < 0.0 {
        return [None; 2];
    }
    // Without a difference of like numbers.
    let q = -(b + square.sqrt().copysign(b));
    let root = |p: f64, q: f64| Some(p / q).filter(|t| t.is_finite());
    [root(q, a), root(c, q)]
}
