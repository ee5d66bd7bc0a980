//! What a plan's passes need on the device: pipelines, buffers, bindings, made once.

use super::*;
use crate::effect::Over;
use std::collections::BTreeMap;

/// Makes what the passes of a plan name.
pub(super) struct Maker<'m, 'a> {
    pub plan: &'a Plan<'a>,
    pub device: &'m Device,
    pub pipelines: &'m mut Pipelines,
    pub scene: &'m mut SceneBuffers,
    pub triangles: &'m Triangles,
    pub fields: &'m [Target],
    pub numbers: &'m Texture,
    pub stages: Vec<Stage<'a>>,
    pub maps: Option<SunMaps>,
    pub from_host: Vec<Field>,
    pub pixels: u64,
    pub scratch: BTreeMap<(&'static str, &'static str), Buffer>,
}

impl<'a> Maker<'_, 'a> {
    pub(super) fn all(&mut self) -> Result<()> {
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
                    counted: [0; 2],
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

    pub(super) fn field(&self, field: Field) -> Option<&Buffer> {
        let target = self.fields.iter().find(|t| t.field == field);
        target.map(|t| &t.buffer)
    }

    pub(super) fn pass(
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
            if matches!(pass.kind, Kind::SunMaps) {
                self.maps = Some(self.sun_maps(settings, raster, group)?);
            } else {
                let silhouettes = settings.get("silhouettes") > 0.5;
                let work = Work::Picture(raster, group, silhouettes);
                self.push(effect, pass, work, finds_surfaces);
            }
            return Ok(());
        }
        let pipeline = self.pipelines.compute(self.device, effect, pass, &layout);
        for field in each {
            let group = self.group(effect, pass, settings, &layout, field)?;
            let work = match pass.kind {
                Kind::EachSun(knob, over) => Work::EachSun(EachSun {
                    pipeline: pipeline.clone(),
                    group,
                    scratch: self.scratch(effect, pass, settings)?,
                    points: self.points(settings.get(knob) as usize),
                    groups: match over {
                        Over::Pixels => None,
                        Over::Groups(count) => Some(count(settings)),
                    },
                }),
                _ => Work::Pixels(pipeline.clone(), group),
            };
            self.push(effect, pass, work, finds_surfaces);
        }
        Ok(())
    }

    /// What a pass leaves for the later ones of its effect: one buffer of each name.
    fn scratch(
        &mut self,
        effect: &'static str,
        pass: &Pass,
        settings: &Settings,
    ) -> Result<Option<BindGroup>> {
        let Some(layout) = self.pipelines.scratch(self.device, pass) else {
            return Ok(None);
        };
        let mut buffers = Vec::with_capacity(pass.scratch.len());
        for scratch in pass.scratch {
            let key = (effect, scratch.name);
            if !self.scratch.contains_key(&key) {
                let bytes = (scratch.bytes)(settings, self.pixels);
                let usage = BufferUsages::STORAGE;
                let made = self.device.buffer(scratch.name, bytes, usage)?;
                self.scratch.insert(key, made);
            }
            buffers.push(self.scratch[&key].clone());
        }
        let entries: Vec<BindGroupEntry> = buffers
            .iter()
            .zip(0..)
            .map(|(buffer, binding)| BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let group = self.device.device.create_bind_group(&BindGroupDescriptor {
            label: Some("scratch"),
            layout: &layout,
            entries: &entries,
        });
        Ok(Some(group))
    }

    pub(super) fn push(
        &mut self,
        effect: &'static str,
        pass: &Pass,
        work: Work<'a>,
        finds_surfaces: bool,
    ) {
        self.stages.push(Stage {
            effect,
            pass: pass.entry,
            work,
            finds_surfaces,
            runs: 0,
            on_cpu: Duration::ZERO,
            counted: [0; 2],
        });
    }

    /// Which points of the sun's disc stand for it when there are so many.
    fn points(&mut self, count: usize) -> Vec<usize> {
        let conditions = self.plan.conditions;
        let suns = conditions.sun_points(count);
        let maps = self
            .maps
            .as_mut()
            .expect("an effect that asks for the sun's maps runs only where the sun shines");
        suns.iter().map(|sun| maps.point(conditions, sun)).collect()
    }

    pub(super) fn sun_maps(
        &self,
        settings: &Settings,
        raster: Raster,
        group: BindGroup,
    ) -> Result<SunMaps> {
        let resolution = settings.get("resolution") as u32;
        let most = self.device.limits().max_texture_dimension_2d;
        if resolution > most {
            return Err(Error::domain(
                "shadow.resolution",
                resolution,
                format!("16 to {most} on {}", self.device.adapter.name),
                "set a lower one with --set shadow.resolution=N",
            ));
        }
        Ok(SunMaps {
            raster,
            group,
            split: Split {
                partitions: settings.get("partitions") as usize,
                logarithmic: settings.get("split"),
            },
            resolution: Resolution {
                density: settings.get("density"),
                most: resolution,
            },
            casters: self.triangles.corners(self.plan.conditions),
            corners: self
                .triangles
                .corner_texture(self.device, self.plan.conditions),
            points: Vec::new(),
            slots: Vec::new(),
            full: false,
            runs: 0,
        })
    }

    pub(super) fn group(
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
