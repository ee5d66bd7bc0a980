//! The frames of a time-lapse on one sheet, each with its local time.

use tyndall::Result;
use tyndall::output::canvas::Color;
use tyndall::output::drawing::{Drawing, PIXELS};
use tyndall::output::lettering::Anchor;
use tyndall::timelapse::frames::{Frames, read_pixels};
use tyndall::timelapse::plan::{FrameLine, Outline};

const INK: Color = [25, 25, 25];
const QUIET: Color = [110, 110, 110];

/// The most pictures on a sheet; of longer sequences it shows every so many.
pub const MOST: usize = 120;
const COLUMNS: usize = 8;

/// Units of the drawing.
const MARGIN: f64 = 16.0;
const WIDTH: f64 = 120.0;
const GAP: f64 = 8.0;
const HEAD: f64 = 46.0;
const LABEL: f64 = 15.0;

/// Draws a sheet of the frames whose PNGs are `frames`; `outline` is of their plan.
///
/// # Errors
/// [`Input`](tyndall::Error::Input) when there is no frame, or for a PNG that cannot be read; [`File`](tyndall::Error::File) for one that is missing.
pub fn draw(title: &str, frames: &Frames, outline: &Outline) -> Result<Drawing> {
    let step = outline.lines.len().div_ceil(MOST).max(1);
    let shown: Vec<&FrameLine> = outline.lines.iter().step_by(step).collect();
    let [width, height] = frames.size()?;
    let scale = PIXELS * WIDTH / f64::from(width);
    let side = |length: u32| ((scale * f64::from(length)).round() as u32).max(1);
    // Very high pictures are shown narrower.
    let tall = (f64::from(side(height)) / (3.0 * PIXELS * WIDTH)).max(1.0);
    let small = [side(width), side(height)].map(|n| ((f64::from(n) / tall) as u32).max(1));
    let high = f64::from(small[1]) / PIXELS;
    let columns = COLUMNS.min(shown.len().max(1));
    let rows = shown.len().div_ceil(columns);
    let row = high + LABEL + GAP;
    // Room for the head even above a single picture.
    let wide = (columns as f64 * (WIDTH + GAP) - GAP).max(3.0 * WIDTH);
    let mut sheet = Drawing::new(2.0 * MARGIN + wide, HEAD + rows as f64 * row + MARGIN - GAP);
    sheet.text([MARGIN, 18.0], 15.0, Anchor::Start, INK, title);
    let frames_there = outline.header.frames;
    let count = match step as u64 * outline.every {
        1 => format!("{frames_there} frames"),
        step => format!("every {step}. of {frames_there} frames"),
    };
    sheet.text([MARGIN, 35.0], 10.0, Anchor::Start, QUIET, count);
    let clock = Clock::of(&shown);
    for (place, line) in shown.iter().enumerate() {
        let [column, at_row] = [place % columns, place / columns].map(|n| n as f64);
        let (x, y) = (MARGIN + column * (WIDTH + GAP), HEAD + at_row * row);
        let picture = read_pixels(&frames.template.path(line.index), [width, height])?;
        let narrow = 0.5 * (WIDTH - f64::from(small[0]) / PIXELS);
        let shown = shrunk(&picture, [width, height], small);
        sheet.picture([x + narrow, y], small, shown);
        let middle = y + high + 0.5 * LABEL;
        sheet.text([x, middle], 9.0, Anchor::Start, INK, clock.label(line));
        let index = line.index.to_string();
        sheet.text([x + WIDTH, middle], 8.0, Anchor::End, QUIET, index);
    }
    Ok(sheet)
}

/// A picture of three bytes a pixel at another size: each pixel is the mean of those that it covers, one at least.
fn shrunk(rgb: &[u8], [width, height]: [u32; 2], small: [u32; 2]) -> Vec<u8> {
    let covered = |i: u32, of: u32, side: u32| {
        let at = |i: u32| (u64::from(i) * u64::from(side) / u64::from(of)) as usize;
        at(i)..at(i + 1).max(at(i) + 1)
    };
    let mut shown = Vec::with_capacity(3 * small[0] as usize * small[1] as usize);
    for y in 0..small[1] {
        let rows = covered(y, small[1], height);
        for x in 0..small[0] {
            let columns = covered(x, small[0], width);
            let count = (rows.len() * columns.len()) as u32;
            let mut sum = [count / 2; 3];
            for row in rows.clone() {
                let from = 3 * row * width as usize;
                for pixel in rgb[from..].as_chunks::<3>().0[columns.clone()].iter() {
                    (0..3).for_each(|c| sum[c] += u32::from(pixel[c]));
                }
            }
            shown.extend(sum.map(|sum| (sum / count) as u8));
        }
    }
    shown
}

/// How much of a local time tells frames apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Clock {
    /// One day, whole minutes.
    Minutes,
    /// One day.
    Seconds,
    /// Several days, one time of day or whole minutes.
    Days,
}

impl Clock {
    /// That of some frames.
    pub fn of(lines: &[&FrameLine]) -> Self {
        let mut days = lines.iter().map(|line| line.local.get(..10));
        let first = days.next();
        if days.any(|day| Some(day) != first) {
            Clock::Days
        } else if lines.iter().all(|l| l.local.get(16..19) == Some(":00")) {
            Clock::Minutes
        } else {
            Clock::Seconds
        }
    }

    /// A frame's local time.
    pub fn label(self, line: &FrameLine) -> String {
        let local = &*line.local;
        let part = |range| local.get(range).unwrap_or(local);
        match self {
            Clock::Minutes => part(11..16).to_owned(),
            Clock::Seconds => part(11..19).to_owned(),
            Clock::Days => format!("{} {}", part(0..10), part(11..16)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_means_of_what_they_cover() {
        let grey = |codes: &[u8]| codes.iter().flat_map(|c| [*c; 3]).collect::<Vec<u8>>();
        let picture = grey(&[0, 10, 20, 31, 40, 50]);
        assert_eq!(shrunk(&picture, [3, 2], [3, 2]), picture);
        // Three columns in two: one, and two of them.
        assert_eq!(shrunk(&picture, [3, 2], [2, 1]), grey(&[16, 30]));
        assert_eq!(shrunk(&picture, [6, 1], [1, 1]), grey(&[25]));
        // What is made larger repeats.
        assert_eq!(shrunk(&grey(&[1, 2]), [2, 1], [4, 1]), grey(&[1, 1, 2, 2]));
    }
}
