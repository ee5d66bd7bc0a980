//! How long passes take on the device: by its own clock, or until they are done where it is software.

use super::device::Device;
use crate::error::Result;
use std::time::{Duration, Instant};
use wgpu::{
    Buffer, BufferUsages, ComputePassTimestampWrites, QuerySet, QuerySetDescriptor, QueryType,
    RenderPassTimestampWrites,
};

/// Passes that are timed before their times are fetched.
const PASSES: u32 = 512;

enum Clock {
    None,
    /// The device's queries, where they are resolved to, and where they are read.
    Queries(QuerySet, Buffer, Buffer),
    /// Each pass is waited for. Software drivers may take both of a pass's queries when they next rasterise, and no time is
    /// seen between them.
    Wall(Option<(usize, Instant)>),
}

/// Times of passes, summed by the number under which each is begun.
pub struct Timer {
    clock: Clock,
    pending: Vec<usize>,
    totals: Vec<Duration>,
}

impl Timer {
    /// For passes of numbers below `count`; without a clock on the device it stays at zero.
    pub fn new(device: &Device, count: usize) -> Result<Self> {
        let clock = if !device.adapter.is_hardware() {
            Clock::Wall(None)
        } else if device.timestamps() {
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
            Clock::Queries(set, resolved, read)
        } else {
            Clock::None
        };
        Ok(Timer {
            clock,
            pending: Vec::new(),
            totals: vec![Duration::ZERO; count],
        })
    }

    /// Begins anew, for passes of numbers below `count`; what was not taken is dropped.
    pub fn begin(&mut self, count: usize) {
        self.pending.clear();
        self.totals = vec![Duration::ZERO; count];
    }

    /// The queries of the next pass.
    fn next(&mut self, device: &Device, number: usize) -> Result<Option<(&QuerySet, u32)>> {
        if let Clock::Wall(begun) = &mut self.clock {
            device.wait()?;
            *begun = Some((number, Instant::now()));
        }
        if self.pending.len() == PASSES as usize {
            self.fetch(device)?;
        }
        let Clock::Queries(set, ..) = &self.clock else {
            return Ok(None);
        };
        self.pending.push(number);
        Ok(Some((set, 2 * (self.pending.len() as u32 - 1))))
    }

    /// To be called when the pass that began last is submitted.
    pub fn submitted(&mut self, device: &Device) -> Result<()> {
        if let Clock::Wall(begun) = &mut self.clock
            && let Some((number, start)) = begun.take()
        {
            device.wait()?;
            self.totals[number] += start.elapsed();
        }
        Ok(())
    }

    pub fn compute(
        &mut self,
        device: &Device,
        number: usize,
    ) -> Result<Option<ComputePassTimestampWrites<'_>>> {
        let queries = self.next(device, number)?;
        Ok(
            queries.map(|(query_set, first)| ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(first),
                end_of_pass_write_index: Some(first + 1),
            }),
        )
    }

    pub fn render(
        &mut self,
        device: &Device,
        number: usize,
    ) -> Result<Option<RenderPassTimestampWrites<'_>>> {
        let queries = self.next(device, number)?;
        Ok(queries.map(|(query_set, first)| RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }))
    }

    /// Fetches what is pending into the totals.
    fn fetch(&mut self, device: &Device) -> Result<()> {
        let Clock::Queries(set, resolved, read) = &self.clock else {
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
        Ok((!matches!(self.clock, Clock::None)).then_some(totals))
    }
}
