//! What the CPU does of a tile: effects without passes, panoramas, points, and pixels at silhouettes or behind what lets light
//! through.

use super::draw::numbers_pitch;
use super::job::{CHUNK, Job, float, pixel_of, surface_word};
use super::prepare::Work;
use super::shared;
use crate::colour::Space;
use crate::conditions::Receivers;
use crate::effect::visibility::{ground_surface, known_surface, receiver_surface};
use crate::effect::{Field, Fields};
use crate::error::Result;
use crate::scene::Ray;
use crate::scene::opacity::choice;
use glam::{DVec3, UVec2};
use rayon::prelude::*;
use std::time::Instant;
use wgpu::*;

impl Job<'_> {
    /// Runs an effect without passes on the fields as the effects before it left them.
    pub(super) fn run_host(
        &mut self,
        index: usize,
        corner: UVec2,
        extent: UVec2,
        rays: &[Ray],
    ) -> Result<()> {
        let mut chunks = match self.on_cpu.take() {
            Some(chunks) => chunks,
            None => self.rays_on_cpu(corner, extent, rays)?,
        };
        let Work::Host(host) = &self.stages[index].work else {
            return Ok(());
        };
        let (fetch, bring) = (host.fetch.clone(), host.bring.clone());
        if !fetch.is_empty() {
            let bytes = self.read(&fetch)?;
            let mut at = 0;
            for target in self.fields.iter().filter(|t| fetch.contains(&t.field)) {
                for (c, chunk) in chunks.iter_mut().enumerate() {
                    let values = (0..chunk.rays.len()).map(|i| {
                        let word = at / 4 + 4 * (c * CHUNK + i);
                        let value = |k| f64::from(float(&bytes, word + k));
                        DVec3::new(value(0), value(1), value(2))
                    });
                    chunk.put(target.field, values.collect());
                }
                at += target.bytes as usize;
            }
        }
        let stage = &mut self.stages[index];
        if let Work::Host(host) = &stage.work {
            for chunk in &mut chunks {
                let effect = stage.effect;
                chunk.name(effect.reads, [effect.writes, effect.alters]);
            }
            let start = Instant::now();
            chunks.par_iter_mut().try_for_each(|chunk| {
                self.task.check()?;
                (host.batch)(chunk);
                Ok(())
            })?;
            stage.on_cpu += start.elapsed();
            stage.runs += 1;
            for paid in chunks.iter_mut().filter_map(Fields::take_paid) {
                stage.paid = Some(stage.paid.unwrap_or_default().and(paid));
            }
        }
        for field in bring {
            let values: Vec<[f32; 4]> = chunks
                .iter()
                .flat_map(|fields| fields.found(field).into_iter().flatten())
                .map(|v| v.as_vec3().extend(0.0).to_array())
                .collect();
            if let Some(target) = self.fields.iter().find(|t| t.field == field) {
                self.device
                    .write(&target.buffer, bytemuck::cast_slice(&values));
            }
        }
        self.on_cpu = Some(chunks);
        Ok(())
    }

    /// The tile's rays with what they meet, as the device has found it.
    pub(super) fn rays_on_cpu(
        &self,
        corner: UVec2,
        extent: UVec2,
        rays: &[Ray],
    ) -> Result<Vec<Fields>> {
        let conditions = self.plan.conditions;
        let bytes = self.read(&[Field::Surface])?;
        let working = Space::Rec709.to_working();
        let triangles = &self.triangles.numbers;
        let mut chunks: Vec<Fields> = (0..rays.len())
            .step_by(CHUNK)
            .map(|from| {
                let to = (from + CHUNK).min(rays.len());
                let pixels = (from..to).map(|i| pixel_of(i, corner, extent)).collect();
                let samples = vec![self.sample; to - from];
                Fields::new(rays[from..to].to_vec(), pixels, samples, &self.written)
            })
            .collect();
        chunks.par_iter_mut().enumerate().for_each(|(c, fields)| {
            for (i, surface) in fields.surfaces.iter_mut().enumerate() {
                let ray = &fields.rays[i];
                let number = surface_word(&bytes, c * CHUNK + i, 7).to_bits();
                *surface = match (&conditions.view.receivers, number) {
                    (Receivers::Points(_), _) => {
                        receiver_surface(&conditions.view, fields.pixels[i])
                    }
                    (_, shared::NOTHING | shared::GROUND) => ground_surface(conditions, ray),
                    (_, n) => known_surface(
                        conditions,
                        ray,
                        triangles[(n - shared::GROUND) as usize - 1],
                        working,
                    ),
                };
            }
        });
        Ok(chunks)
    }

    /// Puts the points whose illuminance is wanted in the place of what rays meet.
    pub(super) fn write_points(&self, corner: UVec2, extent: UVec2) {
        let view = &self.plan.conditions.view;
        let surfaces: Vec<shared::Surface> = (0..(extent.x * extent.y) as usize)
            .map(|i| {
                let surface = receiver_surface(view, pixel_of(i, corner, extent));
                match surface.is_met() {
                    false => shared::Surface::default(),
                    true => shared::Surface {
                        normal: surface.normal.as_vec3(),
                        distance: surface.distance as f32,
                        facet: surface.facet.as_vec3(),
                        number: shared::GROUND,
                        albedo: surface.albedo.as_vec3(),
                    },
                }
            })
            .collect();
        if let Some(target) = self.fields.iter().find(|t| t.field == Field::Surface) {
            self.device.write(&target.buffer, &shared::list(&surfaces));
        }
    }

    /// Finds the triangles of a panorama, which cannot be rasterised.
    pub(super) fn draw_by_cpu(
        &mut self,
        index: usize,
        corner: UVec2,
        extent: UVec2,
        rays: &[Ray],
    ) -> Result<()> {
        let start = Instant::now();
        let geometry = &self.plan.conditions.geometry;
        let (triangles, sample) = (self.triangles, self.sample);
        let numbers: Vec<u32> = rays
            .par_iter()
            .enumerate()
            .with_min_len(CHUNK)
            .map(|(i, ray)| {
                let choice = choice(pixel_of(i, corner, extent).to_array(), sample);
                triangles.number_met(geometry, ray, choice)
            })
            .collect();
        self.write_numbers(&numbers, extent);
        let stage = &mut self.stages[index];
        stage.runs += 1;
        stage.on_cpu += start.elapsed();
        Ok(())
    }

    /// Traces the rays of pixels that show a surface which lets light through, and of those at silhouettes if they are wanted. A
    /// rasteriser rounds corners to parts of a pixel, so that one pixel in some hundreds of them would show what stands beside its
    /// ray: there the light of the air may be another altogether.
    pub(super) fn trace_some(
        &mut self,
        index: usize,
        corner: UVec2,
        extent: UVec2,
        rays: &[Ray],
        silhouettes: bool,
    ) -> Result<()> {
        let drawn = self.read_numbers(extent)?;
        let start = Instant::now();
        let geometry = &self.plan.conditions.geometry;
        let (triangles, sample) = (self.triangles, self.sample);
        let planes = self.planes;
        let (w, h) = (extent.x as i32, extent.y as i32);
        let numbers: Vec<u32> = (0..w * h)
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| {
                let own = drawn[i as usize];
                let (x, y) = (i % w, i / w);
                let ray = &rays[i as usize];
                let at = |number: u32| planes[number as usize - 1].distance(ray);
                let beside = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
                let is_silhouette = silhouettes
                    && beside
                        .filter(|(x, y)| (0..w).contains(x) && (0..h).contains(y))
                        .map(|(x, y)| drawn[(y * w + x) as usize])
                        .filter(|other| *other != own)
                        .any(|other| {
                            // Two planes that the ray meets at one place are a crease, which hides nothing.
                            own == 0 || other == 0 || {
                                let (own, other) = (at(own), at(other));
                                (own - other).abs() > 0.01 * own.abs() || !other.is_finite()
                            }
                        });
                if is_silhouette || triangles.is_veil(own) {
                    let choice = choice(pixel_of(i as usize, corner, extent).to_array(), sample);
                    triangles.number_met(geometry, ray, choice)
                } else {
                    own
                }
            })
            .collect();
        if numbers != drawn {
            self.write_numbers(&numbers, extent);
        }
        self.stages[index].on_cpu += start.elapsed();
        Ok(())
    }

    /// The numbers of the tile's triangles, as they were drawn.
    fn read_numbers(&self, extent: UVec2) -> Result<Vec<u32>> {
        let pitch = numbers_pitch(extent.x);
        let mut encoder = self
            .device
            .device
            .create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            self.numbers.as_image_copy(),
            TexelCopyBufferInfo {
                buffer: &self.staging,
                layout: TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(pitch),
                    rows_per_image: None,
                },
            },
            Extent3d {
                width: extent.x,
                height: extent.y,
                depth_or_array_layers: 1,
            },
        );
        self.device.queue.submit([encoder.finish()]);
        let bytes = self
            .device
            .read(&self.staging, u64::from(pitch) * u64::from(extent.y))?;
        Ok(bytes
            .chunks_exact(pitch as usize)
            .flat_map(|row| bytemuck::pod_collect_to_vec::<u8, u32>(&row[..4 * extent.x as usize]))
            .collect())
    }

    fn write_numbers(&self, numbers: &[u32], extent: UVec2) {
        let bytes: &[u8] = bytemuck::cast_slice(numbers);
        self.device.count(|t| t.uploaded += bytes.len() as u64);
        self.device.queue.write_texture(
            self.numbers.as_image_copy(),
            bytes,
            TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * extent.x),
                rows_per_image: None,
            },
            Extent3d {
                width: extent.x,
                height: extent.y,
                depth_or_array_layers: 1,
            },
        );
    }
}
