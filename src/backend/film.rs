//! The picture as it grows: values by field, means over samples, and whether it fits into memory.

use crate::error::{Error, Result};
use crate::frame::{Field, Frame, Layer, Mixture, Part};
use crate::memory;
use glam::{UVec2, Vec3};

/// Whether a picture of a size, which holds so many bytes, is within a limit.
///
/// # Errors
/// [`Error::Input`] when it is not.
pub(super) fn fits([width, height]: [u32; 2], bytes: u64, limit: u64) -> Result<()> {
    if bytes <= limit {
        return Ok(());
    }
    Err(Error::input(
        format!("--size {width}x{height}"),
        format!(
            "the frame would hold {} MiB, more than the limit of {} MiB",
            bytes >> 20,
            limit >> 20
        ),
        "make the picture smaller, leave effects out with --without, or raise the limit with --max-memory",
    ))
}

/// A picture in the making.
pub(super) struct Film {
    frame: Frame,
    /// Which of the frame's layers each field is.
    slots: [Option<usize>; Field::COUNT],
    shared: bool,
    /// What the edges of pixels may hold [bytes].
    room: u64,
    /// Mixed pixels for which there was none.
    unresolved: usize,
}

impl Film {
    /// Memory that a picture with these fields holds [bytes].
    pub fn bytes([width, height]: [u32; 2], written: &[Field]) -> u64 {
        let layers = written.iter().filter(|field| field.is_layer()).count();
        u64::from(width) * u64::from(height) * Frame::bytes_per_pixel(layers) as u64
    }

    /// A black picture with room for the fields that a plan writes.
    ///
    /// # Errors
    /// [`Error::Input`] when it would hold more than `limit` bytes, [`Error::Failed`] when the system has not as much.
    pub fn new([width, height]: [u32; 2], written: &[Field], limit: u64) -> Result<Self> {
        let bytes = Self::bytes([width, height], written);
        fits([width, height], bytes, limit)?;
        let what = "the picture";
        memory::check(what, bytes)?;
        let mut frame = Frame::new(width, height)?;
        let mut slots = [None; Field::COUNT];
        let pixels = frame.pixels();
        for field in Field::layers().filter(|field| written.contains(field)) {
            slots[field as usize] = Some(frame.layers.len());
            frame.layers.push(Layer {
                name: field.name(),
                rgb: memory::filled(what, pixels, Vec3::ZERO)?,
            });
        }
        let shared = written.iter().any(|field| field.part() == Part::Share);
        if shared {
            frame.transmittance.fill(Vec3::ZERO);
        }
        Ok(Film {
            frame,
            slots,
            shared,
            room: limit - bytes,
            unresolved: 0,
        })
    }

    fn index(&self, pixel: UVec2) -> usize {
        (pixel.y * self.frame.width + pixel.x) as usize
    }

    fn value(&mut self, field: Field, pixel: UVec2) -> Option<&mut Vec3> {
        let index = self.index(pixel);
        match (self.slots[field as usize], field.part()) {
            (Some(slot), _) => Some(&mut self.frame.layers[slot].rgb[index]),
            (None, Part::Share) if self.shared => Some(&mut self.frame.transmittance[index]),
            _ => None,
        }
    }

    /// Sets the value of a field; one that has no room is left out.
    pub fn set(&mut self, field: Field, pixel: UVec2, value: Vec3) {
        if let Some(place) = self.value(field, pixel) {
            *place = value;
        }
    }

    /// Adds a sample's share to the value of a field.
    pub fn add(&mut self, field: Field, pixel: UVec2, value: Vec3) {
        if let Some(place) = self.value(field, pixel) {
            *place += value;
        }
    }

    /// Sets what a pixel shows on a display, where its mean does not say it.
    pub fn mix(&mut self, pixel: UVec2, mixture: &Mixture) {
        let place = (self.index(pixel), self.frame.pixels());
        if mixture.is_mixed() && !self.frame.mixed.keep(place, mixture, self.room) {
            self.unresolved += 1;
        }
    }

    /// What is to be said of the picture.
    pub fn notes(&self) -> Vec<String> {
        let count = self.unresolved;
        let note = || {
            format!(
                "{count} pixels at edges of very different brightness are shown by their linear mean, as the frame's memory is full \
                 (--max-memory)"
            )
        };
        (count > 0).then(note).into_iter().collect()
    }

    /// Sets distance [m] and normal of what a pixel shows.
    pub fn set_surface(&mut self, pixel: UVec2, distance: f32, normal: Vec3) {
        let index = self.index(pixel);
        self.frame.depth[index] = distance;
        self.frame.normal[index] = normal;
    }

    /// The picture so far.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The finished picture.
    pub fn into_frame(self) -> Frame {
        self.frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_find_their_place_and_what_has_none_is_left_out() {
        let written = [Field::Surface, Field::Sky, Field::Transmittance];
        let mut film = Film::new([2, 1], &written, 1 << 20).expect("it fits");
        let pixel = UVec2::new(1, 0);
        film.add(Field::Sky, pixel, Vec3::splat(1.0));
        film.add(Field::Sky, pixel, Vec3::splat(2.0));
        film.set(Field::Transmittance, pixel, Vec3::splat(0.5));
        film.set(Field::Sun, pixel, Vec3::ONE);
        film.set_surface(pixel, 3.0, Vec3::Y);
        let frame = film.into_frame();
        assert_eq!(frame.layers.len(), 1);
        assert_eq!(frame.layers[0].rgb, [Vec3::ZERO, Vec3::splat(3.0)]);
        assert_eq!(frame.transmittance[1], Vec3::splat(0.5));
        assert_eq!(frame.depth[1], 3.0);
        frame.check().expect("it can be written");
    }

    #[test]
    fn edges_that_do_not_fit_are_said_and_shown_by_their_mean() {
        let written = [Field::Sky];
        let bytes = Film::bytes([2, 2], &written);
        let mut mixture = Mixture::default();
        mixture.add(Vec3::ONE);
        mixture.add(Vec3::splat(1e4));
        for (more, kept) in [(0, 0), (48, 1), (80, 2)] {
            let mut film = Film::new([2, 2], &written, bytes + more).expect("it fits");
            film.mix(UVec2::ZERO, &mixture);
            film.mix(UVec2::ONE, &mixture);
            let notes = film.notes();
            let frame = film.into_frame();
            assert_eq!(frame.mixed.pixels(), kept);
            assert_eq!(notes.is_empty(), kept == 2);
            if let [note] = &notes[..] {
                assert!(note.starts_with(&format!("{} pixels", 2 - kept)), "{note}");
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let bytes = Film::bytes([100, 100], &[Field::Sun]);
        assert!(Film::new([100, 100], &[Field::Sun], bytes).is_ok());
        let Err(error) = Film::new([100, 100], &[Field::Sun], bytes - 1) else {
            panic!("it does not fit");
        };
        assert!(error.is_input() && error.remedy().contains("--max-memory"));
    }
}
