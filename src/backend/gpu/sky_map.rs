//! Maps of the whole sky, painted on the device.
//!
//! The sky comes from the same table as behind a scene. The sun's disc is not in it: its few texels are
//! [`Map::disc`]'s, in f64.

use super::device::Device;
use super::shared;
use super::source;
use super::timer::Timer;
use crate::backend::rendering::Traffic;
use crate::error::Result;
use crate::memory;
use crate::sky::Sky;
use crate::sky::map::{Map, Projection};
use encase::ShaderType;
use glam::{DVec3, UVec2, Vec3};
use std::f64::consts::PI;
use std::time::Duration;
use wgpu::*;

/// Texels that are painted at once: their buffer is small enough for every adapter.
const BAND: u32 = 1 << 21;

/// Projections of [`SkyMap`], printed for the shader.
const EQUIRECTANGULAR: u32 = 0;
const FISHEYE: u32 = 1;
const CUBE: u32 = 2;

/// `SkyMap` of shaders/sky_map.wgsl.
#[derive(Debug, Clone, Copy, Default, ShaderType)]
struct SkyMap {
    size: UVec2,
    projection: u32,
    first: u32,
    ground: Vec3,
    rows: u32,
}

/// A painted map.
pub struct Painted {
    /// RGB in the working space [cd/m2], row by row from the top left; without the sun's disc.
    pub texels: Vec<Vec3>,
    /// How long the device took, by its own clock, or by the wall's where it is software; `None` if it has none.
    pub time: Option<Duration>,
    /// Bytes allocated and moved.
    pub traffic: Traffic,
}

/// Paints a map, as [`super::Gpu::paint`] says.
pub(super) fn paint(
    device: &Device,
    pipeline: &ComputePipeline,
    map: &Map,
    sky: &Sky,
    ground: DVec3,
) -> Result<Painted> {
    let mut timer = Timer::new(device, 1)?;
    let size = UVec2::new(map.width, map.height);
    let rows = (BAND / map.width).clamp(1, map.height);
    let bytes = 16 * u64::from(rows) * u64::from(map.width);
    let uniform = |first: u32| {
        shared::uniform(&SkyMap {
            size,
            projection: match map.projection {
                Projection::Equirectangular => EQUIRECTANGULAR,
                Projection::Fisheye => FISHEYE,
                Projection::Cube => CUBE,
            },
            first,
            ground: ground.as_vec3(),
            rows: rows.min(map.height - first),
        })
    };
    let (storage, copied) = (BufferUsages::STORAGE, BufferUsages::COPY_DST);
    let band = device.filled("the map's place", &uniform(0), BufferUsages::UNIFORM)?;
    let table = sky.table();
    let table = device.filled("the sky's table", bytemuck::cast_slice(&table), storage)?;
    let turns = device.filled(
        "the map's turns",
        bytemuck::cast_slice(&turns(map)),
        storage,
    )?;
    let texels = device.buffer("the map", bytes, storage | BufferUsages::COPY_SRC)?;
    let read = device.buffer("the map", bytes, copied | BufferUsages::MAP_READ)?;

    let group = |index: u32, buffers: &[(u32, &Buffer)]| {
        let entries: Vec<BindGroupEntry> = buffers
            .iter()
            .map(|(binding, buffer)| BindGroupEntry {
                binding: *binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        device.device.create_bind_group(&BindGroupDescriptor {
            label: Some("sky map"),
            layout: &pipeline.get_bind_group_layout(index),
            entries: &entries,
        })
    };
    let groups = [
        group(0, &[(0, &band), (1, &turns), (2, &texels)]),
        group(1, &[(2, &table)]),
    ];
    device.check()?;

    let mut whole = Vec::new();
    let texels_in_all = map.width as usize * map.height as usize;
    let in_all = (texels_in_all * size_of::<Vec3>()) as u64;
    memory::check("the map", in_all)?;
    whole
        .try_reserve_exact(texels_in_all)
        .map_err(|_| memory::not_enough("the map", in_all))?;
    for first in (0..map.height).step_by(rows as usize) {
        device.write(&band, &uniform(first));
        let here = rows.min(map.height - first);
        let bytes = 16 * u64::from(here) * u64::from(map.width);
        let timestamp_writes = timer.compute(device, 0)?;
        let mut encoder = device.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
                label: Some("sky map"),
                timestamp_writes,
            });
            pass.set_pipeline(pipeline);
            for (group, i) in groups.iter().zip(0..) {
                pass.set_bind_group(i, group, &[]);
            }
            pass.dispatch_workgroups(map.width.div_ceil(8), here.div_ceil(8), 1);
        }
        device.queue.submit([encoder.finish()]);
        timer.submitted(device)?;
        let mut encoder = device.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&texels, 0, &read, 0, bytes);
        device.queue.submit([encoder.finish()]);
        let painted = device.read(&read, bytes)?;
        let four: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&painted);
        whole.extend(four.iter().map(|[r, g, b, _]| Vec3::new(*r, *g, *b)));
    }
    Ok(Painted {
        texels: whole,
        time: timer.take(device)?.map(|times| times[0]),
        traffic: device.traffic(),
    })
}

/// Sine and cosine of the elevations of an equirectangular map's rows and of its columns' azimuths; one pair for others.
fn turns(map: &Map) -> Vec<[f32; 2]> {
    if map.projection != Projection::Equirectangular {
        return vec![[0.0; 2]];
    }
    let pair = |angle: f64| [angle.sin() as f32, angle.cos() as f32];
    let middle = |i: u32, count: u32| (f64::from(i) + 0.5) / f64::from(count) - 0.5;
    let elevations = (0..map.height).map(|y| pair(-middle(y, map.height) * PI));
    let azimuths = (0..map.width).map(|x| pair(middle(x, map.width) * 2.0 * PI));
    elevations.chain(azimuths).collect()
}

/// What paints.
pub(super) fn pipeline(device: &Device) -> ComputePipeline {
    let source = format!(
        "const EQUIRECTANGULAR = {EQUIRECTANGULAR}u;\nconst FISHEYE = {FISHEYE}u;\nconst CUBE = {CUBE}u;\n\
         {}@group(1) @binding(2) var<storage, read> sky_numbers: array<f32>;\n{}",
        source::sky_table(),
        include_str!("../../../shaders/sky_map.wgsl"),
    );
    let module = device.device.create_shader_module(ShaderModuleDescriptor {
        label: Some("sky map"),
        source: ShaderSource::Wgsl(source.into()),
    });
    device
        .device
        .create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some("sky map"),
            layout: None,
            module: &module,
            entry_point: Some("paint"),
            compilation_options: Default::default(),
            cache: None,
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::naga::{TypeInner, front::wgsl};

    #[test]
    fn the_struct_lies_alike_on_both_sides() {
        let module = wgsl::parse_str(
            include_str!("../../../shaders/sky_map.wgsl")
                .split("fn sine")
                .next()
                .unwrap(),
        )
        .expect("the shader's head is WGSL");
        let found = module
            .types
            .iter()
            .find(|(_, t)| t.name.as_deref() == Some("SkyMap"));
        let TypeInner::Struct { members, span } = &found.expect("the shader has it").1.inner else {
            panic!("SkyMap is a struct");
        };
        for (i, member) in members.iter().enumerate() {
            assert_eq!(SkyMap::METADATA.offset(i), u64::from(member.offset));
        }
        assert_eq!(
            <SkyMap as encase::ShaderSize>::SHADER_SIZE.get(),
            u64::from(*span)
        );
    }
}
