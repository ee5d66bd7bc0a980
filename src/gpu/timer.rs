//! How long passes take on the device, by its own clock.

use super::device::Device;
use crate::error::Result;
use std::time::Duration;
use wgpu::{
    Buffer, BufferUsages, ComputePassTimestampWrites, QuerySet, QuerySetDescriptor, QueryType,
    RenderPassTimestampWrites,
};

/// Passes that are timed before their times are fetched.
const PASSES: u32 = 512;

/// Times of passes, summed by the number under which each is begun.
pub struct Timer {
    set: Option<(QuerySet, Buffer, Buffer)>,
    pending: Vec<usize>,
    totals: Vec<Duration>,
}

impl Timer {
    /// For passes of numbers below `count`; without a clock on the device it stays at zero.
    pub fn new(device: &Device, count: usize) -> Result<Self> {
        let set = if device.timestamps() {
            let set = device.device.create_query_set(&QuerySetDescriptor {
                label: Some("times"),
                ty: QueryType::Timestamp,
                count: 2 * PASSES,
            });
            let bytes = u64::from(16 * PASSES);
            let resolved = device.buffer(
                "times",
                bytes,
                BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
            )?;
            let read = device.buffer(
                "times",
                bytes,
                BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            )?;
            Some((set, resolved, read))
        } else {
            None
        };
        Ok(Timer {
            set,
            pending: Vec::new(),
            totals: vec![Duration::ZERO; count],
        })
    }

    /// The queries of the next pass.
    fn next(&mut self, device: &Device, number: usize) -> Result<Option<u32>> {
        if self.set.is_none() {
            return Ok(None);
        }
        if self.pending.len() == PASSES as usize {
            self.fetch(device)?;
        }
        self.pending.push(number);
        Ok(Some(2 * (self.pending.len() as u32 - 1)))
    }

    pub fn compute(
        &mut self,
        device: &Device,
        number: usize,
    ) -> Result<Option<ComputePassTimestampWrites<'_>>> {
        let first = self.next(device, number)?;
        Ok(first
            .zip(self.set.as_ref())
            .map(|(first, (set, ..))| ComputePassTimestampWrites {
                query_set: set,
                beginning_of_pass_write_index: Some(first),
                end_of_pass_write_index: Some(first + 1),
            }))
    }

    pub fn render(
        &mut self,
        device: &Device,
        number: usize,
    ) -> Result<Option<RenderPassTimestampWrites<'_>>> {
        let first = self.next(device, number)?;
        Ok(first
            .zip(self.set.as_ref())
            .map(|(first, (set, ..))| RenderPassTimestampWrites {
                query_set: set,
                beginning_of_pass_write_index: Some(first),
                end_of_pass_write_index: Some(first + 1),
            }))
    }

    /// Fetches what is pending into the totals.
    fn fetch(&mut self, device: &Device) -> Result<()> {
        let Some((set, resolved, read)) = &self.set else {
            return Ok(());
        };
        let count = self.pending.len() as u32;
        if count == 0 {
            return Ok(());
        }
        let bytes = u64::from(16 * count);
        let mut encoder = device.device.create_command_encoder(&Default::default());
        encoder.resolve_query_set(set, 0..2 * count, resolved, 0);
        encoder.copy_buffer_to_buffer(resolved, 0, read, 0, bytes);
        device.queue.submit([encoder.finish()]);
        let ticks = device.read(read, bytes)?;
        let tick = |i: usize| {
            let mut word = [0; 8];
            word.copy_from_slice(&ticks[8 * i..8 * i + 8]);
            u64::from_le_bytes(word)
        };
        let period = f64::from(device.queue.get_timestamp_period());
        for (i, number) in self.pending.drain(..).enumerate() {
            let nanoseconds = tick(2 * i + 1).saturating_sub(tick(2 * i)) as f64 * period;
            self.totals[number] += Duration::from_nanos(nanoseconds as u64);
        }
        Ok(())
    }

    /// The sums since the last call, one a number; `None` without a clock on the device.
    pub fn take(&mut self, device: &Device) -> Result<Option<Vec<Duration>>> {
        self.fetch(device)?;
        let zeros = vec![Duration::ZERO; self.totals.len()];
        let totals = std::mem::replace(&mut self.totals, zeros);
        Ok(self.set.is_some().then_some(totals))
    }
}
