//! A plan made ready on a device, and its pictures.

mod by_cpu;
mod draw;
mod each_sun;
mod make;
mod view;

use super::device::{Device, Traffic};
use super::light::{self, Resolution, Split};
use super::pipeline::{BUFFERS_COUNTING, Pipelines, Raster};
use super::scene::{Plane, SceneBuffers, Triangles, media};
use super::shared;
use super::timer::Timer;
use crate::colour::Space;
use crate::conditions::{Conditions, SunPoint};
use crate::effect::visibility::{ground_surface, known_surface};
use crate::effect::{Batch, Field, Fields, Kind, Pass, Resource, Settings};
use crate::error::{Error, Result};
use crate::frame::{Frame, Layer, NO_HIT};
use crate::plan::{Plan, sample_positions};
use crate::scene::{Projection, Ray};
use glam::{DVec2, DVec3, UVec2, Vec3, Vec4};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use wgpu::*;

use draw::{Draw, dispatch, texture, tile_groups};
use make::Maker;

/// Called with the share of the work that is done, 0 to 1.
pub type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// Side of a tile [pixels]: a quarter of a million rays are a few milliseconds on hardware.
const TILE: u32 = 512;

/// Shadow maps of several of the sun's points are kept up to this size [bytes].
const KEPT_MAPS: u64 = 2 << 30;

/// Rays that are handed to a core at once.
const CHUNK: usize = 256;

/// One entry of the list of passes.
#[derive(Debug, Clone, PartialEq)]
pub struct PassTime {
    /// The effect.
    pub effect: &'static str,
    /// The pass's entry point, or `reference` for what the CPU did.
    pub pass: &'static str,
    /// Whether the CPU did it.
    pub on_cpu: bool,
    /// How often it ran.
    pub runs: u32,
    /// Reads of shadow maps and leaves, and of nodes of trees, when they were counted ([`Gpu::counting`]).
    pub counted: Option<[u64; 2]>,
    /// Its time: the device's own clock, or the CPU's wall clock for what that did, a software adapter too; `None` when the
    /// device has no clock.
    pub time: Option<Duration>,
}

/// A finished rendering.
pub struct Rendered {
    /// The picture.
    pub frame: Frame,
    /// What ran, in order.
    pub passes: Vec<PassTime>,
    /// Bytes allocated so far, and moved for this picture.
    pub traffic: Traffic,
    /// From the first tile to the last.
    pub elapsed: Duration,
}

enum Work<'a> {
    Pixels(ComputePipeline, BindGroup),
    EachSun(EachSun),
    /// The flag asks for exact silhouettes.
    Picture(Raster, BindGroup, bool),
    Host(Batch<'a>),
}

struct EachSun {
    pipeline: ComputePipeline,
    group: BindGroup,
    scratch: Option<BindGroup>,
    /// Which of [`SunMaps::points`] it runs for.
    points: Vec<usize>,
    /// Workgroups; absent: those that cover the tile.
    groups: Option<[u32; 2]>,
}

struct Stage<'a> {
    effect: &'static str,
    pass: &'static str,
    work: Work<'a>,
    /// Whether it finds the surfaces, which all others read.
    finds_surfaces: bool,
    runs: u32,
    on_cpu: Duration,
    counted: [u64; 2],
}

struct Slot {
    toward: DVec3,
    filled: bool,
    /// Of its maps [texels].
    side: u32,
    light: Buffer,
    /// Depths and casters of each partition.
    views: Vec<(TextureView, TextureView)>,
    draw: BindGroup,
    ask: BindGroup,
}

struct SunMaps {
    raster: Raster,
    group: BindGroup,
    split: Split,
    resolution: Resolution,
    casters: Vec<DVec3>,
    /// The same, relative to the eye, as the shaders read them.
    corners: Texture,
    /// The points of all effects, and where the maps of each look.
    points: Vec<(SunPoint, shared::Light)>,
    slots: Vec<Slot>,
    /// Whether the device had no room for one more.
    full: bool,
    runs: u32,
}

struct Target {
    field: Field,
    buffer: Buffer,
    bytes: u64,
}

/// A plan on a device: pipelines compiled, buffers and textures allocated.
pub struct Gpu<'a> {
    plan: &'a Plan<'a>,
    device: Device,
    pipelines: Pipelines,
    written: Vec<Field>,
    /// Fields that the CPU makes.
    from_host: Vec<Field>,
    tile: UVec2,
    triangles: Triangles,
    corners: Buffer,
    frame: Buffer,
    rays: Buffer,
    common: BindGroup,
    numbers: Texture,
    depth: TextureView,
    planes: Vec<Plane>,
    fields: Vec<Target>,
    stages: Vec<Stage<'a>>,
    maps: Option<SunMaps>,
    staging: Buffer,
    timer: Timer,
    /// Where shaders count what they read, if they do.
    counts: Option<Buffer>,
}

impl<'a> Gpu<'a> {
    /// Prepares a plan on a device.
    ///
    /// # Errors
    /// [`Error::Failed`] when the scene is larger than the adapter takes, or the driver fails; [`Error::Domain`] for a shadow
    /// map larger than the adapter's textures.
    pub fn new(plan: &'a Plan<'a>, device: Device) -> Result<Self> {
        Self::prepared(plan, device, false)
    }

    /// The same with shaders that count what they read ([`PassTime::counted`]); times of such a rendering mean nothing. Takes
    /// one storage buffer more than every device has.
    ///
    /// # Errors
    /// Those of [`Gpu::new`]; [`Error::Failed`] on a device that has too few storage buffers.
    pub fn counting(plan: &'a Plan<'a>, device: Device) -> Result<Self> {
        Self::prepared(plan, device, true)
    }

    fn prepared(plan: &'a Plan<'a>, device: Device, counting: bool) -> Result<Self> {
        let conditions = plan.conditions;
        let buffers = device.limits().max_storage_buffers_per_shader_stage;
        if counting && buffers < BUFFERS_COUNTING {
            return Err(Error::failed(
                format!(
                    "counting what shaders read takes {BUFFERS_COUNTING} storage buffers, and {} takes {buffers} at once",
                    device.adapter.name
                ),
                "use another adapter: `tyndall doctor` lists them",
            ));
        }
        let mut pipelines = Pipelines::new(&device, counting);
        let triangles = Triangles::new(conditions);
        let mut scene = SceneBuffers::default();
        let tile = UVec2::from(conditions.size).min(UVec2::splat(TILE));
        let pixels = u64::from(tile.x) * u64::from(tile.y);

        let corners = scene
            .get(&device, conditions, &triangles, &Resource::Corners)?
            .expect("corners are a buffer of the scene");
        let frame = device.buffer(
            "the frame",
            shared::uniform(&shared::Frame::default()).len() as u64,
            BufferUsages::UNIFORM | BufferUsages::COPY_DST,
        )?;
        let rays = device.buffer(
            "the rays",
            16 * pixels,
            BufferUsages::STORAGE | BufferUsages::COPY_DST,
        )?;
        let mut air = media(conditions);
        if air.is_empty() {
            air.push(shared::Medium::default());
        }
        let air = device.filled("the media", &shared::list(&air), BufferUsages::STORAGE)?;
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let counts = match counting {
            true => Some(device.buffer("counts", 8, storage)?),
            false => None,
        };
        let common = device.device.create_bind_group(&BindGroupDescriptor {
            label: Some("frame, rays, media, counts"),
            layout: &pipelines.common,
            entries: &[&frame, &rays, &air]
                .into_iter()
                .chain(&counts)
                .zip(0..)
                .map(|(buffer, binding)| BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect::<Vec<_>>(),
        });
        let usage = TextureUsages::RENDER_ATTACHMENT
            | TextureUsages::TEXTURE_BINDING
            | TextureUsages::COPY_DST
            | TextureUsages::COPY_SRC;
        let numbers = texture(&device, "numbers", tile, 1, TextureFormat::R32Uint, usage);
        let depth = texture(
            &device,
            "depth",
            tile,
            1,
            TextureFormat::Depth32Float,
            TextureUsages::RENDER_ATTACHMENT,
        )
        .create_view(&Default::default());

        let written = plan.written();
        let mut fields = Vec::new();
        for field in &written {
            let bytes = match field {
                Field::Surface => shared::SURFACE_BYTES * pixels,
                _ => 16 * pixels,
            };
            fields.push(Target {
                field: *field,
                buffer: device.buffer(field.name(), bytes, storage)?,
                bytes,
            });
        }
        let all: u64 = fields.iter().map(|f| f.bytes).sum();
        let staging = device.buffer(
            "what is read back",
            all.max(u64::from(by_cpu::numbers_pitch(tile.x)) * u64::from(tile.y)),
            BufferUsages::MAP_READ | BufferUsages::COPY_DST,
        )?;

        let mut maker = Maker {
            plan,
            device: &device,
            pipelines: &mut pipelines,
            scene: &mut scene,
            triangles: &triangles,
            fields: &fields,
            numbers: &numbers,
            stages: Vec::new(),
            maps: None,
            from_host: Vec::new(),
            pixels,
            scratch: BTreeMap::new(),
        };
        maker.all()?;
        let Maker {
            stages,
            maps,
            from_host,
            ..
        } = maker;
        let silhouettes = |stage: &Stage| matches!(stage.work, Work::Picture(.., true));
        let planes = if stages.iter().any(silhouettes) {
            triangles.planes(conditions)
        } else {
            Vec::new()
        };
        let timer = Timer::new(&device, stages.len() + 1)?;
        device.check()?;
        Ok(Gpu {
            plan,
            pipelines,
            written,
            from_host,
            tile,
            triangles,
            corners,
            frame,
            rays,
            common,
            numbers,
            depth,
            planes,
            fields,
            stages,
            maps,
            staging,
            timer,
            counts,
            device,
        })
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The pipelines that were compiled: `effect.entry`.
    pub fn pipelines(&self) -> &[String] {
        &self.pipelines.compiled
    }

    /// The fields for which there is room.
    pub fn fields(&self) -> &[Field] {
        &self.written
    }

    /// Renders the whole picture.
    ///
    /// With more than one sample, all pixels take the mean of as many rays, at the places of [`sample_positions`]; distance and
    /// normal are those of the ray nearest the pixel's centre.
    ///
    /// # Errors
    /// [`Error::Input`] when the frame would hold more than `memory_limit` bytes; [`Error::Failed`] when the device fails.
    pub fn render(&mut self, memory_limit: u64, progress: Progress) -> Result<Rendered> {
        let start = Instant::now();
        let before = self.device.traffic();
        let conditions = self.plan.conditions;
        let [width, height] = conditions.size;
        let layers: Vec<Field> = Field::LAYERS
            .into_iter()
            .filter(|f| self.written.contains(f))
            .collect();
        let bytes =
            u64::from(width) * u64::from(height) * Frame::bytes_per_pixel(layers.len()) as u64;
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
        for stage in &mut self.stages {
            (stage.runs, stage.on_cpu, stage.counted) = (0, Duration::ZERO, [0; 2]);
        }
        if let Some(maps) = &mut self.maps {
            maps.runs = 0;
            maps.slots.iter_mut().for_each(|slot| slot.filled = false);
        }
        let mut frame = Frame::new(width, height);
        let pixels = frame.pixels();
        for layer in &layers {
            frame.layers.push(Layer {
                name: layer.name(),
                rgb: vec![Vec3::ZERO; pixels],
            });
        }
        if self.written.contains(&Field::Transmittance) {
            frame.transmittance = vec![Vec3::ZERO; pixels];
        }
        let offsets = sample_positions(conditions.samples);
        let middle = DVec2::splat(0.5);
        let central = (0..offsets.len())
            .min_by(|a, b| {
                let d = |i: &usize| offsets[*i].distance(middle);
                d(a).total_cmp(&d(b))
            })
            .unwrap_or(0);
        let corners: Vec<UVec2> = (0..height)
            .step_by(self.tile.y as usize)
            .flat_map(|y| {
                let columns = (0..width).step_by(self.tile.x as usize);
                columns.map(move |x| UVec2::new(x, y))
            })
            .collect();
        let work = (corners.len() * offsets.len()) as f64;
        let mut done = 0.0;
        for corner in corners {
            let extent = self.tile.min(UVec2::new(width, height) - corner);
            for (index, offset) in offsets.iter().enumerate() {
                let found = self.render_tile(corner, extent, *offset)?;
                let share = 1.0 / offsets.len() as f32;
                self.put(&mut frame, corner, extent, &found, share, index == central);
                done += 1.0;
                progress(done / work);
            }
        }
        let times = self.timer.take(&self.device)?;
        let after = self.device.traffic();
        Ok(Rendered {
            frame,
            passes: self.passes(times.as_deref()),
            traffic: Traffic {
                allocated: after.allocated,
                uploaded: after.uploaded - before.uploaded,
                downloaded: after.downloaded - before.downloaded,
            },
            elapsed: start.elapsed(),
        })
    }

    fn passes(&self, times: Option<&[Duration]>) -> Vec<PassTime> {
        let mut passes = Vec::new();
        if let Some(maps) = &self.maps {
            passes.push(PassTime {
                effect: "shadow",
                pass: "map",
                on_cpu: false,
                runs: maps.runs,
                counted: None,
                time: times.map(|t| t[self.stages.len()]),
            });
        }
        for (stage, i) in self.stages.iter().zip(0..) {
            let on_cpu = matches!(stage.work, Work::Host(_)) || self.picture_by_cpu(stage);
            passes.push(PassTime {
                effect: stage.effect,
                pass: stage.pass,
                on_cpu,
                runs: stage.runs,
                counted: (self.counts.is_some() && !on_cpu).then_some(stage.counted),
                time: if on_cpu {
                    Some(stage.on_cpu)
                } else {
                    times.map(|t| t[i])
                },
            });
        }
        passes
    }

    /// A panorama cannot be rasterised: the CPU finds its triangles.
    fn picture_by_cpu(&self, stage: &Stage) -> bool {
        matches!(stage.work, Work::Picture(..))
            && self.plan.conditions.camera.projection == Projection::Panorama
    }

    /// All fields of a tile, one after the other as in `fields`.
    fn render_tile(&mut self, corner: UVec2, extent: UVec2, offset: DVec2) -> Result<Vec<u8>> {
        let conditions = self.plan.conditions;
        let pixel = |i: usize| {
            let i = i as u32;
            corner + UVec2::new(i % extent.x, i / extent.x)
        };
        let count = (extent.x * extent.y) as usize;
        let rays: Vec<Ray> = (0..count)
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| {
                conditions
                    .camera
                    .ray(pixel(i).as_dvec2() + offset, conditions.size)
            })
            .collect();
        let directions: Vec<[f32; 4]> = rays
            .iter()
            .map(|ray| ray.direction.as_vec3().extend(0.0).to_array())
            .collect();
        self.device
            .write(&self.rays, bytemuck::cast_slice(&directions));
        let frame = shared::uniform(&self.frame_of(corner, extent, offset));
        self.device.write(&self.frame, &frame);

        for i in 0..self.stages.len() {
            if self.stages[i].finds_surfaces {
                self.run(i, extent, &rays)?;
            }
        }
        let mut cleared: Vec<Field> = Vec::new();
        if !self.from_host.is_empty() {
            let made = self.host(&rays, (0..count).map(pixel).collect(), extent)?;
            for (field, values) in made {
                if let Some(target) = self.fields.iter().find(|t| t.field == field) {
                    self.device
                        .write(&target.buffer, bytemuck::cast_slice(&values));
                    cleared.push(field);
                }
            }
        }
        let mut encoder = self
            .device
            .device
            .create_command_encoder(&Default::default());
        for target in &self.fields {
            if target.field != Field::Surface && !cleared.contains(&target.field) {
                encoder.clear_buffer(&target.buffer, 0, None);
            }
        }
        self.device.queue.submit([encoder.finish()]);
        let is_each_sun = |stage: &Stage| matches!(stage.work, Work::EachSun(_));
        let first = self.stages.iter().position(is_each_sun);
        for i in 0..self.stages.len() {
            if Some(i) == first {
                self.run_each_sun(extent)?;
            }
            if !self.stages[i].finds_surfaces {
                self.run(i, extent, &rays)?;
            }
        }
        let fields: Vec<Field> = self.fields.iter().map(|t| t.field).collect();
        self.read(&fields)
    }

    /// Reads fields of the tile.
    fn read(&self, fields: &[Field]) -> Result<Vec<u8>> {
        let mut encoder = self
            .device
            .device
            .create_command_encoder(&Default::default());
        let mut at = 0;
        for target in self.fields.iter().filter(|t| fields.contains(&t.field)) {
            encoder.copy_buffer_to_buffer(&target.buffer, 0, &self.staging, at, target.bytes);
            at += target.bytes;
        }
        self.device.queue.submit([encoder.finish()]);
        self.device.read(&self.staging, at)
    }

    fn run(&mut self, index: usize, extent: UVec2, rays: &[Ray]) -> Result<()> {
        if self.picture_by_cpu(&self.stages[index]) {
            return self.draw_by_cpu(index, extent, rays);
        }
        let stage = &mut self.stages[index];
        match &stage.work {
            Work::Pixels(pipeline, group) => {
                stage.runs += 1;
                let groups = [&self.common, group];
                let over = tile_groups(extent);
                dispatch(
                    &self.device,
                    &mut self.timer,
                    index,
                    pipeline,
                    &groups,
                    over,
                )
            }
            Work::Picture(raster, group, silhouettes) => {
                let silhouettes = *silhouettes;
                stage.runs += 1;
                let view = self.numbers.create_view(&Default::default());
                let draw = Draw {
                    raster,
                    groups: &[&self.common, group],
                    corners: &self.corners,
                    triangles: &self.triangles,
                    color: &view,
                    depth: &self.depth,
                    far: 0.0,
                    instance: 0,
                    within: self.tile,
                };
                draw.submit(&self.device, &mut self.timer, index)?;
                if silhouettes {
                    self.trace_silhouettes(index, extent, rays)?;
                }
                Ok(())
            }
            // These run before all others, or by run_each_sun.
            Work::Host(_) | Work::EachSun(..) => Ok(()),
        }
    }

    /// Puts a tile into the picture.
    fn put(
        &self,
        frame: &mut Frame,
        corner: UVec2,
        extent: UVec2,
        found: &[u8],
        share: f32,
        central: bool,
    ) {
        let mut at = 0usize;
        for target in &self.fields {
            let bytes = &found[at..at + target.bytes as usize];
            at += target.bytes as usize;
            let place = |i: u32| {
                let y = corner.y + i / extent.x;
                (y * frame.width + corner.x + i % extent.x) as usize
            };
            let count = extent.x * extent.y;
            if target.field == Field::Surface {
                if central {
                    for i in 0..count {
                        let word = |w| surface_word(bytes, i as usize, w);
                        let met = word(7).to_bits() != 0;
                        frame.depth[place(i)] = if met { word(3).min(NO_HIT) } else { NO_HIT };
                        frame.normal[place(i)] = Vec3::new(word(0), word(1), word(2));
                    }
                }
                continue;
            }
            let name = target.field.name();
            let width = frame.width;
            let place = |i: u32| {
                let y = corner.y + i / extent.x;
                (y * width + corner.x + i % extent.x) as usize
            };
            let values = match target.field {
                Field::Transmittance => &mut frame.transmittance,
                _ => match frame.layers.iter_mut().find(|layer| layer.name == name) {
                    Some(layer) => &mut layer.rgb,
                    None => continue,
                },
            };
            for i in 0..count {
                let word = |w: usize| float(bytes, 4 * i as usize + w);
                values[place(i)] += share * Vec3::new(word(0), word(1), word(2));
            }
        }
    }
}

fn float(bytes: &[u8], word: usize) -> f32 {
    let mut four = [0; 4];
    four.copy_from_slice(&bytes[4 * word..4 * word + 4]);
    f32::from_le_bytes(four)
}

/// A word of a pixel's [`shared::Surface`]: 0 to 2 the normal, 3 the distance, 7 the number.
fn surface_word(bytes: &[u8], pixel: usize, word: usize) -> f32 {
    float(bytes, shared::SURFACE_BYTES as usize / 4 * pixel + word)
}
