//! One submit: a dispatch, or all triangles drawn once.

use super::device::Device;
use super::pipeline::Raster;
use super::timer::Timer;
use crate::error::Result;
use glam::UVec2;
use std::time::{Duration, Instant};
use wgpu::*;

pub(super) fn texture(
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

/// Workgroups of 8 by 8 that cover a tile.
pub(super) fn tile_groups(extent: UVec2) -> [u32; 2] {
    [extent.x.div_ceil(8), extent.y.div_ceil(8)]
}

pub(super) fn dispatch(
    device: &Device,
    timer: &mut Timer,
    number: usize,
    pipeline: &ComputePipeline,
    groups: &[&BindGroup],
    over: [u32; 2],
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
        pass.dispatch_workgroups(over[0], over[1], 1);
    }
    device.queue.submit([encoder.finish()]);
    timer.submitted(device)?;
    device.check()
}

/// Lets the driver compile what it leaves to the first dispatch, by one of no workgroups, and waits for it.
pub(super) fn warm(
    device: &Device,
    pipeline: &ComputePipeline,
    groups: &[&BindGroup],
) -> Result<Duration> {
    device.wait()?;
    let start = Instant::now();
    let mut encoder = device.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(pipeline);
        for (group, i) in groups.iter().zip(0..) {
            pass.set_bind_group(i, *group, &[]);
        }
        pass.dispatch_workgroups(0, 0, 0);
    }
    device.queue.submit([encoder.finish()]);
    device.wait()?;
    Ok(start.elapsed())
}

/// All triangles, drawn once.
pub(super) struct Draw<'r> {
    pub raster: &'r Raster,
    pub groups: &'r [&'r BindGroup],
    pub corners: &'r Buffer,
    /// How many triangles have no holes, and how many there are.
    pub triangles: [u32; 2],
    pub color: &'r TextureView,
    pub depth: &'r TextureView,
    /// The depth of what is farthest.
    pub far: f32,
    pub instance: u32,
    /// Nothing is drawn outside these texels, counted from the corner.
    pub within: UVec2,
}

impl Draw<'_> {
    pub(super) fn submit(&self, device: &Device, timer: &mut Timer, number: usize) -> Result<()> {
        let timestamp_writes = timer.render(device, number)?;
        let mut encoder = device.device.create_command_encoder(&Default::default());
        {
            let color = RenderPassColorAttachment {
                view: self.color,
                depth_slice: None,
                resolve_target: None,
                ops: Operations {
                    load: LoadOp::Clear(Color::TRANSPARENT),
                    store: StoreOp::Store,
                },
            };
            let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
                label: None,
                color_attachments: &[Some(color)],
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
            pass.set_scissor_rect(0, 0, self.within.x, self.within.y);
            pass.set_vertex_buffer(0, self.corners.slice(..));
            let [solid, all] = self.triangles.map(|count| 3 * count);
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
        timer.submitted(device)?;
        device.check()
    }
}

/// Bytes from row to row of numbers that are read back.
pub(super) fn numbers_pitch(width: u32) -> u32 {
    (4 * width).next_multiple_of(COPY_BYTES_PER_ROW_ALIGNMENT)
}
