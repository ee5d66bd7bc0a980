//! What passes that run in parts leave to the reference: pixels that have more to do than a run may take.

use super::job::{CHUNK, Job, float, pixel_of};
use super::prepare::Work;
use crate::effect::Fields;
use crate::error::Result;
use crate::scene::Ray;
use glam::{DVec3, UVec2};
use rayon::prelude::*;
use std::time::Instant;

impl Job<'_> {
    /// Lets the reference do the pixels of a tile that the passes before have marked.
    pub(super) fn do_rest(
        &mut self,
        index: usize,
        corner: UVec2,
        extent: UVec2,
        rays: &[Ray],
    ) -> Result<()> {
        let Work::Rest(_, field) = self.stages[index].work else {
            return Ok(());
        };
        let mut bytes = self.read(&[field])?;
        let marked: Vec<usize> = (0..rays.len())
            .filter(|i| float(&bytes, 4 * i + 3) != 0.0)
            .collect();
        if marked.is_empty() {
            return Ok(());
        }
        let known = match self.on_cpu.take() {
            Some(known) => known,
            None => self.rays_on_cpu(corner, extent, rays)?,
        };
        let start = Instant::now();
        let stage = &self.stages[index];
        let Work::Rest(batch, _) = &stage.work else {
            return Ok(());
        };
        // Few, and each takes long.
        const FEW: usize = 16;
        let found: Result<Vec<Vec<DVec3>>> = marked
            .par_chunks(FEW)
            .map(|few| {
                self.task.check()?;
                let own = few.iter().map(|i| rays[*i]).collect();
                let pixels = few.iter().map(|i| pixel_of(*i, corner, extent)).collect();
                let mut fields = Fields::new(own, pixels, vec![self.sample; few.len()], &[field]);
                let surface = |i: &usize| known[i / CHUNK].surfaces[i % CHUNK];
                fields.surfaces = few.iter().map(surface).collect();
                batch(&mut fields);
                Ok(fields.found(field).unwrap_or_default().to_vec())
            })
            .collect();
        for (i, value) in marked.iter().zip(found?.into_iter().flatten()) {
            let pixel: &mut [u8] = &mut bytes[16 * i..16 * i + 16];
            let value = value.as_vec3().extend(0.0).to_array();
            pixel.copy_from_slice(bytemuck::cast_slice(&value));
        }
        if let Some(target) = self.fields.iter().find(|target| target.field == field) {
            self.device.write(&target.buffer, &bytes);
        }
        self.on_cpu = Some(known);
        let stage = &mut self.stages[index];
        stage.on_cpu += start.elapsed();
        stage.runs += 1;
        *self.left_over.entry(stage.effect.name).or_default() += marked.len();
        Ok(())
    }

    /// How much was left to the reference, in words.
    pub(super) fn notes_of_rest(&self) -> Vec<String> {
        let all = u64::from(self.plan.conditions.view.size[0])
            * u64::from(self.plan.conditions.view.size[1])
            * u64::from(self.plan.conditions.view.samples);
        let note = |(effect, rays): (&&str, &usize)| {
            format!(
                "{effect}: {rays} of {all} rays had more to do than a run of its shader may take, and were left to the reference"
            )
        };
        self.left_over.iter().map(note).collect()
    }
}
