//! How far a picture is from the reference: measured on some of its pixels.
//!
//! Pixels are drawn at random, one from each cell of an even grid (stratified), always the same ones for a size; the measures are
//! those of [`crate::accuracy`].

use super::reference::{Reference, Values, picture};
use crate::accuracy::{LayerError, Random, error};
use crate::colour::luminance;
use crate::effect::Kept;
use crate::error::{Error, Result};
use crate::frame::{Field, Frame, Layer};
use crate::plan::Plan;
use crate::task::Task;
use glam::{DVec3, UVec2};
use serde::Serialize;

/// The stage in which pixels are made that a picture is compared with.
const TRUTH: &str = "the reference's pixels";

/// The stage in which a plan's own are made.
const COMPARED: &str = "pixels to compare";

/// The measured error of a picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Pixels that were compared.
    pub pixels: usize,
    /// The layers that the reference makes, in their order, and the picture.
    pub layers: Vec<LayerError>,
}

impl Check {
    /// The error of the whole picture.
    pub fn picture(&self) -> &LayerError {
        let last = self.layers.last();
        last.expect("the picture is always in the list")
    }
}

/// What the reference makes of some pixels under a plan: the truth for all pictures of the same conditions, found once.
pub struct Yardstick {
    size: [u32; 2],
    written: Vec<Field>,
    pixels: Vec<UVec2>,
    truth: Vec<Values>,
}

impl Yardstick {
    /// The truth at about `count` pixels.
    ///
    /// # Errors
    /// [`Error::Input`] for a count of zero; [`Error::Stopped`] when the work was stopped.
    pub fn new(plan: &Plan, count: usize, task: Task<'_>) -> Result<Self> {
        Self::keeping(plan, count, &Kept::default(), task)
    }

    /// The same; what is kept of earlier plans serves this one.
    ///
    /// # Errors
    /// Those of [`Yardstick::new`].
    pub fn keeping(plan: &Plan, count: usize, kept: &Kept, task: Task<'_>) -> Result<Self> {
        if count == 0 {
            return Err(Error::input(
                "--check 0",
                "no pixel would be compared",
                "give a number of pixels, say 1000",
            ));
        }
        let view = &plan.conditions.view;
        let pixels = stratified(view.size, count);
        Ok(Yardstick {
            size: view.size,
            written: plan.written(),
            truth: Reference::keeping(plan, kept, task)?.sampled(
                &pixels,
                view.samples,
                task.stage(TRUTH),
            )?,
            pixels,
        })
    }

    /// The error of a picture.
    ///
    /// # Errors
    /// [`Error::Input`] for a picture of another size.
    pub fn check(&self, frame: &Frame) -> Result<Check> {
        let size = self.size;
        if [frame.width, frame.height] != size {
            return Err(Error::input(
                "the picture to check",
                format!(
                    "it has {} x {} pixels, the plan {} x {}",
                    frame.width, frame.height, size[0], size[1]
                ),
                "render and check with the same --size",
            ));
        }
        let index = |p: &UVec2| (p.y * size[0] + p.x) as usize;
        let made = Field::ALL.map(|field| frame.layer(field.name()));
        let value = |layer: Option<&Layer>, p: &UVec2| {
            layer.map_or(DVec3::ZERO, |layer| layer.rgb[index(p)].as_dvec3())
        };
        let pixels = self.pixels.iter();
        let ours: Vec<Values> = pixels.map(|p| made.map(|layer| value(layer, p))).collect();
        Ok(self.judge(&ours))
    }

    /// The error of what the reference makes of another plan for conditions of the same view, without a whole picture.
    ///
    /// # Errors
    /// Those of [`Reference::keeping`].
    pub fn compare(&self, plan: &Plan, task: Task<'_>) -> Result<Check> {
        let samples = plan.conditions.view.samples;
        let reference = Reference::keeping(plan, &Kept::default(), task)?;
        let found = reference.sampled(&self.pixels, samples, task.stage(COMPARED))?;
        Ok(self.judge(&found))
    }

    /// The error of the layers and of their sum.
    fn judge(&self, ours: &[Values]) -> Check {
        let pairs = |of: &dyn Fn(&Values) -> DVec3| -> Vec<[f64; 2]> {
            let pairs = ours.iter().zip(&self.truth);
            pairs
                .map(|(o, t)| [luminance(of(o)), luminance(of(t))])
                .collect()
        };
        let mut layers: Vec<LayerError> = Field::layers()
            .filter(|field| self.written.contains(field))
            .map(|field| error(field.name(), &pairs(&|values| values[field as usize])))
            .collect();
        layers.push(error("picture", &pairs(&picture)));
        Check {
            pixels: self.pixels.len(),
            layers,
        }
    }
}

/// One random pixel of each cell of a grid of about `count` cells; all pixels when there are no more.
pub(super) fn stratified([width, height]: [u32; 2], count: usize) -> Vec<UVec2> {
    let aspect = f64::from(width) / f64::from(height);
    let columns = (count as f64 * aspect)
        .sqrt()
        .round()
        .clamp(1.0, f64::from(width)) as u32;
    let rows = (count as f64 / f64::from(columns))
        .round()
        .clamp(1.0, f64::from(height)) as u32;
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut place = |cell: u32, cells: u32, side: u32| {
        let edge = |i: u32| (u64::from(i) * u64::from(side) / u64::from(cells)) as u32;
        let from = edge(cell);
        from + random.below(u64::from(edge(cell + 1) - from)) as u32
    };
    let mut pixels = Vec::with_capacity((columns * rows) as usize);
    for row in 0..rows {
        for column in 0..columns {
            pixels.push(UVec2::new(
                place(column, columns, width),
                place(row, rows, height),
            ));
        }
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_gives_one_pixel() {
        let pixels = stratified([64, 32], 200);
        assert_eq!(pixels.len(), 200);
        for (i, pixel) in pixels.iter().enumerate() {
            let (column, row) = (i as u32 % 20, i as u32 / 20);
            assert!(pixel.x >= column * 64 / 20 && pixel.x < (column + 1) * 64 / 20);
            assert!(pixel.y >= row * 32 / 10 && pixel.y < (row + 1) * 32 / 10);
        }
        let all = stratified([5, 3], 1_000_000);
        assert_eq!(all.len(), 15);
        assert_eq!(stratified([1, 1], 10), [UVec2::ZERO]);
    }
}
