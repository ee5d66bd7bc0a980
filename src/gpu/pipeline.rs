//! From a pass as data to pipelines and bind group layouts.

use super::device::Device;
use super::shared::common;
use crate::effect::{Kind, Pass, Resource};
use wgpu::*;

/// Storage buffers that a pass sees at most while reads are counted: one more than every device takes.
pub const BUFFERS_COUNTING: u32 = 9;

/// Layouts that all passes share, and what was compiled.
pub struct Pipelines {
    /// Frame, rays, media, and counts if anything is counted.
    pub common: BindGroupLayout,
    /// A light alone: to draw its maps.
    pub light: BindGroupLayout,
    /// A light and its maps: to ask them.
    pub lit: BindGroupLayout,
    /// Names of the pipelines that were compiled.
    pub compiled: Vec<String>,
    /// Whether shaders count their reads.
    counting: bool,
}

/// The pipelines of a raster pass.
pub struct Raster {
    pub solid: RenderPipeline,
    /// For triangles with holes, if the scene has any.
    pub cut_out: Option<RenderPipeline>,
}

const CORNER: [VertexAttribute; 1] = vertex_attr_array![0 => Float32x3];

fn entry(binding: u32, visibility: ShaderStages, ty: BindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry {
        binding,
        visibility,
        ty,
        count: None,
    }
}

fn buffer(ty: BufferBindingType) -> BindingType {
    BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

const READ: BufferBindingType = BufferBindingType::Storage { read_only: true };
const WRITE: BufferBindingType = BufferBindingType::Storage { read_only: false };

const ALL: ShaderStages = ShaderStages::VERTEX_FRAGMENT.union(ShaderStages::COMPUTE);

/// What every pass sees.
fn common_entries(counting: bool) -> Vec<BindGroupLayoutEntry> {
    let mut entries = vec![
        entry(0, ALL, buffer(BufferBindingType::Uniform)),
        entry(1, ShaderStages::COMPUTE, buffer(READ)),
        entry(2, ShaderStages::COMPUTE, buffer(READ)),
    ];
    if counting {
        entries.push(entry(3, ShaderStages::COMPUTE, buffer(WRITE)));
    }
    entries
}

/// What a pass uses.
fn own_entries(pass: &Pass) -> Vec<BindGroupLayoutEntry> {
    let stages = match pass.kind {
        Kind::Picture | Kind::SunMaps => ShaderStages::VERTEX_FRAGMENT,
        _ => ShaderStages::COMPUTE,
    };
    let of = |(resource, binding): (&Resource, u32)| {
        let ty = match resource {
            Resource::Update(_) | Resource::Each => buffer(WRITE),
            Resource::Numbers => BindingType::Texture {
                sample_type: TextureSampleType::Uint,
                view_dimension: TextureViewDimension::D2,
                multisampled: false,
            },
            _ => buffer(READ),
        };
        entry(binding, stages, ty)
    };
    pass.uses.iter().zip(0..).map(of).collect()
}

/// What a pass leaves for later ones.
fn scratch_entries(pass: &Pass) -> Vec<BindGroupLayoutEntry> {
    (0..pass.scratch.len() as u32)
        .map(|binding| entry(binding, ShaderStages::COMPUTE, buffer(WRITE)))
        .collect()
}

impl Pipelines {
    pub fn new(device: &Device, counting: bool) -> Self {
        let layout = |label, entries: &[BindGroupLayoutEntry]| {
            device
                .device
                .create_bind_group_layout(&BindGroupLayoutDescriptor {
                    label: Some(label),
                    entries,
                })
        };
        let uniform = buffer(BufferBindingType::Uniform);
        let maps = BindingType::Texture {
            sample_type: TextureSampleType::Depth,
            view_dimension: TextureViewDimension::D2Array,
            multisampled: false,
        };
        let casters = BindingType::Texture {
            sample_type: TextureSampleType::Uint,
            view_dimension: TextureViewDimension::D2Array,
            multisampled: false,
        };
        let corners = BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: false },
            view_dimension: TextureViewDimension::D2,
            multisampled: false,
        };
        Pipelines {
            common: layout("frame, rays, media, counts", &common_entries(counting)),
            light: layout("light", &[entry(0, ALL, uniform)]),
            lit: layout(
                "light and maps",
                &[
                    entry(0, ALL, uniform),
                    entry(1, ShaderStages::COMPUTE, maps),
                    entry(2, ShaderStages::COMPUTE, casters),
                    entry(3, ShaderStages::COMPUTE, corners),
                ],
            ),
            compiled: Vec::new(),
            counting,
        }
    }

    /// The layout of a pass's own bind group.
    pub fn own(&self, device: &Device, pass: &Pass) -> BindGroupLayout {
        device
            .device
            .create_bind_group_layout(&BindGroupLayoutDescriptor {
                label: Some(pass.entry),
                entries: &own_entries(pass),
            })
    }

    /// The layout of what a pass leaves for later ones, if that is anything.
    pub fn scratch(&self, device: &Device, pass: &Pass) -> Option<BindGroupLayout> {
        let entries = scratch_entries(pass);
        (!entries.is_empty()).then(|| {
            device
                .device
                .create_bind_group_layout(&BindGroupLayoutDescriptor {
                    label: Some("scratch"),
                    entries: &entries,
                })
        })
    }

    fn module(&self, device: &Device, label: &str, pass: &Pass) -> ShaderModule {
        let source = common(self.counting) + pass.shader;
        device.device.create_shader_module(ShaderModuleDescriptor {
            label: Some(label),
            source: ShaderSource::Wgsl(source.into()),
        })
    }

    fn layout(
        &self,
        device: &Device,
        label: &str,
        pass: &Pass,
        own: &BindGroupLayout,
    ) -> PipelineLayout {
        let third = match pass.kind {
            Kind::EachSun(..) => Some(&self.lit),
            Kind::SunMaps => Some(&self.light),
            _ => None,
        };
        let mut groups = vec![Some(&self.common), Some(own)];
        groups.extend(third.map(Some));
        let scratch = self.scratch(device, pass);
        groups.extend(scratch.as_ref().map(Some));
        device
            .device
            .create_pipeline_layout(&PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &groups,
                immediate_size: 0,
            })
    }

    /// Compiles a compute pass.
    pub fn compute(
        &mut self,
        device: &Device,
        effect: &str,
        pass: &Pass,
        own: &BindGroupLayout,
    ) -> ComputePipeline {
        let label = format!("{effect}.{}", pass.entry);
        let pipeline = device
            .device
            .create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some(&label),
                layout: Some(&self.layout(device, &label, pass, own)),
                module: &self.module(device, &label, pass),
                entry_point: Some(pass.entry),
                compilation_options: Default::default(),
                cache: None,
            });
        self.compiled.push(label);
        pipeline
    }

    /// Compiles a raster pass.
    pub fn raster(
        &mut self,
        device: &Device,
        effect: &str,
        pass: &Pass,
        own: &BindGroupLayout,
        holes: bool,
    ) -> Raster {
        let label = format!("{effect}.{}", pass.entry);
        let module = self.module(device, &label, pass);
        let layout = self.layout(device, &label, pass, own);
        let targets = [Some(ColorTargetState {
            format: TextureFormat::R32Uint,
            blend: None,
            write_mask: ColorWrites::ALL,
        })];
        let compare = match pass.kind {
            // The camera's depth is reversed.
            Kind::Picture => CompareFunction::Greater,
            _ => CompareFunction::Less,
        };
        let mut pipeline = |infix: &str| {
            let vertex = format!("{}{infix}_vertex", pass.entry);
            let fragment = format!("{}{infix}_fragment", pass.entry);
            self.compiled.push(format!("{label}{infix}"));
            device
                .device
                .create_render_pipeline(&RenderPipelineDescriptor {
                    label: Some(&label),
                    layout: Some(&layout),
                    vertex: VertexState {
                        module: &module,
                        entry_point: Some(&vertex),
                        compilation_options: Default::default(),
                        buffers: &[Some(VertexBufferLayout {
                            array_stride: 12,
                            step_mode: VertexStepMode::Vertex,
                            attributes: &CORNER,
                        })],
                    },
                    // Both sides of a triangle are there.
                    primitive: PrimitiveState::default(),
                    depth_stencil: Some(DepthStencilState {
                        format: TextureFormat::Depth32Float,
                        depth_write_enabled: Some(true),
                        depth_compare: Some(compare),
                        stencil: Default::default(),
                        bias: Default::default(),
                    }),
                    multisample: Default::default(),
                    fragment: Some(FragmentState {
                        module: &module,
                        entry_point: Some(&fragment),
                        compilation_options: Default::default(),
                        targets: &targets,
                    }),
                    multiview_mask: None,
                    cache: None,
                })
        };
        Raster {
            solid: pipeline(""),
            cut_out: holes.then(|| pipeline("_cut")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect;

    /// The most storage buffers that a stage of any pass sees at once.
    fn most_storage_buffers(counting: bool) -> u32 {
        let all = effect::ALL.iter().flat_map(|effect| effect.passes);
        let seen = all.flat_map(|pass| {
            let own = [own_entries(pass), scratch_entries(pass)];
            let entries = [common_entries(counting), own.concat()].concat();
            let is_storage = |entry: &&BindGroupLayoutEntry| {
                matches!(
                    entry.ty,
                    BindingType::Buffer {
                        ty: BufferBindingType::Storage { .. },
                        ..
                    }
                )
            };
            [
                ShaderStages::COMPUTE,
                ShaderStages::VERTEX,
                ShaderStages::FRAGMENT,
            ]
            .map(|stage| {
                let storage = entries.iter().filter(is_storage);
                storage.filter(|e| e.visibility.contains(stage)).count() as u32
            })
        });
        seen.max().unwrap_or(0)
    }

    #[test]
    fn no_pass_binds_more_storage_buffers_than_every_device_takes() {
        // That of core WebGPU.
        let guaranteed = Limits::default().max_storage_buffers_per_shader_stage;
        assert_eq!(guaranteed, 8);
        assert!(most_storage_buffers(false) <= guaranteed);
        let counting = most_storage_buffers(true);
        assert!(counting > guaranteed && counting <= BUFFERS_COUNTING);
    }
}
