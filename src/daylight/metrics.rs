//! The metrics of standards, from a table of hours.
//!
//! Thresholds are met by what equals them, but for what a standard says is to be exceeded. Shares of a plane are by the area that each
//! point stands for.
//!
//! - *Occupied hours* (IES LM-83): 8 to 18 o'clock by the local clock, ten a day, each told by its middle: 3 650 h, 3 660 h with 29
//!   February. Hours without light count.
//! - *Daylight hours* (EN 17037): the half of the year's hours with the most diffuse light on open level ground, 4 380 h. Of hours with
//!   the same the earlier ones count.
//!
//! Blinds count in sDA alone; ASE is without them by its definition, and so is everything else.
//!
//! The standards themselves were not at hand: their words are those of guides and programs that apply them, and each figure says so.

use super::blinds::Operated;
use super::table::Table;
use super::view::Views;
use serde::Serialize;

/// What autonomy is by [lx] (LM-83).
pub const AUTONOMY: f64 = 300.0;

/// What direct sun exceeds [lx], and for more than how many hours (LM-83).
pub const EXPOSED: [f64; 2] = [1000.0, 250.0];

/// Between which useful daylight lies [lx] (Mardaljevic et al. 2012).
pub const USEFUL: [f64; 3] = [100.0, 300.0, 3000.0];

/// Target and minimum [lx] of the levels minimum, medium and high (EN 17037, table A.1).
pub const LEVELS: [(&str, f64, f64); 3] = [
    ("minimum", 300.0, 100.0),
    ("medium", 500.0, 300.0),
    ("high", 750.0, 500.0),
];

/// On which shares of a plane target and minimum are to be reached (EN 17037).
pub const ON_PLANE: [f64; 2] = [0.5, 0.95];

/// What one point has.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct ByPoint {
    /// Mean illuminance of the occupied hours [lx].
    pub mean_lx: f64,
    /// All light of the year [klx h].
    pub year_klxh: f64,
    /// Share of the occupied hours with at least 300 lx [%].
    pub da300_pct: f64,
    /// The same with blinds; without any the same.
    pub da300_blinds_pct: f64,
    /// Occupied hours in which the sun alone gives more than 1 000 lx [h].
    pub sun1000_h: f64,
    /// Share of the occupied hours below 100 lx [%].
    pub udi_below_100_pct: f64,
    /// Of 100 to below 300 lx [%].
    pub udi_100_300_pct: f64,
    /// Of 300 to 3 000 lx [%].
    pub udi_300_3000_pct: f64,
    /// Above 3 000 lx [%].
    pub udi_above_3000_pct: f64,
    /// What is reached in half of the daylight hours [lx].
    pub half_daylight_lx: f64,
    /// Daylight factor under the CIE overcast sky, type 16 [%].
    pub factor_pct: f64,
    /// Horizontal sight angle of the view out [degrees]; NaN: not assessed, as of the next two.
    pub sight_deg: f64,
    /// Outside distance of it [m].
    pub view_m: f64,
    /// Its layers: [`super::view::View::layers`].
    pub view_layers: f64,
}

impl ByPoint {
    /// The names of its figures, in the order of [`ByPoint::values`].
    pub const NAMES: [&str; 14] = [
        "mean_lx",
        "year_klxh",
        "da300_pct",
        "da300_blinds_pct",
        "sun1000_h",
        "udi_below_100_pct",
        "udi_100_300_pct",
        "udi_300_3000_pct",
        "udi_above_3000_pct",
        "half_daylight_lx",
        "factor_pct",
        "sight_deg",
        "view_m",
        "view_layers",
    ];

    /// Its figures.
    pub fn values(&self) -> [f64; 14] {
        [
            self.mean_lx,
            self.year_klxh,
            self.da300_pct,
            self.da300_blinds_pct,
            self.sun1000_h,
            self.udi_below_100_pct,
            self.udi_100_300_pct,
            self.udi_300_3000_pct,
            self.udi_above_3000_pct,
            self.half_daylight_lx,
            self.factor_pct,
            self.sight_deg,
            self.view_m,
            self.view_layers,
        ]
    }
}

/// How a plane is lit by daylight over a year.
#[derive(Debug, Clone)]
pub struct Metrics {
    /// Point by point.
    pub points: Vec<ByPoint>,
    /// Occupied hours of the year.
    pub occupied: usize,
    /// Daylight hours of the year.
    pub daylight: usize,
    /// The median of the diffuse light on open level ground in the daylight hours [lx].
    pub median_diffuse: f64,
    /// The groups of windows that have blinds, and the occupied hours in which each is closed.
    pub blinds: Vec<(String, usize)>,
    /// The materials of outer panes that have none, where others have.
    pub open: Vec<String>,
    /// Why the view's angle, and why its distance and layers are not assessed, where they are not.
    pub unknown_view: [Option<&'static str>; 2],
}

impl Metrics {
    /// Those of a table. `factors`: the daylight factor of each point [1].
    pub fn new(table: &Table, factors: &[f64]) -> Self {
        let occupied: Vec<usize> = (0..table.stamps.len())
            .filter(|hour| table.stamps[*hour].is_occupied())
            .collect();
        let all = 10 * table.days();
        let daylight = table.hours / 2;
        let most_diffuse = most_diffuse(table, daylight);
        let points = (0..table.points)
            .map(|point| {
                let count = |is: &dyn Fn(f64) -> bool| {
                    let some = occupied.iter().filter(|hour| is(table.at(**hour, point)));
                    some.count() as f64
                };
                let share = |hours: f64| 100.0 * hours / all.max(1) as f64;
                let dark = (all - occupied.len().min(all)) as f64;
                let sum = |hours: &[usize]| -> f64 {
                    hours.iter().map(|hour| table.at(*hour, point)).sum()
                };
                let sunny = occupied
                    .iter()
                    .filter(|hour| table.sun_at(**hour, point) > EXPOSED[0]);
                let every: f64 = (0..table.stamps.len())
                    .map(|hour| table.at(hour, point))
                    .sum();
                let [low, good, high] = USEFUL;
                let autonomous = share(count(&|e| e >= AUTONOMY));
                ByPoint {
                    mean_lx: sum(&occupied) / all.max(1) as f64,
                    year_klxh: every / 1000.0,
                    da300_pct: autonomous,
                    da300_blinds_pct: autonomous,
                    sun1000_h: sunny.count() as f64,
                    udi_below_100_pct: share(count(&|e| e < low) + dark),
                    udi_100_300_pct: share(count(&|e| (low..good).contains(&e))),
                    udi_300_3000_pct: share(count(&|e| (good..=high).contains(&e))),
                    udi_above_3000_pct: share(count(&|e| e > high)),
                    half_daylight_lx: half(
                        most_diffuse
                            .iter()
                            .map(|hour| table.at(*hour, point))
                            .collect(),
                        daylight,
                    ),
                    factor_pct: 100.0 * factors.get(point).copied().unwrap_or(0.0),
                    sight_deg: f64::NAN,
                    view_m: f64::NAN,
                    view_layers: f64::NAN,
                }
            })
            .collect();
        let diffuse = most_diffuse.iter().map(|hour| table.stamps[*hour].diffuse);
        Metrics {
            points,
            occupied: all,
            daylight,
            median_diffuse: half(diffuse.collect(), daylight),
            blinds: Vec::new(),
            open: Vec::new(),
            unknown_view: [Some("it was not looked for"); 2],
        }
    }

    /// The same with the views of the points.
    pub fn with_views(mut self, views: &Views) -> Self {
        for (point, view) in self.points.iter_mut().zip(&views.points) {
            point.sight_deg = view.sight_deg;
            point.view_m = view.distance;
            point.view_layers = view.layers;
        }
        self.unknown_view = views.unknown;
        self
    }

    /// The same with blinds that are operated, which autonomy alone is by.
    pub fn with_blinds(mut self, operated: &Operated) -> Self {
        let table = &operated.table;
        let occupied = (0..table.stamps.len()).filter(|hour| table.stamps[*hour].is_occupied());
        let occupied: Vec<usize> = occupied.collect();
        for (number, point) in self.points.iter_mut().enumerate() {
            let is_lit = |hour: &&usize| table.at(**hour, number) >= AUTONOMY;
            let lit = occupied.iter().filter(is_lit).count();
            point.da300_blinds_pct = 100.0 * lit as f64 / self.occupied.max(1) as f64;
        }
        let names = operated.groups.iter().map(|(name, _)| name.clone());
        let closed = names.zip((0..).map(|group| operated.hours(group)));
        self.blinds = closed.collect();
        self.open.clone_from(&operated.open);
        self
    }
}

/// So many of the hours with the most diffuse light; fewer where fewer are lit.
fn most_diffuse(table: &Table, count: usize) -> Vec<usize> {
    let mut hours: Vec<usize> = (0..table.stamps.len()).collect();
    let diffuse = |hour: &usize| table.stamps[*hour].diffuse;
    hours.sort_by(|a, b| diffuse(b).total_cmp(&diffuse(a)));
    hours.truncate(count);
    hours
}

/// What is reached in half of so many hours, of which those that are not given have 0: the greatest value that half of them have at
/// least.
fn half(mut values: Vec<f64>, count: usize) -> f64 {
    values.sort_by(|a, b| b.total_cmp(a));
    let needed = count.div_ceil(2);
    match needed {
        0 => 0.0,
        needed => values.get(needed - 1).copied().unwrap_or(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::super::epw::Date;
    use super::super::figures::Figure;
    use super::super::table::Stamp;
    use super::*;

    /// A year whose hours by day, 6 to 18 o'clock, have what a function says [lx]: of the number of the day, of the hour and of the point.
    fn table(
        points: usize,
        total: impl Fn(usize, u32, usize) -> f64,
        sun: impl Fn(usize, u32, usize) -> f64,
    ) -> Table {
        let mut table = Table {
            hours: 8760,
            points,
            ..Table::default()
        };
        for day in 0..365 {
            for hour in 7..=18 {
                table.stamps.push(Stamp {
                    number: 24 * day + hour as usize - 1,
                    date: Date { month: 1, day: 1 },
                    hour,
                    clock: f64::from(hour) - 0.5,
                    diffuse: 10_000.0,
                });
                for point in 0..points {
                    table.total.push(total(day, hour, point) as f32);
                    table.sun.push(sun(day, hour, point) as f32);
                }
            }
        }
        table
    }

    fn value(figures: &[Figure], key: &str) -> f64 {
        let found = figures.iter().find(|f| f.key == key);
        found.and_then(|f| f.value).expect("it is there")
    }

    #[test]
    fn hours_are_counted_as_they_are_occupied() {
        // 300 lx from 10 to 15 o'clock: five of ten hours, at the threshold itself.
        let five = |_: usize, hour: u32, _: usize| {
            if (11..=15).contains(&hour) {
                300.0
            } else {
                99.0
            }
        };
        let found = Metrics::new(&table(1, five, |_, _, _| 0.0), &[0.02]);
        let point = found.points[0];
        assert_eq!(found.occupied, 3650);
        assert_eq!(point.da300_pct, 50.0);
        assert_eq!(point.udi_300_3000_pct, 50.0);
        assert_eq!(point.udi_below_100_pct, 50.0);
        assert!((point.mean_lx - 199.5).abs() < 1e-9);
        assert!((point.year_klxh - 365.0 * (5.0 * 0.3 + 7.0 * 0.099)).abs() < 1e-6);
        // One hour less on one day, and the point is out.
        let less = |day: usize, hour: u32, point: usize| match (day, hour) {
            (17, 12) => 299.0,
            _ => five(day, hour, point),
        };
        let both = Metrics::new(&table(1, less, |_, _, _| 0.0), &[0.02]);
        assert_eq!(value(&found.figures(&[0], &[1.0]), "sda"), 100.0);
        assert_eq!(value(&both.figures(&[0], &[1.0]), "sda"), 0.0);
    }

    #[test]
    fn useful_daylight_has_its_borders() {
        let by_hour = |_: usize, hour: u32, _: usize| match hour {
            9 => 99.9,
            10 => 100.0,
            11 => 299.9,
            12 => 300.0,
            13 => 3000.0,
            14 => 3000.5,
            _ => 0.0,
        };
        let found = Metrics::new(&table(1, by_hour, |_, _, _| 0.0), &[0.0]);
        let p = found.points[0];
        let shares = [
            p.udi_below_100_pct,
            p.udi_100_300_pct,
            p.udi_300_3000_pct,
            p.udi_above_3000_pct,
        ];
        assert_eq!(shares, [50.0, 20.0, 20.0, 10.0]);
    }

    #[test]
    fn too_much_sun_is_more_than_1000_lx_in_more_than_250_hours() {
        // Points with 250 and with 251 hours, one with 1000 lx alone.
        let sun = |day: usize, hour: u32, point: usize| match (hour, point) {
            (12, 0) if day < 250 => 1001.0,
            (12, 1) if day < 251 => 1001.0,
            (12, 2) => 1000.0,
            // Nobody is there.
            (7, 3) => 50_000.0,
            _ => 0.0,
        };
        let found = Metrics::new(&table(4, |_, _, _| 0.0, sun), &[0.0; 4]);
        let hours: Vec<f64> = found.points.iter().map(|p| p.sun1000_h).collect();
        assert_eq!(hours, [250.0, 251.0, 0.0, 0.0]);
        // By area.
        let figures = found.figures(&[0, 1, 2, 3], &[1.0, 2.0, 1.0, 1.0]);
        assert!((value(&figures, "ase") - 40.0).abs() < 1e-9);
        assert_eq!(value(&found.figures(&[1], &[1.0; 4]), "ase"), 100.0);
    }

    #[test]
    fn half_of_the_daylight_hours_have_the_level() {
        // All 4 380 lit hours are daylight hours. Half of them have 500 lx, the others 100; a second point misses one hour.
        let total = |day: usize, hour: u32, point: usize| match hour {
            13..=18 if !(point == 1 && day == 0 && hour == 13) => 500.0,
            _ => 100.0,
        };
        let found = Metrics::new(&table(2, total, |_, _, _| 0.0), &[0.06, 0.03]);
        assert_eq!(found.daylight, 4380);
        assert_eq!(found.median_diffuse, 10_000.0);
        assert_eq!(
            [
                found.points[0].half_daylight_lx,
                found.points[1].half_daylight_lx
            ],
            [500.0, 100.0]
        );
        let figures = found.figures(&[0, 1], &[1.0, 1.0]);
        assert_eq!(value(&figures, "en17037_year_medium_target"), 50.0);
        assert_eq!(value(&figures, "en17037_year_minimum_minimum"), 100.0);
        assert_eq!(value(&figures, "en17037_year_medium_minimum"), 50.0);
        let verdict = |key: &str| {
            figures
                .iter()
                .find(|f| f.key == key)
                .expect("there")
                .verdict
                .clone()
        };
        assert_eq!(
            verdict("en17037_year_minimum_target"),
            "reached, by light from sides"
        );
        assert_eq!(verdict("en17037_year_medium_target"), "not reached");
        // By the factor: 300 lx of 10 000 are 3 %, 500 lx are 5 %.
        assert_eq!(value(&figures, "en17037_factor_minimum_target"), 100.0);
        assert_eq!(value(&figures, "en17037_factor_medium_target"), 50.0);
        assert_eq!(
            verdict("en17037_factor_minimum_target"),
            "reached, by light from sides or roof"
        );
        let view = figures.iter().find(|f| f.key == "view_high");
        let view = view.expect("there");
        assert!(view.value.is_none() && view.verdict.starts_with("not assessed: "));
    }

    #[test]
    fn ten_parts_of_a_hundred_are_ten_percent_and_no_light_is_no_factor() {
        // The sum of ten areas of 0.1 m2 over all of 10 m2 is a bit more than a tenth.
        let sun = |_: usize, _: u32, point: usize| if point < 10 { 2000.0 } else { 0.0 };
        let mut table = table(100, |_, _, _| 0.0, sun);
        table
            .stamps
            .iter_mut()
            .for_each(|stamp| stamp.diffuse = 0.0);
        let found = Metrics::new(&table, &[0.0; 100]);
        let all: Vec<usize> = (0..100).collect();
        for area in [0.1, 0.3, 0.07] {
            let figures = found.figures(&all, &[area; 100]);
            let of = |key: &str| figures.iter().find(|f| f.key == key).expect("there");
            assert_eq!(of("ase").verdict, "10 % or less", "{:?}", of("ase").value);
            let factor = of("en17037_factor_high_target");
            assert_eq!(
                (factor.value, factor.verdict.as_str()),
                (None, "not assessed")
            );
            assert!(!factor.name.contains("inf"), "{}", factor.name);
        }
    }

    #[test]
    fn where_fewer_hours_are_lit_the_dark_ones_count() {
        assert_eq!(half(vec![5.0, 1.0, 4.0, 2.0], 4), 4.0);
        assert_eq!(half(vec![5.0, 1.0], 4), 1.0);
        assert_eq!(half(vec![5.0], 4), 0.0);
        assert_eq!(half(Vec::new(), 0), 0.0);
    }
}
