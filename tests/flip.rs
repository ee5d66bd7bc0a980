//! FLIP and HDR-FLIP against the program of its authors.

mod common;

use glam::{DVec3, dvec3};
use serde_json::{Value, json};
use tyndall::accuracy::flip::{self, Difference, Exposures, PIXELS_PER_DEGREE};
use tyndall::colour::Space;

/// A picture in linear Rec. 709.
#[derive(Clone)]
struct Picture {
    size: [u32; 2],
    rgb: Vec<DVec3>,
}

impl Picture {
    /// A picture of a function of x and y in pixels.
    fn of(size: [u32; 2], at: impl Fn(f64, f64) -> DVec3) -> Self {
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let rgb = pixels.map(|(x, y)| at(x.into(), y.into()));
        Picture {
            size,
            rgb: rgb.collect(),
        }
    }

    fn map(&self, change: impl FnMut(DVec3) -> DVec3) -> Self {
        Picture {
            size: self.size,
            rgb: self.rgb.iter().copied().map(change).collect(),
        }
    }

    fn working(&self) -> Vec<DVec3> {
        let matrix = Space::Rec709.to_working();
        self.rgb.iter().map(|rgb| matrix * *rgb).collect()
    }

    fn rows(&self) -> Value {
        let rows = self.rgb.chunks(self.size[0] as usize);
        json!(
            rows.map(|row| row.iter().map(|rgb| rgb.to_array()).collect())
                .collect::<Vec<Vec<_>>>()
        )
    }
}

/// Noise from 0 to 1 without a pattern (SplitMix64, Steele 2014).
fn noise(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64
}

/// Discs, stripes and a gradient, from black to saturated colours, inside 0 to 1.
fn figures(size: [u32; 2], shift: f64) -> Picture {
    Picture::of(size, |x, y| {
        let (x, y) = (x + shift, y);
        if (x - 17.0).hypot(y - 14.0) < 9.0 {
            dvec3(0.9, 0.1, 0.05)
        } else if (x - 40.0).abs() < 1.5 {
            dvec3(0.02, 0.05, 0.8)
        } else if ((x + y) / 5.0).fract() < 0.4 && y > 24.0 {
            DVec3::splat(0.85)
        } else {
            dvec3(0.1, 0.35, 0.55) * (0.2 + y / 50.0)
        }
    })
}

/// A sky of 3000 cd/m2 over dark ground, around a sun of up to 1.6e9 cd/m2.
fn sunset(size: [u32; 2], sun: f64, shift: f64) -> Picture {
    Picture::of(size, |x, y| {
        let x = x + shift;
        let d = (x - 20.3).hypot(y - 11.7);
        let sky = dvec3(0.7, 0.9, 1.3) * 3000.0 * (0.3 + 1.0 / (1.0 + 0.1 * d));
        let disc = dvec3(1.0, 0.7, 0.35) * sun * (-0.5 * (d / 1.3).powi(2)).exp();
        if y > 20.0 + 3.0 * (x / 7.0).sin() {
            dvec3(0.4, 0.3, 0.2) * (8.0 + x)
        } else {
            sky + disc
        }
    })
}

/// The mean of 3 x 3 pixels.
fn blurred(picture: &Picture) -> Picture {
    let [width, height] = picture.size.map(i64::from);
    Picture::of(picture.size, |x, y| {
        let near = (-1..=1).flat_map(|j| (-1..=1).map(move |i| (x as i64 + i, y as i64 + j)));
        let pixel = |(x, y): (i64, i64)| y.clamp(0, height - 1) * width + x.clamp(0, width - 1);
        near.map(|at| picture.rgb[pixel(at) as usize])
            .sum::<DVec3>()
            / 9.0
    })
}

struct Pair {
    name: &'static str,
    reference: Picture,
    test: Picture,
    hdr: bool,
    pixels_per_degree: f64,
}

fn pairs() -> Vec<Pair> {
    let mut state = 7;
    let mut noisy = |picture: &Picture, relative: f64| {
        picture.map(|rgb| rgb * (1.0 + relative * (2.0 * noise(&mut state) - 1.0)))
    };
    let size = [61, 47];
    let (scene, sun) = (figures(size, 0.0), sunset(size, 1.6e9, 0.0));
    let mut list = Vec::new();
    let mut add = |name, reference: &Picture, test: Picture, hdr, pixels_per_degree| {
        list.push(Pair {
            name,
            reference: reference.clone(),
            test,
            hdr,
            pixels_per_degree,
        });
    };
    let theirs = PIXELS_PER_DEGREE;
    add("shift", &scene, figures(size, 1.0), false, theirs);
    add("noise", &scene, noisy(&scene, 0.1), false, theirs);
    add("blur", &scene, blurred(&scene), false, theirs);
    add("coarse", &scene, blurred(&scene), false, 25.0);
    add("fine", &scene, figures(size, 1.0), false, 120.0);
    add("hdr shift", &sun, sunset(size, 1.6e9, 1.0), true, theirs);
    add("hdr noise", &sun, noisy(&sun, 0.03), true, theirs);
    add("hdr blur", &sun, blurred(&sun), true, theirs);
    add("hdr coarse", &sun, noisy(&sun, 0.03), true, 30.0);
    let dim = sunset(size, 0.0, 0.0).map(|rgb| 1e-6 * rgb);
    add("hdr night", &dim, noisy(&dim, 0.2), true, theirs);
    // More than half of it is black: the median is zero.
    let mut half = sun.clone();
    half.rgb[..1500].fill(DVec3::ZERO);
    add("hdr half black", &half, noisy(&half, 0.05), true, theirs);
    for (name, size) in [("1 x 1", [1, 1]), ("1 x 9", [1, 9]), ("7 x 2", [7, 2])] {
        let one = figures(size, 0.0);
        add(name, &one, one.map(|rgb| 0.8 * rgb), false, theirs);
        let sun = sunset(size, 1e6, 0.0);
        add(name, &sun, sun.map(|rgb| 1.1 * rgb), true, theirs);
    }
    list
}

fn ours(pair: &Pair, pixels_per_degree: f64) -> Difference {
    let (reference, test) = (pair.reference.working(), pair.test.working());
    let measure = if pair.hdr { flip::hdr } else { flip::ldr };
    let size = pair.reference.size;
    measure(&reference, &test, size, pixels_per_degree).expect(pair.name)
}

/// The mean when all exposures are too dark: by half a stop on a display, and by three where the greatest of many counts.
fn darker(pair: &Pair) -> f64 {
    let (size, ppd) = (pair.reference.size, pair.pixels_per_degree);
    let stops: f64 = if pair.hdr { 3.0 } else { 0.5 };
    let dark = |picture: &Picture| picture.map(|rgb| rgb * (-stops).exp2()).working();
    let (reference, test) = (dark(&pair.reference), dark(&pair.test));
    let found = if pair.hdr {
        let exposures = Exposures::of(&pair.reference.working()).expect(pair.name);
        flip::hdr_over(&reference, &test, size, ppd, exposures)
    } else {
        flip::ldr(&reference, &test, size, ppd)
    };
    found.expect(pair.name).mean
}

/// How far means may be apart: their program computes in f32, whose rounding the features' square root magnifies, and with
/// rounded matrices. Found: 5e-6, and 4e-5 for a single pixel.
const BOUND: f64 = 1e-4;

#[test]
fn differences_are_those_of_the_authors_program() {
    let name = "differences_are_those_of_the_authors_program";
    let pairs = pairs();
    let given: Vec<Value> = pairs
        .iter()
        .map(|pair| {
            json!({
                "reference": pair.reference.rows(),
                "test": pair.test.rows(),
                "hdr": pair.hdr,
                "parameters": { "ppd": pair.pixels_per_degree },
            })
        })
        .collect();
    let Some(text) = common::python(name, "flip.py", &json!(given).to_string()) else {
        return;
    };
    let judged: Option<Vec<Value>> = serde_json::from_str(&text).expect("flip.py prints JSON");
    let Some(judged) = judged else {
        common::not_run(
            name,
            "this Python has no flip-evaluator, which is built for some systems only",
        );
        return;
    };
    let (mut worst_mean, mut worst_pixel): (f64, f64) = (0.0, 0.0);
    for (pair, theirs) in pairs.iter().zip(&judged) {
        let mean = theirs["mean"].as_f64().expect("a mean");
        let map: Vec<f64> = serde_json::from_value(theirs["map"].clone()).expect("a map");
        let found = ours(pair, pair.pixels_per_degree);
        let pixel = found.map.iter().zip(&map);
        let pixel = pixel.map(|(a, b)| (f64::from(*a) - b).abs());
        let pixel = pixel.fold(0.0, f64::max);
        let off = (found.mean - mean).abs();
        println!(
            "{}{}: {:.6}, theirs {mean:.6}, off by {off:.1e}, a pixel by {pixel:.1e}",
            pair.name,
            if pair.hdr { " (hdr)" } else { "" },
            found.mean
        );
        (worst_mean, worst_pixel) = (worst_mean.max(off), worst_pixel.max(pixel));
        // Something is to be seen.
        assert!(found.mean > 0.005, "{}", pair.name);

        if pair.hdr {
            let exposures = Exposures::of(&pair.reference.working()).expect(pair.name);
            let [start, stop, count]: [f64; 3] =
                serde_json::from_value(theirs["exposures"].clone()).expect("three numbers");
            assert!((exposures.start - start).abs() < 1e-3, "{exposures:?}");
            assert!((exposures.stop - stop).abs() < 1e-3, "{exposures:?}");
            assert_eq!(exposures.count as f64, count);
        }
        // A wrong input is noticed: another exposure of both pictures, or of one; another distance from the display, where
        // there is something to blur.
        let brighter = Pair {
            test: pair.test.map(|rgb| 1.02 * rgb),
            reference: pair.reference.clone(),
            ..*pair
        };
        let mut wrong = vec![darker(pair), ours(&brighter, pair.pixels_per_degree).mean];
        if pair.reference.rgb.len() > 100 {
            wrong.push(ours(pair, 0.8 * pair.pixels_per_degree).mean);
        }
        for wrong in wrong {
            assert!((wrong - mean).abs() > 5.0 * BOUND, "{}: {wrong}", pair.name);
        }
    }
    println!("means within {worst_mean:.1e}, pixels within {worst_pixel:.1e}");
    assert!(worst_mean < BOUND, "{worst_mean}");
    assert!(worst_pixel < 2.0 * BOUND, "{worst_pixel}");
}

#[test]
fn the_same_picture_has_no_difference_and_places_may_change() {
    for pair in pairs() {
        let (reference, test) = (pair.reference.working(), pair.test.working());
        let (size, ppd) = (pair.reference.size, pair.pixels_per_degree);
        let same = ours(
            &Pair {
                test: pair.reference.clone(),
                reference: pair.reference.clone(),
                ..pair
            },
            ppd,
        );
        assert_eq!(same.mean, 0.0, "{}", pair.name);
        assert!(same.map.iter().all(|d| *d == 0.0), "{}", pair.name);

        let found = ours(&pair, ppd);
        assert!(found.map.iter().all(|d| (0.0..=1.0).contains(d)));
        let swapped = if pair.hdr {
            let exposures = Exposures::of(&reference).expect(pair.name);
            flip::hdr_over(&test, &reference, size, ppd, exposures)
        } else {
            flip::ldr(&test, &reference, size, ppd)
        };
        assert_eq!(swapped.expect(pair.name), found, "{}", pair.name);

        // HDR-FLIP knows no unit of light where the median is not the least one.
        if pair.hdr && pair.name != "hdr half black" {
            let scaled = |picture: &[DVec3]| picture.iter().map(|c| 8.0 * *c).collect::<Vec<_>>();
            let scaled = flip::hdr(&scaled(&reference), &scaled(&test), size, ppd);
            let mean = scaled.expect(pair.name).mean;
            assert!((mean - found.mean).abs() < 1e-6, "{}: {mean}", pair.name);
        }
    }
}

#[test]
fn a_picture_seen_in_a_mirror_differs_as_much() {
    let pair = &pairs()[0];
    let mirrored = |picture: &Picture| {
        let rows = picture.rgb.chunks(picture.size[0] as usize);
        let rgb = rows.flat_map(|row| row.iter().rev().copied()).collect();
        let size = picture.size;
        Picture { size, rgb }
    };
    let found = ours(pair, PIXELS_PER_DEGREE);
    let mirror = Pair {
        reference: mirrored(&pair.reference),
        test: mirrored(&pair.test),
        ..*pair
    };
    let mirror = ours(&mirror, PIXELS_PER_DEGREE);
    assert!((mirror.mean - found.mean).abs() < 1e-9);
}
