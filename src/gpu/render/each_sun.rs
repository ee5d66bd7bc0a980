//! Passes that run once for each point of the sun's disc, and the shadow maps of that point.

use super::*;

/// Sides of maps are multiples of this [texels].
const SIDES: u32 = 256;

impl Gpu<'_> {
    /// How many stages from this one on run in turns, point of the sun by point: those of one effect that follow each other.
    pub(super) fn together(&self, first: usize) -> usize {
        let of = |stage: &Stage| match &stage.work {
            Work::EachSun(_) => Some(stage.effect),
            _ => None,
        };
        let Some(effect) = of(&self.stages[first]) else {
            return 1;
        };
        self.stages[first..]
            .iter()
            .take_while(|stage| of(stage) == Some(effect))
            .count()
    }

    pub(super) fn run_each_sun(
        &mut self,
        stages: std::ops::Range<usize>,
        extent: UVec2,
    ) -> Result<()> {
        let suns = match &self.stages[stages.start].work {
            Work::EachSun(each) => each.suns.clone(),
            _ => Vec::new(),
        };
        for sun in &suns {
            let slot = self.maps_for(sun)?;
            for index in stages.clone() {
                let stage = &mut self.stages[index];
                stage.runs += 1;
                let (Work::EachSun(each), Some(maps)) = (&stage.work, &self.maps) else {
                    continue;
                };
                let mut groups = vec![&self.common, &each.group, &maps.slots[slot].ask];
                groups.extend(&each.scratch);
                let over = each.groups.unwrap_or(tile_groups(extent));
                let pipeline = &each.pipeline;
                dispatch(
                    &self.device,
                    &mut self.timer,
                    index,
                    pipeline,
                    &groups,
                    over,
                )?;
                self.take_counts(index)?;
            }
        }
        Ok(())
    }

    /// Adds what the last pass counted to its stage, if it did.
    fn take_counts(&mut self, index: usize) -> Result<()> {
        let Some(counts) = &self.counts else {
            return Ok(());
        };
        let mut encoder = self
            .device
            .device
            .create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(counts, 0, &self.staging, 0, 8);
        encoder.clear_buffer(counts, 0, None);
        self.device.queue.submit([encoder.finish()]);
        let bytes = self.device.read(&self.staging, 8)?;
        for (sum, word) in self.stages[index].counted.iter_mut().zip(0..) {
            *sum += u64::from(float(&bytes, word).to_bits());
        }
        Ok(())
    }

    /// The slot that holds the maps of a point of the sun, drawn unless they are there.
    fn maps_for(&mut self, sun: &SunPoint) -> Result<usize> {
        let maps = self
            .maps
            .as_mut()
            .expect("an effect that asks for the sun's maps runs only where the sun shines");
        let mut light = light::fit(
            self.plan.conditions,
            &maps.casters,
            sun,
            maps.split,
            maps.resolution,
        );
        // Points of one disc ask for nearly the same.
        let side = (light.side as u32)
            .next_multiple_of(SIDES)
            .min(maps.resolution.most);
        let bytes = 8 * u64::from(side).pow(2) * maps.split.partitions as u64;
        let kept = maps.slots.iter().position(|slot| slot.toward == sun.toward);
        let index = match kept {
            Some(index) => index,
            None if maps.slots.is_empty() || (maps.slots.len() as u64 + 1) * bytes <= KEPT_MAPS => {
                let slot = maps.slot(&self.device, &self.pipelines, side)?;
                maps.slots.push(slot);
                maps.slots.len() - 1
            }
            // The last one changes hands: when points are gone through in turns, the others stay.
            None => maps.slots.len() - 1,
        };
        if maps.slots[index].side < side {
            maps.slots[index] = maps.slot(&self.device, &self.pipelines, side)?;
        }
        let slot = &mut maps.slots[index];
        light.side = slot.side as f32;
        // The same direction may come with another share of the light.
        self.device.write(&slot.light, &shared::uniform(&light));
        if slot.filled && slot.toward == sun.toward {
            return Ok(index);
        }
        (slot.toward, slot.filled) = (sun.toward, true);
        for (k, map) in (0..light.partitions).zip(&light.maps) {
            maps.runs += 1;
            let (depth, color) = &maps.slots[index].views[k as usize];
            let draw = Draw {
                raster: &maps.raster,
                groups: &[&self.common, &maps.group, &maps.slots[index].draw],
                corners: &self.corners,
                triangles: &self.triangles,
                color,
                depth,
                far: 1.0,
                instance: k,
                within: map.size.as_uvec2(),
            };
            draw.submit(&self.device, &mut self.timer, self.stages.len())?;
        }
        Ok(index)
    }
}
