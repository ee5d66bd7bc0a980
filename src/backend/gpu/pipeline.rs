//! From a pass as data to pipelines and bind group layouts, each compiled once.

use super::device::Device;
use super::source::{Binding, bindings, shader_text};
use crate::conditions::Conditions;
use crate::effect::{Effect, Over, Pass, RasterView, Settings, When};
use std::collections::HashMap;
use wgpu::*;

/// Storage buffers that a pass sees at most while reads are counted: one more than every device takes.
pub const BUFFERS_COUNTING: u32 = 9;

/// Layouts that all passes share, and what was compiled.
pub struct Pipelines {
    /// Tile, rays, media.
    common: BindGroupLayout,
    /// The same and counts.
    counted: BindGroupLayout,
    /// A beam alone: to draw its maps.
    pub beam: BindGroupLayout,
    /// A beam and its maps: to ask them.
    pub lit: BindGroupLayout,
    compute: HashMap<Key, (ComputePipeline, BindGroupLayout)>,
    raster: HashMap<Key, (Raster, BindGroupLayout)>,
    /// How many were compiled so far.
    pub compiled: usize,
}

/// What decides how a pipeline comes out.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Key {
    label: String,
    text: String,
    counting: bool,
    beams: Option<Beams>,
}

/// What a pass sees of beams.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Beams {
    /// One that it draws the maps of.
    Drawn,
    /// One whose maps it asks.
    Asked,
}

/// The pipelines of a raster pass.
#[derive(Clone)]
pub struct Raster {
    pub solid: RenderPipeline,
    /// For triangles with holes, if the scene has any.
    pub cut_out: Option<RenderPipeline>,
}

/// What a pass is compiled from.
pub struct Compile<'c> {
    pub device: &'c Device,
    pub effect: &'static Effect,
    pub pass: &'static Pass,
    pub conditions: &'c Conditions,
    pub settings: &'c Settings<'c>,
    pub counting: bool,
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

fn texture(sample_type: TextureSampleType, view_dimension: TextureViewDimension) -> BindingType {
    BindingType::Texture {
        sample_type,
        view_dimension,
        multisampled: false,
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
fn own_entries(effect: &Effect, pass: &Pass) -> Vec<BindGroupLayoutEntry> {
    let stages = match pass.over {
        Over::Raster(_) => ShaderStages::VERTEX_FRAGMENT,
        _ => ShaderStages::COMPUTE,
    };
    let numbers = TextureSampleType::Uint;
    let floats = TextureSampleType::Float { filterable: false };
    let (all, own) = bindings(effect, pass);
    all[..own]
        .iter()
        .zip(0..)
        .map(|((_, access), binding)| {
            let ty = match access {
                Binding::Read => buffer(READ),
                Binding::Write => buffer(WRITE),
                Binding::Uniform => buffer(BufferBindingType::Uniform),
                Binding::Texture => texture(numbers, TextureViewDimension::D2),
                Binding::TextureArray => texture(numbers, TextureViewDimension::D2Array),
                Binding::FloatTexture => texture(floats, TextureViewDimension::D2),
            };
            entry(binding, stages, ty)
        })
        .collect()
}

fn beams(pass: &Pass) -> Option<Beams> {
    match (pass.when, pass.over) {
        (When::EachBeam(_), _) => Some(Beams::Asked),
        (_, Over::Raster(RasterView::Beam(_))) => Some(Beams::Drawn),
        _ => None,
    }
}

fn key(what: &Compile) -> Key {
    Key {
        label: format!("{}.{}", what.effect.name, what.pass.entry),
        text: shader_text(
            what.effect,
            what.pass,
            what.conditions,
            what.settings,
            what.counting,
        ),
        counting: what.counting,
        beams: beams(what.pass),
    }
}

impl Pipelines {
    pub fn new(device: &Device) -> Self {
        let layout = |label, entries: &[BindGroupLayoutEntry]| {
            device
                .device
                .create_bind_group_layout(&BindGroupLayoutDescriptor {
                    label: Some(label),
                    entries,
                })
        };
        let uniform = buffer(BufferBindingType::Uniform);
        let maps = |of| texture(of, TextureViewDimension::D2Array);
        let corners = TextureSampleType::Float { filterable: false };
        Pipelines {
            common: layout("tile, rays, media", &common_entries(false)),
            counted: layout("tile, rays, media, counts", &common_entries(true)),
            beam: layout("beam", &[entry(0, ALL, uniform)]),
            lit: layout(
                "beam and maps",
                &[
                    entry(0, ALL, uniform),
                    entry(1, ShaderStages::COMPUTE, maps(TextureSampleType::Depth)),
                    entry(2, ShaderStages::COMPUTE, maps(TextureSampleType::Uint)),
                    entry(
                        3,
                        ShaderStages::COMPUTE,
                        texture(corners, TextureViewDimension::D2),
                    ),
                ],
            ),
            compute: HashMap::new(),
            raster: HashMap::new(),
            compiled: 0,
        }
    }

    /// The layout of what every pass sees.
    pub fn common(&self, counting: bool) -> &BindGroupLayout {
        match counting {
            true => &self.counted,
            false => &self.common,
        }
    }

    fn layout(&self, what: &Compile, label: &str, own: &BindGroupLayout) -> PipelineLayout {
        let third = beams(what.pass).map(|beams| match beams {
            Beams::Drawn => &self.beam,
            Beams::Asked => &self.lit,
        });
        let mut groups = vec![Some(self.common(what.counting)), Some(own)];
        groups.extend(third.map(Some));
        let device = &what.device.device;
        device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &groups,
            immediate_size: 0,
        })
    }

    fn own(what: &Compile) -> BindGroupLayout {
        let device = &what.device.device;
        device.create_bind_group_layout(&BindGroupLayoutDescriptor {
            label: Some(what.pass.entry),
            entries: &own_entries(what.effect, what.pass),
        })
    }

    fn module(what: &Compile, label: &str, text: &str) -> ShaderModule {
        let device = &what.device.device;
        device.create_shader_module(ShaderModuleDescriptor {
            label: Some(label),
            source: ShaderSource::Wgsl(text.into()),
        })
    }

    /// A compute pass, compiled unless it has been, and the layout of its own bind group.
    pub fn compute(&mut self, what: &Compile) -> (ComputePipeline, BindGroupLayout) {
        let key = key(what);
        if let Some(known) = self.compute.get(&key) {
            return known.clone();
        }
        let own = Self::own(what);
        let device = &what.device.device;
        let pipeline = device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(&key.label),
            layout: Some(&self.layout(what, &key.label, &own)),
            module: &Self::module(what, &key.label, &key.text),
            entry_point: Some(what.pass.entry),
            compilation_options: Default::default(),
            cache: None,
        });
        self.compiled += 1;
        let made = (pipeline, own);
        self.compute.insert(key, made.clone());
        made
    }

    /// A raster pass, compiled unless it has been, and the layout of its own bind group.
    pub fn raster(&mut self, what: &Compile, holes: bool) -> (Raster, BindGroupLayout) {
        let key = key(what);
        if let Some(known) = self.raster.get(&key)
            && (known.0.cut_out.is_some() || !holes)
        {
            return known.clone();
        }
        let own = Self::own(what);
        let module = Self::module(what, &key.label, &key.text);
        let layout = self.layout(what, &key.label, &own);
        let targets = [Some(ColorTargetState {
            format: TextureFormat::R32Uint,
            blend: None,
            write_mask: ColorWrites::ALL,
        })];
        let compare = match what.pass.over {
            Over::Raster(RasterView::Hemicube(_)) => CompareFunction::Less,
            // What is near the camera or the light has the greatest depth.
            _ => CompareFunction::Greater,
        };
        let mut pipeline = |infix: &str| {
            let vertex = format!("{}{infix}_vertex", what.pass.entry);
            let fragment = format!("{}{infix}_fragment", what.pass.entry);
            self.compiled += 1;
            let device = &what.device.device;
            device.create_render_pipeline(&RenderPipelineDescriptor {
                label: Some(&key.label),
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
        let raster = Raster {
            solid: pipeline(""),
            cut_out: holes.then(|| pipeline("_cut")),
        };
        let made = (raster, own);
        self.raster.insert(key, made.clone());
        made
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect;

    /// The most storage buffers that a stage of any pass of some effects sees at once.
    fn most_storage_buffers(counting: bool, keep: fn(&&&effect::Effect) -> bool) -> u32 {
        let all = effect::ALL
            .iter()
            .filter(keep)
            .flat_map(|effect| effect.passes.iter().map(move |pass| (effect, pass)));
        let seen = all.flat_map(|(effect, pass)| {
            let entries = [common_entries(counting), own_entries(effect, pass)].concat();
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
        assert!(most_storage_buffers(false, |_| true) <= guaranteed);
        assert!(most_storage_buffers(true, |_| true) <= BUFFERS_COUNTING);
        // What lights the air leaves one for effects to come.
        let lights_air = |effect: &&&effect::Effect| effect.method.is_some();
        assert!(most_storage_buffers(false, lights_air) < guaranteed);
    }
}
