//! How long the CPU will take for a picture: judged by some of its pixels.
//!
//! Blocks of neighbouring pixels are looked at, spread over the picture, and of each a core first. What an effect keeps serves the
//! pixels around: if it is kept by cells that are `c` pixels wide in the picture, a block of `b` pixels a side needs (b + c)^2 / c^2 of
//! them, and how much more a block takes than its core says how large `c` is. The picture then takes as its own sides have it. Pixels that
//! differ from their neighbours are resampled too, some of them.

use super::reference::{Reference, Rerun, air_of, differing, picture};
use super::rendering::StepTime;
use crate::conditions::sample_positions;
use glam::{DVec3, UVec2};
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// Sides of a block and of its core [pixels].
const SIDES: [u32; 2] = [16, 4];

/// The most blocks of which cores are looked at, and of which the whole is.
const MOST: [usize; 2] = [1024, 64];

/// The most pixels that are resampled.
const RESAMPLED: usize = 512;

/// Shares of the time allowed that go to whole blocks, to cores, and to pixels that are resampled.
const SHARES: [f64; 3] = [0.4, 0.3, 0.2];

/// The wall time that each effect of the whole picture will take, judged in about the time `allowed`, at least by some dozen pixels. A
/// prediction, not a bound.
pub fn predict(reference: &Reference, allowed: Duration) -> Vec<StepTime> {
    let conditions = reference.plan().conditions;
    let size = conditions.view.size;
    let blocks = blocks(size);
    let threads = rayon::current_num_threads();
    let look = |blocks: &[UVec2], part: fn([u32; 2], UVec2) -> Vec<UVec2>| -> Vec<Vec<_>> {
        let looks = blocks.par_iter();
        let looks = looks.map(|block| reference.centres(&part(size, *block)));
        looks.collect()
    };
    let start = Instant::now();
    let few = blocks.len().min(threads.max(4));
    let mut cores = look(&blocks[..few], core);
    let rays: usize = cores.iter().map(Vec::len).sum();
    let seconds_a_ray = start.elapsed().as_secs_f64() / rays.max(1) as f64;
    let within = |share: f64, rays: u32| {
        (share * allowed.as_secs_f64() / (seconds_a_ray * f64::from(rays)).max(1e-12)) as usize
    };
    let [side, core_side] = SIDES;
    let whole = within(SHARES[0], side * side)
        .min(MOST[1])
        .min(blocks.len());
    // Fewer would say nothing of the others.
    let whole = if whole < few { 0 } else { whole };
    cores.extend(look(&blocks[few..whole.max(few)], core));
    let by_cores = reference.times();
    look(&blocks[..whole], around_core);
    let by_blocks = reference.times();
    let all = within(SHARES[1], core_side * core_side)
        .min(MOST[0])
        .min(blocks.len());
    cores.extend(look(&blocks[cores.len()..all.max(cores.len())], core));
    let by_all = reference.times();
    let (share, resampled) = match conditions.view.samples {
        1 => (0.0, 0),
        samples => {
            let (share, mut pixels) = found_edges(reference, &blocks, &cores);
            pixels.truncate(within(SHARES[2], samples).min(RESAMPLED).max(threads));
            let offsets = sample_positions(samples);
            pixels.par_iter().for_each(|(pixel, rerun)| {
                reference.means(&[(*pixel, *rerun)], &offsets, |_| DVec3::ZERO);
            });
            (share, pixels.len())
        }
    };
    let by_edges = reference.times();

    let seconds = |step: &StepTime| step.time.unwrap_or_default().as_secs_f64();
    let pixels = size.map(f64::from);
    let looked: usize = cores.iter().map(Vec::len).sum();
    let rays_a_pixel = pixels[0] * pixels[1] / looked.max(1) as f64;
    (0..by_edges.len())
        .map(|i| {
            let [a, b, c, d] = [&by_cores, &by_blocks, &by_all, &by_edges].map(|t| seconds(&t[i]));
            let keeps = !by_edges[i].effect.keeps.is_empty();
            let first = match keeps && whole > 0 {
                true => kept(pixels, [a, b].map(|t| t / whole as f64)),
                false => (a + c - b) * rays_a_pixel,
            };
            let again = match resampled {
                0 => 0.0,
                count => (d - c) / count as f64 * share * pixels[0] * pixels[1],
            };
            StepTime {
                time: Some(Duration::from_secs_f64(
                    (first + again).max(0.0) / threads as f64,
                )),
                ..by_edges[i].clone()
            }
        })
        .collect()
}

/// What a picture takes of what is kept by cells, where cores and whole blocks take so much each.
fn kept(size: [f64; 2], [core, block]: [f64; 2]) -> f64 {
    let sides = SIDES.map(|side| size.map(|own| own.min(f64::from(side))));
    let cells = |[w, h]: [f64; 2], c: f64| (w + c) * (h + c);
    let growth = |c: f64| cells(sides[0], c) / cells(sides[1], c);
    // None is larger than the picture.
    let (mut low, mut high) = (0.0, size[0].max(size[1]));
    for _ in 0..60 {
        let c = 0.5 * (low + high);
        if growth(c) * core > block {
            low = c;
        } else {
            high = c;
        }
    }
    block * cells(size, low) / cells(sides[0], low)
}

/// Corners of blocks in an order in which the first few are spread over the picture, at most [`MOST`].
fn blocks(size: [u32; 2]) -> Vec<UVec2> {
    let [columns, rows] = size.map(|side| side.div_ceil(SIDES[0]) as usize);
    let count = columns * rows;
    // The golden section of them, or the next step that comes by all.
    let divides = |a: usize, b: usize| {
        let (mut a, mut b) = (a, b);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a > 1
    };
    let golden = ((0.618_033_988_75 * count as f64) as usize).max(1);
    let step = (golden..).find(|step| !divides(*step, count)).unwrap_or(1);
    (0..count.min(MOST[0]))
        .map(|i| (step / 2 + i * step) % count)
        .map(|i| SIDES[0] * UVec2::new((i % columns) as u32, (i / columns) as u32))
        .collect()
}

/// Pixels of a square of the picture, row by row.
fn square([width, height]: [u32; 2], corner: UVec2, side: u32) -> impl Iterator<Item = UVec2> {
    let columns = corner.x..(corner.x + side).min(width);
    let rows = corner.y..(corner.y + side).min(height);
    rows.flat_map(move |y| columns.clone().map(move |x| UVec2::new(x, y)))
}

fn core(size: [u32; 2], block: UVec2) -> Vec<UVec2> {
    square(size, block, SIDES[1]).collect()
}

fn around_core(size: [u32; 2], block: UVec2) -> Vec<UVec2> {
    let is_outside = |pixel: &UVec2| (*pixel - block).max_element() >= SIDES[1];
    square(size, block, SIDES[0]).filter(is_outside).collect()
}

/// The share of pixels that are resampled, by those inside the cores of blocks, and which of these are.
fn found_edges(
    reference: &Reference,
    blocks: &[UVec2],
    cores: &[Vec<super::reference::Sample>],
) -> (f64, Vec<(UVec2, Rerun)>) {
    let side = SIDES[1] as usize;
    let inner: Vec<usize> = (0..side * side)
        .filter(|i| {
            [i % side, i / side]
                .iter()
                .all(|at| (1..side - 1).contains(at))
        })
        .collect();
    let (mut seen, mut found) = (0, Vec::new());
    for (block, samples) in blocks.iter().zip(cores) {
        // Those at the picture's sides are cut.
        if samples.len() != side * side {
            continue;
        }
        let of = |i: usize| *block + UVec2::new((i % side) as u32, (i / side) as u32);
        let pictures: Vec<DVec3> = samples.iter().map(|s| picture(&s.values)).collect();
        let airs: Vec<DVec3> = samples.iter().map(|s| air_of(&s.values)).collect();
        let differing = differing([side, side], &pictures, &airs);
        seen += inner.len();
        found.extend(inner.iter().filter_map(|i| {
            let pixel = of(*i);
            let rerun = differing.iter().find(|(other, _)| other == i).map(|d| d.1);
            let is_veiled = reference.is_veiled(pixel).then_some(Rerun::All);
            Some((pixel, is_veiled.or(rerun)?))
        }));
    }
    (found.len() as f64 / seen.max(1) as f64, found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cells_of_any_size_take_is_found_by_a_block_and_its_core() {
        for size in [[960.0, 600.0], [48.0, 30.0], [500.0, 1.0]] {
            for cell in [1e-3, 2.0, 7.0, 40.0] {
                let take = |side: f64| {
                    let cells = size.map(|own: f64| (own.min(side) + cell) / cell);
                    0.01 * cells[0] * cells[1]
                };
                let found = kept(size, [take(4.0), take(16.0)]);
                let truth = take(f64::INFINITY);
                assert!(
                    (found / truth - 1.0).abs() < 1e-6,
                    "{size:?} {cell}: {found} {truth}"
                );
            }
        }
        // By pixels alone, and once for all.
        assert!((kept([160.0, 160.0], [1.0, 16.0]) - 1600.0).abs() < 1e-3);
        assert!(kept([160.0, 160.0], [1.0, 1.0]) < 4.5);
    }

    #[test]
    fn all_blocks_are_there_once_and_the_first_are_spread() {
        for size in [[960, 600], [96, 60], [17, 1], [1, 1]] {
            let all = blocks(size);
            let mut sorted: Vec<[u32; 2]> = all.iter().map(UVec2::to_array).collect();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), all.len(), "{size:?}");
            let pixels: usize = all
                .iter()
                .map(|b| core(size, *b).len() + around_core(size, *b).len())
                .sum();
            if all.len() < MOST[0] {
                assert_eq!(pixels, (size[0] * size[1]) as usize, "{size:?}");
            }
        }
        let rows: Vec<u32> = blocks([960, 600])[..8].iter().map(|b| b.y / 150).collect();
        for quarter in 0..4 {
            assert!(rows.contains(&quarter), "{rows:?}");
        }
    }
}
