//! Beams on the device: what shaders know of each, and its shadow maps, kept over tiles and frames while there is room.

use super::device::Device;
use super::draw::{Draw, texture};
use super::maps;
use super::pipeline::{Pipelines, Raster};
use super::seen::Seen;
use super::shared;
use super::timer::Timer;
use crate::beam::Beam;
use crate::conditions::Conditions;
use crate::effect::{Effect, MapSettings};
use crate::error::Result;
use glam::{DVec3, UVec2};
use wgpu::*;

/// Shadow maps of several beams are kept up to this size [bytes].
const KEPT_MAPS: u64 = 2 << 30;

/// Sides of maps are multiples of this [texels].
const SIDES: u32 = 256;

/// The maps of one beam.
struct Slot {
    /// What they were drawn for, and from which eye it was told.
    drawn: Option<(shared::Beam, DVec3)>,
    /// Of each map [texels].
    side: u32,
    uniform: Buffer,
    /// Depths and casters of each partition.
    views: Vec<(TextureView, TextureView)>,
    draw: BindGroup,
    ask: BindGroup,
}

/// The maps of several beams.
#[derive(Default)]
pub struct Slots {
    slots: Vec<Slot>,
    /// Whether the device had no room for one more.
    full: bool,
}

impl Slots {
    /// Lets all maps be drawn again.
    pub fn forget(&mut self) {
        self.slots.iter_mut().for_each(|slot| slot.drawn = None);
    }
}

/// How the maps of a plan's beams are drawn.
pub struct BeamMaps {
    pub effect: &'static Effect,
    pub pass: &'static str,
    pub raster: Raster,
    pub group: BindGroup,
    pub settings: MapSettings,
    /// Corners of casters, as shaders read them.
    pub corners: Texture,
    /// The beams of all effects, and what shaders know of each.
    pub beams: Vec<(Beam, shared::Beam)>,
    /// How far the picture's rays see, once it is asked for.
    pub seen: Option<Seen>,
    pub runs: u32,
}

impl BeamMaps {
    /// The number of a beam, whichever effect asks for it first. It has maps once a pass asks these.
    pub fn number(
        &mut self,
        conditions: &Conditions,
        casters: &[DVec3],
        anchor: DVec3,
        beam: &Beam,
        mapped: bool,
    ) -> usize {
        let known = self.beams.iter().position(|(other, _)| other == beam);
        let index = known.unwrap_or(self.beams.len());
        if known.is_none() {
            self.beams.push((*beam, maps::unmapped(conditions, beam)));
        }
        let (_, fitted) = &mut self.beams[index];
        if mapped && fitted.partitions == 0 {
            let seen = self.seen.get_or_insert_with(|| Seen::of(conditions));
            *fitted = maps::fit(conditions, seen, casters, anchor, beam, &self.settings);
        }
        index
    }

    /// A slot with so many maps of this side.
    fn slot(&self, device: &Device, pipelines: &Pipelines, side: u32, count: u32) -> Result<Slot> {
        let uniform = device.buffer(
            "a beam",
            shared::uniform(&shared::Beam::default()).len() as u64,
            BufferUsages::UNIFORM | BufferUsages::COPY_DST,
        )?;
        let layers = |label, format| {
            texture(
                device,
                label,
                UVec2::splat(side),
                count,
                format,
                TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
            )
        };
        let depths = layers("shadow maps", TextureFormat::Depth32Float);
        let casters = layers("casters in shadow maps", TextureFormat::R32Uint);
        let layer = |maps: &Texture, layer| {
            maps.create_view(&TextureViewDescriptor {
                dimension: Some(TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            })
        };
        let views = (0..count)
            .map(|k| (layer(&depths, k), layer(&casters, k)))
            .collect();
        let all = |maps: &Texture| {
            maps.create_view(&TextureViewDescriptor {
                dimension: Some(TextureViewDimension::D2Array),
                ..Default::default()
            })
        };
        let all = [
            all(&depths),
            all(&casters),
            self.corners.create_view(&Default::default()),
        ];
        let entry = BindGroupEntry {
            binding: 0,
            resource: uniform.as_entire_binding(),
        };
        let group = |layout, entries: &[BindGroupEntry]| {
            device.device.create_bind_group(&BindGroupDescriptor {
                label: Some("a beam"),
                layout,
                entries,
            })
        };
        let mut ask = vec![entry.clone()];
        ask.extend(all.iter().zip(1..).map(|(view, binding)| BindGroupEntry {
            binding,
            resource: BindingResource::TextureView(view),
        }));
        Ok(Slot {
            drawn: None,
            side,
            draw: group(&pipelines.beam, &[entry]),
            ask: group(&pipelines.lit, &ask),
            uniform,
            views,
        })
    }
}

/// What maps are drawn with.
pub struct Drawing<'d> {
    pub device: &'d Device,
    pub pipelines: &'d Pipelines,
    pub common: &'d BindGroup,
    pub corners: &'d Buffer,
    /// How many triangles have no holes, and how many there are.
    pub triangles: [u32; 2],
    pub timer: &'d mut Timer,
    /// Under which number it counts.
    pub number: usize,
    /// The eye [m], to which what shaders know of a beam is relative.
    pub eye: DVec3,
}

impl Slots {
    /// The bind group through which shaders ask a beam and its maps, which are drawn unless they are there.
    pub fn maps_of(
        &mut self,
        number: usize,
        maps: &mut BeamMaps,
        drawing: Drawing<'_>,
    ) -> Result<BindGroup> {
        let Drawing {
            device, pipelines, ..
        } = drawing;
        let (beam, fitted) = maps.beams[number];
        let slots = self;
        // Beams of one disc ask for nearly the same.
        let side = (fitted.side as u32)
            .next_multiple_of(SIDES)
            .min(maps.settings.most);
        let layers = fitted.partitions.max(1);
        let bytes = |side: u32, layers: u64| 8 * u64::from(side).pow(2) * layers;
        let now = Some((fitted, drawing.eye));
        let fits = |slot: &Slot| match fitted.kind {
            // As fine as a fresh one: pictures do not depend on what was before.
            shared::LOCAL => slot.side == side,
            _ => slot.side >= side && slot.views.len() >= layers as usize,
        };
        // What this plan has no beam for is the first to go.
        let wanted = &maps.beams;
        let is_stale = |slot: &Slot| {
            let of_plan = |(beam, eye): (shared::Beam, DVec3)| {
                eye == drawing.eye && wanted.iter().any(|(_, other)| *other == beam)
            };
            !slot.drawn.is_some_and(of_plan)
        };
        let all = |slots: &Slots| -> u64 {
            let sizes = slots.slots.iter();
            sizes
                .map(|slot| bytes(slot.side, slot.views.len() as u64))
                .sum()
        };
        let mut index = slots.slots.iter().position(|slot| slot.drawn == now);
        index = index.or_else(|| slots.slots.iter().position(|s| is_stale(s) && fits(s)));
        while index.is_none() {
            let room = all(slots) + bytes(side, u64::from(layers)) <= KEPT_MAPS;
            if slots.slots.is_empty() || room && !slots.full {
                device.check()?;
                let made = maps.slot(device, pipelines, side, layers);
                match made.and_then(|slot| device.check().map(|()| slot)) {
                    Ok(slot) => {
                        slots.slots.push(slot);
                        index = Some(slots.slots.len() - 1);
                    }
                    Err(error) if slots.slots.is_empty() => return Err(error),
                    // A device that has no room for one more still has those that it has.
                    Err(_) => slots.full = true,
                }
                continue;
            }
            match slots.slots.iter().position(&is_stale) {
                Some(stale) => {
                    slots.slots.remove(stale);
                    slots.full = false;
                }
                // The last one changes hands: when beams are gone through in turns, the others stay.
                None => index = Some(slots.slots.len() - 1),
            }
        }
        let index = index.unwrap_or(0);
        if !fits(&slots.slots[index]) {
            slots.slots[index] = maps.slot(device, pipelines, side, layers)?;
        }
        let slot = &mut slots.slots[index];
        let uniform = shared::Beam {
            side: slot.side as f32,
            // The same direction may come with another share of the light.
            strength: beam.strength().as_vec3(),
            ..fitted
        };
        device.write(&slot.uniform, &shared::uniform(&uniform));
        if slot.drawn != now {
            slot.drawn = None;
            for k in 0..fitted.partitions {
                maps.runs += 1;
                let (depth, color) = &slot.views[k as usize];
                let within = match fitted.kind {
                    shared::LOCAL => UVec2::splat(slot.side),
                    _ => fitted.maps[k as usize].size.as_uvec2(),
                };
                let draw = Draw {
                    raster: &maps.raster,
                    groups: &[drawing.common, &maps.group, &slot.draw],
                    corners: drawing.corners,
                    triangles: drawing.triangles,
                    color,
                    depth,
                    far: 0.0,
                    instance: k,
                    within,
                };
                draw.submit(device, drawing.timer, drawing.number)?;
            }
            slot.drawn = now;
        }
        Ok(slot.ask.clone())
    }
}
