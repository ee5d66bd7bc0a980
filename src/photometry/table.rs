//! Measured luminous intensity: values on a grid of angles, bilinear between them.

use crate::error::{Error, Result};
use std::f64::consts::PI;

/// How the two angles of a table lie about the axis of its lamp, named as in IES LM-63 and CIE 121.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goniometer {
    /// Vertical planes, a horizontal angle H each, share the vertical axis; V is 0 on the horizon. The lamp's axis is H = V = 0, and
    /// V = +90 is where its azimuth begins. H turns to its right, clockwise from above.
    A,
    /// Planes, a vertical angle V each, share the horizontal axis across the beam; H is measured in them. The lamp's axis is
    /// H = V = 0, and V = +90 is where its azimuth begins. H is positive to the right.
    B,
    /// Half planes, a horizontal angle C each, share the lamp's axis, from which the vertical angle gamma is measured. C turns about
    /// **minus** the axis by the right-hand rule, counterclockwise from above a hanging lamp.
    C,
}

/// One turn [degrees].
const TURN: f64 = 360.0;

/// Where a table is greatest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Luminous intensity [cd].
    pub candela: f64,
    /// The horizontal angle there [degrees].
    pub horizontal_deg: f64,
    /// The vertical angle there [degrees].
    pub vertical_deg: f64,
}

/// Luminous intensity on a grid of horizontal and vertical angles [degrees], bilinear between its values, nothing outside its angles.
///
/// It has all planes that symmetry implies. Type C is periodic: its last plane, a turn after the first, is the first again.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    goniometer: Goniometer,
    horizontal: Vec<f64>,
    vertical: Vec<f64>,
    candela: Vec<f64>,
}

impl Table {
    /// A table of `candela` [cd] at each of the `vertical` angles [degrees] in the plane of the first of the `horizontal` angles
    /// [degrees], then in that of the second, and so on.
    ///
    /// Type C: horizontal angles span one turn, the last plane being the first again; vertical ones lie within 0 to 180. Types A and B: horizontal
    /// within -180 to 180 (A) or -90 to 90 (B), vertical within -90 to 90 (A) or -180 to 180 (B).
    ///
    /// # Errors
    /// [`Error::Domain`] for fewer than two angles, angles that do not ascend or are outside these ranges, values that are negative or not
    /// finite, and numbers of values other than angles times angles.
    pub fn new(
        goniometer: Goniometer,
        mut horizontal: Vec<f64>,
        vertical: Vec<f64>,
        candela: Vec<f64>,
    ) -> Result<Self> {
        let (across, up) = match goniometer {
            Goniometer::A => ([-180.0, 180.0], [-90.0, 90.0]),
            Goniometer::B => ([-90.0, 90.0], [-180.0, 180.0]),
            Goniometer::C => ([-360.0, 720.0], [0.0, 180.0]),
        };
        check_angles("horizontal angle", &horizontal, across)?;
        check_angles("vertical angle", &vertical, up)?;
        if goniometer == Goniometer::C {
            let last = horizontal.len() - 1;
            let span = horizontal[last] - horizontal[0];
            if (span - TURN).abs() > 1e-9 {
                return Err(Error::domain(
                    "span of the horizontal angles",
                    format!("{span} degrees"),
                    "360 degrees, one turn",
                    "repeat the first plane as the last, a turn later",
                ));
            }
            horizontal[last] = horizontal[0] + TURN;
        }
        if horizontal.len().checked_mul(vertical.len()) != Some(candela.len()) {
            return Err(Error::domain(
                "number of values",
                candela.len(),
                format!("{} times {} angles", horizontal.len(), vertical.len()),
                "give one value for each pair of angles",
            ));
        }
        match candela.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
            None => Ok(Table {
                goniometer,
                horizontal,
                vertical,
                candela,
            }),
            Some(value) => Err(Error::domain(
                "luminous intensity",
                format!("{value} cd"),
                "the finite numbers from 0",
                "give 0 where a lamp sends nothing",
            )),
        }
    }

    /// How its angles lie.
    pub fn goniometer(&self) -> Goniometer {
        self.goniometer
    }

    /// Its horizontal angles [degrees], ascending.
    pub fn horizontal(&self) -> &[f64] {
        &self.horizontal
    }

    /// Its vertical angles [degrees], ascending.
    pub fn vertical(&self) -> &[f64] {
        &self.vertical
    }

    /// Its values [cd]: all vertical angles of the first horizontal one, then of the second, and so on.
    pub fn candela(&self) -> &[f64] {
        &self.candela
    }

    /// Luminous intensity at two angles of its own [degrees]; of type C `horizontal` may be any.
    pub fn at(&self, horizontal: f64, vertical: f64) -> f64 {
        let horizontal = match self.goniometer {
            Goniometer::C => {
                self.horizontal[0] + (horizontal - self.horizontal[0]).rem_euclid(TURN)
            }
            _ => horizontal,
        };
        let Some((i, x)) = place(&self.horizontal, horizontal) else {
            return 0.0;
        };
        let Some((j, y)) = place(&self.vertical, vertical) else {
            return 0.0;
        };
        let [near, far] = [i, i + 1].map(|i| {
            let plane = &self.candela[i * self.vertical.len()..];
            between(plane[j], plane[j + 1], y)
        });
        between(near, far, x)
    }

    /// The horizontal and the vertical angle [degrees] of an angle from the lamp's axis and an azimuth about it [rad], as
    /// [`super::Pose::angles`] has them.
    pub fn angles(&self, theta: f64, phi: f64) -> (f64, f64) {
        let (horizontal, vertical) = match self.goniometer {
            Goniometer::C => (-phi, theta),
            _ => {
                let ((sin, ahead), (right, up)) = (theta.sin_cos(), phi.sin_cos());
                let (right, up) = (sin * right, sin * up);
                match self.goniometer {
                    Goniometer::A => (right.atan2(ahead), up.atan2(right.hypot(ahead))),
                    _ => (right.atan2(up.hypot(ahead)), up.atan2(ahead)),
                }
            }
        };
        (horizontal.to_degrees(), vertical.to_degrees())
    }

    /// Luminous intensity [cd] at an angle from the lamp's axis (0 to pi) and an azimuth about it [rad].
    pub fn intensity(&self, theta: f64, phi: f64) -> f64 {
        let (horizontal, vertical) = self.angles(theta, phi);
        self.at(horizontal, vertical)
    }

    /// Its greatest value, and the first angles that have it.
    pub fn peak(&self) -> Peak {
        let first = Peak {
            candela: 0.0,
            horizontal_deg: self.horizontal[0],
            vertical_deg: self.vertical[0],
        };
        self.nodes().fold(first, |best, (h, v, candela)| {
            if candela > best.candela {
                Peak {
                    candela,
                    horizontal_deg: h,
                    vertical_deg: v,
                }
            } else {
                best
            }
        })
    }

    fn nodes(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        let planes = self.candela.chunks_exact(self.vertical.len());
        self.horizontal.iter().zip(planes).flat_map(|(h, plane)| {
            self.vertical
                .iter()
                .zip(plane)
                .map(move |(v, candela)| (*h, *v, *candela))
        })
    }

    /// The half angle of a cone around the lamp's axis outside which there is nothing [rad].
    pub fn cone(&self) -> f64 {
        // A cell has light if one of its corners does.
        let mut cone: f64 = 0.0;
        let rows = self.vertical.len();
        for (i, columns) in self.horizontal.windows(2).enumerate() {
            for (j, lines) in self.vertical.windows(2).enumerate() {
                let lit = |i: usize, j: usize| self.candela[i * rows + j] > 0.0;
                if lit(i, j) || lit(i, j + 1) || lit(i + 1, j) || lit(i + 1, j + 1) {
                    cone = cone.max(self.farthest([columns[0], columns[1]], [lines[0], lines[1]]));
                }
            }
        }
        cone.min(PI)
    }

    /// The greatest angle from the axis within a cell [rad].
    fn farthest(&self, across: [f64; 2], up: [f64; 2]) -> f64 {
        if self.goniometer == Goniometer::C {
            return up[1].to_radians();
        }
        let greatest = |[a, b]: [f64; 2]| a.abs().max(b.abs()).to_radians();
        let (h, v) = (greatest(across), greatest(up));
        // cos theta = cos H cos V, which is not monotone beyond the equator of the axis.
        match h.max(v) <= 0.5 * PI {
            true => (h.cos() * v.cos()).clamp(-1.0, 1.0).acos(),
            false => PI,
        }
    }

    /// Luminous flux [lm]: the exact integral over the sphere of what is bilinear between the values.
    pub fn flux(&self) -> f64 {
        // One of the angles is a longitude, along which the integral is the trapezoidal rule's. The other runs from pole to pole.
        let rows = self.vertical.len();
        let (longitudes, latitudes) = match self.goniometer {
            Goniometer::A | Goniometer::C => (&self.horizontal, &self.vertical),
            Goniometer::B => (&self.vertical, &self.horizontal),
        };
        let value = |longitude: usize, latitude: usize| match self.goniometer {
            Goniometer::A | Goniometer::C => self.candela[longitude * rows + latitude],
            Goniometer::B => self.candela[latitude * rows + longitude],
        };
        let from_pole = |angle: f64| match self.goniometer {
            Goniometer::C => angle.to_radians(),
            _ => (90.0 + angle).to_radians(),
        };
        let mut sum = 0.0;
        for j in 1..latitudes.len() {
            let [first, last] = moments(from_pole(latitudes[j - 1]), from_pole(latitudes[j]));
            for i in 1..longitudes.len() {
                let width = 0.5 * (longitudes[i] - longitudes[i - 1]).to_radians();
                sum += width
                    * (first * (value(i - 1, j - 1) + value(i, j - 1))
                        + last * (value(i - 1, j) + value(i, j)));
            }
        }
        sum
    }
}

/// What lies between two values at a share of the way, not beyond them by rounding.
fn between(a: f64, b: f64, share: f64) -> f64 {
    (a + share * (b - a)).clamp(a.min(b), a.max(b))
}

/// The integrals of sine times what falls from 1 to 0, and times what rises from 0 to 1, over [a, b] [rad].
fn moments(a: f64, b: f64) -> [f64; 2] {
    let mean = (b.sin() - a.sin()) / (b - a);
    [a.cos() - mean, mean - b.cos()]
}

/// The interval of an ascending list that holds a number, and how far it is along in it (0 to 1).
fn place(angles: &[f64], angle: f64) -> Option<(usize, f64)> {
    let last = angles.len() - 1;
    if !(angles[0] <= angle && angle <= angles[last]) {
        return None;
    }
    let at = angles.partition_point(|a| *a <= angle).clamp(1, last) - 1;
    Some((at, (angle - angles[at]) / (angles[at + 1] - angles[at])))
}

fn check_angles(name: &str, angles: &[f64], [least, greatest]: [f64; 2]) -> Result<()> {
    if angles.len() < 2 {
        return Err(Error::domain(
            format!("number of {name}s"),
            angles.len(),
            "2 and more",
            "give the angles of at least two measurements",
        ));
    }
    if let Some(angle) = angles.iter().find(|a| !(least..=greatest).contains(*a)) {
        return Err(Error::domain(
            name,
            format!("{angle} degrees"),
            format!("{least} to {greatest} degrees"),
            "check the type of photometry",
        ));
    }
    match angles.windows(2).find(|pair| pair[1] <= pair[0]) {
        None => Ok(()),
        Some(pair) => Err(Error::domain(
            name,
            format!("{} degrees", pair[1]),
            format!(
                "the angles above {} degrees, which stands before it",
                pair[0]
            ),
            "list the angles in ascending order, each once",
        )),
    }
}
