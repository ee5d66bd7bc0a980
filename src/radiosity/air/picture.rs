//! The air's light in a picture: means of J along sparse eye rays, interpolated, and the exact weights of each ray.
//!
//! Rays are taken at the corners of square cells of the picture. Where the means at a cell's middle are not those interpolated
//! between its corners, as where a wall ends that keeps two rooms apart, it is divided into four, down to single pixels. Where
//! none of the corners knows enough, behind a gap that none of them meets, a ray is looked along by itself.

use super::around::Around;
use super::column::{Column, Means};
use super::knots::Knots;
use crate::conditions::Conditions;
use crate::medium::{Kind, Sight};
use crate::radiosity::shards::Shards;
use crate::scene::Ray;
use glam::{DVec2, DVec3};
use std::sync::{Arc, OnceLock};

/// A cell is divided where means differ by more than this share.
const DIFFERENCE: f64 = 0.05;

/// Corners that know enough must carry this share of the weight.
const KNOWN: f64 = 0.2;

/// The means of J all over a picture.
pub struct Picture {
    conditions: Conditions,
    around: Around,
    kinds: Vec<Kind>,
    sight: Sight,
    knots: Knots,
    /// Pixels along each side of an undivided cell, and such cells in a row.
    step: u32,
    least: u32,
    cells_in_row: u32,
    cells: Vec<OnceLock<Cell>>,
    columns: Shards<[u32; 2], Column>,
}

/// A square of the picture.
struct Cell {
    corner: [u32; 2],
    step: u32,
    /// Upper left, upper right, lower left, lower right.
    means: [Means; 4],
    parts: Option<Box<[Cell; 4]>>,
}

impl Picture {
    /// Prepares it; rays are found as they are needed. `step` is the distance of rays [pixels].
    pub fn new(
        conditions: &Conditions,
        around: Around,
        kinds: Vec<Kind>,
        knots: Knots,
        step: f64,
    ) -> Self {
        let [width, height] = conditions.view.size;
        // Small pictures show as much as large ones.
        let fewest = f64::from(width.max(height)) / 40.0;
        let step = 1 << step.min(fewest).max(1.0).log2().floor() as u32;
        let cells_in_row = width.div_ceil(step);
        let count = cells_in_row as usize * height.div_ceil(step) as usize;
        Picture {
            around,
            kinds,
            sight: Sight::new(&conditions.air),
            knots,
            step,
            least: (step / 8).max(1),
            cells_in_row,
            cells: std::iter::repeat_with(OnceLock::new).take(count).collect(),
            columns: Shards::new(),
            conditions: conditions.clone(),
        }
    }

    /// What serves to weigh many rays, one after another.
    pub fn sight(&self) -> Sight {
        self.sight.clone()
    }

    /// The air's light on a ray through a position of the picture [pixels] as far as `distance` [cd/m2]; `is_met` tells whether a
    /// surface is there, or nothing.
    pub fn light(
        &self,
        position: DVec2,
        ray: &Ray,
        distance: f64,
        is_met: bool,
        sight: &mut Sight,
    ) -> DVec3 {
        sight.aim(ray.origin, ray.direction, distance);
        let mut weights = [DVec3::ZERO; 8];
        let mut many;
        let weights = match weights.get_mut(..self.kinds.len()) {
            Some(few) => few,
            None => {
                many = vec![DVec3::ZERO; self.kinds.len()];
                &mut many[..]
            }
        };
        sight.add(0.0, distance, weights);
        for (weight, kind) in weights.iter_mut().zip(&self.kinds) {
            // The sky holds already what the clear air before it sends.
            if kind.is_clear_air && !is_met {
                *weight = DVec3::ZERO;
            }
        }
        if weights.iter().all(|weight| *weight == DVec3::ZERO) {
            return DVec3::ZERO;
        }
        let cell = self.cell(position);
        let at = (position - DVec2::from(cell.corner.map(f64::from))) / f64::from(cell.step);
        let shares = [
            (1.0 - at.x) * (1.0 - at.y),
            at.x * (1.0 - at.y),
            (1.0 - at.x) * at.y,
            at.x * at.y,
        ];
        let knot = self.knots.before(distance);
        let mut sum = DVec3::ZERO;
        for (kind, weight) in weights.iter().enumerate() {
            if *weight == DVec3::ZERO {
                continue;
            }
            match self.interpolated(&cell.means, shares, knot, distance, kind) {
                Some(mean) => sum += *weight * mean,
                None => return self.alone(ray, distance, weights),
            }
        }
        sum
    }

    fn interpolated(
        &self,
        means: &[Means; 4],
        shares: [f64; 4],
        knot: usize,
        distance: f64,
        kind: usize,
    ) -> Option<DVec3> {
        let (mut sum, mut known) = (DVec3::ZERO, 0.0);
        for (means, share) in means.iter().zip(shares) {
            if let Some(mean) = means.at(&self.knots, knot, distance, kind) {
                sum += share * mean;
                known += share;
            }
        }
        (known > KNOWN).then(|| sum / known)
    }

    /// The air's light on a ray that is looked along by itself.
    fn alone(&self, ray: &Ray, distance: f64, weights: &[DVec3]) -> DVec3 {
        let column = self.look(ray, distance);
        let means = column.means(&[]);
        let knot = self.knots.before(distance);
        let of = |(kind, weight): (usize, &DVec3)| {
            let mean = means.at(&self.knots, knot, distance, kind);
            *weight * mean.unwrap_or(DVec3::ZERO)
        };
        weights.iter().enumerate().map(of).sum()
    }

    /// The smallest cell that holds a position.
    fn cell(&self, position: DVec2) -> &Cell {
        let [x, y] = [position.x, position.y].map(|v| v as u32);
        let (column, row) = (x / self.step, y / self.step);
        let index = (row * self.cells_in_row + column) as usize;
        let mut cell = self.cells[index]
            .get_or_init(|| self.make([column * self.step, row * self.step], self.step));
        while let Some(parts) = &cell.parts {
            let half = cell.step / 2;
            let right = usize::from(x >= cell.corner[0] + half);
            let below = usize::from(y >= cell.corner[1] + half);
            cell = &parts[right + 2 * below];
        }
        cell
    }

    fn make(&self, corner: [u32; 2], step: u32) -> Cell {
        let [x, y] = corner;
        let corners = [[x, y], [x + step, y], [x, y + step], [x + step, y + step]];
        let columns = corners.map(|corner| self.column(corner));
        let column = |i: usize| columns[i].get();
        let farthest = (0..4)
            .filter_map(|i| column(i).map(|c| c.end))
            .fold(0.0, f64::max);
        let means = std::array::from_fn(|i| self.means(corners[i], step, farthest));
        let is_even = step <= self.least || self.is_even([x + step / 2, y + step / 2], &means);
        Cell {
            corner,
            step,
            means,
            parts: (!is_even).then(|| {
                let half = step / 2;
                let part = |right, below| self.make([x + right, y + below], half);
                Box::new([part(0, 0), part(half, 0), part(0, half), part(half, half)])
            }),
        }
    }

    /// Whether means interpolated between the corners of a cell are those at its middle.
    fn is_even(&self, middle: [u32; 2], means: &[Means; 4]) -> bool {
        let slot = self.column(middle);
        let Some(column) = slot.get() else {
            return true;
        };
        let own = column.means(&[]);
        let farthest = column.end.min(column.air_end(&self.knots));
        [0.3, 0.6, 1.0].iter().all(|share| {
            let distance = share * farthest;
            let knot = self.knots.before(distance);
            (0..self.kinds.len()).all(|kind| {
                let truth = own.at(&self.knots, knot, distance, kind);
                let found = self.interpolated(means, [0.25; 4], knot, distance, kind);
                match (truth, found) {
                    (Some(truth), Some(found)) => {
                        let off = (truth - found).abs().max_element();
                        off <= DIFFERENCE * truth.max_element().max(found.max_element())
                    }
                    (None, _) => true,
                    (Some(_), None) => false,
                }
            })
        })
    }

    /// The means of a ray at a corner of cells, as far as `farthest`.
    fn means(&self, [x, y]: [u32; 2], step: u32, farthest: f64) -> Means {
        let own = self.column([x, y]);
        let Some(column) = own.get() else {
            return Means::none(self.kinds.len());
        };
        if column.end >= farthest {
            return column.means(&[]);
        }
        let places = (0..9u32).filter(|i| *i != 4).filter_map(|i| {
            let x = (x + i % 3 * step).checked_sub(step)?;
            let y = (y + i / 3 * step).checked_sub(step)?;
            Some(self.column([x, y]))
        });
        let slots: Vec<_> = places.collect();
        let others: Vec<&Column> = slots.iter().filter_map(|slot| slot.get()).collect();
        column.means(&others)
    }

    /// The ray through a corner of pixels.
    fn column(&self, corner: [u32; 2]) -> Arc<OnceLock<Column>> {
        let slot = self.columns.place(corner);
        slot.get_or_init(|| {
            let ray = self.conditions.view.ray(DVec2::from(corner.map(f64::from)));
            self.look(&ray, self.end(&ray))
        });
        slot
    }

    fn look(&self, ray: &Ray, end: f64) -> Column {
        let source = |place: DVec3| self.around.source(place, ray.direction);
        Column::new(ray, end, &self.knots, &mut self.sight.clone(), source)
    }

    /// How far a ray sees [m], through what lets light through.
    fn end(&self, ray: &Ray) -> f64 {
        let Conditions {
            geometry, ground, ..
        } = &self.conditions;
        if let Some(hit) = geometry.seen(ray, 1.0) {
            return hit.distance;
        }
        match ground {
            Some(ground) if ray.direction.y < 0.0 && ray.origin.y > ground.height => {
                (ray.origin.y - ground.height) / -ray.direction.y
            }
            _ => f64::INFINITY,
        }
    }
}
