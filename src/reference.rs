//! The yardstick: every effect in f64 on all cores of the CPU, by its own exact way.
//!
//! Rays are worked off in batches, each of which passes through all effects of the plan; only the fields that these write are
//! ever held. A first pass takes one ray through each pixel's centre; where a picture of more samples is wanted, pixels that
//! differ from a neighbour are then taken again with that many rays: with all effects where the air's light differs, without
//! the air's where only surfaces or background do.

use crate::colour::luminance;
use crate::effect::{ALL, Batch, Effect, Field, Fields, Settings, Surface};
use crate::error::{Error, Result};
use crate::frame::{Frame, Layer, NO_HIT};
use crate::plan::{Plan, sample_positions};
use glam::{DVec2, DVec3, UVec2, Vec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Called with the share of the work that is done, 0 to 1.
pub type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// Neighbouring pixels that differ by less than this share of the brighter one's luminance need no more rays.
const CONTRAST: f64 = 0.05;

/// The same for the air's own light, which is soft but where a surface ends, and dear.
const AIR_CONTRAST: f64 = 0.15;

/// What one pixel holds.
#[derive(Debug, Clone)]
pub struct Sample {
    /// The layers of [`Field::LAYERS`], zero where none was made [cd/m2].
    pub layers: [DVec3; 7],
    /// Light let through by the air.
    pub transmittance: DVec3,
    /// The surface.
    pub surface: Surface,
}

impl Sample {
    /// The picture: the sum of the layers [cd/m2].
    pub fn picture(&self) -> DVec3 {
        self.layers.iter().sum()
    }
}

/// Time that an effect took, summed over cores.
#[derive(Debug, Clone, PartialEq)]
pub struct StageTime {
    /// The effect.
    pub effect: &'static str,
    /// Summed over cores.
    pub time: Duration,
}

/// A finished rendering.
pub struct Rendered {
    /// The picture.
    pub frame: Frame,
    /// Time of each effect, summed over cores.
    pub stages: Vec<StageTime>,
    /// Pixels that were taken again with more rays.
    pub refined: usize,
    /// From the first ray to the last.
    pub elapsed: Duration,
}

struct Prepared<'a> {
    effect: &'static Effect,
    run: Batch<'a>,
    nanoseconds: AtomicU64,
}

/// Which effects are run on a ray.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Extent {
    All,
    /// All but those that only make the air's own light.
    WithoutAir,
}

/// A plan made ready to answer for any pixels.
pub struct Reference<'a> {
    plan: &'a Plan<'a>,
    steps: Vec<Prepared<'a>>,
    written: Vec<Field>,
}

impl<'a> Reference<'a> {
    /// Prepares the effects of a plan.
    pub fn new(plan: &'a Plan<'a>) -> Self {
        let steps: Vec<_> = plan
            .running()
            .map(|step| {
                let settings = Settings {
                    values: &step.settings,
                };
                Prepared {
                    effect: step.effect,
                    run: (step.effect.reference)(plan.conditions, &settings),
                    nanoseconds: AtomicU64::new(0),
                }
            })
            .collect();
        Reference {
            plan,
            steps,
            written: plan.written(),
        }
    }

    /// Memory that a frame of this plan's size holds [bytes].
    pub fn frame_bytes(&self) -> u64 {
        let [w, h] = self.plan.conditions.size;
        let layers = Field::LAYERS
            .iter()
            .filter(|f| self.written.contains(f))
            .count();
        u64::from(w) * u64::from(h) * Frame::bytes_per_pixel(layers) as u64
    }

    /// Takes rays through positions of the picture [pixels]; each belongs to the pixel that is named.
    pub fn trace(&self, positions: &[(UVec2, DVec2)]) -> Vec<Sample> {
        self.trace_with(positions, Extent::All)
    }

    fn trace_with(&self, positions: &[(UVec2, DVec2)], extent: Extent) -> Vec<Sample> {
        let conditions = self.plan.conditions;
        let rays = positions
            .iter()
            .map(|(_, at)| conditions.camera.ray(*at, conditions.size))
            .collect();
        let pixels = positions.iter().map(|(pixel, _)| *pixel).collect();
        let mut fields = Fields::new(rays, pixels, &self.written);
        for step in &self.steps {
            if extent == Extent::WithoutAir && only_air(step.effect) {
                continue;
            }
            let start = Instant::now();
            (step.run)(&mut fields);
            let elapsed = start.elapsed().as_nanos() as u64;
            step.nanoseconds.fetch_add(elapsed, Ordering::Relaxed);
        }
        (0..positions.len())
            .map(|i| Sample {
                layers: Field::LAYERS
                    .map(|layer| fields.get(layer).map_or(DVec3::ZERO, |values| values[i])),
                transmittance: fields
                    .get(Field::Transmittance)
                    .map_or(DVec3::ONE, |values| values[i]),
                surface: fields.surfaces[i],
            })
            .collect()
    }

    /// Takes the centres of pixels, on all cores.
    pub fn pixels(&self, pixels: &[UVec2]) -> Vec<Sample> {
        pixels
            .par_chunks(64)
            .flat_map_iter(|chunk| {
                let positions: Vec<_> = chunk.iter().map(|p| (*p, centre(*p))).collect();
                self.trace(&positions)
            })
            .collect()
    }

    /// The layers of [`Field::LAYERS`] and the transmittance of pixels, each the mean of `samples` rays at the places of
    /// [`sample_positions`], on all cores.
    pub fn sampled(&self, pixels: &[UVec2], samples: u32) -> Vec<[DVec3; 8]> {
        let offsets = sample_positions(samples);
        pixels
            .par_chunks(16)
            .flat_map_iter(|chunk| {
                let whole: Vec<_> = chunk.iter().map(|p| (*p, Extent::All)).collect();
                self.means(&whole, &offsets)
            })
            .collect()
    }

    /// Time of each effect so far, summed over cores.
    pub fn stage_times(&self) -> Vec<StageTime> {
        self.steps
            .iter()
            .map(|step| StageTime {
                effect: step.effect.name,
                time: Duration::from_nanos(step.nanoseconds.load(Ordering::Relaxed)),
            })
            .collect()
    }

    /// Renders the whole picture.
    ///
    /// # Errors
    /// [`Error::Input`] when the frame would hold more than `memory_limit` bytes.
    pub fn render(&self, memory_limit: u64, progress: Progress) -> Result<Rendered> {
        let [width, height] = self.plan.conditions.size;
        let bytes = self.frame_bytes();
        if bytes > memory_limit {
            return Err(Error::input(
                format!("--size {width}x{height}"),
                format!(
                    "the frame would hold {} MiB, more than the limit of {} MiB",
                    bytes >> 20,
                    memory_limit >> 20
                ),
                "make the picture smaller, leave effects out with --without, or raise the limit with --max-memory",
            ));
        }
        let start = Instant::now();
        let mut frame = Frame::new(width, height);
        let pixels = frame.pixels();
        for layer in Field::LAYERS.iter().filter(|f| self.written.contains(f)) {
            frame.layers.push(Layer {
                name: layer.name(),
                rgb: vec![Vec3::ZERO; pixels],
            });
        }
        let samples = self.plan.conditions.samples;
        let first_share = if samples > 1 { 0.5 } else { 1.0 };
        const BAND: u32 = 32;
        for top in (0..height).step_by(BAND as usize) {
            let band: Vec<UVec2> = (top..(top + BAND).min(height))
                .flat_map(|y| (0..width).map(move |x| UVec2::new(x, y)))
                .collect();
            let found = self.pixels(&band);
            for (pixel, sample) in band.iter().zip(&found) {
                self.put(&mut frame, *pixel, sample);
            }
            progress(
                first_share * f64::from(top + BAND).min(f64::from(height)) / f64::from(height),
            );
        }
        let mut refined = 0;
        if samples > 1 {
            let edges = edges(&frame);
            refined = edges.len();
            let offsets = sample_positions(samples);
            for (part, chunk) in edges.chunks(4096).enumerate() {
                let means: Vec<[DVec3; 8]> = chunk
                    .par_chunks(16)
                    .flat_map_iter(|edges| self.means(edges, &offsets))
                    .collect();
                for ((pixel, extent), mean) in chunk.iter().zip(&means) {
                    self.put_mean(&mut frame, *pixel, mean, *extent);
                }
                let done = (part * 4096 + chunk.len()) as f64 / edges.len() as f64;
                progress(first_share + (1.0 - first_share) * done);
            }
        }
        progress(1.0);
        Ok(Rendered {
            frame,
            stages: self.stage_times(),
            refined,
            elapsed: start.elapsed(),
        })
    }

    /// The means over `offsets` of the layers and the transmittance of each pixel.
    fn means(&self, edges: &[(UVec2, Extent)], offsets: &[DVec2]) -> Vec<[DVec3; 8]> {
        edges
            .iter()
            .map(|(pixel, extent)| {
                let positions: Vec<_> = offsets
                    .iter()
                    .map(|offset| (*pixel, pixel.as_dvec2() + *offset))
                    .collect();
                let mut mean = [DVec3::ZERO; 8];
                for sample in self.trace_with(&positions, *extent) {
                    for (m, v) in mean.iter_mut().zip(&sample.layers) {
                        *m += v / offsets.len() as f64;
                    }
                    mean[7] += sample.transmittance / offsets.len() as f64;
                }
                mean
            })
            .collect()
    }

    fn put(&self, frame: &mut Frame, pixel: UVec2, sample: &Sample) {
        let index = (pixel.y * frame.width + pixel.x) as usize;
        let mut values = [DVec3::ZERO; 8];
        values[..7].copy_from_slice(&sample.layers);
        values[7] = sample.transmittance;
        self.put_mean(frame, pixel, &values, Extent::All);
        let surface = &sample.surface;
        frame.depth[index] = (surface.distance as f32).min(NO_HIT);
        frame.normal[index] = surface.normal.as_vec3();
    }

    fn put_mean(&self, frame: &mut Frame, pixel: UVec2, values: &[DVec3; 8], extent: Extent) {
        let index = (pixel.y * frame.width + pixel.x) as usize;
        for layer in &mut frame.layers {
            let slot = Field::LAYERS
                .iter()
                .position(|f| f.name() == layer.name)
                .expect("only layers of the list are made");
            if extent == Extent::WithoutAir && AIR.contains(&Field::LAYERS[slot]) {
                continue;
            }
            layer.rgb[index] = values[slot].as_vec3();
        }
        frame.transmittance[index] = values[7].as_vec3();
    }
}

/// Wall time that each effect of the whole picture will take, one ray a pixel, judged by 2048 pixels.
///
/// Of an effect that remembers, later pixels cost less: its time is taken to level off exponentially, as that of 2048
/// pixels against that of the first 512 has it. A prediction, not a bound.
pub fn predict(reference: &Reference) -> Vec<StageTime> {
    let [w, h] = reference.plan.conditions.size;
    let all = f64::from(w) * f64::from(h);
    let pixels = spread([w, h], 2048);
    let (few, rest) = pixels.split_at(pixels.len() / 4);
    let start = Instant::now();
    reference.pixels(few);
    let first = reference.stage_times();
    reference.pixels(rest);
    let second = reference.stage_times();
    let cpu: f64 = second.iter().map(|s| s.time.as_secs_f64()).sum();
    let cores = cpu / start.elapsed().as_secs_f64().max(1e-9);
    first
        .iter()
        .zip(&second)
        .map(|(a, b)| {
            let (few_time, time) = (a.time.as_secs_f64(), b.time.as_secs_f64());
            let growth = if few_time > 0.0 { time / few_time } else { 4.0 };
            let remembers = ALL.iter().any(|e| e.name == b.effect && e.remembers);
            let whole = if !remembers || growth >= 4.0 || few.is_empty() {
                time * all / pixels.len() as f64
            } else {
                // time(n) = c (1 - x^(n / few)), so growth = 1 + x + x^2 + x^3.
                let (mut low, mut high) = (0.0f64, 1.0f64);
                for _ in 0..50 {
                    let x = 0.5 * (low + high);
                    if 1.0 + x * (1.0 + x * (1.0 + x)) < growth {
                        low = x;
                    } else {
                        high = x;
                    }
                }
                few_time * (1.0 - low.powf(all / few.len() as f64)) / (1.0 - low)
            };
            StageTime {
                effect: b.effect,
                time: Duration::from_secs_f64(whole / cores.max(1.0)),
            }
        })
        .collect()
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
            let at = |power: f64, extent: f64| {
                ((0.5 + i as f64 / power).fract() * extent).min(extent - 1.0) as u32
            };
            UVec2::new(at(PLASTIC, w), at(PLASTIC * PLASTIC, h))
        })
        .collect()
}

fn centre(pixel: UVec2) -> DVec2 {
    pixel.as_dvec2() + 0.5
}

/// The layers of light that the air itself sends.
const AIR: [Field; 3] = [
    Field::InscatterSun,
    Field::InscatterSky,
    Field::InscatterLights,
];

/// Whether an effect makes nothing but the air's own light.
fn only_air(effect: &Effect) -> bool {
    !effect.writes.is_empty() && effect.writes.iter().all(|field| AIR.contains(field))
}

/// The pixels whose colour differs from one of their eight neighbours', and what must be taken again there.
fn edges(frame: &Frame) -> Vec<(UVec2, Extent)> {
    let (width, height) = (frame.width as usize, frame.height as usize);
    let is_air = |layer: &&Layer| AIR.iter().any(|air| air.name() == layer.name);
    let (picture, air): (Vec<DVec3>, Vec<DVec3>) = (0..frame.pixels())
        .into_par_iter()
        .map(|i| {
            let air = frame.layers.iter().filter(is_air);
            let air: DVec3 = air.map(|layer| layer.rgb[i].as_dvec3()).sum();
            (frame.picture(i), air)
        })
        .unzip();
    let differs = |values: &[DVec3], contrast: f64, a: usize, b: usize| {
        let brighter = luminance(picture[a]).max(luminance(picture[b]));
        (values[a] - values[b]).abs().max_element() > contrast * brighter
    };
    let around = |x: usize, y: usize| {
        let columns = x.saturating_sub(1)..(x + 2).min(width);
        (y.saturating_sub(1)..(y + 2).min(height))
            .flat_map(move |v| columns.clone().map(move |u| v * width + u))
    };
    (0..width * height)
        .into_par_iter()
        .filter_map(|i| {
            let (x, y) = (i % width, i / width);
            let extent = if around(x, y).any(|j| differs(&air, AIR_CONTRAST, i, j)) {
                Extent::All
            } else if around(x, y).any(|j| differs(&picture, CONTRAST, i, j)) {
                Extent::WithoutAir
            } else {
                return None;
            };
            Some((UVec2::new(x as u32, y as u32), extent))
        })
        .collect()
}
