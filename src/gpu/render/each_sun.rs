//! Passes that run once for each point of the sun's disc, and the shadow maps of that point.

use super::*;

/// Sides of maps are multiples of this [texels].
const SIDES: u32 = 256;

impl SunMaps {
    /// The number of a point of the sun's disc, whichever effect asks for it first.
    pub(super) fn point(&mut self, conditions: &Conditions, sun: &SunPoint) -> usize {
        let known = self.points.iter().position(|(point, _)| point == sun);
        known.unwrap_or_else(|| {
            let light = light::fit(conditions, &self.casters, sun, self.split, self.resolution);
            self.points.push((*sun, light));
            self.points.len() - 1
        })
    }
}

impl Gpu<'_> {
    /// Runs all passes of all effects that run for each point of the sun's disc, point by point, so that each point's maps are
    /// drawn once for all that ask for them. Effects with as many points have the same ones.
    pub(super) fn run_each_sun(&mut self, extent: UVec2) -> Result<()> {
        let count = self.maps.as_ref().map_or(0, |maps| maps.points.len());
        for point in 0..count {
            let slot = self.maps_for(point)?;
            for index in 0..self.stages.len() {
                let stage = &mut self.stages[index];
                let (Work::EachSun(each), Some(maps)) = (&stage.work, &self.maps) else {
                    continue;
                };
                if !each.points.contains(&point) {
                    continue;
                }
                stage.runs += 1;
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
    fn maps_for(&mut self, point: usize) -> Result<usize> {
        let maps = self.maps.as_mut().expect("a point has maps");
        let (sun, mut light) = maps.points[point];
        // Points of one disc ask for nearly the same.
        let side = (light.side as u32)
            .next_multiple_of(SIDES)
            .min(maps.resolution.most);
        let layers = light.partitions.max(1);
        let bytes = |side: u32, layers: u64| 8 * u64::from(side).pow(2) * layers;
        let kept = maps.slots.iter().position(|slot| slot.toward == sun.toward);
        let sizes = maps.slots.iter();
        let sizes = sizes.map(|slot| bytes(slot.side, slot.views.len() as u64));
        let room = sizes.sum::<u64>() + bytes(side, u64::from(layers)) <= KEPT_MAPS;
        if kept.is_none() && (maps.slots.is_empty() || room && !maps.full) {
            self.device.check()?;
            let made = maps.slot(&self.device, &self.pipelines, side, layers);
            match made.and_then(|slot| self.device.check().map(|()| slot)) {
                Ok(slot) => maps.slots.push(slot),
                Err(error) if maps.slots.is_empty() => return Err(error),
                // A device that has no room for one more still has those that it has.
                Err(_) => maps.full = true,
            }
        }
        // The last one changes hands: when points are gone through in turns, the others stay.
        let index = kept.unwrap_or(maps.slots.len() - 1);
        if maps.slots[index].side < side || maps.slots[index].views.len() < layers as usize {
            maps.slots[index] = maps.slot(&self.device, &self.pipelines, side, layers)?;
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
