//! Buffers that outlive a plan: fields and products, kept while the plans that follow name them.

use super::device::Device;
use super::draw::texture;
use super::shared::TREE_WIDTH;
use crate::conditions::{Conditions, Snapshot};
use crate::effect::{Life, Product, Settings};
use crate::error::{Error, Result};
use glam::{DVec3, UVec2};
use std::collections::HashMap;
use wgpu::*;

/// Products that no effect of the present plan names are kept up to this size [bytes].
const IDLE: u64 = 512 << 20;

/// A buffer, and whether the present plan names it.
struct Held {
    buffer: Buffer,
    usage: BufferUsages,
    named: bool,
}

/// What a kept product was made of.
struct MadeOf {
    snapshot: Snapshot,
    settings: Vec<(&'static str, f64)>,
    anchor: DVec3,
}

struct HeldProduct {
    held: Held,
    product: Product,
    /// As many as were asked for; the buffer may be larger.
    bytes: u64,
    /// Absent: it is not made yet.
    made_of: Option<MadeOf>,
    /// What it would be made of now.
    now: Option<MadeOf>,
}

/// Fields by their names, products by effect and name.
#[derive(Default)]
pub struct Store {
    buffers: HashMap<String, Held>,
    textures: HashMap<&'static str, (Texture, bool)>,
    products: HashMap<(&'static str, &'static str), HeldProduct>,
    faces: HashMap<&'static str, (Texture, bool)>,
}

impl Store {
    /// A new plan begins to name what it needs.
    pub fn begin(&mut self) {
        self.buffers
            .values_mut()
            .for_each(|held| held.named = false);
        self.products
            .values_mut()
            .for_each(|product| product.held.named = false);
        let textures = self.textures.values_mut().chain(self.faces.values_mut());
        textures.for_each(|(_, named)| *named = false);
    }

    /// Drops what the plan did not name, but for kept products that still hold: a later plan may ask for them again.
    pub fn finish(&mut self, conditions: &Conditions, anchor: DVec3) {
        self.buffers.retain(|_, held| held.named);
        let mut idle = 0;
        self.products.retain(|_, product| {
            let holds = product.made_of.as_ref().is_some_and(|made| {
                made.anchor == anchor
                    && made.snapshot.still_holds(conditions, product.product.reads)
            });
            if !product.held.named && holds {
                idle += product.held.buffer.size();
            }
            product.held.named || holds && idle <= IDLE
        });
        self.textures.retain(|_, (_, named)| *named);
        self.faces.retain(|_, (_, named)| *named);
    }

    /// A buffer of at least that size, the one of that name if it fits.
    pub fn buffer(
        &mut self,
        device: &Device,
        name: &str,
        bytes: u64,
        usage: BufferUsages,
    ) -> Result<Buffer> {
        if let Some(held) = self.buffers.get_mut(name)
            && fits(&held.buffer, bytes)
            && held.usage == usage
        {
            held.named = true;
            return Ok(held.buffer.clone());
        }
        let buffer = device.buffer(name, bytes, usage)?;
        let held = Held {
            buffer: buffer.clone(),
            usage,
            named: true,
        };
        self.buffers.insert(name.to_owned(), held);
        Ok(buffer)
    }

    /// A buffer with contents.
    pub fn filled(
        &mut self,
        device: &Device,
        name: &str,
        bytes: &[u8],
        usage: BufferUsages,
    ) -> Result<Buffer> {
        let usage = usage | BufferUsages::COPY_DST;
        let buffer = self.buffer(device, name, bytes.len() as u64, usage)?;
        device.write(&buffer, bytes);
        Ok(buffer)
    }

    /// A texture, the one of that name if it is as large.
    pub fn texture(
        &mut self,
        device: &Device,
        name: &'static str,
        size: UVec2,
        format: TextureFormat,
        usage: TextureUsages,
    ) -> Texture {
        if let Some((texture, named)) = self.textures.get_mut(name)
            && UVec2::new(texture.width(), texture.height()) == size
        {
            *named = true;
            return texture.clone();
        }
        let made = texture(device, name, size, 1, format, usage);
        self.textures.insert(name, (made.clone(), true));
        made
    }

    /// A texture of numbers, in rows of [`TREE_WIDTH`], the one of that name if it has as many rows.
    pub fn texels(
        &mut self,
        device: &Device,
        name: &'static str,
        mut texels: Vec<[f32; 4]>,
    ) -> Result<Texture> {
        let rows = texels.len().div_ceil(TREE_WIDTH as usize).max(1) as u32;
        let most = device.limits().max_texture_dimension_2d;
        if rows > most {
            return Err(Error::failed(
                format!(
                    "the numbers of `{name}` fill {rows} rows of a texture, and the adapter takes {most}"
                ),
                "use `--backend reference`, another adapter, or fewer lamps",
            ));
        }
        texels.resize((rows * TREE_WIDTH) as usize, [0.0; 4]);
        let size = UVec2::new(TREE_WIDTH, rows);
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let made = self.texture(device, name, size, TextureFormat::Rgba32Float, usage);
        let bytes: &[u8] = bytemuck::cast_slice(&texels);
        device.count(|traffic| traffic.uploaded += bytes.len() as u64);
        device.queue.write_texture(
            made.as_image_copy(),
            bytes,
            TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(16 * size.x),
                rows_per_image: None,
            },
            made.size(),
        );
        Ok(made)
    }

    /// The buffer of a product.
    #[allow(clippy::too_many_arguments)] // all of them decide whether what is there still holds
    pub fn product(
        &mut self,
        device: &Device,
        conditions: &Conditions,
        anchor: DVec3,
        effect: &'static str,
        product: &Product,
        settings: &Settings<'_>,
        bytes: u64,
    ) -> Result<Buffer> {
        let key = (effect, product.name);
        let kept = product.life() == Life::Kept;
        let now = kept.then(|| MadeOf {
            snapshot: conditions.snapshot(product.reads),
            settings: settings.values.to_vec(),
            anchor,
        });
        if let Some(known) = self.products.get_mut(&key)
            && fits(&known.held.buffer, bytes)
        {
            known.held.named = true;
            known.bytes = bytes;
            let holds = known.made_of.as_ref().is_some_and(|made| {
                made.anchor == anchor
                    && made.settings == settings.values
                    && made.snapshot.still_holds(conditions, product.reads)
            });
            if !holds {
                known.made_of = None;
            }
            known.now = now;
            return Ok(known.held.buffer.clone());
        }
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let buffer = device.buffer(product.name, bytes, usage)?;
        let held = HeldProduct {
            held: Held {
                buffer: buffer.clone(),
                usage,
                named: true,
            },
            product: *product,
            bytes,
            made_of: None,
            now,
        };
        self.products.insert(key, held);
        Ok(buffer)
    }

    /// Whether a kept product must be made.
    pub fn is_stale(&self, effect: &'static str, name: &'static str) -> bool {
        let found = self.products.get(&(effect, name));
        found.is_some_and(|product| product.made_of.is_none())
    }

    /// Lets a kept product be made again, from the beginning.
    pub fn spoil(&mut self, effect: &'static str, name: &'static str) {
        if let Some(product) = self.products.get_mut(&(effect, name)) {
            product.made_of = None;
        }
    }

    /// Lets all kept products be made again.
    pub fn forget(&mut self) {
        self.products.values_mut().for_each(|p| p.made_of = None);
    }

    /// Says that a kept product is made.
    pub fn made(&mut self, effect: &'static str, name: &'static str) {
        if let Some(product) = self.products.get_mut(&(effect, name))
            // Several passes may have made it together.
            && let Some(now) = product.now.take()
        {
            product.made_of = Some(now);
        }
    }

    /// The buffer of a product that the plan names, and its bytes.
    pub fn buffer_of(&self, effect: &'static str, name: &'static str) -> Option<(&Buffer, u64)> {
        let product = self.products.get(&(effect, name))?;
        Some((&product.held.buffer, product.bytes))
    }

    /// The buffers of products of such a life that begin as zeros: of kept ones those that are to be made.
    pub fn zeroed(&self, life: Life) -> impl Iterator<Item = &Buffer> {
        let products = self.products.values();
        products
            .filter(move |p| p.product.zeroed && p.product.life() == life && p.made_of.is_none())
            .map(|p| &p.held.buffer)
    }

    /// The faces of an effect's hemicube, of so many texels on a side; 0: those that it has.
    pub fn faces(&mut self, device: &Device, effect: &'static str, side: u32) -> Result<Texture> {
        if let Some((faces, named)) = self.faces.get_mut(effect)
            && (side == 0 || faces.width() == side)
        {
            *named = true;
            return Ok(faces.clone());
        }
        let most = device.limits().max_texture_dimension_2d;
        if side == 0 || side > most {
            return Err(Error::failed(
                format!("a hemicube of {side} texels on a side cannot be drawn"),
                format!("draw it before it is read, with 1 to {most} texels"),
            ));
        }
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let format = TextureFormat::R32Uint;
        let faces = texture(device, "hemicube", UVec2::splat(side), 5, format, usage);
        self.faces.insert(effect, (faces.clone(), true));
        Ok(faces)
    }
}

/// Whether a buffer is large enough, and not so large that most of it would lie idle.
fn fits(buffer: &Buffer, bytes: u64) -> bool {
    buffer.size() >= bytes && buffer.size() <= 2 * bytes.max(4096)
}
