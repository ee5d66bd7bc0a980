//! From radiance to the codes of a picture: exposure, tone curve, path to white, gamut, sRGB, dither.
//!
//! The display transform, for a triple x of the working space divided by the luminance that is white:
//! 1. Tone: the greatest channel n of x becomes T(n) = n^c / (n^c + k), and all channels are scaled alike. The
//!    channels' ratios stay, so no channel clips before another: skies do not turn cyan nor the sun yellow.
//! 2. Path to white: what is many times brighter than white loses colour, as on film. In Oklab (Ottosson 2020) the
//!    colour goes in a straight line toward the neutral of T(n), so that its hue angle stays:
//!    share of colour kept = (1 + n / 8)^(-1/2).
//! 3. Gamut: what lies outside Rec. 709 goes toward the neutral of its own Oklab lightness, to the gamut's face.
//! 4. The mean over the colours that a pixel holds, of the light that a display shows of each ([`crate::frame::Frame::shares`]).
//! 5. The sRGB transfer function, triangular dither of at most 3/4 of a code, rounding.
//!
//! c = 1.2 gives a photographic contrast, and k puts the meter's grey (0.104 of white, [`super::exposure`]) at 0.18.

use super::{Space, XYZ_FROM_WORKING, exposure::white_luminance, into_gamut, srgb_encode};
use glam::{DMat3, DVec3};
use std::sync::LazyLock;

const CONTRAST: f64 = 1.2;

/// Where the meter's grey is before and after the curve.
const GREY: (f64, f64) = (0.125 / 1.2, 0.18);

/// Half the width of the dither [codes]. A whole code leaves no bias at all, this one at most 0.03 of a code, and keeps the
/// mean Delta E 2000 of a sky below 0.25.
const NOISE: f64 = 0.75;

/// How many times white a colour is when the path to white has taken 1 - 1/sqrt(2) of it.
const WHITENING: f64 = 8.0;

struct Oklab {
    lms_from_working: DMat3,
    lab_from_lms: DMat3,
    lms_from_lab: DMat3,
    rec709_from_lms: DMat3,
}

static OKLAB: LazyLock<Oklab> = LazyLock::new(|| {
    // Ottosson 2020, "A perceptual color space for image processing": M1 (from XYZ, D65) and M2, by column.
    let lms_from_xyz = DMat3::from_cols(
        DVec3::new(0.818_933_010_1, 0.032_984_543_6, 0.048_200_301_8),
        DVec3::new(0.361_866_742_4, 0.929_311_871_5, 0.264_366_269_1),
        DVec3::new(-0.128_859_713_7, 0.036_145_638_7, 0.633_851_707_0),
    );
    let lab_from_lms = DMat3::from_cols(
        DVec3::new(0.210_454_255_3, 1.977_998_495_1, 0.025_904_037_1),
        DVec3::new(0.793_617_785_0, -2.428_592_205_0, 0.782_771_766_2),
        DVec3::new(-0.004_072_046_8, 0.450_593_709_9, -0.808_675_766_0),
    );
    // White has lms = (1, 1, 1) to four digits only: scaled so that neutral stays exactly neutral.
    let lms_from_working = lms_from_xyz * XYZ_FROM_WORKING;
    let lms_from_working =
        DMat3::from_diagonal((lms_from_working * DVec3::ONE).recip()) * lms_from_working;
    Oklab {
        lms_from_working,
        lab_from_lms,
        lms_from_lab: lab_from_lms.inverse(),
        rec709_from_lms: Space::Rec709.from_working() * lms_from_working.inverse(),
    }
});

impl Oklab {
    fn lab(&self, rgb: DVec3) -> DVec3 {
        let lms = self.lms_from_working * rgb;
        self.lab_from_lms * DVec3::from_array(lms.to_array().map(f64::cbrt))
    }

    fn rec709(&self, lab: DVec3) -> DVec3 {
        let root = self.lms_from_lab * lab;
        self.rec709_from_lms * (root * root * root)
    }
}

/// The tone curve: display-linear value [1] of a scene-linear one, both relative to white; 0 at 0, toward 1 without end.
pub fn tone(n: f64) -> f64 {
    let k = GREY.0.powf(CONTRAST) * (1.0 / GREY.1 - 1.0);
    // In this form an infinite n gives 1.
    1.0 / (1.0 + k * n.powf(-CONTRAST))
}

/// Linear Rec. 709 for a display, each channel in 0 to 1, of a working-space radiance at an exposure: steps 1 to 3.
///
/// A radiance that is not finite gives white.
pub fn display(rgb_working: DVec3, ev100: f64) -> DVec3 {
    let x = into_gamut(rgb_working / white_luminance(ev100));
    let n = x.max_element();
    if !x.is_finite() || !n.is_finite() {
        return DVec3::ONE;
    }
    if n <= 0.0 {
        return DVec3::ZERO;
    }
    let t = tone(n);
    let kept = (1.0 + n / WHITENING).sqrt().recip();
    let neutral = DVec3::new(t.cbrt(), 0.0, 0.0);
    let lab = neutral.lerp(OKLAB.lab(x * (t / n)), kept);
    to_rec709_gamut(lab)
}

/// Rec. 709 of an Oklab colour of lightness <= 1, moved toward the neutral of its lightness until it is inside 0 to 1.
fn to_rec709_gamut(lab: DVec3) -> DVec3 {
    const SLACK: f64 = 1e-9;
    let inside = |rgb: DVec3| rgb.min_element() >= -SLACK && rgb.max_element() <= 1.0 + SLACK;
    let mut rgb = OKLAB.rec709(lab);
    if !inside(rgb) {
        let neutral = DVec3::new(lab.x, 0.0, 0.0);
        let (mut low, mut high) = (0.0, 1.0);
        // 16 halvings: the chroma is found to 1.5e-5, far below one code.
        for _ in 0..16 {
            let half = 0.5 * (low + high);
            let trial = OKLAB.rec709(neutral.lerp(lab, half));
            if inside(trial) {
                low = half;
            } else {
                high = half;
            }
        }
        rgb = OKLAB.rec709(neutral.lerp(lab, low));
    }
    rgb.clamp(DVec3::ZERO, DVec3::ONE)
}

/// 8-bit sRGB codes through the display transform.
///
/// `rgb_working` is a radiance in the working space [cd/m2], white is 1.2 * 2^ev100 cd/m2. With `dither`, triangular
/// noise of at most 3/4 of a code, the same for the same `pixel`, is added before rounding, except to exact black and white.
pub fn encode(rgb_working: DVec3, ev100: f64, pixel: [u32; 2], dither: bool) -> [u8; 3] {
    codes(display(rgb_working, ev100), pixel, dither)
}

/// 8-bit sRGB codes without tone curve: linear Rec. 709 over white, each channel cut to 0 to 1. For measuring, not for looking.
pub fn encode_plain(rgb_working: DVec3, ev100: f64, pixel: [u32; 2], dither: bool) -> [u8; 3] {
    let rgb = Space::Rec709.from_working() * rgb_working / white_luminance(ev100);
    codes(rgb.clamp(DVec3::ZERO, DVec3::ONE), pixel, dither)
}

/// 8-bit sRGB codes of light of a display, linear Rec. 709 in 0 to 1 ([`display`]): step 5.
pub fn codes(rgb: DVec3, pixel: [u32; 2], dither: bool) -> [u8; 3] {
    // The same noise for the three channels: grey grain is seen less than coloured (mean Delta E 2000 0.26 against 0.39).
    let noise = NOISE * triangular(pixel);
    rgb.to_array().map(|linear| {
        let mut code = 255.0 * srgb_encode(linear);
        if dither && code > 0.0 && code < 255.0 {
            code += noise;
        }
        // `as` saturates: 0 to 255.
        code.round() as u8
    })
}

/// Deterministic noise in (-1, 1) with triangular density: the difference of two hashed uniforms.
fn triangular(pixel: [u32; 2]) -> f64 {
    // PCG-3D (Jarzynski & Olano 2020, "Hash functions for GPU rendering").
    let mut v =
        [pixel[0], pixel[1], 0].map(|c| c.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    for round in 0..2 {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
        if round == 0 {
            v = v.map(|c| c ^ (c >> 16));
        }
    }
    (f64::from(v[0]) - f64::from(v[1])) / 4_294_967_296.0
}
