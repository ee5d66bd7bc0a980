//! One plan at work on a device: tile by tile, sample by sample.

use super::beams::{BeamMaps, Drawing, Slots};
use super::device::Device;
use super::draw::{Draw, dispatch, tile_groups, warm};
use super::on_device::Growing;
use super::pipeline::Pipelines;
use super::prepare::{self, Compute, Filling, Maker, Stage, Work};
use super::scene::{Plane, SceneOnDevice, Triangles};
use super::schedule::{Action, Schedule};
use super::shared;
use super::store::Store;
use super::tile::{Target, TileBuffers};
use super::timer::Timer;
use super::window;
use crate::backend::film::{self, Film};
use crate::backend::rendering::{Made, PICTURE, Rendered, StartUp, StepTime, Traffic};
use crate::conditions::sample_positions;
use crate::effect::{Field, Fields, Kept, Life, Resource, Settings};
use crate::error::Result;
use crate::frame::{Mixture, NO_HIT};
use crate::plan::Plan;
use crate::scene::{Projection, Ray};
use crate::task::Task;
use glam::{DVec2, UVec2, Vec3};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use wgpu::*;

/// Rays that are handed to a core at once.
pub const CHUNK: usize = 256;

/// What a [`super::Gpu`] lends to a job.
pub struct Lent<'j> {
    pub device: &'j Device,
    pub pipelines: &'j mut Pipelines,
    pub scene: &'j mut SceneOnDevice,
    pub store: &'j mut Store,
    pub kept: &'j Kept,
    pub timer: &'j mut Timer,
    pub counting: bool,
}

/// A plan on a device: pipelines compiled, buffers and textures allocated.
pub struct Job<'j> {
    pub plan: &'j Plan<'j>,
    pub device: &'j Device,
    pub pipelines: &'j Pipelines,
    pub triangles: &'j Triangles,
    pub planes: &'j [Plane],
    pub anchor: glam::DVec3,
    /// The greatest depth in an orthographic frame [m].
    pub deepest: f64,
    pub slots: &'j mut Slots,
    pub store: &'j mut Store,
    pub written: Vec<Field>,
    pub tile: UVec2,
    pub corners: Buffer,
    tile_view: Buffer,
    rays: Buffer,
    pub common: BindGroup,
    pub numbers: Texture,
    depth: TextureView,
    pub fields: Vec<Target>,
    pub stages: Vec<Stage<'j>>,
    schedule: Schedule,
    fillings: Vec<Filling>,
    pub maps: Option<BeamMaps>,
    pub staging: Buffer,
    pub timer: &'j mut Timer,
    /// Where shaders count what they read, if they do.
    counts: Option<Buffer>,
    /// Which of the pixels' samples is at work.
    pub sample: u32,
    /// What the CPU knows of the tile's rays, once it was asked.
    pub on_cpu: Option<Vec<Fields>>,
    /// How many rays effects have left to their references.
    pub left_over: BTreeMap<&'static str, usize>,
    pub made: Made,
    start_up: StartUp,
    /// Compiling that drivers leave to the first run.
    late: Duration,
    /// Before anything was prepared.
    before: Traffic,
    pub task: Task<'j>,
}

impl<'j> Job<'j> {
    /// Prepares a plan on a device.
    pub fn new(plan: &'j Plan<'j>, lent: Lent<'j>, task: Task<'j>) -> Result<Self> {
        let Lent {
            device,
            pipelines,
            scene,
            store,
            kept,
            timer,
            counting,
        } = lent;
        task.check()?;
        let begin = Instant::now();
        let mut start_up = StartUp::default();
        let before = device.traffic();
        let compiled = pipelines.compiled;
        store.begin();
        let make = || scene.buffer(device, plan.conditions, &Resource::Corners);
        let corners = start_up
            .timed(prepare::SCENE, make)?
            .expect("corners are a buffer of the scene");
        let TileBuffers {
            tile,
            tile_view,
            rays,
            common,
            numbers,
            depth,
            fields,
            staging,
            counts,
        } = TileBuffers::new(plan, device, pipelines, store, counting)?;
        let mut maker = Maker {
            plan,
            device,
            pipelines,
            scene,
            store,
            kept: &kept.keeper(task),
            counting,
            fields: &fields,
            numbers: &numbers,
            pixels: u64::from(tile.x) * u64::from(tile.y),
            stages: Vec::new(),
            schedule: Schedule::default(),
            fillings: Vec::new(),
            maps: None,
            lamps: None,
            start_up,
        };
        maker.all()?;
        let Maker {
            mut start_up,
            stages,
            schedule,
            fillings,
            maps,
            ..
        } = maker;
        store.finish(plan.conditions, scene.anchor);
        timer.begin(stages.len() + 1);
        device.check()?;
        let traced = |stage: &Stage| matches!(stage.work, Work::Camera(.., true));
        let made = Made {
            pipelines: pipelines.compiled - compiled,
            ..Made::default()
        };
        let traced = stages.iter().any(traced);
        let anchor = scene.anchor;
        let deepest = window::deepest(plan.conditions, &scene.casters);
        let (triangles, planes, slots) = scene.parts(traced);
        let rest = begin.elapsed().saturating_sub(start_up.time());
        start_up.add("buffers", rest);
        Ok(Job {
            start_up,
            plan,
            device,
            pipelines,
            triangles,
            planes,
            anchor,
            deepest,
            slots,
            store,
            written: plan.written(),
            tile,
            corners,
            tile_view,
            rays,
            common,
            numbers,
            depth,
            fields,
            stages,
            schedule,
            fillings,
            maps,
            staging,
            timer,
            counts,
            sample: 0,
            on_cpu: None,
            left_over: BTreeMap::new(),
            made,
            late: Duration::ZERO,
            before,
            task: task.stage(PICTURE),
        })
    }

    /// Renders the whole picture, of at most `memory` bytes; what is to stay on the device grows there.
    pub fn render(mut self, memory: u64, growing: &mut Growing) -> Result<Rendered> {
        let start = Instant::now();
        let view = &self.plan.conditions.view;
        let size = UVec2::from(view.size);
        let mut film = match growing.is_wanted() {
            true => {
                film::fits(
                    view.size,
                    16 * u64::from(size.x) * u64::from(size.y),
                    memory,
                )?;
                None
            }
            false => Some(Film::new(view.size, &self.written, memory)?),
        };
        let offsets = sample_positions(view.samples);
        let middle = DVec2::splat(0.5);
        let central = (0..offsets.len())
            .min_by(|a, b| {
                let d = |i: &usize| offsets[*i].distance(middle);
                d(a).total_cmp(&d(b))
            })
            .unwrap_or(0);
        let corners: Vec<UVec2> = (0..size.y)
            .step_by(self.tile.y as usize)
            .flat_map(|y| {
                let columns = (0..size.x).step_by(self.tile.x as usize);
                columns.map(move |x| UVec2::new(x, y))
            })
            .collect();
        let count = (corners.len() * offsets.len()) as f64;
        let mut done = 0.0;
        let mut filled = false;
        for corner in corners {
            let extent = self.tile.min(size - corner);
            let several = film.is_some() && offsets.len() > 1;
            let pixels = if several { extent.x * extent.y } else { 0 };
            let mut mixtures = vec![Mixture::default(); pixels as usize];
            for (index, offset) in offsets.iter().enumerate() {
                self.task.check()?;
                self.sample = index as u32;
                let rays = self.begin_tile(corner, extent, *offset);
                if !filled {
                    self.fill()?;
                    filled = true;
                }
                self.run_tile(corner, extent, &rays)?;
                let share = 1.0 / offsets.len() as f32;
                match &mut film {
                    Some(film) => {
                        let fields: Vec<Field> = self.fields.iter().map(|t| t.field).collect();
                        let found = self.read(&fields)?;
                        self.put(film, corner, extent, &found, share, index == central);
                        self.mix(&mut mixtures, &found);
                    }
                    None => {
                        let layers = self.fields.iter().filter(|t| t.field.is_layer());
                        let layers: Vec<&Buffer> = layers.map(|target| &target.buffer).collect();
                        growing.add(self.device, view.size, &layers, (corner, extent), share)?;
                    }
                }
                done += 1.0;
                self.task.tell(done / count);
            }
            for (i, mixture) in mixtures.iter().enumerate() {
                if let Some(film) = &mut film {
                    film.mix(pixel_of(i, corner, extent), mixture);
                }
            }
        }
        let times = self.timer.take(self.device)?;
        let after = self.device.traffic();
        self.start_up.add(prepare::PIPELINES, self.late);
        self.made.maps = self.maps.as_ref().map_or(0, |maps| maps.runs);
        let mut notes = film.as_ref().map(Film::notes).unwrap_or_default();
        notes.extend(self.notes_of_rest());
        Ok(Rendered {
            notes,
            frame: film.map(Film::into_frame).unwrap_or_default(),
            steps: self.steps(times.as_deref()),
            traffic: Traffic {
                allocated: after.allocated,
                uploaded: after.uploaded - self.before.uploaded,
                downloaded: after.downloaded - self.before.downloaded,
            },
            refined: 0,
            made: self.made,
            elapsed: start.elapsed().saturating_sub(self.late),
            start_up: self.start_up,
        })
    }

    fn steps(&self, times: Option<&[Duration]>) -> Vec<StepTime> {
        let mut steps = Vec::new();
        if let Some(maps) = &self.maps {
            steps.push(StepTime {
                effect: maps.effect,
                pass: maps.pass,
                on_cpu: false,
                runs: maps.runs,
                counted: None,
                paid: None,
                time: times.map(|t| t[self.stages.len()]),
            });
        }
        for (stage, i) in self.stages.iter().zip(0..) {
            // What was not needed.
            if matches!(stage.work, Work::Rest(..)) && stage.runs == 0 {
                continue;
            }
            let by_cpu = matches!(stage.work, Work::Host(_) | Work::Rest(..));
            let on_cpu = by_cpu || self.found_by_cpu(stage);
            steps.push(StepTime {
                effect: stage.effect,
                pass: stage.pass,
                on_cpu,
                runs: stage.runs,
                counted: (self.counts.is_some() && !on_cpu).then_some(stage.counted),
                paid: stage.paid,
                time: if on_cpu {
                    Some(stage.on_cpu)
                } else {
                    times.map(|t| t[i])
                },
            });
        }
        steps
    }

    /// A panorama cannot be rasterised: the CPU finds its triangles. Points are known to it.
    fn found_by_cpu(&self, stage: &Stage) -> bool {
        matches!(stage.work, Work::Camera(..))
            && self.plan.conditions.view.camera.projection == Projection::Panorama
    }

    /// Tells the shaders of a tile: its rays and its place. The rays.
    fn begin_tile(&mut self, corner: UVec2, extent: UVec2, offset: DVec2) -> Vec<Ray> {
        let view = &self.plan.conditions.view;
        let count = (extent.x * extent.y) as usize;
        let rays: Vec<Ray> = (0..count)
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| view.ray(pixel_of(i, corner, extent).as_dvec2() + offset))
            .collect();
        let directions: Vec<[f32; 4]> = rays
            .iter()
            .map(|ray| ray.direction.as_vec3().extend(0.0).to_array())
            .collect();
        self.device
            .write(&self.rays, bytemuck::cast_slice(&directions));
        let tile_view = shared::uniform(&self.tile_view_of(corner, extent, offset));
        self.device.write(&self.tile_view, &tile_view);
        self.on_cpu = None;
        rays
    }

    /// Runs everything of a tile, in its order.
    fn run_tile(&mut self, corner: UVec2, extent: UVec2, rays: &[Ray]) -> Result<()> {
        let fields = self.fields.iter();
        let fields = fields.filter(|target| target.field != Field::Surface);
        let mut cleared: Vec<Buffer> = fields.map(|target| target.buffer.clone()).collect();
        cleared.extend(self.store.zeroed(Life::Tile).cloned());
        self.clear(&cleared);
        for index in 0..self.schedule.actions.len() {
            let stages = match &self.schedule.actions[index] {
                Action::Stage(stage) => {
                    let stage = *stage;
                    self.run(stage, corner, extent, rays)?;
                    continue;
                }
                Action::Beams(stages) => stages.clone(),
            };
            self.run_beams(&stages, extent)?;
        }
        Ok(())
    }

    fn clear(&self, buffers: &[Buffer]) {
        if buffers.is_empty() {
            return;
        }
        let device = &self.device.device;
        let mut encoder = device.create_command_encoder(&Default::default());
        for buffer in buffers {
            encoder.clear_buffer(buffer, 0, None);
        }
        self.device.queue.submit([encoder.finish()]);
    }

    /// Makes what is kept and not there.
    fn fill(&mut self) -> Result<()> {
        let fillings = std::mem::take(&mut self.fillings);
        // What passes make together is made together: adding to what is still good would spoil it.
        loop {
            let stale = |filling: &&Filling| filling.is_needed(self.store);
            let needed = fillings.iter().filter(stale);
            let together: Vec<_> = needed
                .flat_map(|filling| filling.makes().map(|name| (filling.effect.name, name)))
                .filter(|(effect, name)| !self.store.is_stale(effect, name))
                .collect();
            if together.is_empty() {
                break;
            }
            for (effect, name) in together {
                self.store.spoil(effect, name);
            }
        }
        let zeroed: Vec<Buffer> = self.store.zeroed(Life::Kept).cloned().collect();
        self.clear(&zeroed);
        let needed: Vec<&Filling> = fillings
            .iter()
            .filter(|filling| filling.is_needed(self.store))
            .collect();
        for filling in &needed {
            self.task.check()?;
            match &filling.until {
                None => self.turn(filling)?,
                Some((until, settings)) => {
                    let effect = filling.effect.name;
                    let settings = Settings {
                        effect,
                        values: settings,
                    };
                    let most = (until.most)(&settings);
                    let mut turns = 0;
                    while turns < most {
                        for _ in 0..until.turns.clamp(1, most - turns) {
                            self.turn(filling)?;
                            turns += 1;
                        }
                        self.task.check()?;
                        let found = self.read_product(filling.effect.name, until.condition.name)?;
                        if (until.holds)(&found, &settings) {
                            break;
                        }
                    }
                }
            }
        }
        for filling in &needed {
            for name in filling.makes() {
                self.store.made(filling.effect.name, name);
                if !self.made.products.contains(&name) {
                    self.made.products.push(name);
                }
            }
        }
        Ok(())
    }

    /// Runs the passes of a filling once.
    fn turn(&mut self, filling: &Filling) -> Result<()> {
        for stage in &filling.stages {
            self.run_kept(*stage)?;
        }
        Ok(())
    }

    /// The numbers of a product.
    fn read_product(&mut self, effect: &'static str, name: &'static str) -> Result<Vec<u32>> {
        let Some((buffer, bytes)) = self.store.buffer_of(effect, name) else {
            return Ok(Vec::new());
        };
        let buffer = buffer.clone();
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let what = "what a loop reads back";
        let staging = self.store.buffer(self.device, what, bytes, usage)?;
        let device = &self.device.device;
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&buffer, 0, &staging, 0, bytes);
        self.device.queue.submit([encoder.finish()]);
        let found = self.device.read(&staging, bytes)?;
        Ok(bytemuck::pod_collect_to_vec(&found))
    }

    /// Runs a stage of computing, over `otherwise` workgroups unless it has its own number.
    fn compute(&mut self, index: usize, otherwise: [u32; 2]) -> Result<()> {
        let stage = &mut self.stages[index];
        let Work::Compute(compute) = &mut stage.work else {
            return Ok(());
        };
        let over = compute.groups.unwrap_or(otherwise);
        let pipeline = &compute.pipeline;
        for own in std::iter::once(&compute.group).chain(&compute.further) {
            stage.runs += 1;
            let groups = [&self.common, own];
            if std::mem::take(&mut compute.cold) {
                self.late += warm(self.device, pipeline, &groups)?;
            }
            dispatch(self.device, self.timer, index, pipeline, &groups, over)?;
        }
        Ok(())
    }

    /// Runs a stage that fills what is kept.
    fn run_kept(&mut self, index: usize) -> Result<()> {
        let stage = &mut self.stages[index];
        match &stage.work {
            Work::Compute(_) => self.compute(index, [1, 1]),
            Work::Hemicube(raster, group, faces) => {
                stage.runs += 1;
                for (face, view) in faces.views.iter().enumerate() {
                    let draw = Draw {
                        raster,
                        groups: &[&self.common, group],
                        corners: &self.corners,
                        triangles: self.triangles.counts(),
                        color: view,
                        depth: &faces.depth,
                        far: 1.0,
                        instance: face as u32,
                        within: UVec2::splat(faces.side),
                    };
                    draw.submit(self.device, self.timer, index)?;
                }
                Ok(())
            }
            Work::Camera(..) | Work::Host(_) | Work::Rest(..) => Ok(()),
        }
    }

    /// Reads fields of the tile.
    pub fn read(&self, fields: &[Field]) -> Result<Vec<u8>> {
        let device = &self.device.device;
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut at = 0;
        for target in self.fields.iter().filter(|t| fields.contains(&t.field)) {
            encoder.copy_buffer_to_buffer(&target.buffer, 0, &self.staging, at, target.bytes);
            at += target.bytes;
        }
        self.device.queue.submit([encoder.finish()]);
        self.device.read(&self.staging, at)
    }

    fn run(&mut self, index: usize, corner: UVec2, extent: UVec2, rays: &[Ray]) -> Result<()> {
        if self.found_by_cpu(&self.stages[index]) {
            // Points are known, and take the place of what rays meet behind this.
            return match self.plan.conditions.view.points() {
                Some(_) => Ok(()),
                None => self.draw_by_cpu(index, corner, extent, rays),
            };
        }
        let stage = &mut self.stages[index];
        match &stage.work {
            Work::Compute(_) => {
                let finds = stage.effect.writes.contains(&Field::Surface);
                self.compute(index, tile_groups(extent))?;
                if finds && self.plan.conditions.view.points().is_some() {
                    self.write_points(corner, extent);
                }
                Ok(())
            }
            Work::Camera(raster, group, traced) => {
                let traced = *traced;
                stage.runs += 1;
                let view = self.numbers.create_view(&Default::default());
                let draw = Draw {
                    raster,
                    groups: &[&self.common, group],
                    corners: &self.corners,
                    triangles: self.triangles.counts(),
                    color: &view,
                    depth: &self.depth,
                    far: 0.0,
                    instance: 0,
                    within: self.tile,
                };
                draw.submit(self.device, self.timer, index)?;
                if traced || self.plan.conditions.geometry.has_veils() {
                    self.trace_some(index, corner, extent, rays, traced)?;
                }
                Ok(())
            }
            Work::Host(_) => self.run_host(index, corner, extent, rays),
            Work::Rest(..) => self.do_rest(index, corner, extent, rays),
            // It belongs to what is filled before all tiles.
            Work::Hemicube(..) => self.run_kept(index),
        }
    }

    /// Runs stages for each beam, beam by beam, so that the maps of a beam are drawn once for all that ask for them.
    fn run_beams(&mut self, stages: &[usize], extent: UVec2) -> Result<()> {
        let count = self.maps.as_ref().map_or(0, |maps| maps.beams.len());
        for beam in 0..count {
            let asks = |index: &&usize| match &self.stages[**index].work {
                Work::Compute(compute) => compute.beams.contains(&beam),
                _ => false,
            };
            let asking: Vec<usize> = stages.iter().filter(asks).copied().collect();
            if asking.is_empty() {
                continue;
            }
            let Some(maps) = &mut self.maps else { continue };
            let drawing = Drawing {
                device: self.device,
                pipelines: self.pipelines,
                common: &self.common,
                corners: &self.corners,
                triangles: self.triangles.counts(),
                timer: &mut *self.timer,
                number: self.stages.len(),
                eye: self.plan.conditions.view.camera.eye,
            };
            let ask = self.slots.maps_of(beam, maps, drawing)?;
            let zeroed: Vec<Buffer> = self.store.zeroed(Life::Beam).cloned().collect();
            self.clear(&zeroed);
            for index in asking {
                let stage = &mut self.stages[index];
                let Work::Compute(Compute {
                    pipeline,
                    group,
                    groups,
                    cold,
                    ..
                }) = &mut stage.work
                else {
                    continue;
                };
                stage.runs += 1;
                let over = groups.unwrap_or(tile_groups(extent));
                let groups = [&self.common, &*group, &ask];
                if std::mem::take(cold) {
                    self.late += warm(self.device, pipeline, &groups)?;
                }
                dispatch(self.device, self.timer, index, pipeline, &groups, over)?;
                self.take_counts(index)?;
            }
        }
        Ok(())
    }

    /// Adds what the last pass counted to its stage, if it did.
    fn take_counts(&mut self, index: usize) -> Result<()> {
        let Some(counts) = &self.counts else {
            return Ok(());
        };
        let device = &self.device.device;
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(counts, 0, &self.staging, 0, 8);
        encoder.clear_buffer(counts, 0, None);
        self.device.queue.submit([encoder.finish()]);
        let bytes = self.device.read(&self.staging, 8)?;
        for (sum, word) in self.stages[index].counted.iter_mut().zip(0..) {
            *sum += u64::from(float(&bytes, word).to_bits());
        }
        Ok(())
    }

    /// Puts a tile into the picture.
    fn put(
        &self,
        film: &mut Film,
        corner: UVec2,
        extent: UVec2,
        found: &[u8],
        share: f32,
        central: bool,
    ) {
        let mut at = 0usize;
        let count = (extent.x * extent.y) as usize;
        for target in &self.fields {
            let bytes = &found[at..at + target.bytes as usize];
            at += target.bytes as usize;
            for i in 0..count {
                let pixel = pixel_of(i, corner, extent);
                if target.field != Field::Surface {
                    let word = |w: usize| float(bytes, 4 * i + w);
                    let value = Vec3::new(word(0), word(1), word(2));
                    film.add(target.field, pixel, share * value);
                } else if central {
                    let word = |w| surface_word(bytes, i, w);
                    let met = word(7).to_bits() != shared::NOTHING;
                    let depth = if met { word(3).min(NO_HIT) } else { NO_HIT };
                    film.set_surface(pixel, depth, Vec3::new(word(0), word(1), word(2)));
                }
            }
        }
    }

    /// Adds the picture of a sample of a tile to what its pixels hold.
    fn mix(&self, mixtures: &mut [Mixture], found: &[u8]) {
        let mut at = 0;
        let mut layers = Vec::new();
        for target in &self.fields {
            if target.field.is_layer() {
                layers.push(&found[at..at + target.bytes as usize]);
            }
            at += target.bytes as usize;
        }
        mixtures
            .par_iter_mut()
            .enumerate()
            .for_each(|(i, mixture)| {
                let value = |bytes: &&[u8]| {
                    let word = |w: usize| float(bytes, 4 * i + w);
                    Vec3::new(word(0), word(1), word(2))
                };
                mixture.add(layers.iter().map(value).sum());
            });
    }
}

/// The pixel of the picture that is the i-th of a tile.
pub fn pixel_of(i: usize, corner: UVec2, extent: UVec2) -> UVec2 {
    let i = i as u32;
    corner + UVec2::new(i % extent.x, i / extent.x)
}

pub fn float(bytes: &[u8], word: usize) -> f32 {
    let mut four = [0; 4];
    four.copy_from_slice(&bytes[4 * word..4 * word + 4]);
    f32::from_le_bytes(four)
}

/// A word of a pixel's [`shared::Surface`]: 0 to 2 the normal, 3 the distance, 7 the number.
pub fn surface_word(bytes: &[u8], pixel: usize, word: usize) -> f32 {
    float(bytes, shared::SURFACE_BYTES as usize / 4 * pixel + word)
}
