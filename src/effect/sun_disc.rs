//! The sun's disc behind everything, by exact coverage of each pixel.
//!
//! A pixel shows the mean over its own solid angle of the disc's luminance: L = 1 / Omega_pixel * integral over pixel and disc
//! of L(rho) dw. So the pixels' sum is the sun's illuminance however small the disc is against a pixel. Directions are mapped
//! around the sun's centre by Lambert's azimuthal equal-area projection, in which solid angles are areas and circles stay
//! circles; the pixel's outline becomes a polygon, whose overlap with the rings of the limb-darkened disc has a closed form.
//! The part below the horizon is cut off. With several samples a pixel, those nearest the sun's centre take that light, as many as
//! the disc covers: their mean is the same, and a display can show the disc's rim by what each of them sees.
//! In an orthographic view every pixel looks in one direction and shows its luminance.

use super::{Contribution, Decision, Effect, Field};
use crate::conditions::{Conditions, Sun, View, sample_positions};
use crate::scene::Projection;
use glam::{DVec2, DVec3, UVec2};

/// The sun seen directly.
pub const SUN_DISC: Effect = Effect {
    name: "sun_disc",
    summary: "the sun's disc where nothing stands before it",
    reads: &[Field::Surface],
    writes: &[Field::Background],
    decide: |conditions| {
        let sun = &conditions.sun;
        if let Some(reason) = sun.missing() {
            return Decision::nothing(reason);
        }
        if sun.angular_radius() == 0.0 {
            return Decision::nothing("a point sun has no disc");
        }
        let brightest = Contribution::Bound(sun.illuminance_lux() / sun.solid_angle());
        if in_picture(conditions) {
            Decision::run("the sun stands in the picture", brightest)
        } else {
            Decision::nothing("the sun stands outside the picture")
        }
    },
    reference: |conditions, _, _| {
        let disc = Disc::new(&conditions.sun);
        Ok(Box::new(move |fields| {
            fields.update(Field::Background, |ray, pixel, surface, present| {
                if surface.is_met() {
                    return present;
                }
                let seen = match conditions.view.camera.projection {
                    Projection::Orthographic { .. } => disc.luminance_at(ray.direction),
                    _ if disc.is_far_from(ray.direction, conditions) => DVec3::ZERO,
                    _ => {
                        let (mean, covered) = disc.mean_luminance(&outline(conditions, pixel));
                        disc.share(ray.direction, pixel, covered, &conditions.view) * mean
                    }
                };
                present + seen
            });
        }))
    },
    // Exact coverage needs f64; it costs nothing away from the disc's few pixels.
    passes: &[],
    ..Effect::NOTHING
};

/// Whether any pixel can show a part of the disc.
fn in_picture(conditions: &Conditions) -> bool {
    let [w, h] = conditions.view.size;
    let sun = &conditions.sun;
    let reach = sun.angular_radius() + pixel_angle(conditions);
    match conditions.view.camera.projection {
        Projection::Panorama => true,
        Projection::Orthographic { .. } => {
            let [_, _, forward] = conditions.view.camera.axes();
            forward.angle_between(sun.toward) <= reach
        }
        Projection::Perspective { .. } => {
            // The picture is a convex cone: the disc is outside when it lies wholly beyond one of its four sides.
            let (w, h) = (f64::from(w), f64::from(h));
            let corners = [
                DVec2::ZERO,
                DVec2::new(w, 0.0),
                DVec2::new(w, h),
                DVec2::new(0.0, h),
            ]
            .map(|p| {
                conditions
                    .view
                    .camera
                    .ray(p, conditions.view.size)
                    .direction
            });
            (0..4).all(|i| {
                let inward = corners[i].cross(corners[(i + 1) % 4]).normalize();
                inward.dot(sun.toward) >= -reach.sin()
            })
        }
    }
}

/// More than the angle between a pixel's centre and its farthest corner [rad], anywhere in the picture.
fn pixel_angle(conditions: &Conditions) -> f64 {
    let [w, h] = conditions.view.size;
    match conditions.view.camera.projection {
        Projection::Perspective { fov_y } => {
            // Pixels are largest in angle in the middle, where one spans 2 tan(fov / 2) / h.
            2.0 * (0.5 * fov_y).tan() / f64::from(h)
        }
        Projection::Orthographic { .. } => 0.0,
        Projection::Panorama => {
            std::f64::consts::PI * (1.0 / f64::from(w)).max(1.0 / f64::from(h)) * 2.0
        }
    }
}

/// The outline of a pixel as directions, sixteen a side on a panorama (whose sides are not great circles).
fn outline(conditions: &Conditions, pixel: UVec2) -> Vec<DVec3> {
    let corner = pixel.as_dvec2();
    let sides = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
    let mut at = corner;
    let mut directions = Vec::with_capacity(64);
    for side in sides {
        for i in 0..16 {
            let position = at + side * (f64::from(i) / 16.0);
            directions.push(
                conditions
                    .view
                    .camera
                    .ray(position, conditions.view.size)
                    .direction,
            );
        }
        at += side;
    }
    directions
}

const RINGS: usize = 16;

/// The disc as rings of even luminance in the equal-area projection around its centre.
struct Disc {
    toward: DVec3,
    axes: [DVec3; 2],
    radius: f64,
    /// Outer radius in the projection and luminance of each ring, from the inside.
    rings: Vec<(f64, DVec3)>,
}

impl Disc {
    fn new(sun: &Sun) -> Self {
        let axis = sun.toward.any_orthonormal_vector();
        let edge = 2.0 * (0.5 * sun.angular_radius()).sin();
        let rings = (0..RINGS)
            .map(|i| {
                // Rings of even steps in the cosine mu = sqrt(1 - rho^2), which is what the luminance depends on.
                let rho = |mu: f64| (1.0 - mu * mu).max(0.0).sqrt();
                let inner = rho(1.0 - i as f64 / RINGS as f64);
                let outer = rho(1.0 - (i + 1) as f64 / RINGS as f64);
                (edge * outer, sun.ring_luminance(inner, outer))
            })
            .collect();
        Disc {
            toward: sun.toward,
            axes: [axis, sun.toward.cross(axis)],
            radius: sun.angular_radius(),
            rings,
        }
    }

    /// Whether a pixel around this direction surely shows nothing of the disc.
    fn is_far_from(&self, direction: DVec3, conditions: &Conditions) -> bool {
        let reach = self.radius + pixel_angle(conditions);
        let chord = (direction - self.toward).length();
        // chord = 2 sin(angle / 2)
        reach < std::f64::consts::PI && chord > 2.0 * (0.5 * reach).sin()
    }

    /// Lambert's azimuthal equal-area projection around the disc's centre.
    fn project(&self, direction: DVec3) -> DVec2 {
        let [x, y] = self.axes.map(|axis| direction.dot(axis));
        // sqrt(2 / (1 + cos)); the direction opposite the sun, where it is singular, is never in a pixel near the disc.
        let scale = (2.0 / (1.0 + direction.dot(self.toward)).max(1e-9)).sqrt();
        scale * DVec2::new(x, y)
    }

    /// Luminance of one direction.
    fn luminance_at(&self, direction: DVec3) -> DVec3 {
        if direction.y < 0.0 || direction.dot(self.toward) < 0.0 {
            return DVec3::ZERO;
        }
        let radius = self.project(direction).length();
        self.rings
            .iter()
            .find(|(outer, _)| radius <= *outer)
            .map_or(DVec3::ZERO, |(_, luminance)| *luminance)
    }

    /// What a sample of a pixel takes of the pixel's mean, of which the disc covers a share. The samples nearest the sun's centre
    /// see it, one of them in part, so that the mean of all is 1; a ray that is none of the view's samples stands for all of them.
    fn share(&self, direction: DVec3, pixel: UVec2, covered: f64, view: &View) -> f64 {
        let ray = |offset: &DVec2| view.ray(pixel.as_dvec2() + *offset).direction;
        let samples: Vec<DVec3> = sample_positions(view.samples).iter().map(ray).collect();
        let own = samples.iter().position(|sample| *sample == direction);
        let Some(own) = own.filter(|_| covered > 0.0) else {
            return 1.0;
        };
        let distance = |sample: usize| match samples[sample] {
            below if below.y < 0.0 => f64::INFINITY,
            above => above.distance_squared(self.toward),
        };
        let is_nearer = |other: &usize| (distance(*other), *other) < (distance(own), own);
        let nearer = (0..samples.len()).filter(is_nearer).count();
        let seen = covered * samples.len() as f64 - nearer as f64;
        seen.clamp(0.0, 1.0) / covered
    }

    /// Mean luminance of the disc over a pixel's solid angle, and the share of that which it covers.
    fn mean_luminance(&self, outline: &[DVec3]) -> (DVec3, f64) {
        let whole = area(&self.projected(outline));
        if whole == 0.0 {
            return (DVec3::ZERO, 0.0);
        }
        let polygon = self.projected(&above_horizon(outline));
        let mut inner = 0.0;
        let mut sum = DVec3::ZERO;
        for (radius, luminance) in &self.rings {
            let covered = overlap(&polygon, *radius);
            sum += *luminance * (covered - inner).max(0.0);
            inner = covered;
        }
        (sum / whole.abs(), inner / whole.abs())
    }

    fn projected(&self, outline: &[DVec3]) -> Vec<DVec2> {
        outline.iter().map(|d| self.project(*d)).collect()
    }
}

/// The part of an outline above the horizon.
fn above_horizon(outline: &[DVec3]) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(outline.len() + 2);
    for (i, &a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        if a.y >= 0.0 {
            kept.push(a);
        }
        if (a.y < 0.0) != (b.y < 0.0) {
            kept.push(a.lerp(b, a.y / (a.y - b.y)).normalize());
        }
    }
    kept
}

/// Signed area of a polygon.
fn area(polygon: &[DVec2]) -> f64 {
    edges(polygon).map(|(a, b)| 0.5 * a.perp_dot(b)).sum()
}

/// Area of the overlap of a polygon with a circle around the origin: the sum over edges of the overlap of the circle with the
/// triangle between the edge and the centre, signed.
fn overlap(polygon: &[DVec2], radius: f64) -> f64 {
    let r2 = radius * radius;
    edges(polygon)
        .map(|(a, b)| {
            let sector = |p: DVec2, q: DVec2| 0.5 * r2 * p.perp_dot(q).atan2(p.dot(q));
            let d = b - a;
            let (aa, ad, dd) = (a.dot(d), a.length_squared() - r2, d.length_squared());
            let root = aa * aa - dd * ad;
            if root <= 0.0 || dd == 0.0 {
                return sector(a, b);
            }
            let root = root.sqrt();
            let (enter, leave) = ((-aa - root) / dd, (-aa + root) / dd);
            if leave <= 0.0 || enter >= 1.0 {
                return sector(a, b);
            }
            let p = a + d * enter.max(0.0);
            let q = a + d * leave.min(1.0);
            let before = if enter > 0.0 { sector(a, p) } else { 0.0 };
            let after = if leave < 1.0 { sector(q, b) } else { 0.0 };
            before + 0.5 * p.perp_dot(q) + after
        })
        .sum::<f64>()
        .abs()
}

fn edges(polygon: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_overlap_of_square_and_circle_is_the_known_one() {
        let square = |half: f64| {
            [
                DVec2::new(-half, -half),
                DVec2::new(half, -half),
                DVec2::new(half, half),
                DVec2::new(-half, half),
            ]
        };
        assert!((overlap(&square(2.0), 1.0) - PI).abs() < 1e-14);
        assert!((overlap(&square(0.5), 1.0) - 1.0).abs() < 1e-14);
        // A square whose sides cut the circle: circle less four segments of half angle acos(0.9).
        let half = 0.9f64.acos();
        let segment = half - half.sin() * half.cos();
        assert!((overlap(&square(0.9), 1.0) - (PI - 4.0 * segment)).abs() < 1e-14);
        // Half a circle, and nothing.
        let aside: Vec<DVec2> = square(2.0).map(|p| p + DVec2::X * 2.0).to_vec();
        assert!((overlap(&aside, 1.0) - 0.5 * PI).abs() < 1e-14);
        let apart: Vec<DVec2> = square(1.0).map(|p| p + DVec2::X * 3.0).to_vec();
        assert!(overlap(&apart, 1.0).abs() < 1e-15);
    }
}
