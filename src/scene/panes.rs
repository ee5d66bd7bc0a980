//! Panes: where light crosses glass, and what is left of it behind.
//!
//! A pane stands in no one's way: eye, shadows and patches look through it, and what they see is multiplied by what the glass lets
//! through at the angle of the way ([`super::glass`]), by channel of the working space. Light goes straight on; what a pane
//! reflects is left out. Of a material that alpha has there in part, a, 1 - a + a T is let through.
//!
//! Panes are a tree of triangles of their own, beside that of all that stops light. The curtain, the fan and the chords of the sun's disc
//! draw straight lines over them, whose parts of one colour have exact ends (see the module `glazing`).

use super::across::Across;
use super::geometry::{Geometry, SAME_PLACE};
use super::shade::{Run, Shade};
use super::{Hit, Ray};
use crate::beam::Beam;
use glam::{DVec2, DVec3};

/// The panes of a scene.
#[derive(Clone, Copy)]
pub struct Panes<'a> {
    /// Their triangles.
    tree: &'a Geometry,
}

impl<'a> Panes<'a> {
    /// The scene's numbers of the triangles that are panes.
    pub fn triangles(&self) -> &'a [u32] {
        &self.tree.scene_triangle
    }

    /// Where a ray crosses panes between the distances `near` and `far` [m], in order, and what each lets through [1].
    pub fn crossings(&self, ray: &Ray, near: f64, far: f64) -> Vec<(f64, DVec3)> {
        self.tree.crossings(ray, near, far)
    }

    /// The panes that a ray crosses between the distances `near` and `far` [m], in order: where, and the scene's number of the triangle.
    pub fn met(&self, ray: &Ray, near: f64, far: f64) -> Vec<(f64, u32)> {
        let mut met = Vec::new();
        self.tree.visit(ray, near, far, |_, hit| {
            met.push((hit.distance, hit.triangle));
            f64::INFINITY
        });
        met.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        met
    }

    /// What is left of light that goes along a ray from the distance `near` to `far` [m], either way [1].
    pub fn transmittance(&self, ray: &Ray, near: f64, far: f64) -> DVec3 {
        let crossings = self.crossings(ray, near, far);
        crossings.iter().map(|(_, through)| *through).product()
    }

    /// Adds what panes keep of the light of beams off the first `far` metres of a ray.
    pub(super) fn tint(&self, ray: &Ray, far: f64, beams: &[Beam], shades: &mut [Shade]) {
        let mut found = Vec::new();
        self.tree.shades_of_triangles(ray, far, beams, &mut found);
        for (shade, found) in shades.iter_mut().zip(found) {
            shade.tinted = found.tinted;
        }
    }

    /// Their triangles, with what they let through.
    pub(super) fn tree(&self) -> &'a Geometry {
        self.tree
    }
}

/// What panes leave of light that comes along a ray to where it begins.
#[derive(Debug, Default)]
pub struct Sighted {
    /// Distances [m], ascending, from beyond which as much is left.
    steps: Vec<(f64, DVec3)>,
}

impl Sighted {
    /// Whether there is no pane.
    pub fn is_clear(&self) -> bool {
        self.steps.is_empty()
    }

    /// Of light from a distance [m]: what is left of it, by channel [1].
    pub fn from(&self, distance: f64) -> DVec3 {
        let before = self.steps.partition_point(|(at, _)| *at < distance);
        match before {
            0 => DVec3::ONE,
            n => self.steps[n - 1].1,
        }
    }

    /// The runs between panes up to a distance [m], and what is left of light from there.
    pub fn runs(&self, far: f64) -> Vec<(Run, DVec3)> {
        self.of(vec![([0.0, far], DVec3::ONE)])
    }

    /// Runs of the ray, divided at panes, and what of their light is left.
    pub fn of(&self, runs: Vec<(Run, DVec3)>) -> Vec<(Run, DVec3)> {
        if self.steps.is_empty() {
            return runs;
        }
        let mut seen = Vec::with_capacity(runs.len() + self.steps.len());
        for ([from, to], share) in runs {
            let inner = self.steps.iter().map(|(at, _)| *at);
            let inner = inner.filter(|at| *at > from && *at < to);
            let mut at = from;
            for end in inner.chain([to]) {
                let left = share * self.from(0.5 * at + 0.5 * end.min(f64::MAX));
                if end > at && left != DVec3::ZERO {
                    seen.push(([at, end], left));
                }
                at = end;
            }
        }
        seen
    }
}

impl Geometry {
    /// The panes of the scene, if it has any.
    pub fn panes(&self) -> Option<Panes<'_>> {
        self.panes.as_deref().map(|tree| Panes { tree })
    }

    /// What panes leave of what a ray sees between its start and a distance [m].
    pub fn sighted(&self, ray: &Ray, far: f64) -> Sighted {
        let Some(panes) = self.panes() else {
            return Sighted::default();
        };
        let mut left = DVec3::ONE;
        let steps = panes.crossings(ray, 0.0, far).into_iter();
        let steps = steps.map(|(distance, through)| {
            left *= through;
            (distance, left)
        });
        Sighted {
            steps: steps.collect(),
        }
    }

    /// Of a tree of panes, where a ray crosses them and what each lets through. At the edge between two triangles of one pane it
    /// crosses it once.
    pub(super) fn crossings(&self, ray: &Ray, near: f64, far: f64) -> Vec<(f64, DVec3)> {
        let Some(glazing) = &self.glazing else {
            return Vec::new();
        };
        let mut met = Vec::new();
        self.visit(ray, near, far, |slot, hit| {
            met.push((slot, hit));
            f64::INFINITY
        });
        met.sort_unstable_by(|(_, a), (_, b)| {
            let by_distance = a.distance.total_cmp(&b.distance);
            by_distance.then(a.triangle.cmp(&b.triangle))
        });
        let reach = (ray.origin - self.origin).length() + self.extent;
        met.dedup_by(|(other, b), (slot, a)| {
            glazing.glass(*slot) == glazing.glass(*other)
                && b.distance - a.distance <= SAME_PLACE * reach
        });
        let through = |(slot, hit): (usize, Hit)| {
            let cosine = glazing.normal(slot).dot(ray.direction);
            let through = glazing.through(slot, hit.barycentric.into(), cosine);
            (hit.distance, through)
        };
        met.into_iter().map(through).collect()
    }
}

impl Geometry {
    /// Of a tree of panes, unit vectors along the borders between colours of one of them.
    pub(super) fn borders(&self, slot: usize) -> impl Iterator<Item = DVec3> {
        let borders = self.glazing.as_ref().map(|glazing| glazing.borders(slot));
        borders.into_iter().flatten().flatten()
    }

    /// Of a tree of panes, adds what one of them lets through to a chord of a disc that light comes from.
    pub(super) fn tint_chord(
        &self,
        slot: usize,
        across: &Across,
        toward: DVec3,
        shade: &mut Shade,
    ) {
        let cosine = self.pane_normal(slot).dot(toward);
        self.colours(
            slot,
            across.ends,
            |_| cosine,
            |p, q, through| {
                let run = [p, q].map(|f| across.along(f));
                shade.tint(through, run, across.span());
            },
        );
    }

    /// Of a tree of panes, the unit normal of one of them.
    pub(super) fn pane_normal(&self, slot: usize) -> DVec3 {
        let glazing = self.glazing.as_ref();
        glazing.map_or(DVec3::ZERO, |glazing| glazing.normal(slot))
    }

    /// Of a tree of panes, calls `found` for the parts of a straight line over one of them where there is glass, as fractions of the
    /// line, with what is let through there. The line's ends are weights of the second and third corner; `cosine` is that of the
    /// light's way to the normal, by the fraction.
    pub(super) fn colours(
        &self,
        slot: usize,
        line: [DVec2; 2],
        cosine: impl Fn(f64) -> f64,
        mut found: impl FnMut(f64, f64, DVec3),
    ) {
        let Some(glazing) = &self.glazing else {
            return;
        };
        let Some((cut, map)) = self.cut_out(slot) else {
            return glazing.parts(slot, line, [0.0, 1.0], &cosine, &mut found);
        };
        let ends = line.map(|at| cut.spot(at.into()));
        map.solid_parts(ends, [0.0, 1.0], |p, q| {
            glazing.parts(slot, line, [p, q], &cosine, &mut found);
        });
    }
}
