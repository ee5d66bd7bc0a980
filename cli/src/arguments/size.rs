//! The size of a picture, of which one side may follow from the other.

/// Width and height, or one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SizeFlag {
    width: Option<u32>,
    height: Option<u32>,
}

impl std::fmt::Display for SizeFlag {
    /// As it was written: what follows from the other side is left out.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.width, self.height) {
            (Some(width), Some(height)) => write!(f, "{width}x{height}"),
            (None, Some(height)) => write!(f, "x{height}"),
            (width, None) => write!(f, "{}", width.unwrap_or_default()),
        }
    }
}

impl SizeFlag {
    /// Another size in the words of this one.
    pub fn written(self, [width, height]: [u32; 2]) -> SizeFlag {
        SizeFlag {
            width: self.width.map(|_| width),
            height: self.height.map(|_| height),
        }
    }

    /// Both sides, in the shape of another size where one is not given.
    pub fn in_shape_of(self, [width, height]: [u32; 2]) -> [u32; 2] {
        let scaled = |side: u32, from: u32, to: u32| {
            let scaled = f64::from(side) * f64::from(to) / f64::from(from.max(1));
            scaled.round().clamp(1.0, f64::from(u32::MAX)) as u32
        };
        match (self.width, self.height) {
            (Some(w), Some(h)) => [w, h],
            (Some(w), None) => [w, scaled(w, width, height)],
            (None, Some(h)) => [scaled(h, height, width), h],
            (None, None) => [width, height],
        }
    }
}

/// `960x600`; `960` and `960x`, a width, and `x600`, a height.
pub fn size(text: &str) -> Result<SizeFlag, String> {
    let (width, height) = text.split_once(['x', 'X']).unwrap_or((text, ""));
    let side = |text: &str| match text.trim() {
        "" => Ok(None),
        digits => digits.parse().map(Some),
    };
    match (side(width), side(height)) {
        (Ok(width), Ok(height)) if width.or(height).is_some() => Ok(SizeFlag { width, height }),
        _ => Err(
            "WIDTHxHEIGHT was expected, as in 960x600, or a width alone, 960, or a height, x600"
                .into(),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_side_follows_from_the_other() {
        let of = |text: &str| size(text).map(|size| size.in_shape_of([960, 600]));
        assert_eq!(of("960x600"), Ok([960, 600]));
        assert_eq!(of("320 x 100"), Ok([320, 100]));
        for width in ["1600", "1600x", "1600X"] {
            assert_eq!(of(width), Ok([1600, 1000]), "{width}");
        }
        assert_eq!(of("x400"), Ok([640, 400]));
        assert_eq!(of("1"), Ok([1, 1]));
        for (text, other) in [("101x", "64"), ("x7", "x32"), ("9 x 9", "64x32")] {
            let written = size(text).map(|size| size.written([64, 32]).to_string());
            assert_eq!(written.as_deref(), Ok(other), "{text}");
        }
        for bad in ["", "x", "-3x4", "3x4x5", "1.5x2", "wide"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }
}
