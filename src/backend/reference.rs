//! The yardstick: every effect in f64 on all cores of the CPU, by its own exact way.
//!
//! Rays are worked off in batches, each of which passes through all effects of the plan; only the fields that these write are
//! ever held. A first pass takes one ray through each pixel's centre; where a picture of more samples is wanted, pixels that
//! differ from a neighbour are then resampled with that many rays: with all effects where the air's light differs, without
//! the air's where only surfaces or background do. So are all that show surfaces which let light through.

use super::film::Film;
use super::rendering::{Limits, PICTURE, Rendered, StartUp, StepTime};
use crate::colour::luminance;
use crate::conditions::{Conditions, sample_positions};
use crate::effect::{Batch, Effect, Field, Fields, Kept, Paid, Settings, Surface};
use crate::error::Result;
use crate::frame::{Frame, Layer, Mixture, NO_HIT, Part};
use crate::plan::Plan;
use crate::task::{Progress, Task};
use glam::{DVec2, DVec3, UVec2};
use rayon::prelude::*;
use std::collections::HashSet;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Neighbouring pixels that differ by less than this share of the brighter one's luminance need no more rays.
const CONTRAST: f64 = 0.05;

/// The same for the air's own light, which is soft but where a surface ends, and expensive.
const AIR_CONTRAST: f64 = 0.15;

/// Colours by field: `values[field as usize]`. That of [`Field::Surface`] is nothing.
pub type Values = [DVec3; Field::COUNT];

/// What one pixel holds.
#[derive(Debug, Clone)]
pub struct Sample {
    /// By field: layers are zero where none was made [cd/m2], the transmittance is one.
    pub values: Values,
    /// The surface.
    pub surface: Surface,
}

impl Sample {
    /// The value of a field.
    pub fn get(&self, field: Field) -> DVec3 {
        self.values[field as usize]
    }

    /// The picture: the sum of the layers [cd/m2].
    pub fn picture(&self) -> DVec3 {
        picture(&self.values)
    }
}

/// The picture: the sum of the layers [cd/m2].
pub fn picture(values: &Values) -> DVec3 {
    Field::layers().map(|field| values[field as usize]).sum()
}

/// Where a ray goes.
#[derive(Debug, Clone, Copy)]
pub struct Aim {
    /// The pixel that it belongs to.
    pub pixel: UVec2,
    /// Which of the pixel's samples it is.
    pub sample: u32,
    /// Position of the picture [pixels].
    pub at: DVec2,
}

struct Prepared<'a> {
    effect: &'static Effect,
    run: Batch<'a>,
    nanoseconds: AtomicU64,
    runs: AtomicU32,
    paid: Mutex<Option<Paid>>,
}

/// Which effects are run on a ray.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Rerun {
    All,
    /// All but those that only make the air's own light.
    WithoutAir,
}

/// A plan made ready to answer for any pixels.
pub struct Reference<'a> {
    plan: &'a Plan<'a>,
    steps: Vec<Prepared<'a>>,
    written: Vec<Field>,
    start_up: StartUp,
}

impl<'a> Reference<'a> {
    /// Prepares the effects of a plan.
    ///
    /// # Errors
    /// Those of the effects.
    pub fn new(plan: &'a Plan<'a>) -> Result<Self> {
        Self::keeping(plan, &Kept::default(), Task::unwatched())
    }

    /// The same with what effects kept of plans before, as far as it still holds; what is new is kept there.
    ///
    /// # Errors
    /// Those of the effects; [`crate::Error::Stopped`] when the work was stopped.
    pub fn keeping(plan: &'a Plan<'a>, kept: &Kept, task: Task<'_>) -> Result<Self> {
        let kept = kept.keeper(task);
        let mut start_up = StartUp::default();
        let steps: Result<Vec<_>> = plan
            .running()
            .map(|step| {
                task.check()?;
                let settings = Settings {
                    effect: step.effect.name,
                    values: &step.settings,
                };
                // It knows none of the methods by which a GPU integrates sunlight in the air.
                let name = step.effect.method.map_or(step.effect.name, |_| "shafts");
                let prepare = || (step.effect.reference)(plan.conditions, &settings, &kept);
                Ok(Prepared {
                    effect: step.effect,
                    run: start_up.timed(&format!("{name}.prepare"), prepare)?,
                    nanoseconds: AtomicU64::new(0),
                    runs: AtomicU32::new(0),
                    paid: Mutex::default(),
                })
            })
            .collect();
        Ok(Reference {
            plan,
            steps: steps?,
            written: plan.written(),
            start_up,
        })
    }

    /// The plan that it answers for.
    pub fn plan(&self) -> &'a Plan<'a> {
        self.plan
    }

    /// Takes rays through positions of the picture.
    pub fn trace(&self, aims: &[Aim]) -> Vec<Sample> {
        self.trace_with(aims, Rerun::All)
    }

    fn trace_with(&self, aims: &[Aim], rerun: Rerun) -> Vec<Sample> {
        let conditions = self.plan.conditions;
        let rays = aims.iter().map(|aim| conditions.view.ray(aim.at)).collect();
        let pixels = aims.iter().map(|aim| aim.pixel).collect();
        let samples = aims.iter().map(|aim| aim.sample).collect();
        let mut fields = Fields::new(rays, pixels, samples, &self.written);
        for step in &self.steps {
            if rerun == Rerun::WithoutAir && only_air(step.effect) {
                continue;
            }
            let effect = step.effect;
            fields.name(effect.reads, [effect.writes, effect.alters]);
            let start = Instant::now();
            (step.run)(&mut fields);
            let elapsed = start.elapsed().as_nanos() as u64;
            step.nanoseconds.fetch_add(elapsed, Ordering::Relaxed);
            step.runs.fetch_add(1, Ordering::Relaxed);
            if let Some(paid) = fields.take_paid() {
                let mut sum = step.paid.lock().unwrap_or_else(PoisonError::into_inner);
                *sum = Some(sum.unwrap_or_default().and(paid));
            }
        }
        (0..aims.len())
            .map(|i| Sample {
                values: Field::ALL.map(|field| {
                    fields
                        .found(field)
                        .map_or(field.unwritten(), |values| values[i])
                }),
                surface: fields.surfaces[i],
            })
            .collect()
    }

    /// Takes the centres of pixels, on all cores.
    pub fn pixels(&self, pixels: &[UVec2]) -> Vec<Sample> {
        pixels
            .par_chunks(batch(pixels.len(), 64))
            .flat_map_iter(|chunk| self.centres(chunk))
            .collect()
    }

    /// Takes the centres of pixels, one after the other.
    pub(super) fn centres(&self, pixels: &[UVec2]) -> Vec<Sample> {
        let aim = |pixel: &UVec2| Aim {
            pixel: *pixel,
            sample: 0,
            at: centre(*pixel),
        };
        self.trace(&pixels.iter().map(aim).collect::<Vec<_>>())
    }

    /// The fields of pixels, each the mean of `samples` rays at the places of [`sample_positions`], on all cores.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] when the work was stopped.
    pub fn sampled(&self, pixels: &[UVec2], samples: u32, task: Task<'_>) -> Result<Vec<Values>> {
        let offsets = sample_positions(samples);
        let means = in_pieces(pixels, 16, task, |pixels| {
            let whole: Vec<_> = pixels.iter().map(|p| (*p, Rerun::All)).collect();
            self.means(&whole, &offsets, |_| DVec3::ZERO)
        })?;
        Ok(means.into_iter().map(|(mean, _)| mean).collect())
    }

    /// Time of each effect so far, summed over cores.
    pub fn times(&self) -> Vec<StepTime> {
        self.steps
            .iter()
            .map(|step| StepTime {
                effect: step.effect,
                pass: "reference",
                on_cpu: true,
                runs: step.runs.load(Ordering::Relaxed),
                counted: None,
                paid: *step.paid.lock().unwrap_or_else(PoisonError::into_inner),
                time: Some(Duration::from_nanos(
                    step.nanoseconds.load(Ordering::Relaxed),
                )),
            })
            .collect()
    }

    /// Renders the whole picture.
    ///
    /// # Errors
    /// [`crate::Error::Input`] when the frame would hold more than the limit's memory; [`crate::Error::Stopped`] when it was
    /// stopped.
    pub fn render(&self, limits: &Limits, progress: Progress) -> Result<Rendered> {
        let task = limits.task(progress).stage(PICTURE);
        let view = &self.plan.conditions.view;
        let [width, height] = view.size;
        let mut film = Film::new(view.size, &self.written, limits.memory)?;
        let start = Instant::now();
        let samples = view.samples;
        // As if all pixels were resampled, until some of them have told.
        let mut first_share = match samples {
            1 => 1.0,
            samples => 1.0 / (1.0 + f64::from(samples)),
        };
        // A turn has every so many-th three of rows: each takes about as long as another, so that the first tell how long the rest will
        // take, and in each middle row it is seen which pixels differ from their neighbours.
        let threes = height.div_ceil(3);
        let turns = threes.div_ceil(TURN);
        let mut done = 0.0;
        for turn in 0..turns {
            let rows = (turn..threes).step_by(turns as usize);
            let band: Vec<UVec2> = rows
                .flat_map(|three| 3 * three..(3 * three + 3).min(height))
                .flat_map(|y| (0..width).map(move |x| UVec2::new(x, y)))
                .collect();
            let share = band.len() as f64 / (f64::from(width) * f64::from(height));
            let task = task.part(first_share * done, first_share * (done + share).min(1.0));
            let found = in_pieces(&band, 64, task, |pixels| self.centres(pixels))?;
            for (pixel, sample) in band.iter().zip(&found) {
                put(&mut film, *pixel, &sample.values, Rerun::All);
                let surface = &sample.surface;
                let distance = (surface.distance as f32).min(NO_HIT);
                film.set_surface(*pixel, distance, surface.normal.as_vec3());
            }
            done += share;
            if turn == 0 && samples > 1 {
                let resampled = self.resampled_share(&band, &found);
                first_share = 1.0 / (1.0 + resampled * f64::from(samples));
            }
        }
        let mut refined = 0;
        if samples > 1 {
            let edges = self.with_veiled(edges(film.frame()));
            refined = edges.len();
            let offsets = sample_positions(samples);
            // What all of them hold together would be more than the film.
            const MANY: usize = 4096;
            let task = task.part(first_share, 1.0);
            for (part, edges) in (0..).zip(edges.chunks(MANY)) {
                let [from, to] =
                    [part, part + 1].map(|part| ((MANY * part) as f64 / refined as f64).min(1.0));
                let frame = film.frame();
                let means = in_pieces(edges, 16, task.part(from, to), |edges| {
                    let air = |pixel: UVec2| air(frame, (pixel.y * width + pixel.x) as usize);
                    self.means(edges, &offsets, air)
                })?;
                for ((pixel, rerun), (mean, mixture)) in edges.iter().zip(&means) {
                    put(&mut film, *pixel, mean, *rerun);
                    film.mix(*pixel, mixture);
                }
            }
        }
        task.tell(1.0);
        Ok(Rendered {
            notes: film.notes(),
            frame: film.into_frame(),
            steps: self.times(),
            start_up: self.start_up.clone(),
            refined,
            elapsed: start.elapsed(),
            ..Rendered::default()
        })
    }

    /// The share of pixels that will be resampled, by the middle rows of threes of whole rows.
    fn resampled_share(&self, pixels: &[UVec2], samples: &[Sample]) -> f64 {
        let width = self.plan.conditions.view.size[0] as usize;
        let threes = pixels
            .chunks_exact(3 * width)
            .zip(samples.chunks_exact(3 * width));
        let shares: Vec<f64> = threes
            .map(|(pixels, samples)| {
                let pictures: Vec<DVec3> = samples.iter().map(Sample::picture).collect();
                let airs: Vec<DVec3> = samples.iter().map(|s| air_of(&s.values)).collect();
                let mut resampled = vec![false; width];
                for (i, _) in differing([width, 3], &pictures, &airs) {
                    if let Some(inner) = i.checked_sub(width).filter(|inner| *inner < width) {
                        resampled[inner] = true;
                    }
                }
                let middle = resampled.into_iter().zip(&pixels[width..]);
                let count = middle.filter(|(differs, pixel)| *differs || self.is_veiled(**pixel));
                count.count() as f64 / width as f64
            })
            .collect();
        shares.iter().sum::<f64>() / shares.len().max(1) as f64
    }

    /// Whether one ray through a pixel shows only one of several surfaces, as these let light through.
    pub(super) fn is_veiled(&self, pixel: UVec2) -> bool {
        let Conditions { geometry, view, .. } = self.plan.conditions;
        geometry.has_veils()
            && view.points().is_none()
            && geometry.is_veiled(&view.ray(centre(pixel)))
    }

    /// The same with all pixels where one ray shows only one of several surfaces, as these let light through.
    fn with_veiled(&self, mut edges: Vec<(UVec2, Rerun)>) -> Vec<(UVec2, Rerun)> {
        let Conditions { geometry, view, .. } = self.plan.conditions;
        if !geometry.has_veils() || view.points().is_some() {
            return edges;
        }
        let [width, height] = view.size;
        let veiled: Vec<UVec2> = (0..width * height)
            .into_par_iter()
            .map(|i| UVec2::new(i % width, i / width))
            .filter(|pixel| self.is_veiled(*pixel))
            .collect();
        let is_veiled: HashSet<UVec2> = veiled.iter().copied().collect();
        edges.retain(|(pixel, _)| !is_veiled.contains(pixel));
        edges.extend(veiled.into_iter().map(|pixel| (pixel, Rerun::All)));
        edges
    }

    /// The means over `offsets` of the fields of each pixel, and what of them a display has to show; `air` is the air's own light in a
    /// pixel where it is not made again.
    pub(super) fn means(
        &self,
        edges: &[(UVec2, Rerun)],
        offsets: &[DVec2],
        air: impl Fn(UVec2) -> DVec3,
    ) -> Vec<(Values, Mixture)> {
        edges
            .iter()
            .map(|(pixel, rerun)| {
                let air = match rerun {
                    Rerun::All => DVec3::ZERO,
                    Rerun::WithoutAir => air(*pixel),
                };
                let aim = |(sample, offset): (u32, &DVec2)| Aim {
                    pixel: *pixel,
                    sample,
                    at: pixel.as_dvec2() + *offset,
                };
                let aims: Vec<Aim> = (0..).zip(offsets).map(aim).collect();
                let mut mean = [DVec3::ZERO; Field::COUNT];
                let mut mixture = Mixture::default();
                for sample in self.trace_with(&aims, *rerun) {
                    mixture.add((sample.picture() + air).as_vec3());
                    for (m, v) in mean.iter_mut().zip(&sample.values) {
                        *m += v / offsets.len() as f64;
                    }
                }
                (mean, mixture)
            })
            .collect()
    }
}

/// So many threes of rows are worked off together.
const TURN: u32 = 11;

/// Puts the values of a pixel into the picture, those of the air's own light only where they were made.
fn put(film: &mut Film, pixel: UVec2, values: &Values, rerun: Rerun) {
    for field in Field::ALL {
        if rerun == Rerun::All || field.part() != Part::Air {
            film.set(field, pixel, values[field as usize].as_vec3());
        }
    }
}

/// What is found of each of some pixels, by at most so many at a time, on all cores.
///
/// # Errors
/// [`crate::Error::Stopped`] when the task was stopped.
fn in_pieces<P: Sync, T: Send>(
    pixels: &[P],
    most: usize,
    task: Task<'_>,
    find: impl Fn(&[P]) -> Vec<T> + Sync,
) -> Result<Vec<T>> {
    let size = batch(pixels.len(), most);
    let pieces = task.pieces(pixels.len().div_ceil(size));
    let found: Result<Vec<Vec<T>>> = pixels
        .par_chunks(size)
        .map(|pixels| {
            pieces.begin()?;
            Ok(find(pixels))
        })
        .collect();
    Ok(found?.into_iter().flatten().collect())
}

/// How many of so many pixels pass through the effects together: at most `most`, and few enough that every core has some.
fn batch(pixels: usize, most: usize) -> usize {
    let shares = 4 * rayon::current_num_threads();
    pixels.div_ceil(shares).clamp(1, most)
}

fn centre(pixel: UVec2) -> DVec2 {
    pixel.as_dvec2() + 0.5
}

/// Whether an effect makes nothing but the air's own light.
fn only_air(effect: &Effect) -> bool {
    let mut made = effect.writes.iter().chain(effect.alters).peekable();
    made.peek().is_some() && made.all(|field| field.part() == Part::Air)
}

/// The light of a pixel that the air itself sends [cd/m2].
fn air(frame: &Frame, pixel: usize) -> DVec3 {
    let is_air =
        |layer: &&Layer| Field::named(layer.name).is_some_and(|field| field.part() == Part::Air);
    let layers = frame.layers.iter().filter(is_air);
    layers.map(|layer| layer.rgb[pixel].as_dvec3()).sum()
}

/// The air's own light among the values of a pixel [cd/m2].
pub(super) fn air_of(values: &Values) -> DVec3 {
    let fields = Field::layers().filter(|field| field.part() == Part::Air);
    fields.map(|field| values[field as usize]).sum()
}

/// The pixels whose colour differs from one of their eight neighbours', and what must be resampled there.
fn edges(frame: &Frame) -> Vec<(UVec2, Rerun)> {
    let size = [frame.width, frame.height].map(|side| side as usize);
    let (picture, air): (Vec<DVec3>, Vec<DVec3>) = (0..frame.pixels())
        .into_par_iter()
        .map(|i| (frame.picture(i), air(frame, i)))
        .unzip();
    let at = |i: usize| UVec2::new((i % size[0]) as u32, (i / size[0]) as u32);
    let differing = differing(size, &picture, &air).into_par_iter();
    differing.map(|(i, rerun)| (at(i), rerun)).collect()
}

/// The same of a part of a picture, row by row, by index.
pub(super) fn differing(
    [width, height]: [usize; 2],
    picture: &[DVec3],
    air: &[DVec3],
) -> Vec<(usize, Rerun)> {
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
            if around(x, y).any(|j| differs(air, AIR_CONTRAST, i, j)) {
                Some((i, Rerun::All))
            } else if around(x, y).any(|j| differs(picture, CONTRAST, i, j)) {
                Some((i, Rerun::WithoutAir))
            } else {
                None
            }
        })
        .collect()
}
