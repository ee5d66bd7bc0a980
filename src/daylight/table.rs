//! The illuminance of points in each hour of a year.

use super::epw::Date;

/// From when to when rooms are occupied by the local clock [h] (IES LM-83).
pub const OCCUPIED: [f64; 2] = [8.0, 18.0];

/// An hour of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stamp {
    /// Its number in the year, from 0.
    pub number: usize,
    /// Its date, standard time.
    pub date: Date,
    /// 1 to 24: the hour that ends then, standard time.
    pub hour: u32,
    /// Its middle by the local clock [h]: with summer time, where there is one.
    pub clock: f64,
    /// What the sky gives to open level ground [lx].
    pub diffuse: f64,
}

impl Stamp {
    /// Whether rooms are occupied in its middle.
    pub fn is_occupied(&self) -> bool {
        (OCCUPIED[0]..OCCUPIED[1]).contains(&self.clock)
    }
}

/// The illuminance of points in the lit hours of a year; in all others it is 0.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// The lit hours, in order.
    pub stamps: Vec<Stamp>,
    /// All hours of the year: 8 760 or 8 784.
    pub hours: usize,
    /// Points.
    pub points: usize,
    /// Illuminance [lx], hour by hour, in each point by point.
    pub total: Vec<f32>,
    /// The same straight from the sun alone.
    pub sun: Vec<f32>,
}

impl Table {
    /// Days of the year.
    pub fn days(&self) -> usize {
        self.hours / 24
    }

    /// What the points have in a lit hour [lx].
    pub fn row(&self, hour: usize) -> &[f32] {
        &self.total[hour * self.points..(hour + 1) * self.points]
    }

    /// What a point has in a lit hour [lx].
    pub fn at(&self, hour: usize, point: usize) -> f64 {
        f64::from(self.total[hour * self.points + point])
    }

    /// What it has straight from the sun [lx].
    pub fn sun_at(&self, hour: usize, point: usize) -> f64 {
        f64::from(self.sun[hour * self.points + point])
    }

    /// The mean over the points in each lit hour, weighted by area [lx].
    pub fn means(&self, areas: &[f64]) -> Vec<f64> {
        let whole: f64 = areas.iter().sum();
        let mean = |hour: usize| {
            let sum = self.row(hour).iter().zip(areas);
            sum.map(|(e, area)| f64::from(*e) * area).sum::<f64>() / whole
        };
        (0..self.stamps.len()).map(mean).collect()
    }
}
