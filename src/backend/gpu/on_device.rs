//! Pictures that stay on the device, for whoever shows them there.

use super::device::Device;
use super::draw::tile_groups;
use crate::error::Result;
use glam::UVec2;
use wgpu::*;

/// A picture on the device.
#[derive(Debug, Clone)]
pub struct OnDevice {
    /// The sum of all layers, one `vec4f` a pixel, row by row from the top: red, green, blue in the working space [cd/m2], and 1. Its
    /// usage is `STORAGE | COPY_SRC`.
    pub buffer: Buffer,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

/// What adds a share of a layer to a picture, and where that is told its place.
#[derive(Clone)]
pub struct Adder {
    pipeline: ComputePipeline,
    place: Buffer,
}

/// Whether a picture is to stay on the device, and where it grows.
#[derive(Default)]
pub struct Growing {
    wanted: bool,
    picture: Option<OnDevice>,
    /// Made when it is first needed.
    pub adder: Option<Adder>,
}

/// Adds a share of one layer of a tile to the picture.
const ADD: &str = "
struct Place {
    corner: vec2u,
    extent: vec2u,
    width: u32,
    share: f32,
}
@group(0) @binding(0) var<uniform> place: Place;
@group(0) @binding(1) var<storage, read> layer: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> picture: array<vec4f>;
@compute @workgroup_size(8, 8)
fn add(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= place.extent) {
        return;
    }
    let at = (place.corner.y + id.y) * place.width + place.corner.x + id.x;
    let value = place.share * layer[id.y * place.extent.x + id.x].xyz;
    picture[at] = vec4f(picture[at].xyz + value, 1.0);
}
";

impl Growing {
    /// A picture that stays, with what added up the one before.
    pub fn wanted(adder: Option<Adder>) -> Self {
        Growing {
            wanted: true,
            picture: None,
            adder,
        }
    }

    pub fn is_wanted(&self) -> bool {
        self.wanted
    }

    pub fn into_picture(self) -> Option<OnDevice> {
        self.picture
    }

    fn adder(&mut self, device: &Device) -> Result<Adder> {
        if let Some(made) = &self.adder {
            return Ok(made.clone());
        }
        let module = device.device.create_shader_module(ShaderModuleDescriptor {
            label: Some("picture"),
            source: ShaderSource::Wgsl(ADD.into()),
        });
        let pipeline = device
            .device
            .create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some("picture"),
                layout: None,
                module: &module,
                entry_point: Some("add"),
                compilation_options: Default::default(),
                cache: None,
            });
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let place = device.buffer("the tile's place", 32, usage)?;
        Ok(self.adder.insert(Adder { pipeline, place }).clone())
    }

    /// Adds a share of the layers of a tile, which lies at a pixel and has an extent, to a picture of that size.
    pub fn add(
        &mut self,
        device: &Device,
        [width, height]: [u32; 2],
        layers: &[&Buffer],
        (corner, extent): (UVec2, UVec2),
        share: f32,
    ) -> Result<()> {
        if self.picture.is_none() {
            let bytes = 16 * u64::from(width) * u64::from(height);
            let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
            let buffer = device.buffer("the picture", bytes, usage)?;
            self.picture = Some(OnDevice {
                buffer,
                width,
                height,
            });
        }
        let Adder { pipeline, place } = self.adder(device)?;
        let words = [
            corner.x,
            corner.y,
            extent.x,
            extent.y,
            width,
            share.to_bits(),
        ];
        device.write(&place, bytemuck::cast_slice(&words));
        let Some(picture) = &self.picture else {
            return Ok(());
        };
        let mut encoder = device.device.create_command_encoder(&Default::default());
        for layer in layers {
            let buffers = [&place, *layer, &picture.buffer];
            let entries: Vec<BindGroupEntry> = buffers
                .into_iter()
                .zip(0..)
                .map(|(buffer, binding)| BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            let group = device.device.create_bind_group(&BindGroupDescriptor {
                label: Some("picture"),
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries,
            });
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            let [x, y] = tile_groups(extent);
            pass.dispatch_workgroups(x, y, 1);
        }
        device.queue.submit([encoder.finish()]);
        device.check()
    }
}
