//! The buffers of a tile: what shaders see of it, and the fields that they leave.

use super::device::Device;
use super::draw::numbers_pitch;
use super::pipeline::Pipelines;
use super::scene::media;
use super::shared;
use super::store::Store;
use crate::effect::{Field, TILE};
use crate::error::Result;
use crate::plan::Plan;
use glam::UVec2;
use wgpu::*;

/// A field of a tile.
pub struct Target {
    pub field: Field,
    pub buffer: Buffer,
    pub bytes: u64,
}

/// What shaders see of a tile, and what they leave of it.
pub struct TileBuffers {
    pub tile: UVec2,
    pub tile_view: Buffer,
    pub rays: Buffer,
    pub common: BindGroup,
    pub numbers: Texture,
    pub depth: TextureView,
    pub fields: Vec<Target>,
    pub staging: Buffer,
    pub counts: Option<Buffer>,
}

impl TileBuffers {
    pub fn new(
        plan: &Plan,
        device: &Device,
        pipelines: &Pipelines,
        store: &mut Store,
        counting: bool,
    ) -> Result<Self> {
        let conditions = plan.conditions;
        let tile = UVec2::from(conditions.view.size).min(UVec2::splat(TILE));
        let pixels = u64::from(tile.x) * u64::from(tile.y);
        let copied = BufferUsages::COPY_DST;
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | copied;
        let mut buffer = |name, bytes, usage| store.buffer(device, name, bytes, usage);
        let tile_bytes = shared::uniform(&shared::TileView::default()).len() as u64;
        let tile_view = buffer("the tile", tile_bytes, BufferUsages::UNIFORM | copied)?;
        let rays = buffer("the rays", 16 * pixels, BufferUsages::STORAGE | copied)?;
        let counts = match counting {
            true => Some(buffer("counts", 8, storage)?),
            false => None,
        };
        let mut fields = Vec::new();
        for field in plan.written() {
            let bytes = match field {
                Field::Surface => shared::SURFACE_BYTES * pixels,
                _ => 16 * pixels,
            };
            fields.push(Target {
                field,
                buffer: buffer(field.name(), bytes, storage)?,
                bytes,
            });
        }
        let all: u64 = fields.iter().map(|f| f.bytes).sum();
        let staging = buffer(
            "what is read back",
            all.max(u64::from(numbers_pitch(tile.x)) * u64::from(tile.y)),
            BufferUsages::MAP_READ | copied,
        )?;
        let mut air = media(conditions);
        if air.is_empty() {
            air.push(shared::Medium::default());
        }
        let air = shared::list(&air);
        let air = store.filled(device, "the media", &air, BufferUsages::STORAGE)?;
        let common = device.device.create_bind_group(&BindGroupDescriptor {
            label: Some("tile, rays, media, counts"),
            layout: pipelines.common(counting),
            entries: &[&tile_view, &rays, &air]
                .into_iter()
                .chain(&counts)
                .zip(0..)
                .map(|(buffer, binding)| BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect::<Vec<_>>(),
        });
        let drawn = TextureUsages::RENDER_ATTACHMENT;
        let numbers = store.texture(
            device,
            "numbers",
            tile,
            TextureFormat::R32Uint,
            drawn
                | TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_DST
                | TextureUsages::COPY_SRC,
        );
        let depth = store.texture(device, "depth", tile, TextureFormat::Depth32Float, drawn);
        Ok(TileBuffers {
            tile,
            tile_view,
            rays,
            common,
            numbers,
            depth: depth.create_view(&Default::default()),
            fields,
            staging,
            counts,
        })
    }
}
