//! From where a scene is looked at: the pixels of a camera, or points whose illuminance is wanted.

use super::checks;
use crate::error::{Error, Result};
use crate::scene::{Camera, Projection};
use glam::{DVec2, DVec3, UVec2};
use std::sync::Arc;

/// What light is computed for.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The camera. Of points it is a panorama from their middle: where precision is centred and shadow maps are finest.
    pub camera: Camera,
    /// Where the camera comes from, in words; empty when nobody chose it and it frames the bounds.
    pub chosen: String,
    /// Width and height of the picture [pixels]. Points fill it row by row; what is left of the last row stays black.
    pub size: [u32; 2],
    /// Rays through pixels that differ from their neighbours; 1: one through each centre.
    pub samples: u32,
    /// What receives the light.
    pub receivers: Receivers,
}

/// What receives light.
#[derive(Debug, Clone, PartialEq)]
pub enum Receivers {
    /// The camera's pixels: layers are luminances [cd/m2].
    Pixels,
    /// Points with normals: layers are illuminances [lx]. Only light that surfaces receive is computed.
    Points(Arc<[Receiver]>),
}

/// A point that receives light on one side, as a light meter does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    /// Where it is [m], scene axes.
    pub position: DVec3,
    /// Unit vector toward the side that receives.
    pub normal: DVec3,
}

impl Receiver {
    /// A point, and a direction of any length toward the side that receives.
    ///
    /// # Errors
    /// [`Error::Domain`] for a coordinate beyond 1e9 m and for a direction of length 0.
    pub fn new(position: DVec3, direction: DVec3) -> Result<Self> {
        checks::position(position)?;
        // First brought near 1, so that no square overflows or vanishes.
        let normal = (direction / direction.abs().max_element()).try_normalize();
        match normal {
            Some(normal) if direction.is_finite() => Ok(Receiver { position, normal }),
            _ => Err(Error::domain(
                "the normal",
                direction,
                "a direction of a length above 0",
                "0, 1, 0 is up",
            )),
        }
    }
}

/// Where rays go through a pixel of side 1: its centre for one, else a rank-1 lattice by the golden ratio, the same in every
/// pixel and every picture.
pub fn sample_positions(samples: u32) -> Vec<DVec2> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    (0..samples)
        .map(|i| {
            let x = (f64::from(i) + 0.5) / f64::from(samples);
            DVec2::new(x, (f64::from(i) * GOLDEN + 0.5).fract())
        })
        .collect()
}

impl View {
    /// The most points in a row of the picture that they fill.
    const ROW: u32 = 512;

    /// Points as receivers, in their order; at least one.
    pub fn of_points(points: impl Into<Arc<[Receiver]>>) -> Self {
        let points: Arc<[Receiver]> = points.into();
        let count = points.len().max(1) as u32;
        // Of points, the few that lie far off do not take from the precision of the others.
        let middle = |axis: usize| middle(points.iter().map(|p| p.position[axis]).collect());
        let eye = DVec3::new(middle(0), middle(1), middle(2));
        let width = count.min(Self::ROW);
        View {
            camera: Camera {
                eye,
                forward: DVec3::NEG_Z,
                up: DVec3::Y,
                projection: Projection::Panorama,
                shift: DVec2::ZERO,
            },
            chosen: format!("{} points", points.len()),
            size: [width, count.div_ceil(width)],
            samples: 1,
            receivers: Receivers::Points(points),
        }
    }

    /// The points that receive, if it is they.
    pub fn points(&self) -> Option<&[Receiver]> {
        match &self.receivers {
            Receivers::Pixels => None,
            Receivers::Points(points) => Some(points),
        }
    }

    /// Checks the points that receive light, if there are any, and whether the picture has a pixel for each.
    pub(super) fn check_points(&self) -> Result<()> {
        let Some(points) = self.points() else {
            return Ok(());
        };
        let [width, height] = self.size;
        if points.is_empty() {
            return Err(Error::input(
                "the points",
                "there are none",
                "give at least one position and normal",
            ));
        }
        if u64::from(width) * u64::from(height) < points.len() as u64 {
            return Err(Error::input(
                format!("the {} points", points.len()),
                format!("a picture of {width} x {height} pixels has not one for each"),
                "take the view as View::of_points makes it",
            ));
        }
        let good = |point: &Receiver| {
            checks::near(point.position) && (point.normal.length() - 1.0).abs() < 1e-6
        };
        match points.iter().position(|point| !good(point)) {
            None => Ok(()),
            Some(i) => Err(Error::domain(
                format!("point {}", i + 1),
                format!("{}, normal {}", points[i].position, points[i].normal),
                "-1e9 to 1e9 m in each coordinate and a normal of length 1",
                "give metres in scene axes and a unit vector",
            )),
        }
    }

    /// The point whose illuminance a pixel holds.
    pub fn point(&self, pixel: glam::UVec2) -> Option<&Receiver> {
        let index = pixel.y * self.size[0] + pixel.x;
        self.points()?.get(index as usize)
    }

    /// The ray through a position on the picture [pixels from its upper left corner]; of points, the way from their middle to
    /// the point that the pixel holds.
    pub fn ray(&self, position: DVec2) -> crate::scene::Ray {
        let camera = self.camera.ray(position, self.size);
        match self.point(position.as_uvec2()) {
            None => camera,
            Some(point) => crate::scene::Ray {
                origin: self.camera.eye,
                direction: (point.position - self.camera.eye)
                    .try_normalize()
                    .unwrap_or(camera.direction),
            },
        }
    }
}

/// The median; of two in the middle the one nearer to 0. 0 for none.
fn middle(mut values: Vec<f64>) -> f64 {
    let half = values.len() / 2;
    let whole = values.len() % 2 == 1;
    if values.is_empty() {
        return 0.0;
    }
    let (below, upper, _) = values.select_nth_unstable_by(half, f64::total_cmp);
    let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match whole || upper.abs() <= lower.abs() {
        true => *upper,
        false => lower,
    }
}

/// `count` pixels (or all, if there are fewer) spread evenly over a picture, any first part of them too (Roberts's R2
/// sequence).
pub fn spread(size: [u32; 2], count: usize) -> Vec<UVec2> {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let [w, h] = size.map(f64::from);
    if w * h <= count as f64 {
        return (0..size[1])
            .flat_map(|y| (0..size[0]).map(move |x| UVec2::new(x, y)))
            .collect();
    }
    (0..count)
        .map(|i| {
            let at = |power: f64, side: f64| {
                ((0.5 + i as f64 / power).fract() * side).min(side - 1.0) as u32
            };
            UVec2::new(at(PLASTIC, w), at(PLASTIC * PLASTIC, h))
        })
        .collect()
}
