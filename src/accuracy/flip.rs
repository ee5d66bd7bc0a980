//! FLIP: how different two pictures look to somebody who switches between them.
//!
//! A map of numbers between 0 (nothing to be seen) and 1 (as far apart as black and white), and its mean.
//!
//! LDR-FLIP, for pictures on a display:
//! 1. Each picture goes into YCxCz (linear in light, with the scales of L\*a\*b\*) and is blurred as the eye blurs it at this many
//!    pixels per degree: lightness least, blue-yellow most (contrast sensitivity). What leaves the display's gamut is cut off.
//! 2. Colour: the HyAB distance (|dL| + the Euclidean distance of a, b) in L\*a\*b\*, colourfulness scaled by 0.01 L (Hunt), to the
//!    power 0.7; redistributed so that 0.4 of the greatest distance (green to blue) becomes 0.95.
//! 3. Features: the first and second derivatives of Gaussians of the lightness find edges and points; the difference of their
//!    lengths, the greater of the two, over sqrt(2), to the power 0.5.
//! 4. colour^(1 - features).
//!
//! HDR-FLIP, for light that no display shows at once: the greatest LDR-FLIP over exposures, each tone-mapped with a fit to ACES.
//! They are about a stop apart, from where the brightest pixel of the reference is at 0.85 of white to where its median is.
//!
//! Sources: P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. D. Fairchild, "FLIP: A Difference Evaluator for
//! Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020; P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Moller,
//! "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics Short Papers 2021; the tone curve by K. Narkowicz 2016.
//! Differs: f64, and Rec. 709 from its chromaticities instead of a rounded matrix.

use crate::colour::Space;
use crate::error::{Error, Result};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::{PI, SQRT_2};
use std::sync::LazyLock;

/// Pixels per degree of their observer, 67.02: a display 0.7 m and 3840 pixels wide, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// Contrast sensitivities: parts a * sqrt(pi / b) * exp(-pi^2 d^2 / b), d in degrees, as (a, b) (2020, table 1).
const ACHROMATIC: [(f64, f64); 1] = [(1.0, 0.0047)];
const RED_GREEN: [(f64, f64); 1] = [(1.0, 0.0053)];
const BLUE_YELLOW: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];

/// Width of an edge from peak to trough of its detector [degrees]: two standard deviations.
const FEATURE_WIDTH: f64 = 0.082;

/// Exponents of the colour and the feature difference.
const COLOUR_POWER: f64 = 0.7;
const FEATURE_POWER: f64 = 0.5;

/// This share of the greatest colour difference becomes that difference.
const KNEE: (f64, f64) = (0.4, 0.95);

/// The tone curve (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5), with the 0.6 of its author's pre-exposure taken in.
const TONE: [f64; 5] = [
    0.6 * 0.6 * 2.51,
    0.6 * 0.03,
    0.6 * 0.6 * 2.43,
    0.6 * 0.59,
    0.14,
];

/// Where the first and the last exposure put the brightest and the median luminance.
const TONE_TARGET: f64 = 0.85;

/// A median luminance is at least this one, as in version 1.7 of their program: a reference that is half black has an end.
const LEAST_MEDIAN: f64 = f32::EPSILON as f64;

/// How different two pictures look.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The difference [1] of every pixel, 0 to 1, in the order of the pictures.
    pub map: Vec<f32>,
    /// Its mean over the pixels [1].
    pub mean: f64,
}

/// The exposures of HDR-FLIP: light is multiplied by 2^start ... 2^stop in equal steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposures {
    /// The exponent at which the brightest pixel is near white.
    pub start: f64,
    /// The exponent at which the median is near white.
    pub stop: f64,
    /// How many there are, both ends included: at least two.
    pub count: usize,
}

impl Exposures {
    /// The exposures for a reference picture in the working space, whatever its unit.
    ///
    /// Source: Andersson et al. 2021, section 3.
    ///
    /// # Errors
    /// [`Error::Input`] for one that is black (luminance below 1.2e-7 everywhere) or not finite.
    pub fn of(reference: &[DVec3]) -> Result<Self> {
        let mut luminances: Vec<f64> = rec709("the reference picture", reference)?
            .iter()
            .map(|rgb| RELATIVE_FROM_REC709.mul_vec3(*rgb).y)
            .collect();
        luminances.sort_unstable_by(f64::total_cmp);
        let brightest = luminances.last().copied().unwrap_or(0.0);
        if brightest < LEAST_MEDIAN {
            return Err(Error::input(
                "the reference picture",
                "it is black, so that no exposure suits it",
                "give the exposures, or compare other pictures",
            ));
        }
        let median = luminances[luminances.len() / 2].max(LEAST_MEDIAN);
        let white = white_at_target();
        let (start, stop) = ((white / brightest).log2(), (white / median).log2());
        Ok(Exposures {
            start,
            stop,
            count: (stop - start).ceil().max(2.0) as usize,
        })
    }

    /// The factors of the light.
    fn factors(self) -> impl Iterator<Item = f64> {
        let step = (self.stop - self.start) / (self.count.max(2) - 1) as f64;
        (0..self.count).map(move |i| (self.start + i as f64 * step).exp2())
    }
}

/// LDR-FLIP of two pictures as a display shows them.
///
/// `reference` and `test` hold `size[0] * size[1]` triples of the working space, linear, with white at 1, row by row from the
/// top. What Rec. 709 does not hold (channels below 0, above 1) is cut off, as the display does. The pictures may change places.
///
/// Domain: 1 to 1000 pixels per degree ([`PIXELS_PER_DEGREE`] is theirs).
///
/// # Errors
/// [`Error::Input`] for pictures of another size or not finite; [`Error::Domain`] for the pixels per degree.
pub fn ldr(
    reference: &[DVec3],
    test: &[DVec3],
    size: [u32; 2],
    pixels_per_degree: f64,
) -> Result<Difference> {
    let [reference, test] = pair(reference, test, size)?;
    let eye = Eye::new(pixels_per_degree)?;
    let shown = |rgb: DVec3| rgb.min(DVec3::ONE);
    Ok(eye.difference(&reference, &test, size[0] as usize, shown))
}

/// HDR-FLIP of a picture and its reference, in light of any one unit, over the exposures that suit the reference.
///
/// As [`ldr`] otherwise, without the bound at 1. The pictures must not change places: [`hdr_over`] with fixed exposures may.
///
/// # Errors
/// Those of [`ldr`] and of [`Exposures::of`].
pub fn hdr(
    reference: &[DVec3],
    test: &[DVec3],
    size: [u32; 2],
    pixels_per_degree: f64,
) -> Result<Difference> {
    let exposures = Exposures::of(reference)?;
    hdr_over(reference, test, size, pixels_per_degree, exposures)
}

/// HDR-FLIP over given exposures.
///
/// # Errors
/// Those of [`ldr`]; [`Error::Domain`] for no exposure.
pub fn hdr_over(
    reference: &[DVec3],
    test: &[DVec3],
    size: [u32; 2],
    pixels_per_degree: f64,
    exposures: Exposures,
) -> Result<Difference> {
    let [reference, test] = pair(reference, test, size)?;
    let eye = Eye::new(pixels_per_degree)?;
    let mut maps = exposures.factors().map(|factor| {
        let shown = |rgb: DVec3| tone(rgb * factor);
        eye.difference(&reference, &test, size[0] as usize, shown)
            .map
    });
    let Some(mut map) = maps.next() else {
        return Err(Error::domain(
            "the number of exposures",
            exposures.count,
            "1 and more",
            "give at least one",
        ));
    };
    for next in maps {
        for (most, here) in map.iter_mut().zip(next) {
            *most = most.max(here);
        }
    }
    Ok(Difference::new(map))
}

impl Difference {
    fn new(map: Vec<f32>) -> Self {
        let mean = map.iter().copied().map(f64::from).sum::<f64>() / map.len() as f64;
        Difference { map, mean }
    }
}

/// Both pictures in linear Rec. 709.
fn pair(reference: &[DVec3], test: &[DVec3], size: [u32; 2]) -> Result<[Vec<DVec3>; 2]> {
    let pixels = size[0] as usize * size[1] as usize;
    for (name, picture) in [("the reference picture", reference), ("the picture", test)] {
        if picture.len() != pixels || pixels == 0 {
            return Err(Error::input(
                name,
                format!(
                    "it has {} pixels, for a size of {} x {}",
                    picture.len(),
                    size[0],
                    size[1]
                ),
                "compare two pictures of one size, of a pixel at least",
            ));
        }
    }
    Ok([
        rec709("the reference picture", reference)?,
        rec709("the picture", test)?,
    ])
}

/// A picture in linear Rec. 709, without the negative channels that no display shows.
fn rec709(name: &str, picture: &[DVec3]) -> Result<Vec<DVec3>> {
    if let Some(pixel) = picture.iter().position(|rgb| !rgb.is_finite()) {
        return Err(Error::input(
            name,
            format!("pixel {pixel} is {}", picture[pixel]),
            "compare finite pictures",
        ));
    }
    let matrix = Space::Rec709.from_working();
    Ok(picture
        .iter()
        .map(|rgb| (matrix * *rgb).max(DVec3::ZERO))
        .collect())
}

/// What a display shows [1] of light, by channel.
fn tone(x: DVec3) -> DVec3 {
    let [k0, k1, k3, k4, k5] = TONE;
    // Divided by x^2, so that no light is too bright; black becomes 0 / infinity.
    let per_x = x.recip();
    let shown =
        (DVec3::splat(k0) + k1 * per_x) / (DVec3::splat(k3) + k4 * per_x + k5 * per_x * per_x);
    DVec3::select(x.cmpgt(DVec3::ZERO), shown, DVec3::ZERO).min(DVec3::ONE)
}

/// The light that [`tone`] shows at [`TONE_TARGET`].
fn white_at_target() -> f64 {
    let [k0, k1, k3, k4, k5] = TONE;
    let t = TONE_TARGET;
    let (a, b, c) = (k0 - t * k3, k1 - t * k4, -t * k5);
    let half = -0.5 * b / a;
    half + (half * half - c / a).sqrt()
}

/// XYZ over the XYZ of white, of linear Rec. 709.
static RELATIVE_FROM_REC709: LazyLock<DMat3> = LazyLock::new(|| {
    let xyz = Space::Rec709.chromaticities().xyz_from_rgb();
    DMat3::from_diagonal((xyz * DVec3::ONE).recip()) * xyz
});

static REC709_FROM_RELATIVE: LazyLock<DMat3> = LazyLock::new(|| RELATIVE_FROM_REC709.inverse());

/// L\*a\*b\* of XYZ over white's if both are given as cube roots; YCxCz if both are given as they are.
fn opponent(v: DVec3) -> DVec3 {
    DVec3::new(116.0 * v.y - 16.0, 500.0 * (v.x - v.y), 200.0 * (v.y - v.z))
}

/// The inverse of [`opponent`].
fn from_opponent(v: DVec3) -> DVec3 {
    let y = (v.x + 16.0) / 116.0;
    DVec3::new(y + v.y / 500.0, y, y - v.z / 200.0)
}

/// L\*a\*b\* of linear Rec. 709 inside its gamut, with Hunt's colourfulness.
fn hunt_lab(rgb: DVec3) -> DVec3 {
    const DELTA: f64 = 6.0 / 29.0;
    let root = |t: f64| {
        if t > DELTA * DELTA * DELTA {
            t.cbrt()
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let relative = RELATIVE_FROM_REC709.mul_vec3(rgb);
    let lab = opponent(DVec3::from_array(relative.to_array().map(root)));
    let hunt = 0.01 * lab.x;
    DVec3::new(lab.x, hunt * lab.y, hunt * lab.z)
}

/// HyAB (Abasi, Amani Tehran, Fairchild 2020), to its power.
fn colour_distance(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    (d.x.abs() + d.y.hypot(d.z)).powf(COLOUR_POWER)
}

/// What the eye makes of pictures at a number of pixels per degree: weights of odd length, the middle one at the pixel.
struct Eye {
    achromatic: Vec<(f64, Vec<f64>)>,
    red_green: Vec<(f64, Vec<f64>)>,
    blue_yellow: Vec<(f64, Vec<f64>)>,
    /// A Gaussian and its first and second derivative, whose weights of each sign sum to 1.
    smooth: Vec<f64>,
    slope: Vec<f64>,
    bend: Vec<f64>,
    /// The greatest colour difference: from green to blue.
    greatest: f64,
}

/// A picture as the eye has it.
struct Seen {
    lab: Vec<DVec3>,
    edge: Vec<f64>,
    point: Vec<f64>,
}

impl Eye {
    fn new(pixels_per_degree: f64) -> Result<Self> {
        if !(1.0..=1000.0).contains(&pixels_per_degree) {
            return Err(Error::domain(
                "the pixels per degree",
                pixels_per_degree,
                "1 to 1000",
                "67 is a display 0.7 m wide with 3840 pixels at 0.7 m",
            ));
        }
        // Three standard deviations of the widest blur.
        let widest = BLUE_YELLOW[0].1;
        let reach = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
        let blur = |parts: &[(f64, f64)]| sensitivity(parts, reach, pixels_per_degree);

        let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let offsets = -(3.0 * deviation).ceil() as i32..=(3.0 * deviation).ceil() as i32;
        let weights = |f: &dyn Fn(f64) -> f64| {
            let gauss = |x: f64| (-0.5 * (x / deviation).powi(2)).exp();
            let raw = offsets.clone().map(f64::from).map(|x| f(x) * gauss(x));
            balanced(raw.collect())
        };
        let [green, blue] = [DVec3::Y, DVec3::Z].map(hunt_lab);
        Ok(Eye {
            achromatic: blur(&ACHROMATIC),
            red_green: blur(&RED_GREEN),
            blue_yellow: blur(&BLUE_YELLOW),
            smooth: weights(&|_| 1.0),
            slope: weights(&|x| -x),
            bend: weights(&|x| (x / deviation).powi(2) - 1.0),
            greatest: colour_distance(green, blue),
        })
    }

    /// LDR-FLIP of what a display shows of two pictures in linear Rec. 709.
    fn difference(
        &self,
        reference: &[DVec3],
        test: &[DVec3],
        width: usize,
        shown: impl Fn(DVec3) -> DVec3 + Sync,
    ) -> Difference {
        let (reference, test) = rayon::join(
            || self.see(reference, width, &shown),
            || self.see(test, width, &shown),
        );
        let map = (0..reference.lab.len()).into_par_iter().map(|i| {
            let colour = self.redistributed(colour_distance(reference.lab[i], test.lab[i]));
            let edge = (reference.edge[i] - test.edge[i]).abs();
            let point = (reference.point[i] - test.point[i]).abs();
            let feature = (edge.max(point) / SQRT_2).powf(FEATURE_POWER);
            colour.powf(1.0 - feature) as f32
        });
        Difference::new(map.collect())
    }

    fn see(
        &self,
        picture: &[DVec3],
        width: usize,
        shown: &(impl Fn(DVec3) -> DVec3 + Sync),
    ) -> Seen {
        let ycxcz: Vec<DVec3> = picture
            .par_iter()
            .map(|rgb| opponent(RELATIVE_FROM_REC709.mul_vec3(shown(*rgb))))
            .collect();
        let plane = |channel: usize| ycxcz.iter().map(|v| v[channel]).collect::<Vec<_>>();
        let blurred = |channel, parts: &[(f64, Vec<f64>)]| {
            let plane = plane(channel);
            let mut sum = vec![0.0; plane.len()];
            for (share, weights) in parts {
                let part = filtered(&plane, width, weights, weights);
                sum.iter_mut().zip(part).for_each(|(s, p)| *s += share * p);
            }
            sum
        };
        let y = blurred(0, &self.achromatic);
        let cx = blurred(1, &self.red_green);
        let cz = blurred(2, &self.blue_yellow);
        let lab = (0..ycxcz.len()).into_par_iter().map(|i| {
            let relative = from_opponent(DVec3::new(y[i], cx[i], cz[i]));
            let rgb = REC709_FROM_RELATIVE.mul_vec3(relative);
            hunt_lab(rgb.clamp(DVec3::ZERO, DVec3::ONE))
        });
        let lightness: Vec<f64> = ycxcz.iter().map(|v| (v.x + 16.0) / 116.0).collect();
        let length = |derivative: &[f64]| {
            let across = filtered(&lightness, width, derivative, &self.smooth);
            let down = filtered(&lightness, width, &self.smooth, derivative);
            across.iter().zip(down).map(|(a, d)| a.hypot(d)).collect()
        };
        Seen {
            lab: lab.collect(),
            edge: length(&self.slope),
            point: length(&self.bend),
        }
    }

    /// A colour difference on the scale from 0 to 1.
    fn redistributed(&self, difference: f64) -> f64 {
        let (share, at) = KNEE;
        let knee = share * self.greatest;
        if difference < knee {
            at * difference / knee
        } else {
            at + (1.0 - at) * (difference - knee) / (self.greatest - knee)
        }
    }
}

/// A sum of Gaussians in two dimensions: the share of each, and its weights along one.
fn sensitivity(parts: &[(f64, f64)], reach: i32, pixels_per_degree: f64) -> Vec<(f64, Vec<f64>)> {
    let mut list: Vec<(f64, Vec<f64>)> = parts
        .iter()
        .map(|&(a, b)| {
            let weight = |i: i32| (-(PI * f64::from(i) / pixels_per_degree).powi(2) / b).exp();
            let raw: Vec<f64> = (-reach..=reach).map(weight).collect();
            let sum = raw.iter().sum::<f64>();
            (a * (PI / b).sqrt() * sum * sum, balanced(raw))
        })
        .collect();
    let whole: f64 = list.iter().map(|(share, _)| share).sum();
    list.iter_mut().for_each(|(share, _)| *share /= whole);
    list
}

/// Weights whose positive ones sum to 1 and whose negative ones to -1.
fn balanced(mut weights: Vec<f64>) -> Vec<f64> {
    let sum = |sign: f64| weights.iter().map(|w| (sign * w).max(0.0)).sum::<f64>();
    let (positive, negative) = (sum(1.0), sum(-1.0));
    for weight in &mut weights {
        *weight /= if *weight > 0.0 { positive } else { negative }.max(f64::MIN_POSITIVE);
    }
    weights
}

/// A plane weighted along its rows, then along its columns; beyond its edge stands the pixel at the edge.
fn filtered(plane: &[f64], width: usize, across: &[f64], down: &[f64]) -> Vec<f64> {
    let height = plane.len() / width;
    let mut rows = vec![0.0; plane.len()];
    let each = rows.par_chunks_mut(width).zip(plane.par_chunks(width));
    each.for_each(|(out, row)| {
        let reach = across.len() / 2;
        let mut wide = vec![row[0]; reach];
        wide.extend(row);
        wide.resize(width + 2 * reach, row[width - 1]);
        for (k, weight) in across.iter().enumerate() {
            add(out, &wide[k..], *weight);
        }
    });
    let mut columns = vec![0.0; plane.len()];
    let each = columns.par_chunks_mut(width).enumerate();
    each.for_each(|(y, out)| {
        for (k, weight) in down.iter().enumerate() {
            let from = (y + k).saturating_sub(down.len() / 2).min(height - 1);
            add(out, &rows[from * width..], *weight);
        }
    });
    columns
}

fn add(out: &mut [f64], values: &[f64], weight: f64) {
    out.iter_mut()
        .zip(values)
        .for_each(|(o, v)| *o += weight * v);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tone_curve_is_where_it_should_be() {
        let at = tone(DVec3::new(0.0, white_at_target(), 1e300));
        assert_eq!((at.x, at.z), (0.0, 1.0));
        assert!((at.y - TONE_TARGET).abs() < 1e-12, "{at}");
    }

    #[test]
    fn weights_sum_to_one_and_derivatives_to_zero() {
        for pixels_per_degree in [1.0, 20.0, PIXELS_PER_DEGREE, 1000.0] {
            let eye = Eye::new(pixels_per_degree).expect("it is in the domain");
            let sum = |weights: &[f64]| weights.iter().sum::<f64>();
            for (share, weights) in eye.blue_yellow.iter().chain(&eye.achromatic) {
                assert!(*share > 0.0 && (sum(weights) - 1.0).abs() < 1e-12);
            }
            assert!((sum(&eye.smooth) - 1.0).abs() < 1e-12);
            for weights in [&eye.slope, &eye.bend] {
                assert!(sum(weights).abs() < 1e-12, "{pixels_per_degree}");
                assert!(weights.iter().all(|w| w.is_finite()));
            }
        }
    }

    #[test]
    fn black_and_white_are_about_as_far_apart_as_can_be() {
        let size = [8, 8];
        let [black, white] = [DVec3::ZERO, DVec3::ONE].map(|rgb| vec![rgb; 64]);
        let found = ldr(&black, &white, size, PIXELS_PER_DEGREE).expect("they are of one size");
        assert!((0.9..=1.0).contains(&found.mean), "{}", found.mean);
    }

    #[test]
    fn colours_that_no_display_shows_are_cut_off() {
        // The working space's own green has a negative red in Rec. 709.
        let green = Space::Rec709.from_working() * DVec3::Y;
        assert!(green.x < 0.0 && green.y > 1.0);
        let cut = Space::Rec709.to_working() * green.clamp(DVec3::ZERO, DVec3::ONE);
        let found = ldr(&[DVec3::Y; 4], &[cut; 4], [2, 2], PIXELS_PER_DEGREE);
        assert!(found.expect("they are of one size").mean < 1e-6);
    }

    #[test]
    fn what_cannot_be_compared_is_named() {
        let grey = vec![DVec3::splat(0.5); 6];
        let broken = vec![DVec3::splat(f64::NAN); 6];
        let black = vec![DVec3::ZERO; 6];
        let named = |result: Result<Difference>, words: &str| {
            let found = result.expect_err(words).to_string();
            assert!(found.contains(words), "{found}");
        };
        named(ldr(&grey, &grey, [3, 3], 67.0), "6 pixels");
        named(ldr(&[], &[], [0, 3], 67.0), "0 pixels");
        named(ldr(&grey, &grey[..5], [3, 2], 67.0), "5 pixels");
        named(ldr(&grey, &broken, [3, 2], 67.0), "NaN");
        named(ldr(&grey, &grey, [3, 2], 0.5), "pixels per degree");
        named(hdr(&grey, &grey, [3, 2], f64::NAN), "pixels per degree");
        named(hdr(&black, &grey, [3, 2], 67.0), "black");
        let none = Exposures {
            start: 0.0,
            stop: 1.0,
            count: 0,
        };
        named(hdr_over(&grey, &grey, [3, 2], 67.0, none), "exposures");
    }
}
