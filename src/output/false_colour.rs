//! A picture of luminance in false colours, with isolines and a legend beside it.

use super::canvas::Canvas;
use super::isolines::{Field, isolines};
use super::lettering::{Anchor, draw_text, text_width};
use super::scale::{Scale, short};
use crate::colour::luminance;
use crate::frame::Frame;
use rayon::prelude::*;

const INK: [u8; 3] = [20, 20, 20];
const PAPER: [u8; 3] = [255; 3];

/// Isolines run through means of so many pixels each way, as a share of the picture's height: they tell of surfaces, not of noise.
const SMOOTHED: f64 = 1.0 / 180.0;

/// Lines shorter than this share of the picture's height are specks.
const SHORTEST: f64 = 0.08;

/// The legend is at least so high, in sizes of its letters: of a picture that is lower the rest stays white.
const LEGEND: f64 = 13.0;

/// The luminance of each pixel [cd/m2] as a colour of the scale, with its isolines and its legend. Width, height, and three bytes a pixel
/// of sRGB.
pub fn picture(frame: &Frame, scale: &Scale) -> Canvas {
    let [width, height] = [frame.width, frame.height].map(|side| side as usize);
    let values: Vec<f64> = (0..width * height)
        .into_par_iter()
        .map(|pixel| luminance(frame.picture(pixel)))
        .collect();
    let size = (0.028 * height as f64).clamp(9.0, 32.0);
    let levels = scale.levels();
    let legend = Legend::new(scale, size);
    let [whole_width, whole_height] = [
        width + legend.width(),
        height.max((LEGEND * size).ceil() as usize),
    ];
    let mut bytes = vec![255; 3 * whole_width * whole_height];
    let lines = bytes.chunks_exact_mut(3 * whole_width);
    for (row, line) in lines.take(height).enumerate() {
        for (pixel, out) in line[..3 * width].chunks_exact_mut(3).enumerate() {
            out.copy_from_slice(&scale.color(values[row * width + pixel]));
        }
    }
    let mut canvas = Canvas::over(whole_width, whole_height, &bytes);
    let step = (SMOOTHED * height as f64).round().max(1.0) as usize;
    let (columns, means) = means(&values, width, step);
    let field = Field {
        columns,
        values: &means,
    };
    let place = |[x, y]: [f64; 2]| [x, y].map(|at| (at + 0.5) * step as f64);
    let mut labels: Vec<[f64; 2]> = Vec::new();
    // The ends of the scale are where colours end; no light is no line.
    for level in levels
        .iter()
        .copied()
        .filter(|level| *level > scale.range()[0])
    {
        for line in isolines(&field, level) {
            let line: Vec<[f64; 2]> = line.into_iter().map(place).collect();
            let length: f64 = line.windows(2).map(|p| apart(p[0], p[1])).sum();
            if length < SHORTEST * height as f64 {
                continue;
            }
            let stroke = std::slice::from_ref(&line);
            canvas.stroke(stroke, 0.14 * size, PAPER);
            canvas.stroke(stroke, 0.07 * size, INK);
            let text = short(level);
            let half = 0.5 * text_width(&text, size);
            let has_room = |at: &[f64; 2]| {
                at[0] > half
                    && at[0] + half < width as f64
                    && at[1] > size
                    && at[1] + size < height as f64
                    && labels.iter().all(|other| apart(*at, *other) > 4.0 * size)
            };
            let middle = line.len() / 2;
            let spots = [middle, middle / 2, middle + middle / 2].map(|i| line[i]);
            if let Some(at) = spots.into_iter().find(|at| has_room(at)) {
                draw_text(
                    &mut canvas,
                    at,
                    &text,
                    size,
                    Anchor::Middle,
                    INK,
                    Some(PAPER),
                );
                labels.push(at);
            }
        }
    }
    legend.draw(&mut canvas, width as f64, &levels);
    canvas
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Means of squares of so many pixels, and how many squares are in a row; what is left over at the right and below has none.
fn means(values: &[f64], width: usize, step: usize) -> (usize, Vec<Option<f64>>) {
    let height = values.len() / width.max(1);
    let (columns, rows) = (width / step, height / step);
    let mean = |i: usize| {
        let (x, y) = (i % columns * step, i / columns * step);
        let all = (y..y + step).flat_map(|y| (x..x + step).map(move |x| y * width + x));
        Some(all.map(|pixel| values[pixel]).sum::<f64>() / (step * step) as f64)
    };
    (columns, (0..columns * rows).map(mean).collect())
}

/// The strip beside a picture.
struct Legend<'a> {
    scale: &'a Scale,
    size: f64,
}

impl<'a> Legend<'a> {
    fn new(scale: &'a Scale, size: f64) -> Self {
        Legend { scale, size }
    }

    /// Its width [pixels].
    fn width(&self) -> usize {
        let numbers = self
            .scale
            .levels()
            .into_iter()
            .map(|level| text_width(&short(level), self.size));
        let numbers = numbers.fold(0.0, f64::max) + 4.0 * self.size;
        let head = [
            self.scale.quantity.as_str(),
            self.unit().as_str(),
            "by ratios",
        ]
        .map(|text| text_width(text, self.size) + 1.5 * self.size);
        head.into_iter().fold(numbers, f64::max).ceil() as usize
    }

    fn unit(&self) -> String {
        format!("[{}]", self.scale.unit)
    }

    fn draw(&self, canvas: &mut Canvas, left: f64, levels: &[f64]) {
        let size = self.size;
        let (top, bottom) = (5.0 * size, canvas.height() as f64 - 1.5 * size);
        let bar = [left + size, left + 2.5 * size];
        let at = |place: f64| bottom + place * (top - bottom);
        // Whole pixels, so that no edge shows through.
        let (first, last) = (top.round() as usize, bottom.round() as usize);
        let [from, to] = bar.map(f64::round);
        for row in first..last {
            let y = row as f64;
            let place = ((bottom - y - 0.5) / (bottom - top)).clamp(0.0, 1.0);
            let corners = [[from, y], [to, y], [to, y + 1.0], [from, y + 1.0]];
            canvas.fill(&corners, self.scale.color(self.scale.value(place)));
        }
        let write = |canvas: &mut Canvas, y: f64, text: &str, x: f64| {
            draw_text(canvas, [x, y], text, size, Anchor::Start, INK, None);
        };
        write(canvas, 1.2 * size, &self.scale.quantity, bar[0]);
        write(canvas, 2.4 * size, &self.unit(), bar[0]);
        if self.scale.is_log() {
            write(canvas, 3.6 * size, "by ratios", bar[0]);
        }
        let mut free = f64::INFINITY;
        for level in levels {
            let y = at(self.scale.place(*level));
            canvas.stroke(
                &[vec![[bar[1], y], [bar[1] + 0.4 * size, y]]],
                0.1 * size,
                INK,
            );
            // From the lowest up, as far as numbers have room above each other.
            if y <= free {
                write(canvas, y, &short(*level), bar[1] + 0.7 * size);
                free = y - 1.1 * size;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn numbers_of_a_small_legend_stand_apart() {
        let scale = Scale::parse("luminance", "cd/m2", "0..2000").expect("a range");
        for height in [4, 30, 60, 300] {
            let frame = Frame::map(20, height, vec![Vec3::splat(300.0); 20 * height as usize]);
            let canvas = picture(&frame, &scale);
            let size = (0.028 * f64::from(height)).clamp(9.0, 32.0);
            // Rows with ink to the right of the bar and its ticks, below the title.
            let from = 20 + (3.3 * size) as usize;
            let bytes = canvas.bytes();
            let is_inked = |row: usize| {
                let row = &bytes[3 * row * canvas.width()..3 * (row + 1) * canvas.width()];
                row[3 * from..].iter().any(|code| *code < 128)
            };
            let rows = (3.2 * size) as usize..canvas.height();
            let inked: Vec<bool> = rows.map(is_inked).collect();
            let runs: Vec<usize> = (inked.chunk_by(|a, b| a == b))
                .filter(|run| run[0])
                .map(<[bool]>::len)
                .collect();
            assert!(runs.len() >= 4, "{height}: {runs:?}");
            assert!(
                runs.iter().all(|run| *run as f64 <= size),
                "{height}: {runs:?}"
            );
        }
    }
}
