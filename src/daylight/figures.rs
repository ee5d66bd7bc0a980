//! What metrics say of a room: figures with their verdicts, their methods and the standards that they are of.
//!
//! Shares of a plane are by the area that each point stands for.

use super::blinds::CLOSES;
use super::metrics::{ByPoint, EXPOSED, LEVELS, Metrics, ON_PLANE};
use super::view;
use serde::Serialize;

/// Sums of areas are off by less than this [% of a plane].
const SLACK: f64 = 1e-7;

const LM_83: &str = "IES LM-83-12 and ANSI/IES LM-83-22, not read in print";
const UDI: &str = "Mardaljevic et al. 2012, not read in print";
const EN_17037: &str = "EN 17037:2018+A1:2021, not read in print";
const CIE: &str = "CIE S 011 / ISO 15469:2004";

/// A figure of a room, with where it comes from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// Its name for programs.
    pub key: String,
    /// Its name for people.
    pub name: String,
    /// What it is; `None`: not assessed.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: &'static str,
    /// What it means for the standard: reached, not reached, and why it was not assessed.
    pub verdict: String,
    /// How it is found.
    pub method: String,
    /// Whose it is, with the edition.
    pub edition: &'static str,
}

/// A number of a point.
type Of = fn(&ByPoint) -> f64;

/// The share of a plane's area whose points are such [1].
type Part<'a> = dyn Fn(&dyn Fn(&ByPoint) -> bool) -> f64 + 'a;

impl Metrics {
    /// The figures of some of its points, each of an area.
    pub fn figures(&self, points: &[usize], areas: &[f64]) -> Vec<Figure> {
        let whole: f64 = points.iter().map(|p| areas[*p]).sum();
        let part = |is: &dyn Fn(&ByPoint) -> bool| -> f64 {
            let some = points.iter().filter(|p| is(&self.points[**p]));
            // The sum of nothing is -0.
            (0.0 + some.map(|p| areas[*p]).sum::<f64>()) / whole
        };
        let mean = |of: &dyn Fn(&ByPoint) -> f64| -> f64 {
            let sum = points.iter().map(|p| areas[*p] * of(&self.points[*p]));
            sum.sum::<f64>() / whole
        };
        let mut all = vec![figure(
            "mean",
            "Mean illuminance",
            mean(&|p| p.mean_lx),
            "lx",
            format!(
                "mean over the plane and the {} occupied hours",
                self.occupied
            ),
            "",
        )];
        self.by_autonomy(&mut all, &part);
        let exposed = 100.0 * part(&|p| p.sun1000_h > EXPOSED[1]);
        all.push(Figure {
            verdict: if exposed <= 10.0 + SLACK { "10 % or less" } else { "above 10 %" }.into(),
            ..figure(
                "ase",
                "ASE1000,250h",
                exposed,
                "% of the plane",
                "points where the sun alone, without bounces and blinds, gives more than 1000 lx in more than 250 occupied hours".into(),
                LM_83,
            )
        });
        let useful: [(&str, &str, Of); 4] = [
            ("udi_below_100", "UDI below 100 lx", |p| p.udi_below_100_pct),
            ("udi_100_300", "UDI 100 to 300 lx", |p| p.udi_100_300_pct),
            ("udi_300_3000", "UDI 300 to 3000 lx", |p| p.udi_300_3000_pct),
            ("udi_above_3000", "UDI above 3000 lx", |p| {
                p.udi_above_3000_pct
            }),
        ];
        for (key, name, of) in useful {
            let method = format!(
                "mean over the plane of the share of the {} occupied hours",
                self.occupied
            );
            all.push(figure(key, name, mean(&of), "% of the hours", method, UDI));
        }
        self.by_year(&mut all, &part);
        self.by_factor(&mut all, &part, mean(&|p| p.factor_pct));
        self.by_view(&mut all, &part);
        all
    }

    fn by_view(&self, all: &mut Vec<Figure>, part: &Part<'_>) {
        // Of all planes together those count that have a view.
        let told = part(&|p| !p.sight_deg.is_nan());
        let part = |is: &dyn Fn(&ByPoint) -> bool| part(is) / told;
        let no_floor = (told == 0.0).then_some(view::NO_FLOOR);
        let [no_angle, no_rest] = self.unknown_view.map(|why| why.or(no_floor));
        let asked = format!("asked on {:.0} %", 100.0 * view::ON_PLANE);
        let mut add = |key: &str, name: &str, unknown: Option<&str>, share: f64, how: String| {
            let is_enough = share >= view::ON_PLANE - 0.01 * SLACK;
            all.push(Figure {
                value: unknown.is_none().then_some(100.0 * share),
                verdict: match unknown {
                    Some(why) => format!("not assessed: {why}"),
                    None if is_enough => "reached".into(),
                    None => "not reached".into(),
                },
                ..figure(key, name, 0.0, "% of the plane", how, EN_17037)
            });
        };
        for (level, angle, distance, layers) in view::LEVELS {
            let what = match layers as u32 {
                1 => "landscape",
                2 => "landscape and sky or ground",
                _ => "sky, landscape and ground",
            };
            add(
                &format!("view_{level}_angle"),
                &format!("View out, level {level}: sight angle {angle} degrees"),
                no_angle,
                part(&|p| p.sight_deg >= angle),
                format!(
                    "share of the plane from where, {} m above the floor, panes are so wide together; {asked}",
                    view::EYES
                ),
            );
            add(
                &format!("view_{level}_distance"),
                &format!("View out, level {level}: outside distance {distance} m"),
                no_rest,
                part(&|p| p.view_m >= distance),
                format!(
                    "share of the plane from where half of the level view ends so far from the pane or farther; {asked}"
                ),
            );
            add(
                &format!("view_{level}_layers"),
                &format!("View out, level {level}: {what}"),
                no_rest,
                part(&|p| p.view_layers >= layers),
                format!("share of the plane from where one opening shows them; {asked}"),
            );
        }
        for (level, angle, distance, layers) in view::LEVELS {
            let is_such = |p: &ByPoint| {
                p.sight_deg >= angle && p.view_m >= distance && p.view_layers >= layers
            };
            add(
                &format!("view_{level}"),
                &format!("View out, level {level}"),
                no_rest,
                part(&is_such),
                format!("share of the plane with all three; {asked}"),
            );
        }
    }

    fn by_autonomy(&self, all: &mut Vec<Figure>, part: &Part<'_>) {
        let autonomy = |key: &str, name: &str, of: Of, blinds: &str, how: &str| {
            let share = 100.0 * part(&|p| of(p) >= 50.0);
            let verdict = match share {
                a if a >= 75.0 - SLACK => "preferred (75 % or more)",
                a if a >= 55.0 - SLACK => "acceptable (55 % or more)",
                _ => "below 55 %",
            };
            let method = format!(
                "points with at least 300 lx in at least half of the {} occupied hours; {how}",
                self.occupied
            );
            Figure {
                verdict: format!("{verdict}{blinds}"),
                ..figure(key, name, share, "% of the plane", method, LM_83)
            }
        };
        let none = "sDA300/50%, no blinds";
        let without = ", without blinds";
        if self.blinds.is_empty() {
            all.push(autonomy(
                "sda",
                none,
                |p| p.da300_pct,
                without,
                "blinds are not operated, which the standard asks for",
            ));
            return;
        }
        let (least, share) = CLOSES;
        let rule = format!(
            "while more than {:.0} % of the plane of any room get {least} lx or more of direct sun through the group",
            100.0 * share
        );
        let open = match self.open.as_slice() {
            [] => String::new(),
            names => format!(
                "; windows of {} have no blinds and are open all the year, which the standard does not know",
                names.join(", ")
            ),
        };
        all.push(autonomy(
            "sda",
            "sDA300/50%",
            |p| p.da300_blinds_pct,
            if open.is_empty() {
                ""
            } else {
                ", some windows without blinds"
            },
            &format!("blinds are closed group by group, {rule}{open}"),
        ));
        all.push(autonomy(
            "sda_no_blinds",
            none,
            |p| p.da300_pct,
            without,
            "blinds are never closed",
        ));
        for (name, hours) in &self.blinds {
            all.push(figure(
                &format!("closed_h:{name}"),
                &format!("Blinds of {name} closed"),
                *hours as f64,
                "h",
                format!("of the {} occupied hours those {rule}", self.occupied),
                LM_83,
            ));
        }
    }

    fn by_year(&self, all: &mut Vec<Figure>, part: &Part<'_>) {
        let method = |e: f64, share: f64| {
            format!(
                "share of the plane with at least {e} lx in half of the {} daylight hours; asked on {:.0} %",
                self.daylight,
                100.0 * share
            )
        };
        for (name, target, minimum) in LEVELS {
            let shares = [target, minimum].map(|e| part(&|p| p.half_daylight_lx >= e));
            let verdict = reached(shares);
            for ((what, e), (share, asked)) in [("target", target), ("minimum", minimum)]
                .into_iter()
                .zip(shares.into_iter().zip(ON_PLANE))
            {
                all.push(Figure {
                    verdict: verdict.clone(),
                    ..figure(
                        &format!("en17037_year_{name}_{what}"),
                        &format!("EN 17037 by the year, level {name}: {what} {e} lx"),
                        100.0 * share,
                        "% of the plane",
                        method(e, asked),
                        EN_17037,
                    )
                });
            }
        }
    }

    fn by_factor(&self, all: &mut Vec<Figure>, part: &Part<'_>, mean: f64) {
        all.push(figure(
            "factor_mean",
            "Mean daylight factor",
            mean,
            "%",
            "mean over the plane under the CIE overcast sky, type 16, over open level ground"
                .into(),
            CIE,
        ));
        all.push(figure(
            "diffuse_median",
            "Median external diffuse illuminance",
            self.median_diffuse,
            "lx",
            format!(
                "on open level ground, of the {} daylight hours of the weather file",
                self.daylight
            ),
            EN_17037,
        ));
        for (name, target, minimum) in LEVELS {
            let factors = [target, minimum].map(|e| 100.0 * e / self.median_diffuse);
            let shares = factors.map(|factor| part(&|p| p.factor_pct >= factor));
            let verdict = reached(shares);
            let lines = ["target", "minimum"]
                .into_iter()
                .zip(factors)
                .zip(shares.into_iter().zip(ON_PLANE));
            for ((what, factor), (share, asked)) in lines {
                // Without diffuse light there is no factor to ask for.
                let is_known = factor.is_finite();
                let asks = match is_known {
                    true => format!("{what} {factor:.2} %"),
                    false => what.to_owned(),
                };
                all.push(Figure {
                    value: is_known.then_some(100.0 * share),
                    verdict: match is_known {
                        true => verdict.clone(),
                        false => "not assessed".into(),
                    },
                    ..figure(
                        &format!("en17037_factor_{name}_{what}"),
                        &format!("EN 17037 by the daylight factor, level {name}: {asks}"),
                        100.0 * share,
                        "% of the plane",
                        format!(
                            "share of the plane with at least that factor: the level's illuminance over the median external diffuse; asked on {:.0} %",
                            100.0 * asked
                        ),
                        EN_17037,
                    )
                });
            }
        }
    }
}

/// Whether target and minimum hold on enough of the plane; of roofs' light the target is asked on as much as the minimum.
fn reached([target, minimum]: [f64; 2]) -> String {
    let is_enough = |share: f64, asked: f64| share >= asked - 0.01 * SLACK;
    let side = is_enough(target, ON_PLANE[0]) && is_enough(minimum, ON_PLANE[1]);
    match (side, is_enough(target, ON_PLANE[1])) {
        (_, true) => "reached, by light from sides or roof",
        (true, false) => "reached, by light from sides",
        (false, false) => "not reached",
    }
    .into()
}

fn figure(
    key: &str,
    name: &str,
    value: f64,
    unit: &'static str,
    method: String,
    edition: &'static str,
) -> Figure {
    Figure {
        key: key.into(),
        name: name.into(),
        value: Some(value),
        unit,
        verdict: String::new(),
        method,
        edition,
    }
}
