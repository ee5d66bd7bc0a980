//! A plan made ready on a device, and its pictures.

use super::device::{Device, Traffic};
use super::light;
use super::pipeline::{Pipelines, Raster};
use super::scene::{SceneBuffers, Triangles, media};
use super::shared;
use super::timer::Timer;
use crate::colour::Space;
use crate::conditions::SunPoint;
use crate::effect::visibility::{ground_surface, known_surface};
use crate::effect::{Batch, Field, Fields, Kind, Pass, Resource, Settings};
use crate::error::{Error, Result};
use crate::frame::{Frame, Layer, NO_HIT};
use crate::plan::{Plan, sample_positions};
use crate::scene::{Projection, Ray};
use glam::{DVec2, DVec3, UVec2, Vec3, Vec4};
use rayon::prelude::*;
use std::time::{Duration, Instant};
use wgpu::*;

/// Called with the share of the work that is done, 0 to 1.
pub type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// Side of a tile [pixels]: a quarter of a million rays are a few milliseconds on hardware.
const TILE: u32 = 512;

/// Shadow maps of several of the sun's points are kept up to this size [bytes].
const KEPT_MAPS: u64 = 512 << 20;

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
    /// Its time: the device's own clock, or the CPU's wall clock for what that did; `None` when the device has no clock.
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
    EachSun(ComputePipeline, BindGroup, Vec<SunPoint>),
    Picture(Raster, BindGroup),
    Host(Batch<'a>),
}

struct Stage<'a> {
    effect: &'static str,
    pass: &'static str,
    work: Work<'a>,
    /// Whether it finds the surfaces, which all others read.
    finds_surfaces: bool,
    runs: u32,
    on_cpu: Duration,
}

struct Slot {
    toward: DVec3,
    filled: bool,
    light: Buffer,
    views: Vec<TextureView>,
    draw: BindGroup,
    ask: BindGroup,
}

struct SunMaps {
    raster: Raster,
    group: BindGroup,
    partitions: usize,
    resolution: u32,
    casters: Vec<DVec3>,
    slots: Vec<Slot>,
    most_slots: usize,
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
    fields: Vec<Target>,
    stages: Vec<Stage<'a>>,
    maps: Option<SunMaps>,
    staging: Buffer,
    timer: Timer,
}

impl<'a> Gpu<'a> {
    /// Prepares a plan on a device.
    ///
    /// # Errors
    /// [`Error::Failed`] when the scene is larger than the adapter takes, or the driver fails; [`Error::Domain`] for a shadow
    /// map larger than the adapter's textures.
    pub fn new(plan: &'a Plan<'a>, device: Device) -> Result<Self> {
        let conditions = plan.conditions;
        let mut pipelines = Pipelines::new(&device);
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
        let common = device.device.create_bind_group(&BindGroupDescriptor {
            label: Some("frame, rays, media"),
            layout: &pipelines.common,
            entries: &[&frame, &rays, &air]
                .map(|b| b.as_entire_binding())
                .into_iter()
                .zip(0..)
                .map(|(resource, binding)| BindGroupEntry { binding, resource })
                .collect::<Vec<_>>(),
        });
        let usage = TextureUsages::RENDER_ATTACHMENT
            | TextureUsages::TEXTURE_BINDING
            | TextureUsages::COPY_DST;
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
                buffer: device.buffer(
                    field.name(),
                    bytes,
                    BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
                )?,
                bytes,
            });
        }
        let all: u64 = fields.iter().map(|f| f.bytes).sum();
        let staging = device.buffer(
            "what is read back",
            all,
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
        };
        maker.all()?;
        let Maker {
            stages,
            maps,
            from_host,
            ..
        } = maker;
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
            fields,
            stages,
            maps,
            staging,
            timer,
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
            (stage.runs, stage.on_cpu) = (0, Duration::ZERO);
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
        for i in 0..self.stages.len() {
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

    /// What the effects without passes add to fields.
    fn host(
        &mut self,
        rays: &[Ray],
        pixels: Vec<UVec2>,
        extent: UVec2,
    ) -> Result<Vec<(Field, Vec<[f32; 4]>)>> {
        let conditions = self.plan.conditions;
        let bytes = self.read(&[Field::Surface])?;
        let numbers: Vec<u32> = (0..(extent.x * extent.y) as usize)
            .map(|i| surface_word(&bytes, i, 7).to_bits())
            .collect();
        let working = Space::Rec709.to_working();
        let triangles = &self.triangles.numbers;
        let mut chunks: Vec<Fields> = (0..rays.len())
            .step_by(CHUNK)
            .map(|from| {
                let to = (from + CHUNK).min(rays.len());
                Fields::new(
                    rays[from..to].to_vec(),
                    pixels[from..to].to_vec(),
                    &self.written,
                )
            })
            .collect();
        chunks.par_iter_mut().enumerate().for_each(|(c, fields)| {
            for (i, surface) in fields.surfaces.iter_mut().enumerate() {
                let ray = &fields.rays[i];
                *surface = match numbers[c * CHUNK + i] {
                    0 | 1 => ground_surface(conditions, ray),
                    n => known_surface(conditions, ray, triangles[n as usize - 2], working),
                };
            }
        });
        for stage in &mut self.stages {
            if let Work::Host(batch) = &stage.work {
                let start = Instant::now();
                chunks.par_iter_mut().for_each(batch);
                stage.on_cpu += start.elapsed();
                stage.runs += 1;
            }
        }
        let values = |field: Field| -> Vec<[f32; 4]> {
            chunks
                .iter()
                .flat_map(|fields| fields.get(field).into_iter().flatten())
                .map(|v| v.as_vec3().extend(0.0).to_array())
                .collect()
        };
        Ok(self.from_host.iter().map(|f| (*f, values(*f))).collect())
    }

    fn run(&mut self, index: usize, extent: UVec2, rays: &[Ray]) -> Result<()> {
        if self.picture_by_cpu(&self.stages[index]) {
            return self.draw_by_cpu(index, extent, rays);
        }
        let suns = match &self.stages[index].work {
            Work::EachSun(_, _, suns) => suns.clone(),
            _ => Vec::new(),
        };
        if matches!(self.stages[index].work, Work::EachSun(..)) {
            for sun in &suns {
                let slot = self.maps_for(sun)?;
                let stage = &mut self.stages[index];
                stage.runs += 1;
                let (Work::EachSun(pipeline, group, _), Some(maps)) = (&stage.work, &self.maps)
                else {
                    continue;
                };
                let groups = [&self.common, group, &maps.slots[slot].ask];
                dispatch(
                    &self.device,
                    &mut self.timer,
                    index,
                    pipeline,
                    &groups,
                    extent,
                )?;
            }
            return Ok(());
        }
        let stage = &mut self.stages[index];
        match &stage.work {
            Work::Pixels(pipeline, group) => {
                stage.runs += 1;
                let groups = [&self.common, group];
                dispatch(
                    &self.device,
                    &mut self.timer,
                    index,
                    pipeline,
                    &groups,
                    extent,
                )
            }
            Work::Picture(raster, group) => {
                stage.runs += 1;
                let view = self.numbers.create_view(&Default::default());
                let draw = Draw {
                    raster,
                    groups: &[&self.common, group],
                    corners: &self.corners,
                    triangles: &self.triangles,
                    color: Some(&view),
                    depth: &self.depth,
                    far: 0.0,
                    instance: 0,
                };
                draw.submit(&self.device, &mut self.timer, index)
            }
            // These ran before all others.
            Work::Host(_) | Work::EachSun(..) => Ok(()),
        }
    }

    fn draw_by_cpu(&mut self, index: usize, extent: UVec2, rays: &[Ray]) -> Result<()> {
        let start = Instant::now();
        let geometry = &self.plan.conditions.geometry;
        let mut number_of = vec![0u32; self.plan.conditions.scene.mesh.triangles.len()];
        for (i, number) in self.triangles.numbers.iter().enumerate() {
            number_of[*number as usize] = i as u32 + 1;
        }
        let numbers: Vec<u32> = rays
            .par_iter()
            .with_min_len(CHUNK)
            .map(|ray| {
                let hit = geometry.closest(ray, 0.0, f64::INFINITY);
                hit.map_or(0, |hit| number_of[hit.triangle as usize])
            })
            .collect();
        let bytes: &[u8] = bytemuck::cast_slice(&numbers);
        self.device.count(|t| t.uploaded += bytes.len() as u64);
        self.device.queue.write_texture(
            self.numbers.as_image_copy(),
            bytes,
            TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * extent.x),
                rows_per_image: None,
            },
            Extent3d {
                width: extent.x,
                height: extent.y,
                depth_or_array_layers: 1,
            },
        );
        let stage = &mut self.stages[index];
        stage.runs += 1;
        stage.on_cpu += start.elapsed();
        Ok(())
    }

    /// The slot that holds the maps of a point of the sun, drawn unless they are there.
    fn maps_for(&mut self, sun: &SunPoint) -> Result<usize> {
        let maps = self
            .maps
            .as_mut()
            .expect("an effect that asks for the sun's maps runs only where the sun shines");
        let kept = maps.slots.iter().position(|slot| slot.toward == sun.toward);
        let index = match kept {
            Some(index) => index,
            None if maps.slots.len() < maps.most_slots => {
                let slot = maps.slot(&self.device, &self.pipelines)?;
                maps.slots.push(slot);
                maps.slots.len() - 1
            }
            // The last one changes hands: when points are gone through in turns, the others stay.
            None => maps.slots.len() - 1,
        };
        let slot = &mut maps.slots[index];
        if slot.filled && slot.toward == sun.toward {
            // The same direction may come with another share of the light.
            let light = light::fit(
                self.plan.conditions,
                &maps.casters,
                sun,
                maps.partitions,
                maps.resolution,
            );
            self.device.write(&slot.light, &shared::uniform(&light));
            return Ok(index);
        }
        let light = light::fit(
            self.plan.conditions,
            &maps.casters,
            sun,
            maps.partitions,
            maps.resolution,
        );
        self.device.write(&slot.light, &shared::uniform(&light));
        (slot.toward, slot.filled) = (sun.toward, true);
        for k in 0..light.partitions {
            maps.runs += 1;
            let draw = Draw {
                raster: &maps.raster,
                groups: &[&self.common, &maps.group, &maps.slots[index].draw],
                corners: &self.corners,
                triangles: &self.triangles,
                color: None,
                depth: &maps.slots[index].views[k as usize],
                far: 1.0,
                instance: k,
            };
            draw.submit(&self.device, &mut self.timer, self.stages.len())?;
        }
        Ok(index)
    }

    /// What shaders know of a tile.
    fn frame_of(&self, corner: UVec2, extent: UVec2, offset: DVec2) -> shared::Frame {
        let conditions = self.plan.conditions;
        let camera = &conditions.camera;
        let [right, up, forward] = camera.axes();
        let size = UVec2::from(conditions.size).as_dvec2();
        let tile = self.tile.as_dvec2();
        // A position P of the picture is at P - shifted in the tile, whose pixels have their centres at halves.
        let shifted = corner.as_dvec2() + offset - 0.5;
        let middle = 0.5 * size + DVec2::new(-camera.shift.x, camera.shift.y) * size - shifted;
        let half = match camera.projection {
            Projection::Perspective { fov_y } => (0.5 * fov_y).tan(),
            Projection::Orthographic { height } => 0.5 * height,
            Projection::Panorama => 1.0,
        };
        let scale = size.y / half / tile;
        let place = 2.0 * middle / tile;
        let origin = |at: DVec2| {
            let at = corner.as_dvec2() + offset + at;
            camera.ray(at, conditions.size).origin - camera.eye
        };
        let extent_m = conditions.geometry.extent();
        let (low, high) = conditions.geometry.bounds();
        let deepest = (0..8)
            .map(|i| {
                let pick = |bit: usize, a: f64, b: f64| if i & bit == 0 { a } else { b };
                let c = DVec3::new(
                    pick(1, low.x, high.x),
                    pick(2, low.y, high.y),
                    pick(4, low.z, high.z),
                );
                (c - camera.eye).dot(forward)
            })
            .fold(extent_m * 1e-6, f64::max);
        let ground = conditions.ground.map_or(Vec4::ZERO, |ground| {
            let height = camera.eye.y - ground.height;
            ground.albedo.as_vec3().extend(height as f32)
        });
        shared::Frame {
            tile: corner,
            extent,
            right: right.as_vec3(),
            projection: match camera.projection {
                Projection::Perspective { .. } => 0,
                Projection::Orthographic { .. } => 1,
                Projection::Panorama => 2,
            },
            up: up.as_vec3(),
            media: conditions.air.media.len() as u32,
            forward: forward.as_vec3(),
            grounded: u32::from(conditions.ground.is_some()),
            project: Vec4::new(
                scale.x as f32,
                (place.x - 1.0) as f32,
                scale.y as f32,
                (1.0 - place.y) as f32,
            ),
            ground,
            depth: match camera.projection {
                Projection::Orthographic { .. } => (0.999 / deepest) as f32,
                _ => (1e-6 * extent_m).max(f64::from(f32::MIN_POSITIVE)) as f32,
            },
            origin: origin(DVec2::ZERO).as_vec3(),
            origin_right: (origin(DVec2::X) - origin(DVec2::ZERO)).as_vec3(),
            origin_down: (origin(DVec2::Y) - origin(DVec2::ZERO)).as_vec3(),
            working_from_rec709: Space::Rec709.to_working().as_mat3(),
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

fn texture(
    device: &Device,
    label: &str,
    size: UVec2,
    layers: u32,
    format: TextureFormat,
    usage: TextureUsages,
) -> Texture {
    device.count(|t| t.allocated += 4 * u64::from(size.x) * u64::from(size.y) * u64::from(layers));
    device.device.create_texture(&TextureDescriptor {
        label: Some(label),
        size: Extent3d {
            width: size.x,
            height: size.y,
            depth_or_array_layers: layers,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

fn dispatch(
    device: &Device,
    timer: &mut Timer,
    number: usize,
    pipeline: &ComputePipeline,
    groups: &[&BindGroup],
    extent: UVec2,
) -> Result<()> {
    let timestamp_writes = timer.compute(device, number)?;
    let mut encoder = device.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: None,
            timestamp_writes,
        });
        pass.set_pipeline(pipeline);
        for (group, i) in groups.iter().zip(0..) {
            pass.set_bind_group(i, *group, &[]);
        }
        pass.dispatch_workgroups(extent.x.div_ceil(8), extent.y.div_ceil(8), 1);
    }
    device.queue.submit([encoder.finish()]);
    device.check()
}

/// All triangles, drawn once.
struct Draw<'r> {
    raster: &'r Raster,
    groups: &'r [&'r BindGroup],
    corners: &'r Buffer,
    triangles: &'r Triangles,
    color: Option<&'r TextureView>,
    depth: &'r TextureView,
    /// The depth of what is farthest.
    far: f32,
    instance: u32,
}

impl Draw<'_> {
    fn submit(&self, device: &Device, timer: &mut Timer, number: usize) -> Result<()> {
        let timestamp_writes = timer.render(device, number)?;
        let mut encoder = device.device.create_command_encoder(&Default::default());
        {
            let color = self.color.map(|view| RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: Operations {
                    load: LoadOp::Clear(Color::TRANSPARENT),
                    store: StoreOp::Store,
                },
            });
            let attachments = [color];
            let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
                label: None,
                color_attachments: if self.color.is_some() {
                    &attachments
                } else {
                    &[]
                },
                depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
                    view: self.depth,
                    depth_ops: Some(Operations {
                        load: LoadOp::Clear(self.far),
                        store: StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            for (group, i) in self.groups.iter().zip(0..) {
                pass.set_bind_group(i, *group, &[]);
            }
            pass.set_vertex_buffer(0, self.corners.slice(..));
            let solid = 3 * self.triangles.solid;
            let all = 3 * self.triangles.numbers.len() as u32;
            let instances = self.instance..self.instance + 1;
            if solid > 0 {
                pass.set_pipeline(&self.raster.solid);
                pass.draw(0..solid, instances.clone());
            }
            if let Some(cut_out) = &self.raster.cut_out {
                pass.set_pipeline(cut_out);
                pass.draw(solid..all, instances);
            }
        }
        device.queue.submit([encoder.finish()]);
        device.check()
    }
}

impl SunMaps {
    fn slot(&self, device: &Device, pipelines: &Pipelines) -> Result<Slot> {
        let light = device.buffer(
            "a light",
            shared::uniform(&shared::Light::default()).len() as u64,
            BufferUsages::UNIFORM | BufferUsages::COPY_DST,
        )?;
        let maps = texture(
            device,
            "shadow maps",
            UVec2::splat(self.resolution),
            self.partitions as u32,
            TextureFormat::Depth32Float,
            TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
        );
        let views = (0..self.partitions as u32)
            .map(|layer| {
                maps.create_view(&TextureViewDescriptor {
                    dimension: Some(TextureViewDimension::D2),
                    base_array_layer: layer,
                    array_layer_count: Some(1),
                    ..Default::default()
                })
            })
            .collect();
        let all = maps.create_view(&TextureViewDescriptor {
            dimension: Some(TextureViewDimension::D2Array),
            ..Default::default()
        });
        let light_entry = BindGroupEntry {
            binding: 0,
            resource: light.as_entire_binding(),
        };
        let group = |layout, entries: &[BindGroupEntry]| {
            device.device.create_bind_group(&BindGroupDescriptor {
                label: Some("a light"),
                layout,
                entries,
            })
        };
        let ask = [
            light_entry.clone(),
            BindGroupEntry {
                binding: 1,
                resource: BindingResource::TextureView(&all),
            },
        ];
        Ok(Slot {
            toward: DVec3::ZERO,
            filled: false,
            draw: group(&pipelines.light, &[light_entry]),
            ask: group(&pipelines.lit, &ask),
            light,
            views,
        })
    }
}

/// Makes what the passes of a plan name.
struct Maker<'m, 'a> {
    plan: &'a Plan<'a>,
    device: &'m Device,
    pipelines: &'m mut Pipelines,
    scene: &'m mut SceneBuffers,
    triangles: &'m Triangles,
    fields: &'m [Target],
    numbers: &'m Texture,
    stages: Vec<Stage<'a>>,
    maps: Option<SunMaps>,
    from_host: Vec<Field>,
}

impl<'a> Maker<'_, 'a> {
    fn all(&mut self) -> Result<()> {
        let plan = self.plan;
        for step in plan.running() {
            let settings = Settings {
                values: &step.settings,
            };
            let effect = step.effect;
            if effect.passes.is_empty() {
                self.stages.push(Stage {
                    effect: effect.name,
                    pass: "reference",
                    work: Work::Host((effect.reference)(plan.conditions, &settings)),
                    finds_surfaces: false,
                    runs: 0,
                    on_cpu: Duration::ZERO,
                });
                self.from_host.extend(effect.writes);
                continue;
            }
            for pass in effect.passes {
                self.pass(
                    effect.name,
                    pass,
                    &settings,
                    effect.writes.contains(&Field::Surface),
                )?;
            }
        }
        self.from_host.sort_unstable_by_key(|f| f.name());
        self.from_host.dedup();
        Ok(())
    }

    fn field(&self, field: Field) -> Option<&Buffer> {
        let target = self.fields.iter().find(|t| t.field == field);
        target.map(|t| &t.buffer)
    }

    fn pass(
        &mut self,
        effect: &'static str,
        pass: &'static Pass,
        settings: &Settings,
        finds_surfaces: bool,
    ) -> Result<()> {
        let each: Vec<Option<Field>> = match pass.kind {
            Kind::EachField(fields) => fields
                .iter()
                .filter(|f| self.field(**f).is_some())
                .map(|f| Some(*f))
                .collect(),
            _ => vec![None],
        };
        let missing = pass.uses.iter().any(|resource| match resource {
            Resource::Read(field) | Resource::Update(field) => self.field(*field).is_none(),
            _ => false,
        });
        if missing || each.is_empty() {
            return Ok(());
        }
        let layout = self.pipelines.own(self.device, pass);
        if matches!(pass.kind, Kind::Picture | Kind::SunMaps) {
            let group = self.group(effect, pass, settings, &layout, None)?;
            let holes = (self.triangles.solid as usize) < self.triangles.numbers.len();
            let raster = self
                .pipelines
                .raster(self.device, effect, pass, &layout, holes);
            if pass.kind == Kind::SunMaps {
                self.maps = Some(self.sun_maps(settings, raster, group)?);
            } else {
                self.push(effect, pass, Work::Picture(raster, group), finds_surfaces);
            }
            return Ok(());
        }
        let pipeline = self.pipelines.compute(self.device, effect, pass, &layout);
        for field in each {
            let group = self.group(effect, pass, settings, &layout, field)?;
            let work = match pass.kind {
                Kind::EachSun(knob) => {
                    let count = settings.get(knob) as usize;
                    let suns = self.plan.conditions.sun.points(count);
                    Work::EachSun(pipeline.clone(), group, suns)
                }
                _ => Work::Pixels(pipeline.clone(), group),
            };
            self.push(effect, pass, work, finds_surfaces);
        }
        Ok(())
    }

    fn push(&mut self, effect: &'static str, pass: &Pass, work: Work<'a>, finds_surfaces: bool) {
        self.stages.push(Stage {
            effect,
            pass: pass.entry,
            work,
            finds_surfaces,
            runs: 0,
            on_cpu: Duration::ZERO,
        });
    }

    fn sun_maps(&self, settings: &Settings, raster: Raster, group: BindGroup) -> Result<SunMaps> {
        let resolution = settings.get("resolution") as u32;
        let partitions = settings.get("partitions") as usize;
        let most = self.device.limits().max_texture_dimension_2d;
        if resolution > most {
            return Err(Error::domain(
                "shadow.resolution",
                resolution,
                format!("16 to {most} on {}", self.device.adapter.name),
                "set a lower one with --set shadow.resolution=N",
            ));
        }
        let bytes = 4 * u64::from(resolution).pow(2) * partitions as u64;
        Ok(SunMaps {
            raster,
            group,
            partitions,
            resolution,
            casters: self.triangles.corners(self.plan.conditions),
            slots: Vec::new(),
            most_slots: (KEPT_MAPS / bytes).max(1) as usize,
            runs: 0,
        })
    }

    fn group(
        &mut self,
        effect: &str,
        pass: &Pass,
        settings: &Settings,
        layout: &BindGroupLayout,
        each: Option<Field>,
    ) -> Result<BindGroup> {
        let conditions = self.plan.conditions;
        let view = self.numbers.create_view(&Default::default());
        let mut buffers = Vec::with_capacity(pass.uses.len());
        for resource in pass.uses {
            buffers.push(match resource {
                Resource::Read(field) | Resource::Update(field) => self.field(*field).cloned(),
                Resource::Each => each.and_then(|field| self.field(field).cloned()),
                Resource::Numbers => None,
                Resource::Table(make) => Some(self.device.filled(
                    &format!("the table of {effect}"),
                    bytemuck::cast_slice(&make(conditions, settings)),
                    BufferUsages::STORAGE,
                )?),
                _ => self
                    .scene
                    .get(self.device, conditions, self.triangles, resource)?,
            });
        }
        let entries: Vec<BindGroupEntry> = buffers
            .iter()
            .zip(0..)
            .map(|(buffer, binding)| BindGroupEntry {
                binding,
                resource: match buffer {
                    Some(buffer) => buffer.as_entire_binding(),
                    None => BindingResource::TextureView(&view),
                },
            })
            .collect();
        Ok(self.device.device.create_bind_group(&BindGroupDescriptor {
            label: Some(pass.entry),
            layout,
            entries: &entries,
        }))
    }
}
