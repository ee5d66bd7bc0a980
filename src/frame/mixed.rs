//! How light spreads over the area of a pixel: what a display has to show of it.
//!
//! A display shows nothing brighter than its white. A pixel of which a tenth is sky of 10 000 cd/m2 and the rest dark stone has a
//! linear mean that is as good as the sky's, and would be shown like it: the edge moves by a pixel and has steps. What is to be
//! shown is a tenth of what is shown of the sky and nine tenths of what is shown of the stone. Exposure is known only when the
//! picture is finished, and may be chosen anew; so the colours themselves are kept, of those pixels in which they differ.

use crate::memory;
use glam::{DVec3, Vec3};

/// In how many parts a pixel is kept at most.
const MOST: usize = 8;

/// Colours are one part when their channels differ by no more than this share of the brighter one's greatest. The display transform
/// is so nearly straight over such a step that what it makes of the mean is within a quarter of an 8-bit code of the mean of what it
/// makes.
const ALIKE: f32 = 0.2;

/// Samples of a pixel that are alike.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Part {
    /// Their mean: in a [`Mixture`] a colour [cd/m2], in [`Mixed`] relative to the pixel's, channel by channel.
    colour: Vec3,
    samples: u16,
    /// How many parts of the same pixel stand behind this.
    behind: u16,
}

/// The samples of a pixel as they are taken.
#[derive(Debug, Clone, Copy, Default)]
pub struct Mixture {
    parts: [Part; MOST],
    count: usize,
}

impl Mixture {
    /// Takes another sample [cd/m2].
    pub fn add(&mut self, sample: Vec3) {
        let apart = |part: &Part| {
            let brighter = part.colour.max_element().max(sample.max_element());
            (part.colour - sample).abs().max_element() / brighter.max(f32::MIN_POSITIVE)
        };
        let parts = self.parts[..self.count].iter_mut();
        let nearest = parts.min_by(|a, b| apart(a).total_cmp(&apart(b)));
        match nearest {
            Some(part) if self.count == MOST || apart(part) <= ALIKE => {
                part.samples = part.samples.saturating_add(1);
                part.colour += (sample - part.colour) / f32::from(part.samples);
            }
            _ => {
                self.parts[self.count] = Part {
                    colour: sample,
                    samples: 1,
                    behind: 0,
                };
                self.count += 1;
            }
        }
    }

    /// Whether its mean does not say what a display has to show.
    pub fn is_mixed(&self) -> bool {
        self.count > 1
    }
}

/// The pixels of a picture that are mixed. Nothing is held of the others.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mixed {
    /// Where in `parts` each pixel begins, or [`NONE`]; empty while no pixel is mixed.
    first: Vec<u32>,
    parts: Vec<Part>,
}

const NONE: u32 = u32::MAX;

impl Mixed {
    /// Keeps the parts of a pixel of a picture with `pixels` of them, unless that would take more than `most` bytes or there is not
    /// enough memory: `false` then.
    pub(crate) fn keep(
        &mut self,
        (pixel, pixels): (usize, usize),
        mixture: &Mixture,
        most: u64,
    ) -> bool {
        let parts = &mixture.parts[..mixture.count];
        let begin = self.parts.len();
        let bytes = 4 * pixels + (begin + parts.len()) * size_of::<Part>();
        if bytes as u64 > most || begin + parts.len() >= NONE as usize {
            return false;
        }
        if self.first.is_empty() {
            match memory::filled("the picture's edges", pixels, NONE) {
                Ok(first) => self.first = first,
                Err(_) => return false,
            }
        }
        if self.parts.try_reserve(parts.len()).is_err() {
            return false;
        }
        let samples: f32 = parts.iter().map(|part| f32::from(part.samples)).sum();
        let share = |part: &Part| f32::from(part.samples) / samples;
        let mean: Vec3 = parts.iter().map(|part| share(part) * part.colour).sum();
        self.first[pixel] = begin as u32;
        for (part, behind) in parts.iter().zip((0..parts.len() as u16).rev()) {
            let relative = part.colour / mean;
            self.parts.push(Part {
                colour: Vec3::select(mean.cmpgt(Vec3::ZERO), relative, Vec3::ONE),
                behind,
                ..*part
            });
        }
        true
    }

    fn of(&self, pixel: usize) -> &[Part] {
        let begin = self.first.get(pixel).copied().unwrap_or(NONE) as usize;
        match self.parts.get(begin) {
            Some(part) => &self.parts[begin..=begin + usize::from(part.behind)],
            None => &[],
        }
    }

    /// The colours that a pixel holds, of which the mean is `picture`, and the share of its area that each takes; all of it for a
    /// pixel that is not mixed.
    pub(super) fn shares(
        &self,
        pixel: usize,
        picture: DVec3,
    ) -> impl Iterator<Item = (f64, DVec3)> {
        let parts = self.of(pixel);
        let samples: f64 = parts.iter().map(|part| f64::from(part.samples)).sum();
        let mixed = parts.iter().map(move |part| {
            let share = f64::from(part.samples) / samples;
            (share, part.colour.as_dvec3() * picture)
        });
        mixed.chain(parts.is_empty().then_some((1.0, picture)))
    }

    /// How many pixels are mixed.
    pub fn pixels(&self) -> usize {
        self.parts.iter().filter(|part| part.behind == 0).count()
    }

    /// The first pixel whose parts are not finite or negative, or that does not exist.
    pub(super) fn spoilt(&self, pixels: usize) -> Option<usize> {
        let bad = |part: &Part| !(part.colour.is_finite() && part.colour.min_element() >= 0.0);
        let here = 0..self.first.len();
        here.into_iter()
            .find(|pixel| *pixel >= pixels || self.of(*pixel).iter().any(bad))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mixture(samples: &[f32]) -> Mixture {
        let mut mixture = Mixture::default();
        for sample in samples {
            mixture.add(*sample * Vec3::new(1.0, 0.8, 0.6));
        }
        mixture
    }

    fn shares(mixed: &Mixed, pixel: usize, picture: f64) -> Vec<(f64, f64)> {
        let found = mixed.shares(pixel, DVec3::splat(picture));
        found.map(|(share, colour)| (share, colour.x)).collect()
    }

    #[test]
    fn parts_have_their_share_and_their_mean_is_the_pixel() {
        let mut mixed = Mixed::default();
        let pixel = mixture(&[1.0, 10_000.0, 1.1, 10_000.0, 0.9, 1.0, 1.0, 1.0]);
        assert!(pixel.is_mixed() && !mixture(&[1.0, 1.1, 0.95, 1.05]).is_mixed());
        assert!(mixed.keep((2, 4), &pixel, 1 << 10));
        let mean = (6.0 + 20_000.0) / 8.0;
        let found = shares(&mixed, 2, mean);
        assert_eq!(found.len(), 2);
        for ((share, colour), truth) in found.iter().zip([(0.75, 1.0), (0.25, 10_000.0)]) {
            assert_eq!(*share, truth.0);
            assert!((colour / truth.1 - 1.0).abs() < 1e-5, "{colour}");
        }
        // A picture that is made twice as bright is mixed as before; others are not mixed.
        let twice = shares(&mixed, 2, 2.0 * mean);
        assert!((twice[1].1 / 20_000.0 - 1.0).abs() < 1e-5);
        assert_eq!(shares(&mixed, 1, 7.0), [(1.0, 7.0)]);
        assert_eq!(shares(&Mixed::default(), 1, 7.0), [(1.0, 7.0)]);
        assert_eq!(mixed.pixels(), 1);
        assert_eq!(mixed.spoilt(4), None);
    }

    #[test]
    fn more_colours_than_parts_join_the_nearest() {
        let samples: Vec<f32> = (0..64).map(|i| 1.5f32.powi(i % 20)).collect();
        let pixel = mixture(&samples);
        let mut mixed = Mixed::default();
        assert!(mixed.keep((0, 1), &pixel, 1 << 10));
        let mean = samples.iter().sum::<f32>() / 64.0;
        let found = shares(&mixed, 0, f64::from(mean));
        assert_eq!(found.len(), MOST);
        let sum: f64 = found.iter().map(|(share, colour)| share * colour).sum();
        assert!((sum / f64::from(mean) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn black_channels_and_bounds() {
        let mut pixel = Mixture::default();
        pixel.add(Vec3::ZERO);
        pixel.add(Vec3::new(0.0, 1.0, 0.0));
        let mut mixed = Mixed::default();
        assert!(mixed.keep((0, 1), &pixel, 36));
        assert!(!mixed.keep((0, 1), &pixel, 36), "it would take 68 bytes");
        let found = mixed.shares(0, DVec3::new(0.0, 0.5, 0.0));
        let found: Vec<DVec3> = found.map(|(_, colour)| colour).collect();
        assert_eq!(found, [DVec3::ZERO, DVec3::Y]);
    }

    #[test]
    fn spoilt_parts_are_found() {
        let mut sound = Mixed::default();
        assert!(sound.keep((2, 4), &mixture(&[1.0, 10_000.0]), 1 << 10));
        for bad in [f32::NAN, f32::INFINITY, -1e-3] {
            let mut mixed = sound.clone();
            mixed.parts[1].colour.y = bad;
            assert_eq!(mixed.spoilt(4), Some(2), "{bad}");
        }
        assert_eq!(sound.spoilt(4), None);
        assert_eq!(
            sound.spoilt(3),
            Some(3),
            "a picture of three pixels has no fourth"
        );
    }
}
