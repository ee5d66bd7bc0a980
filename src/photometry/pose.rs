//! How a lamp hangs: its axis, and where its azimuth begins.

use crate::error::{Error, Result};
use glam::DVec3;

/// Below this part of a unit vector across another the two are taken as parallel [1].
const PARALLEL: f64 = 1e-6;

/// The frame of a lamp: three unit vectors, each perpendicular to the others, right-handed (toward x around = third).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The axis, theta = 0.
    pub toward: DVec3,
    /// Where phi = 0.
    pub around: DVec3,
    /// Where phi = 90 degrees.
    pub third: DVec3,
}

impl Pose {
    /// Of a lamp whose axis points `toward`, of any length. Azimuth begins at the part of `around` across the axis; absent, at +X,
    /// or at -Z for an axis along X.
    ///
    /// # Errors
    /// [`Error::Domain`] where `toward` or `around` has no direction, or both have the same or opposite ones.
    pub fn new(toward: DVec3, around: Option<DVec3>) -> Result<Self> {
        let axis = unit("toward", toward)?;
        let across = |v: DVec3| v - axis * axis.dot(v);
        let side = match around {
            Some(given) => {
                let side = across(unit("around", given)?);
                if side.length() < PARALLEL {
                    return Err(Error::domain(
                        "around",
                        shown(given),
                        format!("the directions across toward = {}", shown(toward)),
                        "give another direction than that of the axis, or leave it out",
                    ));
                }
                side
            }
            None => match across(DVec3::X) {
                side if side.length() >= PARALLEL => side,
                _ => across(DVec3::NEG_Z),
            },
        };
        // Twice, since little of a nearly parallel direction is left the first time.
        let around = across(side.normalize()).normalize();
        Ok(Pose {
            toward: axis,
            around,
            third: axis.cross(around),
        })
    }

    /// The angle from the axis (0 to pi) and the azimuth (-pi to pi) of a direction away from the lamp, of any length [rad]; both 0 of
    /// no direction.
    pub fn angles(&self, direction: DVec3) -> (f64, f64) {
        let along = direction.dot(self.toward);
        let (x, y) = (direction.dot(self.around), direction.dot(self.third));
        (x.hypot(y).atan2(along), y.atan2(x))
    }

    /// The unit vector at an angle from the axis and an azimuth [rad].
    pub fn direction(&self, theta: f64, phi: f64) -> DVec3 {
        let ((sin, cos), (across, along)) = (theta.sin_cos(), phi.sin_cos());
        cos * self.toward + sin * (along * self.around + across * self.third)
    }
}

/// A vector made unit, whatever its length.
fn unit(name: &str, v: DVec3) -> Result<DVec3> {
    let greatest = v.abs().max_element();
    match v.is_finite() && greatest > 0.0 {
        true => Ok((v / greatest).normalize()),
        false => Err(Error::domain(
            name,
            shown(v),
            "the finite directions",
            "give three numbers that are not all 0",
        )),
    }
}

fn shown(v: DVec3) -> String {
    format!("[{}, {}, {}]", v.x, v.y, v.z)
}
