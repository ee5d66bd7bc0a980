//! What a plan's passes need on the device: pipelines, buffers, bindings; and the order in which they run.

use super::beams::BeamMaps;
use super::device::Device;
use super::pipeline::{Compile, Pipelines, Raster};
use super::scene::SceneOnDevice;
use super::schedule::{Schedule, Touched};
use super::source::{knob_bytes, knobs};
use super::store::Store;
use super::tile::Target;
use crate::backend::rendering::StartUp;
use crate::effect::{
    Batch, Effect, Extent, Field, Keeper, Life, Loop, MapSettings, Over, Paid, Pass, RasterView,
    Resource, Settings, When,
};
use crate::error::{Error, Result};
use crate::plan::Plan;
use glam::UVec2;
use std::time::Duration;
use wgpu::*;

/// Stages of the start-up: the scene's buffers and textures, and what is compiled.
pub const SCENE: &str = "scene to device";
pub const PIPELINES: &str = "pipelines";

/// One entry of the list of what is done.
pub struct Stage<'p> {
    pub effect: &'static Effect,
    pub pass: &'static str,
    pub work: Work<'p>,
    pub runs: u32,
    pub on_cpu: Duration,
    pub counted: [u64; 2],
    /// Rays that it paid for on the CPU.
    pub paid: Option<Paid>,
}

pub enum Work<'p> {
    Compute(Compute),
    /// The flag asks for exact silhouettes.
    Camera(Raster, BindGroup, bool),
    Hemicube(Raster, BindGroup, Faces),
    Host(Host<'p>),
    /// What the passes before left of a field to the effect's reference.
    Rest(Batch<'p>, Field),
}

pub struct Compute {
    pub pipeline: ComputePipeline,
    pub group: BindGroup,
    /// Those of further parts of the work.
    pub further: Vec<BindGroup>,
    /// Workgroups; absent: those that cover the tile.
    pub groups: Option<[u32; 2]>,
    /// The numbers of the beams that it runs for, of a pass for each beam.
    pub beams: Vec<usize>,
    /// Whether it was compiled for this plan and has not run since.
    pub cold: bool,
}

/// What the CPU does.
pub struct Host<'p> {
    pub batch: Batch<'p>,
    /// The fields that must be fetched from the device.
    pub fetch: Vec<Field>,
    /// The fields that are brought back to it.
    pub bring: Vec<Field>,
}

/// The faces of a hemicube.
pub struct Faces {
    pub views: Vec<TextureView>,
    pub depth: TextureView,
    pub side: u32,
}

/// Passes that fill what is kept, in their order; those of one loop are one entry.
pub struct Filling {
    pub effect: &'static Effect,
    pub passes: Vec<&'static Pass>,
    pub stages: Vec<usize>,
    pub until: Option<(&'static Loop, Vec<(&'static str, f64)>)>,
}

/// Makes what the passes of a plan name.
pub struct Maker<'m, 'p> {
    pub plan: &'p Plan<'p>,
    pub device: &'m Device,
    pub pipelines: &'m mut Pipelines,
    pub scene: &'m mut SceneOnDevice,
    pub store: &'m mut Store,
    pub kept: &'m Keeper<'m>,
    pub counting: bool,
    pub fields: &'m [Target],
    pub numbers: &'m Texture,
    /// Pixels of a tile.
    pub pixels: u64,
    pub stages: Vec<Stage<'p>>,
    pub schedule: Schedule,
    pub fillings: Vec<Filling>,
    pub maps: Option<BeamMaps>,
    /// The lamps as the effect at hand has them, for all parts of its work.
    pub lamps: Option<(&'static str, Texture)>,
    pub start_up: StartUp,
}

impl<'p> Maker<'_, 'p> {
    pub fn all(&mut self) -> Result<()> {
        let plan = self.plan;
        let mut written: Vec<Field> = Vec::new();
        for step in plan.running() {
            let settings = Settings {
                effect: step.effect.name,
                values: &step.settings,
            };
            let effect = step.effect;
            let in_parts = |pass: &Pass| matches!(pass.when, When::Parts(_));
            let in_parts = effect.passes.iter().any(in_parts);
            // What it leaves to the reference takes the place of all that is there.
            let is_late = in_parts && effect.writes.iter().any(|f| written.contains(f));
            written.extend(effect.writes);
            if is_late || step.is_by_reference(plan.conditions) {
                self.host(effect, &settings)?;
                continue;
            }
            let note = (effect.note)(plan.conditions, &settings);
            note.into_iter().for_each(|note| self.kept.note(note));
            for pass in effect.passes {
                self.pass(effect, pass, &settings)?;
            }
            if let ([field], true) = (effect.writes, in_parts) {
                self.rest(effect, *field, &settings)?;
            }
        }
        Ok(())
    }

    /// Lets the reference do what passes that run in parts leave.
    fn rest(&mut self, effect: &'static Effect, field: Field, settings: &Settings) -> Result<()> {
        if self.field(field).is_none() {
            return Ok(());
        }
        let prepare = || (effect.reference)(self.plan.conditions, settings, self.kept);
        let batch = self
            .start_up
            .timed(&format!("{}.prepare", effect.name), prepare)?;
        self.schedule
            .tile(self.stages.len(), Touched::by_host(effect));
        self.push(effect, "reference", Work::Rest(batch, field));
        Ok(())
    }

    fn host(&mut self, effect: &'static Effect, settings: &Settings) -> Result<()> {
        let changed: Vec<Field> = effect.writes.iter().chain(effect.alters).copied().collect();
        let touched = Touched::by_host(effect);
        let number = self.stages.len();
        let before = self.schedule.host(number, &touched);
        let mut fetch: Vec<Field> = effect
            .reads
            .iter()
            .chain(&changed)
            .copied()
            .filter(|field| *field != Field::Surface && before.contains(field))
            .collect();
        fetch.sort_unstable();
        fetch.dedup();
        let bring = changed
            .into_iter()
            .filter(|field| self.field(*field).is_some())
            .collect();
        let prepare = || (effect.reference)(self.plan.conditions, settings, self.kept);
        let batch = self
            .start_up
            .timed(&format!("{}.prepare", effect.name), prepare)?;
        self.push(
            effect,
            "reference",
            Work::Host(Host {
                batch,
                fetch,
                bring,
            }),
        );
        Ok(())
    }

    fn field(&self, field: Field) -> Option<&Buffer> {
        let target = self.fields.iter().find(|t| t.field == field);
        target.map(|t| &t.buffer)
    }

    fn push(&mut self, effect: &'static Effect, pass: &'static str, work: Work<'p>) {
        self.stages.push(Stage {
            effect,
            pass,
            work,
            runs: 0,
            on_cpu: Duration::ZERO,
            counted: [0; 2],
            paid: None,
        });
    }

    fn pass(
        &mut self,
        effect: &'static Effect,
        pass: &'static Pass,
        settings: &Settings,
    ) -> Result<()> {
        let each: Vec<Option<Field>> = match pass.over {
            Over::Fields(fields) => fields
                .iter()
                .filter(|f| self.field(**f).is_some())
                .map(|f| Some(*f))
                .collect(),
            _ => vec![None],
        };
        let fields = pass.uses.iter().filter_map(Resource::field);
        let missing = fields.clone().any(|field| self.field(field).is_none());
        if missing || each.is_empty() {
            return Ok(());
        }
        let plan = self.plan;
        let what = Compile {
            device: self.device,
            effect,
            pass,
            conditions: plan.conditions,
            settings,
            counting: self.counting,
        };
        if let Over::Raster(view) = pass.over {
            let triangles = &self.scene.triangles;
            let holes = (triangles.solid as usize) < triangles.numbers.len();
            let compile = || self.pipelines.raster(&what, holes);
            let (raster, layout) = self.start_up.timed(PIPELINES, compile);
            let group = self.group(effect, pass, settings, &layout, (None, 0))?;
            match view {
                RasterView::Camera(traced) => {
                    let work = Work::Camera(raster, group, traced(settings));
                    self.schedule_pass(effect, pass, None);
                    self.push(effect, pass.entry, work);
                }
                RasterView::Beam(wanted) if self.maps.is_none() => {
                    let settings = self.checked(effect, wanted(settings))?;
                    self.maps = Some(BeamMaps {
                        effect,
                        pass: pass.entry,
                        raster,
                        group,
                        settings,
                        corners: self
                            .start_up
                            .timed(SCENE, || self.scene.caster_corners(self.device))?,
                        beams: Vec::new(),
                        seen: None,
                        runs: 0,
                    });
                }
                // The first that draws them draws them for all.
                RasterView::Beam(_) => {}
                RasterView::Hemicube(side) => {
                    let extent = self.extent(settings);
                    let faces = self.faces(effect, side(&extent))?;
                    let views = (0..5).map(|face| {
                        faces.create_view(&TextureViewDescriptor {
                            dimension: Some(TextureViewDimension::D2),
                            base_array_layer: face,
                            array_layer_count: Some(1),
                            ..Default::default()
                        })
                    });
                    let side = faces.width();
                    let work = Faces {
                        views: views.collect(),
                        depth: self
                            .store
                            .texture(
                                self.device,
                                "depth of a hemicube",
                                UVec2::splat(side),
                                TextureFormat::Depth32Float,
                                TextureUsages::RENDER_ATTACHMENT,
                            )
                            .create_view(&Default::default()),
                        side,
                    };
                    self.schedule_pass(effect, pass, None);
                    self.filling(effect, pass, settings);
                    self.push(effect, pass.entry, Work::Hemicube(raster, group, work));
                }
            }
            return Ok(());
        }
        let beams = match pass.when {
            When::EachBeam(beams) => {
                let beams = beams(plan.conditions, settings);
                if beams.is_empty() {
                    return Ok(());
                }
                let traced = |r: &Resource| matches!(r, Resource::CasterTree);
                self.beams(beams, !pass.uses.iter().any(traced))?
            }
            _ => Vec::new(),
        };
        let compiled = self.pipelines.compiled;
        let compile = || self.pipelines.compute(&what);
        let (pipeline, layout) = self.start_up.timed(PIPELINES, compile);
        let cold = self.pipelines.compiled > compiled;
        let parts = match pass.when {
            When::Parts(parts) => parts(plan.conditions, settings).max(1),
            _ => 1,
        };
        for field in each {
            let group = self.group(effect, pass, settings, &layout, (field, 0))?;
            let further: Result<Vec<BindGroup>> = (1..parts)
                .map(|part| self.group(effect, pass, settings, &layout, (field, part)))
                .collect();
            let further = further?;
            let beams = beams.clone();
            let groups = match pass.over {
                Over::Groups(count) => Some(count(&self.extent(settings))),
                _ => None,
            };
            self.schedule_pass(effect, pass, field);
            self.filling(effect, pass, settings);
            let work = Work::Compute(Compute {
                pipeline: pipeline.clone(),
                group,
                further,
                groups,
                beams,
                cold,
            });
            self.push(effect, pass.entry, work);
        }
        Ok(())
    }

    fn extent<'s>(&self, settings: &Settings<'s>) -> Extent<'s>
    where
        'p: 's,
    {
        Extent {
            conditions: self.plan.conditions,
            settings: *settings,
            pixels: self.pixels,
        }
    }

    /// Puts the next stage into the order of a tile's work, unless it runs before all tiles.
    fn schedule_pass(&mut self, effect: &'static Effect, pass: &'static Pass, each: Option<Field>) {
        let touched = Touched::by_pass(effect, pass, each);
        let number = self.stages.len();
        match pass.when {
            When::Tile | When::Parts(_) => self.schedule.tile(number, touched),
            When::EachBeam(_) => self.schedule.each_beam(number, effect.name, touched),
            When::Once | When::Until(_) => {}
        }
    }

    /// Puts the next stage among those that fill what is kept, if it is one.
    fn filling(&mut self, effect: &'static Effect, pass: &'static Pass, settings: &Settings) {
        let number = self.stages.len();
        let until = match pass.when {
            When::Once => None,
            When::Until(until) => Some(until),
            _ => return,
        };
        if let (Some(until), Some(last)) = (until, self.fillings.last_mut())
            && last.effect.name == effect.name
            && last
                .until
                .as_ref()
                .is_some_and(|(other, _)| std::ptr::eq(*other, until))
        {
            last.stages.push(number);
            last.passes.push(pass);
            return;
        }
        self.fillings.push(Filling {
            effect,
            passes: vec![pass],
            stages: vec![number],
            until: until.map(|until| (until, settings.values.to_vec())),
        });
    }

    /// The numbers of beams, whose maps are asked or not.
    fn beams(&mut self, beams: Vec<crate::beam::Beam>, mapped: bool) -> Result<Vec<usize>> {
        let conditions = self.plan.conditions;
        let (casters, anchor) = (&self.scene.casters, self.scene.anchor);
        let Some(maps) = self.maps.as_mut() else {
            // The plan checks that somebody draws them; whoever it is may have nothing to do.
            return match beams.is_empty() {
                true => Ok(Vec::new()),
                false => Err(Error::failed(
                    "an effect runs for each beam of light, and the effect that draws the shadow maps of beams was left out",
                    "leave both in or both out: `tyndall plan` lists them",
                )),
            };
        };
        Ok(beams
            .iter()
            .map(|beam| maps.number(conditions, casters, anchor, beam, mapped))
            .collect())
    }

    /// Whether the device takes maps of that size.
    fn checked(&self, effect: &Effect, settings: MapSettings) -> Result<MapSettings> {
        let most = self.device.limits().max_texture_dimension_2d;
        if settings.most > most {
            return Err(Error::domain(
                format!("the resolution of the maps of `{}`", effect.name),
                settings.most,
                format!("16 to {most} texels on {}", self.device.adapter.name),
                format!("set a lower one with --set {}.resolution=N", effect.name),
            ));
        }
        Ok(settings)
    }

    fn faces(&mut self, effect: &'static Effect, side: u32) -> Result<Texture> {
        self.store.faces(self.device, effect.name, side)
    }

    fn group(
        &mut self,
        effect: &'static Effect,
        pass: &Pass,
        settings: &Settings,
        layout: &BindGroupLayout,
        (each, part): (Option<Field>, u32),
    ) -> Result<BindGroup> {
        enum Bound {
            Buffer(Buffer),
            View(TextureView),
        }
        let conditions = self.plan.conditions;
        let extent = self.extent(settings);
        let mut bound = Vec::with_capacity(pass.uses.len());
        for (binding, resource) in pass.uses.iter().enumerate() {
            let device = self.device;
            let name = |what| format!("{what} of {}.{}, {binding}", effect.name, pass.entry);
            let buffer = match resource {
                Resource::Read(field) | Resource::Update(field) => self.field(*field).cloned(),
                Resource::Each => each.and_then(|field| self.field(field).cloned()),
                Resource::Use(product) | Resource::Make(product) => {
                    let bytes = (product.bytes)(&extent);
                    Some(self.store.product(
                        device,
                        conditions,
                        self.scene.anchor,
                        effect.name,
                        product,
                        settings,
                        bytes,
                    )?)
                }
                Resource::Numbers => {
                    bound.push(Bound::View(self.numbers.create_view(&Default::default())));
                    continue;
                }
                Resource::CasterTree => {
                    let make = || self.scene.caster_tree(device);
                    let tree = self.start_up.timed(SCENE, make)?;
                    bound.push(Bound::View(tree.create_view(&Default::default())));
                    continue;
                }
                Resource::CasterCorners => {
                    let make = || self.scene.caster_corners(device);
                    let corners = self.start_up.timed(SCENE, make)?;
                    bound.push(Bound::View(corners.create_view(&Default::default())));
                    continue;
                }
                Resource::Lamps(make) => {
                    let made = self.lamps.take().filter(|(of, _)| *of == effect.name);
                    let lamps = match made.filter(|_| part > 0) {
                        Some((_, lamps)) => lamps,
                        None => {
                            let texels = make(conditions, settings);
                            self.store.texels(device, effect.name, texels)?
                        }
                    };
                    self.lamps = Some((effect.name, lamps.clone()));
                    bound.push(Bound::View(lamps.create_view(&Default::default())));
                    continue;
                }
                Resource::Part => Some(self.store.filled(
                    device,
                    &format!("part {part}"),
                    &part.to_le_bytes(),
                    BufferUsages::UNIFORM,
                )?),
                Resource::Ends => {
                    let ends = self.scene.ends(device, conditions)?;
                    bound.push(Bound::View(ends.create_view(&Default::default())));
                    continue;
                }
                Resource::Faces => {
                    let faces = self.store.faces(device, effect.name, 0)?;
                    bound.push(Bound::View(faces.create_view(&TextureViewDescriptor {
                        dimension: Some(TextureViewDimension::D2Array),
                        ..Default::default()
                    })));
                    continue;
                }
                Resource::Knobs(_) => Some(self.store.filled(
                    device,
                    &name("the knobs"),
                    &knob_bytes(&knobs(effect, pass, conditions, settings)),
                    BufferUsages::UNIFORM,
                )?),
                Resource::Table(make) => Some(self.store.filled(
                    device,
                    &name("the table"),
                    bytemuck::cast_slice(&make(conditions, settings)),
                    BufferUsages::STORAGE,
                )?),
                Resource::Sky => {
                    let sky = conditions.sky.as_ref();
                    let table = sky.map_or_else(|| vec![0.0], |sky| sky.table());
                    Some(self.store.filled(
                        device,
                        "the sky's table",
                        bytemuck::cast_slice(&table),
                        BufferUsages::STORAGE,
                    )?)
                }
                _ => {
                    let make = || self.scene.buffer(device, conditions, resource);
                    self.start_up.timed(SCENE, make)?
                }
            };
            let buffer = buffer.ok_or_else(|| {
                Error::failed(
                    format!("{}.{} names what is not there", effect.name, pass.entry),
                    "mend the effect: `layer` goes with passes over fields",
                )
            })?;
            bound.push(Bound::Buffer(buffer));
        }
        let entries: Vec<BindGroupEntry> = bound
            .iter()
            .zip(0..)
            .map(|(bound, binding)| BindGroupEntry {
                binding,
                resource: match bound {
                    Bound::Buffer(buffer) => buffer.as_entire_binding(),
                    Bound::View(view) => BindingResource::TextureView(view),
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

impl Filling {
    /// The kept products that its passes make.
    pub fn makes(&self) -> impl Iterator<Item = &'static str> + '_ {
        let uses = self.passes.iter().flat_map(|pass| pass.uses);
        uses.filter_map(|resource| match resource {
            Resource::Make(product) if product.life() == Life::Kept => Some(product.name),
            _ => None,
        })
    }

    /// Whether it makes something that is not there; one that makes nothing itself draws what the effect's others need.
    pub fn is_needed(&self, store: &Store) -> bool {
        let stale = |name| store.is_stale(self.effect.name, name);
        if self.makes().next().is_some() {
            return self.makes().any(stale);
        }
        let uses = self.effect.passes.iter().flat_map(|pass| pass.uses);
        let products = uses.filter_map(Resource::product);
        products
            .filter(|product| product.life() == Life::Kept)
            .any(|product| stale(product.name))
    }
}
