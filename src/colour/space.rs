//! RGB spaces: chromaticities, matrices derived from them, Bradford adaptation.

use crate::error::{Error, Result};
use glam::{DMat3, DVec3};
use std::fmt;
use std::str::FromStr;

/// A linear colour space in which a picture can be written.
///
/// The library computes in [`Space::WORKING`]. Rec. 709 and Rec. 2020 share its white (D65); ACEScg has its own and is
/// reached by Bradford adaptation. `Xyz` is CIE 1931 XYZ of the same light, unadapted: its luminance is Y.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Space {
    /// ITU-R BT.709 primaries (those of sRGB), D65, linear.
    Rec709,
    /// ITU-R BT.2020 primaries, D65, linear.
    Rec2020,
    /// Academy AP1 primaries, white at x 0.32168, y 0.33767, linear.
    AcesCg,
    /// CIE 1931 XYZ.
    Xyz,
}

/// CIE 1931 chromaticities x, y of the primaries and the white of a [`Space`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chromaticities {
    /// Red primary.
    pub red: [f64; 2],
    /// Green primary.
    pub green: [f64; 2],
    /// Blue primary.
    pub blue: [f64; 2],
    /// White: equal amounts of the three.
    pub white: [f64; 2],
}

/// CIE D65 as ITU-R BT.709 and BT.2020 state it.
const D65: [f64; 2] = [0.3127, 0.3290];

const REC709: Chromaticities = Chromaticities {
    red: [0.640, 0.330],
    green: [0.300, 0.600],
    blue: [0.150, 0.060],
    white: D65,
};

const REC2020: Chromaticities = Chromaticities {
    red: [0.708, 0.292],
    green: [0.170, 0.797],
    blue: [0.131, 0.046],
    white: D65,
};

const AP1: Chromaticities = Chromaticities {
    red: [0.713, 0.293],
    green: [0.165, 0.830],
    blue: [0.128, 0.044],
    white: [0.32168, 0.33767],
};

const XYZ: Chromaticities = Chromaticities {
    red: [1.0, 0.0],
    green: [0.0, 1.0],
    blue: [0.0, 0.0],
    white: [1.0 / 3.0, 1.0 / 3.0],
};

/// XYZ of the working space's red, green and blue at one unit each, by column.
pub const XYZ_FROM_WORKING: DMat3 = REC2020.xyz_from_rgb();

/// The inverse of [`XYZ_FROM_WORKING`].
pub const WORKING_FROM_XYZ: DMat3 = inverse(XYZ_FROM_WORKING);

/// Luminance of one unit of each channel of the working space: the Y row of [`XYZ_FROM_WORKING`].
pub const LUMINANCE: DVec3 = DVec3::new(
    XYZ_FROM_WORKING.x_axis.y,
    XYZ_FROM_WORKING.y_axis.y,
    XYZ_FROM_WORKING.z_axis.y,
);

/// Cone-like responses of Bradford (Lam 1985), from XYZ; rows as published.
const BRADFORD: DMat3 = DMat3::from_cols(
    DVec3::new(0.8951, -0.7502, 0.0389),
    DVec3::new(0.2664, 1.7135, -0.0685),
    DVec3::new(-0.1614, 0.0367, 1.0296),
);

impl Space {
    /// The space in which the library computes: linear Rec. 2020, because sunsets leave sRGB.
    pub const WORKING: Space = Space::Rec2020;

    /// Every space, in the order of the documentation.
    pub const ALL: [Space; 4] = [Space::Rec709, Space::Rec2020, Space::AcesCg, Space::Xyz];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Space::Rec709 => "rec709",
            Space::Rec2020 => "rec2020",
            Space::AcesCg => "acescg",
            Space::Xyz => "xyz",
        }
    }

    /// Chromaticities [1] as the `chromaticities` attribute of an EXR states them.
    pub fn chromaticities(self) -> Chromaticities {
        match self {
            Space::Rec709 => REC709,
            Space::Rec2020 => REC2020,
            Space::AcesCg => AP1,
            Space::Xyz => XYZ,
        }
    }

    /// The matrix that takes the working space to this one.
    ///
    /// Derived from the chromaticities, never from a standard's rounded matrix (IEC 61966-2-1's differs by 1.6e-4). White
    /// stays white: Bradford adaptation stands between different whites, except for XYZ, which is not adapted.
    pub fn from_working(self) -> DMat3 {
        match self {
            Space::Xyz => XYZ_FROM_WORKING,
            Space::Rec2020 => DMat3::IDENTITY,
            _ => {
                let own = self.chromaticities();
                own.xyz_from_rgb().inverse() * bradford(D65, own.white) * XYZ_FROM_WORKING
            }
        }
    }

    /// The inverse of [`Space::from_working`].
    pub fn to_working(self) -> DMat3 {
        match self {
            Space::Xyz => WORKING_FROM_XYZ,
            Space::Rec2020 => DMat3::IDENTITY,
            _ => {
                let own = self.chromaticities();
                WORKING_FROM_XYZ * bradford(own.white, D65) * own.xyz_from_rgb()
            }
        }
    }
}

impl fmt::Display for Space {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Space {
    type Err = Error;

    /// Reads `rec709` (also `srgb`, `bt709`), `rec2020` (`bt2020`), `acescg` (`ap1`) or `xyz`; case and `-_. ` do not matter.
    fn from_str(text: &str) -> Result<Self> {
        let plain: String = text
            .chars()
            .filter(|c| c.is_ascii_alphanumeric())
            .map(|c| c.to_ascii_lowercase())
            .collect();
        match plain.as_str() {
            "rec709" | "bt709" | "srgb" | "linearsrgb" => Ok(Space::Rec709),
            "rec2020" | "bt2020" => Ok(Space::Rec2020),
            "acescg" | "ap1" => Ok(Space::AcesCg),
            "xyz" | "ciexyz" => Ok(Space::Xyz),
            _ => Err(Error::domain(
                "the colour space",
                format!("`{text}`"),
                "rec709, rec2020, acescg, xyz",
                "name one of these",
            )),
        }
    }
}

impl Chromaticities {
    /// XYZ of the red, green and blue primaries, one unit each, by column; equal units of all have Y = 1 and this white.
    pub const fn xyz_from_rgb(&self) -> DMat3 {
        // Y-free sums instead of dividing by y, which is zero for two primaries of XYZ.
        let [r, g, b] = [
            xyz_sum_1(self.red),
            xyz_sum_1(self.green),
            xyz_sum_1(self.blue),
        ];
        let w = xyz_sum_1(self.white);
        let white = DVec3::new(w.x / w.y, 1.0, w.z / w.y);
        let units = times(inverse(DMat3::from_cols(r, g, b)), white);
        DMat3::from_cols(scaled(r, units.x), scaled(g, units.y), scaled(b, units.z))
    }
}

/// The Bradford adaptation of XYZ from one white to another (Lam 1985; the linear form of ICC and colour-science).
///
/// `from` and `to` are CIE 1931 chromaticities x, y with y > 0.
pub fn bradford(from: [f64; 2], to: [f64; 2]) -> DMat3 {
    let response = |[x, y]: [f64; 2]| BRADFORD * super::xyz_from_xyy(DVec3::new(x, y, 1.0));
    let (from, to) = (response(from), response(to));
    inverse(BRADFORD) * DMat3::from_diagonal(to / from) * BRADFORD
}

const fn xyz_sum_1(xy: [f64; 2]) -> DVec3 {
    DVec3::new(xy[0], xy[1], 1.0 - xy[0] - xy[1])
}

const fn scaled(v: DVec3, s: f64) -> DVec3 {
    DVec3::new(v.x * s, v.y * s, v.z * s)
}

const fn times(m: DMat3, v: DVec3) -> DVec3 {
    DVec3::new(
        m.x_axis.x * v.x + m.y_axis.x * v.y + m.z_axis.x * v.z,
        m.x_axis.y * v.x + m.y_axis.y * v.y + m.z_axis.y * v.z,
        m.x_axis.z * v.x + m.y_axis.z * v.y + m.z_axis.z * v.z,
    )
}

/// The inverse by cofactors, at compile time.
const fn inverse(m: DMat3) -> DMat3 {
    let (a, b, c) = (m.x_axis, m.y_axis, m.z_axis);
    let bc = cross(b, c);
    let det = a.x * bc.x + a.y * bc.y + a.z * bc.z;
    let (r0, r1, r2) = (
        scaled(bc, 1.0 / det),
        scaled(cross(c, a), 1.0 / det),
        scaled(cross(a, b), 1.0 / det),
    );
    DMat3::from_cols(
        DVec3::new(r0.x, r1.x, r2.x),
        DVec3::new(r0.y, r1.y, r2.y),
        DVec3::new(r0.z, r1.z, r2.z),
    )
}

const fn cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        a.y * b.z - a.z * b.y,
        a.z * b.x - a.x * b.z,
        a.x * b.y - a.y * b.x,
    )
}
