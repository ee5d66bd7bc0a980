//! Hemicubes, drawn: which triangle stands in each of their texels.
//!
//! As many hemicubes as fit stand side by side in one texture, each as the block that [`crate::radiosity::Hemicube`] counts. All
//! triangles are drawn once for each face of each. Corners and places are of two parts in f32, so that a room on a plain of 30 km has
//! the digits that it needs.

use super::device::Device;
use super::draw::{numbers_pitch, texture};
use super::shared;
use crate::error::Result;
use crate::radiosity::{Drawer, Eye, FACES, Target};
use encase::ShaderType;
use glam::{DVec3, UVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};
use wgpu::*;

/// Texels on a side of the texture, unless one hemicube needs more.
const SIDE: usize = 2048;

/// Triangles that are drawn at most in one submit, but that each has a hemicube at least: drivers stop long work.
const TRIANGLES: usize = 20_000_000;

/// `Face` of shaders/hemicube.wgsl.
#[derive(Debug, Clone, Copy, Default, ShaderType)]
struct Face {
    right: Vec3,
    rows: Vec2,
    up: Vec3,
    near: f32,
    forward: Vec3,
    home: u32,
    high: Vec3,
    low: Vec3,
}

/// Draws hemicubes on a device.
pub struct Hemicubes {
    device: Arc<Device>,
    pipeline: OnceLock<RenderPipeline>,
}

impl Hemicubes {
    /// On an open device. Nothing is compiled before it is needed.
    pub fn new(device: Arc<Device>) -> Self {
        Hemicubes {
            device,
            pipeline: OnceLock::new(),
        }
    }
}

/// Where hemicubes lie in the texture.
struct Atlas {
    /// Texels on a side of a hemicube.
    side: usize,
    columns: usize,
    rows: usize,
}

impl Atlas {
    /// For so many at most.
    fn new(side: usize, most: usize) -> Self {
        let columns = (SIDE / side).clamp(1, most.max(1));
        let rows = (SIDE / (3 * side)).clamp(1, most.div_ceil(columns).max(1));
        Atlas {
            side,
            columns,
            rows,
        }
    }

    fn size(&self) -> UVec2 {
        let [width, height] = [self.columns, 3 * self.rows].map(|count| (count * self.side) as u32);
        UVec2::new(width, height)
    }

    /// The corner of a hemicube.
    fn corner(&self, number: usize) -> [usize; 2] {
        let [column, row] = [number % self.columns, number / self.columns];
        [column * self.side, row * 3 * self.side]
    }
}

/// A position in two parts.
fn parts(p: DVec3) -> [Vec3; 2] {
    let high = p.as_vec3();
    [high, (p - high.as_dvec3()).as_vec3()]
}

/// The faces of a hemicube.
fn faces(eye: &Eye) -> [Face; 5] {
    let [u, v, w] = eye.axes;
    let turned = |axis: DVec3| (axis.x * u + axis.y * v + axis.z * w).as_vec3();
    let [high, low] = parts(eye.place);
    FACES.map(|[right, up, forward]| Face {
        right: turned(right),
        rows: match up == DVec3::Z {
            true => Vec2::new(2.0, -1.0),
            false => Vec2::X,
        },
        up: turned(up),
        near: eye.near as f32,
        forward: turned(forward),
        home: eye.home,
        high,
        low,
    })
}

/// Corners for the device.
fn corners(triangles: &[Target]) -> Vec<[u32; 7]> {
    let corner = |p: DVec3, home: u32| {
        let [high, low] = parts(p).map(|part| part.to_array().map(f32::to_bits));
        [high[0], high[1], high[2], low[0], low[1], low[2], home]
    };
    let all = triangles.iter();
    all.flat_map(|t| t.corners.map(|p| corner(p, t.home)))
        .collect()
}

const CORNER: [VertexAttribute; 3] =
    vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32];

fn pipeline(device: &Device) -> RenderPipeline {
    let device = &device.device;
    let module = device.create_shader_module(ShaderModuleDescriptor {
        label: Some("hemicube"),
        source: ShaderSource::Wgsl(include_str!("../../../shaders/hemicube.wgsl").into()),
    });
    device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some("hemicube"),
        layout: None,
        vertex: VertexState {
            module: &module,
            entry_point: Some("hemicube_vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(VertexBufferLayout {
                array_stride: 28,
                step_mode: VertexStepMode::Vertex,
                attributes: &CORNER,
            })],
        },
        // Both sides of a triangle are there.
        primitive: PrimitiveState::default(),
        depth_stencil: Some(DepthStencilState {
            format: TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(FragmentState {
            module: &module,
            entry_point: Some("hemicube_fragment"),
            compilation_options: Default::default(),
            targets: &[Some(ColorTargetState {
                format: TextureFormat::R32Uint,
                blend: None,
                write_mask: ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

impl Drawer for Hemicubes {
    fn draw(
        &self,
        triangles: &[Target],
        eyes: &[Eye],
        side: usize,
        each: &mut dyn FnMut(&[u32]) -> Result<()>,
    ) -> Result<()> {
        let device = &*self.device;
        let pipeline = self.pipeline.get_or_init(|| pipeline(device));
        let once = TRIANGLES / (5 * triangles.len().max(1));
        let atlas = Atlas::new(side, eyes.len().min(once.max(1)));
        let size = atlas.size();
        let pitch = numbers_pitch(size.x);
        let bytes = u64::from(pitch) * u64::from(size.y);
        let target = |label, format, usage| texture(device, label, size, 1, format, usage);
        let (attached, copied) = (
            TextureUsages::RENDER_ATTACHMENT,
            TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
        );
        let numbers = target("hemicubes", TextureFormat::R32Uint, copied);
        let depth = target("hemicubes' depth", TextureFormat::Depth32Float, attached);
        let views = [&numbers, &depth].map(|texture| texture.create_view(&Default::default()));
        let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
        let staging = device.buffer("what hemicubes see", bytes, usage)?;
        let corners = corners(triangles);
        let corners = device.filled(
            "the triangles that hemicubes see",
            bytemuck::cast_slice(&corners),
            BufferUsages::VERTEX,
        )?;
        let count = (atlas.columns * atlas.rows).max(1);
        let first: Vec<Face> = eyes.iter().take(count).flat_map(faces).collect();
        let places = device.filled(
            "the places of hemicubes",
            &shared::list(&first),
            BufferUsages::STORAGE,
        )?;
        let group = device.device.create_bind_group(&BindGroupDescriptor {
            label: Some("hemicubes"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[BindGroupEntry {
                binding: 0,
                resource: places.as_entire_binding(),
            }],
        });
        device.check()?;
        for batch in eyes.chunks(count) {
            let faces: Vec<Face> = batch.iter().flat_map(faces).collect();
            device.write(&places, &shared::list(&faces));
            let mut encoder = device.device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
                label: Some("hemicubes"),
                color_attachments: &[Some(RenderPassColorAttachment {
                    view: &views[0],
                    depth_slice: None,
                    resolve_target: None,
                    ops: Operations {
                        load: LoadOp::Clear(Color::TRANSPARENT),
                        store: StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
                    view: &views[1],
                    depth_ops: Some(Operations {
                        load: LoadOp::Clear(0.0),
                        store: StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes: None,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.set_vertex_buffer(0, corners.slice(..));
            for number in 0..batch.len() {
                let [x, mut y] = atlas.corner(number).map(|at| at as u32);
                for face in 0..5 {
                    let width = side as u32;
                    let height = if face == 0 { width } else { width / 2 };
                    let [left, top, wide, high] = [x, y, width, height].map(|at| at as f32);
                    pass.set_viewport(left, top, wide, high, 0.0, 1.0);
                    pass.set_scissor_rect(x, y, width, height);
                    let instance = (5 * number) as u32 + face;
                    pass.draw(0..3 * triangles.len() as u32, instance..instance + 1);
                    y += height;
                }
            }
            drop(pass);
            encoder.copy_texture_to_buffer(
                numbers.as_image_copy(),
                TexelCopyBufferInfo {
                    buffer: &staging,
                    layout: TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(pitch),
                        rows_per_image: None,
                    },
                },
                numbers.size(),
            );
            device.queue.submit([encoder.finish()]);
            let seen = device.read(&staging, bytes)?;
            let seen: Vec<u32> = bytemuck::pod_collect_to_vec(&seen);
            let pitch = pitch as usize / 4;
            let mut texels = vec![0; batch.len() * 3 * side * side];
            let blocks = texels.par_chunks_exact_mut(3 * side * side);
            blocks.enumerate().for_each(|(number, block)| {
                let [x, y] = atlas.corner(number);
                for (row, texels) in block.chunks_exact_mut(side).enumerate() {
                    let at = (y + row) * pitch + x;
                    texels.copy_from_slice(&seen[at..at + side]);
                }
            });
            each(&texels)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::naga::{TypeInner, front::wgsl};

    #[test]
    fn the_struct_lies_alike_on_both_sides() {
        let module = wgsl::parse_str(include_str!("../../../shaders/hemicube.wgsl"));
        let module = module.expect("the shader is WGSL");
        let mut types = module.types.iter();
        let found = types.find(|(_, t)| t.name.as_deref() == Some("Face"));
        let TypeInner::Struct { members, span } = &found.expect("the shader has it").1.inner else {
            panic!("Face is a struct");
        };
        for (i, member) in members.iter().enumerate() {
            assert_eq!(Face::METADATA.offset(i), u64::from(member.offset));
        }
        let size = <Face as encase::ShaderSize>::SHADER_SIZE.get();
        assert_eq!(size, u64::from(*span));
    }

    #[test]
    fn hemicubes_lie_side_by_side() {
        for (side, most) in [(2, 1), (16, 7), (64, 100_000), (1024, 3)] {
            let atlas = Atlas::new(side, most);
            let count = (atlas.columns * atlas.rows).min(most);
            let size = atlas.size();
            let mut corners: Vec<_> = (0..count).map(|number| atlas.corner(number)).collect();
            for [x, y] in &corners {
                assert!(x + side <= size.x as usize && y + 3 * side <= size.y as usize);
            }
            assert!(size.max_element() as usize <= SIDE.max(3 * side));
            corners.sort_unstable();
            corners.dedup();
            assert_eq!(corners.len(), count);
        }
    }
}
