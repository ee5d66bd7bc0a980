//! Edges between very different brightness, as a display shows them: in proportion to what they cover.

mod common;

use common::build::{conditions, quad, scene};
use common::own_effects::{by_reference, on_gpu};
use glam::{DVec2, DVec3};
use tyndall::colour::display::{codes, display};
use tyndall::colour::srgb_decode;
use tyndall::conditions::{Conditions, sample_positions};
use tyndall::effect::{ALL, Contribution, Decision, Effect, Field};
use tyndall::frame::Frame;
use tyndall::output::png;
use tyndall::plan::{Overrules, Plan};
use tyndall::scene::{Camera, Projection};

const SKY: f64 = 10_000.0;
const STONE: f64 = 1.0;
const SIZE: [u32; 2] = [24, 16];

/// How far the edge goes to the right for each metre that it goes up.
const SLANT: f64 = 0.37;

/// Where the edge is in the middle of the picture, from there [m]; a pixel is 1 m wide.
const PLACE: f64 = 0.2137;

/// What is met is stone, all else is sky.
const TWO: Effect = Effect {
    name: "two",
    summary: "bright sky, dark stone",
    reads: &[Field::Surface],
    writes: &[Field::Lights],
    decide: |_| Decision::run("a test", Contribution::Everything),
    reference: |_, _, _| {
        Ok(Box::new(|fields| {
            fields.update(Field::Lights, |_, _, surface, _| {
                DVec3::splat(if surface.is_met() { STONE } else { SKY })
            });
        }))
    },
    ..Effect::NOTHING
};

/// A wall on the left of a slanted edge.
fn wall(samples: u32) -> Conditions {
    let up = DVec3::new(SLANT, 1.0, 0.0);
    let corner = DVec3::new(PLACE, 0.0, 0.0) - 20.0 * up;
    let wall = quad(corner, -30.0 * DVec3::X, 40.0 * up);
    let camera = Camera {
        eye: DVec3::new(0.0, 0.0, 10.0),
        forward: -DVec3::Z,
        up: DVec3::Y,
        projection: Projection::Orthographic {
            height: f64::from(SIZE[1]),
        },
        shift: DVec2::ZERO,
    };
    let mut conditions = conditions(scene(&wall, 180.0, 40.0), camera, SIZE);
    conditions.view.samples = samples;
    conditions
}

/// Pictures of both backends.
fn pictures(test: &str, samples: u32) -> Vec<Frame> {
    let conditions = wall(samples);
    let visibility = ALL.iter().find(|effect| effect.name == "visibility");
    let effects = [*visibility.expect("it is there"), &TWO];
    let plan = Plan::with(&conditions, &Overrules::default(), &effects).expect("they fit");
    let mut frames = vec![by_reference(&plan).frame];
    if common::gpu(test) {
        frames.push(on_gpu(&plan).frame);
    }
    frames
}

/// Whether sky is seen at a position of the picture.
fn is_sky(at: DVec2) -> bool {
    let [x, y] = [
        at.x - 0.5 * f64::from(SIZE[0]),
        0.5 * f64::from(SIZE[1]) - at.y,
    ];
    x > PLACE + SLANT * y
}

/// The share of a pixel at the offsets where sky is seen.
fn share(pixel: usize, offsets: &[DVec2]) -> f64 {
    let (x, y) = (pixel % SIZE[0] as usize, pixel / SIZE[0] as usize);
    let corner = DVec2::new(x as f64, y as f64);
    let seen = offsets.iter().filter(|offset| is_sky(corner + **offset));
    seen.count() as f64 / offsets.len() as f64
}

#[test]
fn an_edge_is_shown_in_proportion_to_what_it_covers() {
    const SAMPLES: u32 = 16;
    let offsets = sample_positions(SAMPLES);
    let fine: Vec<DVec2> = (0..4096)
        .map(|i| DVec2::new((i % 64) as f64 + 0.5, (i / 64) as f64 + 0.5) / 64.0)
        .collect();
    let test = "an_edge_is_shown_in_proportion_to_what_it_covers";
    for frame in pictures(test, SAMPLES) {
        frame.check().expect("every value is sound");
        let mixed: Vec<f64> = (0..frame.pixels())
            .map(|pixel| share(pixel, &offsets))
            .collect();
        let edge = mixed.iter().filter(|share| **share > 0.0 && **share < 1.0);
        assert_eq!(frame.mixed.pixels(), edge.count());
        // One frame at any exposure.
        for ev100 in [3.0, 6.0, 12.0] {
            let [sky, stone] = [SKY, STONE].map(|l| display(DVec3::splat(l), ev100));
            let bytes = png::encode(&frame, ev100);
            let mut from_the_mean = 0;
            for (pixel, (found, share)) in bytes.chunks_exact(3).zip(&mixed).enumerate() {
                let area = self::share(pixel, &fine);
                assert!((share - area).abs() <= 1.0 / f64::from(SAMPLES));
                let at = [pixel % SIZE[0] as usize, pixel / SIZE[0] as usize].map(|n| n as u32);
                let truth = codes(stone.lerp(sky, *share), at, true);
                assert!(
                    found.iter().zip(truth).all(|(a, b)| a.abs_diff(b) <= 1),
                    "{found:?} where {share} is sky at EV {ev100}, not {truth:?}"
                );
                // The linear mean is what it was, and shown it is another edge.
                let mean = frame.picture(pixel).x;
                let linear = STONE + share * (SKY - STONE);
                assert!((mean / linear - 1.0).abs() < 1e-5, "{mean} {linear}");
                let old = codes(display(frame.picture(pixel), ev100), at, true);
                from_the_mean = from_the_mean.max(old[0].abs_diff(truth[0]));
            }
            assert!(from_the_mean > 30, "{from_the_mean} at EV {ev100}");
            // From stone to sky it never darkens, but for the dither.
            for row in bytes.chunks_exact(3 * SIZE[0] as usize) {
                let row: Vec<u8> = row.iter().step_by(3).copied().collect();
                assert!(
                    row.windows(2)
                        .all(|pair| pair[0] <= pair[1].saturating_add(2)),
                    "{row:?}"
                );
            }
        }
    }
}

#[test]
fn the_sun_s_rim_is_shown_in_proportion_to_what_it_covers() {
    const SAMPLES: u32 = 16;
    // A disc of 24.4 pixels across, its centre off theirs; alone before a black sky.
    let diameter = 0.533f64.to_radians();
    let toward = DVec3::new(0.0, 0.6f64.sin(), -0.6f64.cos());
    let aside = DVec3::new(2e-4, 1e-4, 0.0);
    let mut scene = scene(&[], 0.0, 0.6f64.to_degrees());
    let sun = scene.sun.as_mut().expect("it has one");
    sun.diameter_deg = Some(0.533);
    let camera = Camera::look_at(DVec3::ZERO, toward + aside, diameter * 32.0 / 24.4);
    let disc = ALL.iter().find(|effect| effect.name == "sun_disc");
    let visibility = ALL.iter().find(|effect| effect.name == "visibility");
    let effects = [visibility, disc].map(|effect| *effect.expect("it is there"));
    let mut conditions = conditions(scene, camera, [32, 32]);
    let once = Plan::with(&conditions, &Overrules::default(), &effects).expect("they fit");
    let once = by_reference(&once).frame;
    conditions.view.samples = SAMPLES;
    let plan = Plan::with(&conditions, &Overrules::default(), &effects).expect("they fit");
    let mut frames = vec![by_reference(&plan).frame];
    if common::gpu("the_sun_s_rim_is_shown_in_proportion_to_what_it_covers") {
        frames.push(on_gpu(&plan).frame);
    }
    let brightest = |frame: &Frame| {
        let pixels = (0..frame.pixels()).map(|pixel| frame.picture(pixel).x);
        pixels.fold(0.0, f64::max)
    };
    for frame in frames {
        let mut rim = 0;
        let full = brightest(&frame);
        for (pixel, code) in png::encode(&frame, 14.0).chunks_exact(3).enumerate() {
            // The linear mean is what one ray gives, exactly the disc's part of the pixel.
            let (mean, exact) = (frame.picture(pixel).x, once.picture(pixel).x);
            assert!((mean - exact).abs() <= 1e-5 * full, "{mean} {exact}");
            let at = conditions.view.ray(DVec2::new(
                (pixel % 32) as f64 + 0.5,
                (pixel / 32) as f64 + 0.5,
            ));
            let from_rim = (at.direction.angle_between(toward) / diameter - 0.5) * 24.4;
            let shown = srgb_decode(f64::from(code[0]) / 255.0);
            if from_rim.abs() > 0.8 {
                assert!((shown - f64::from(from_rim < 0.0)).abs() < 0.01, "{shown}");
            } else {
                // A straight rim across a pixel at any angle: what it covers is known to 0.15.
                rim += 1;
                assert!((shown - (0.5 - from_rim).clamp(0.0, 1.0)).abs() < 0.15 + 1.0 / 16.0);
            }
        }
        assert!(rim > 60, "{rim}");
        assert!(frame.mixed.pixels() > 50);
    }
}

#[test]
fn with_one_sample_a_pixel_is_shown_as_it_is() {
    for frame in pictures("with_one_sample_a_pixel_is_shown_as_it_is", 1) {
        assert_eq!(frame.mixed.pixels(), 0);
        let bytes = png::encode(&frame, 6.0);
        for (pixel, found) in bytes.chunks_exact(3).enumerate() {
            let at = [pixel % SIZE[0] as usize, pixel / SIZE[0] as usize].map(|n| n as u32);
            let colour = frame.picture(pixel);
            assert_eq!(found, codes(display(colour, 6.0), at, true));
        }
    }
}

#[test]
fn a_frame_that_is_made_brighter_keeps_its_edges() {
    for mut frame in pictures("a_frame_that_is_made_brighter_keeps_its_edges", 16) {
        let before = png::encode(&frame, 6.0);
        for layer in &mut frame.layers {
            layer.rgb.iter_mut().for_each(|rgb| *rgb *= 4.0);
        }
        let after = png::encode(&frame, 8.0);
        let apart = before.iter().zip(&after).map(|(a, b)| a.abs_diff(*b));
        assert!(apart.max() <= Some(1));
    }
}
