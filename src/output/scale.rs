//! Values as colours: a scale with its range, its round values and their colours.

use super::canvas::Color;
use crate::error::{Error, Result};

/// From values to colours: a range, divided evenly or by ratios.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// What is shown, as the legend names it.
    pub quantity: String,
    /// Its unit; empty for none.
    pub unit: String,
    low: f64,
    high: f64,
    is_log: bool,
}

/// From this ratio of its ends on a scale that does not start at 0 goes by ratios.
const LOG_FROM: f64 = 20.0;

/// The most round values of a scale.
const MOST_LEVELS: usize = 12;

impl Scale {
    /// A scale between two values; by ratios where both are above 0 and one is 20 times the other or more.
    ///
    /// # Errors
    /// [`Error::Input`] where they are not finite or `high` is not above `low`.
    pub fn new(quantity: &str, unit: &str, low: f64, high: f64) -> Result<Self> {
        if !(low.is_finite() && high.is_finite() && high > low) {
            return Err(Error::input(
                format!("the scale {low}..{high}"),
                "its upper end is not above its lower end",
                "write it like 0..2000",
            ));
        }
        Ok(Scale {
            quantity: quantity.into(),
            unit: unit.into(),
            low,
            high,
            is_log: low > 0.0 && high >= LOG_FROM * low,
        })
    }

    /// Reads `LOW..HIGH`.
    ///
    /// # Errors
    /// [`Error::Input`] for another text, and those of [`Scale::new`].
    pub fn parse(quantity: &str, unit: &str, text: &str) -> Result<Self> {
        let ends = text.split_once("..").and_then(|(low, high)| {
            let number = |text: &str| text.trim().parse::<f64>().ok();
            Some((number(low)?, number(high)?))
        });
        let Some((low, high)) = ends else {
            return Err(Error::input(
                format!("the scale `{text}`"),
                "it is no range",
                "write it like 0..2000",
            ));
        };
        Scale::new(quantity, unit, low, high)
    }

    /// A scale that holds values, between round numbers; 0 to 1 where there are none above 0.
    pub fn of(quantity: &str, unit: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let positive = values.into_iter().filter(|v| v.is_finite() && *v > 0.0);
        let ends = positive.fold(None, |ends: Option<(f64, f64)>, v| {
            let (low, high) = ends.unwrap_or((v, v));
            Some((low.min(v), high.max(v)))
        });
        let (low, high) = ends.unwrap_or((0.5, 1.0));
        let is_log = high >= LOG_FROM * low;
        let (low, high) = match is_log {
            // No more than three powers of ten: darker is dark.
            true => (round_down(low.max(1e-3 * high)), round_up(high)),
            false => (0.0, round_up(high)),
        };
        Scale {
            quantity: quantity.into(),
            unit: unit.into(),
            low,
            high,
            is_log,
        }
    }

    /// An even scale from 0 to a round number that holds values; 0 to 1 where there are none above 0.
    pub fn from_zero(quantity: &str, unit: &str, values: impl IntoIterator<Item = f64>) -> Self {
        Scale {
            low: 0.0,
            is_log: false,
            ..Scale::of(quantity, unit, values)
        }
    }

    /// The same scale of another quantity.
    pub fn named(self, quantity: &str, unit: &str) -> Self {
        Scale {
            quantity: quantity.into(),
            unit: unit.into(),
            ..self
        }
    }

    /// The least and the greatest value.
    pub fn range(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Whether it goes by ratios.
    pub fn is_log(&self) -> bool {
        self.is_log
    }

    /// Where a value lies between the ends, 0 to 1; values beyond are at the ends.
    pub fn place(&self, value: f64) -> f64 {
        let share = match self.is_log {
            true => (value.max(f64::MIN_POSITIVE) / self.low).ln() / (self.high / self.low).ln(),
            false => (value - self.low) / (self.high - self.low),
        };
        share.clamp(0.0, 1.0)
    }

    /// The value at a place between the ends.
    pub fn value(&self, place: f64) -> f64 {
        match self.is_log {
            true => self.low * (self.high / self.low).powf(place),
            false => self.low + place * (self.high - self.low),
        }
    }

    /// The colour of a value.
    pub fn color(&self, value: f64) -> Color {
        viridis(self.place(value))
    }

    /// Round values from end to end, at most twelve: where isolines run and what the legend names.
    pub fn levels(&self) -> Vec<f64> {
        let decade = |steps: &[f64]| -> Vec<f64> {
            let exponent = |value: f64| value.log10().floor() as i32;
            let all = exponent(self.low) - 1..=exponent(self.high) + 1;
            let all = all.flat_map(|k| steps.iter().map(move |s| s * 10f64.powi(k)));
            all.filter(|v| self.holds(*v)).collect()
        };
        if self.is_log {
            let series: [&[f64]; 3] = [&[1.0, 2.0, 3.0, 5.0, 7.5], &[1.0, 2.0, 5.0], &[1.0]];
            let finest = series.iter().map(|steps| decade(steps));
            return finest
                .into_iter()
                .find(|levels| levels.len() <= MOST_LEVELS)
                .unwrap_or_default();
        }
        let span = self.high - self.low;
        let unit = 10f64.powf((span / 10.0).log10().floor());
        let steps = [1.0, 2.0, 2.5, 5.0, 10.0].map(|s| s * unit);
        let few = |step: &f64| span / step <= MOST_LEVELS as f64 - 1.0;
        let step = steps.into_iter().find(few).unwrap_or(span);
        let first = (self.low / step - 1e-9).ceil() as i64;
        (first..)
            .map(|i| i as f64 * step)
            .take_while(|v| self.holds(*v))
            .collect()
    }

    fn holds(&self, value: f64) -> bool {
        let slack = 1e-9 * (self.high - self.low);
        value >= self.low - slack.min(1e-9 * self.low.abs()) && value <= self.high + slack
    }

    /// The quantity with its unit: `illuminance [lx]`.
    pub fn title(&self) -> String {
        match self.unit.as_str() {
            "" => self.quantity.clone(),
            unit => format!("{} [{unit}]", self.quantity),
        }
    }
}

/// The next of 1, 2, 3, 5, 7.5 times a power of ten that is not above a value.
fn round_down(value: f64) -> f64 {
    let unit = 10f64.powf(value.log10().floor());
    let steps = [7.5, 5.0, 3.0, 2.0, 1.0].map(|s| s * unit);
    (steps.into_iter().find(|s| *s <= value * (1.0 + 1e-9))).unwrap_or(unit)
}

/// The next of them that is not below a value.
fn round_up(value: f64) -> f64 {
    let unit = 10f64.powf(value.log10().floor());
    let steps = [1.0, 2.0, 3.0, 5.0, 7.5].map(|s| s * unit);
    (steps.into_iter().find(|s| *s >= value * (1.0 - 1e-9))).unwrap_or(10.0 * unit)
}

/// A value with three digits that count, without zeros that do not.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".into();
    }
    if value.abs() < 1e-4 {
        return format!("{value:.1e}");
    }
    let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// The colour map viridis (Smith, van der Walt & Firing 2015, matplotlib, CC0), whose lightness rises evenly for all eyes: polynomials
/// through its table (M. Zucker, CC0), within 0.02 of it.
pub fn viridis(place: f64) -> Color {
    const COEFFICIENTS: [[f64; 3]; 7] = [
        [0.277_727_327, 0.005_407_345, 0.334_099_805],
        [0.105_093_043, 1.404_613_53, 1.384_590_163],
        [-0.330_861_829, 0.214_847_559, 0.095_095_163],
        [-4.634_230_499, -5.799_100_973, -19.332_440_956],
        [6.228_269_936, 14.179_933_367, 56.690_552_601],
        [4.776_384_998, -13.745_145_378, -65.353_032_633],
        [-5.435_455_856, 4.645_852_612, 26.312_435_25],
    ];
    let t = place.clamp(0.0, 1.0);
    std::array::from_fn(|channel| {
        let horner = |sum: f64, c: &[f64; 3]| sum * t + c[channel];
        let value = COEFFICIENTS.iter().rev().fold(0.0, horner);
        (255.0 * value).round().clamp(0.0, 255.0) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::srgb_decode;

    #[test]
    fn values_have_places_and_places_values() {
        let linear = Scale::parse("luminance", "cd/m2", "0..2000").unwrap();
        assert!(!linear.is_log());
        assert_eq!(
            linear.levels(),
            [
                0.0, 200.0, 400.0, 600.0, 800.0, 1000.0, 1200.0, 1400.0, 1600.0, 1800.0, 2000.0
            ]
        );
        let log = Scale::of("illuminance", "lx", [0.0, 43.0, 8123.0]);
        assert_eq!(log.range(), [30.0, 10_000.0]);
        assert_eq!(
            log.levels(),
            [50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10_000.0]
        );
        for scale in [&linear, &log] {
            for value in [50.0, 300.0, 1999.0] {
                assert!((scale.value(scale.place(value)) / value - 1.0).abs() < 1e-12);
            }
        }
        for bad in ["2000", "5..5", "9..1", "a..b", "0..inf"] {
            assert!(
                Scale::parse("x", "", bad).is_err_and(|e| e.is_input()),
                "{bad}"
            );
        }
        let hours = Scale::from_zero("hours of sun", "h", [0.0, 0.2, 8.3]);
        assert_eq!((hours.range(), hours.is_log()), ([0.0, 10.0], false));
        assert!(hours.place(0.2) > hours.place(0.0));
        let dark = Scale::of("illuminance", "lx", [0.0, 0.0]);
        assert_eq!(dark.range(), [0.0, 1.0]);
    }

    #[test]
    fn lightness_rises_along_the_colours() {
        let luminance = |c: Color| {
            let [r, g, b] = c.map(|c| srgb_decode(f64::from(c) / 255.0));
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let all: Vec<f64> = (0..=50)
            .map(|i| luminance(viridis(f64::from(i) / 50.0)))
            .collect();
        assert!(all.windows(2).all(|pair| pair[1] > pair[0]));
        // The ends of matplotlib's table.
        for (place, known) in [
            (0.0, [68, 1, 84]),
            (0.5, [33, 145, 140]),
            (1.0, [253, 231, 37]),
        ] {
            let colour = viridis(place);
            let off = colour.iter().zip(known).map(|(a, b)| i32::from(*a) - b);
            assert!(off.map(i32::abs).max() <= Some(6), "{place}");
        }
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (0.0312, "0.0312"),
            (2.5, "2.5"),
            (750.0, "750"),
            (12_345.6, "12346"),
            (5.5e-8, "5.5e-8"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
