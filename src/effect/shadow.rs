//! Shadow maps in z-partitions, for the effects that ask on a GPU whether the sun reaches a point.
//!
//! Maps are fitted to what is seen and not to the bounds of the scene: some thousand rays of the picture tell how far it sees, to
//! the first surface, the end of the air, or where the air hides what is behind (sample distribution shadow maps, Lauritzen,
//! Salvi & Lefohn 2011, with rays on the CPU in place of the device's depths). What they see is split by its distance z from the
//! eye into n partitions, z_i = l zn (zf / zn)^(i/n) + (1 - l) (zn + (zf - zn) i/n) with l the knob split (Zhang et al. 2006), zf
//! the farthest that a ray sees and zn half of what the nearest twentieth does. Where that makes partitions whose ends are more
//! than four times apart there are more of them, even in the logarithm. Each has an orthographic map across the light whose window
//! is fitted to its part of the rays and snapped to whole texels; a last map covers the whole view, for what no ray has met. A map
//! holds the sun-nearest caster of the whole scene; its depth runs over the heights of what lies over or under its window, so that
//! it has as many digits as it needs wherever else the scene reaches. A point is compared in the finest map that covers it. Maps
//! are made for each point of the sun's disc, and not at all where only surfaces are lit, whose shadows are traced
//! ([`super::surface_sun`]).
//!
//! A map has as many texels as the picture has use for: `density` across the width of a pixel in the middle of its partition,
//! measured across the light, up to `resolution` on a side. This is what the classes A, B and C of Kolivand et al. 2018 (section
//! 3.4) come to in numbers: near parts, of which the eye sees every detail, get all that a side may have; the middle what it
//! shows; what is far or lies flat under a low sun little. A part that a finer map covers altogether gets none. Maps are turned
//! around the light, so that the edges of buildings do not lie along texels: an edge that does is off by the same part of a
//! texel all along, and the light that a slit lets in with it.
//!
//! The reference traces exact shadows and has nothing to do here.

use super::{
    Contribution, Decision, Effect, Knob, MapSettings, Over, Pass, RasterView, Resource, When,
};

/// Shadow maps.
pub const SHADOW: Effect = Effect {
    name: "shadow",
    summary: "z-partitioned shadow maps (GPU; the reference traces shadows)",
    knobs: &[
        Knob {
            name: "partitions",
            meaning: "parts of what is seen by its distance, one map each; more where that reaches far",
            values: [3.0, 3.0, 4.0, 4.0],
            range: [1.0, 16.0],
        },
        Knob {
            name: "split",
            meaning: "share of logarithmic spacing in the split by distance, unless there are more parts; the rest is even",
            values: [0.7; 4],
            range: [0.0, 1.0],
        },
        Knob {
            name: "resolution",
            meaning: "the most texels on a side of a map",
            values: [1024.0, 4096.0, 4096.0, 8192.0],
            range: [16.0, 16384.0],
        },
        Knob {
            name: "density",
            meaning: "texels across a pixel's width in the middle of each partition, as far as the resolution allows",
            values: [2.0, 8.0, 16.0, 16.0],
            range: [0.0625, 1024.0],
        },
    ],
    decide: |conditions| {
        if let Some(reason) = conditions.sun.missing() {
            return Decision::nothing(reason);
        }
        Decision::run("sunlight meets surfaces", Contribution::Everything)
    },
    passes: &[Pass {
        shader: include_str!("../../shaders/shadow.wgsl"),
        entry: "map",
        over: Over::Raster(RasterView::Beam(|settings| MapSettings {
            partitions: settings.get("partitions") as usize,
            logarithmic: settings.get("split"),
            most: settings.get("resolution") as u32,
            density: settings.get("density"),
        })),
        when: When::Tile,
        uses: &[
            Resource::Attributes,
            Resource::Facets,
            Resource::Materials,
            Resource::Texels,
        ],
    }],
    ..Effect::NOTHING
};
