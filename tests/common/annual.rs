//! RADIANCE's year: what points of a room receive for each patch of the sky and for each sun, from a run or from a truth that is stored.

use super::python;
use glam::DVec3;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use tyndall::daylight::hours::Hours;
use tyndall::daylight::table::{Stamp, Table};

/// What RADIANCE gives to points: a row a source, a number a point.
pub struct Annual {
    /// By patch of the sky: toward its middle, and illuminance for a luminance of 1 [lx per cd/m2].
    pub sky: Vec<(DVec3, Vec<f64>)>,
    /// By sun: toward it, and illuminance for 1 lx on a plane that faces it, in all and straight from it [1].
    pub suns: Vec<(DVec3, [Vec<f64>; 2])>,
    /// What it took [s], run by run and of processors' time, and by which commands.
    pub said: String,
    /// All of that [s].
    pub seconds: f64,
    /// A number of what it was made of.
    pub input: f64,
}

/// Where the truth of the suite's sample lies.
const TRUTH: &str = "tests/truth/year.csv";

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(TRUTH)
}

/// A number that is another where anything of the room, its ground or its points is.
pub fn input(task: &Value) -> f64 {
    fn flat(value: &Value, all: &mut Vec<f64>) {
        match value {
            Value::Array(values) => values.iter().for_each(|value| flat(value, all)),
            value => all.push(value.as_f64().expect("a number")),
        }
    }
    let mut all = Vec::new();
    for key in ["triangles", "materials", "ground", "points"] {
        flat(&task[key], &mut all);
    }
    let weighted = all.iter().zip(1u32..);
    weighted.map(|(v, i)| v * f64::from(i).sqrt()).sum()
}

fn numbers(value: &Value) -> Vec<Vec<f64>> {
    serde_json::from_value(value.clone()).expect("rows of numbers")
}

impl Annual {
    /// From a run of `annual.py`; `None` (and noted) without Python. `patches` and `suns` are what the task says.
    pub fn run(test: &str, task: &Value, patches: &[DVec3], suns: &[DVec3]) -> Option<Self> {
        let out = python(test, "annual.py", &task.to_string())?;
        let out: Value = serde_json::from_str(&out).expect("annual.py prints JSON");
        let [sky, all, straight] = [
            "sky_coefficients",
            "sun_coefficients",
            "straight_coefficients",
        ]
        .map(|name| numbers(&out[name]));
        let own = |rows: &[Vec<f64>], source: usize| rows.iter().map(|row| row[source]).collect();
        let seconds = out["seconds"].as_object().expect("a table");
        Some(Annual {
            sky: (patches.iter().enumerate())
                .map(|(i, toward)| (*toward, own(&sky, i)))
                .collect(),
            suns: (suns.iter().enumerate())
                .map(|(i, toward)| (*toward, [own(&all, i), own(&straight, i)]))
                .collect(),
            seconds: seconds.values().filter_map(Value::as_f64).sum(),
            input: input(task),
            said: json!([out["seconds"], out["cpu"], out["commands"]]).to_string(),
        })
    }

    /// The truth that is stored.
    pub fn stored() -> Self {
        let text = std::fs::read_to_string(path()).expect("the truth is there");
        let mut annual = Annual {
            sky: Vec::new(),
            suns: Vec::new(),
            said: String::new(),
            seconds: 0.0,
            input: f64::NAN,
        };
        for line in text.lines() {
            if let Some(said) = line.strip_prefix("# ") {
                annual.said += said;
                continue;
            }
            if let Some(input) = line.strip_prefix("input,") {
                annual.input = input.parse().expect("a number");
                continue;
            }
            let mut cells = line.split(',');
            let kind = cells.next().unwrap_or_default();
            let numbers: Vec<f64> = cells.filter_map(|cell| cell.parse().ok()).collect();
            if numbers.len() < 4 {
                continue;
            }
            let (toward, row) = (DVec3::from_slice(&numbers[..3]), numbers[3..].to_vec());
            match kind {
                "sky" => annual.sky.push((toward, row)),
                "sun" => annual.suns.push((toward, [row, Vec::new()])),
                _ => {
                    let sun = annual.suns.iter_mut().find(|(other, _)| *other == toward);
                    sun.expect("its sun stands before it").1[1] = row;
                }
            }
        }
        annual
    }

    /// Stores it as the truth.
    pub fn store(&self) {
        let mut text = format!(
            "# {}\ninput,{:.9e}\nkind,x,y,z,a number a point\n",
            self.said, self.input
        );
        let mut line = |kind: &str, toward: &DVec3, row: &[f64]| {
            let cells: Vec<String> = row.iter().map(|v| format!("{v:.5e}")).collect();
            let _ = writeln!(
                text,
                "{kind},{:.7},{:.7},{:.7},{}",
                toward.x,
                toward.y,
                toward.z,
                cells.join(",")
            );
        };
        for (toward, row) in &self.sky {
            line("sky", toward, row);
        }
        for (toward, [all, straight]) in &self.suns {
            line("sun", toward, all);
            line("straight", toward, straight);
        }
        std::fs::write(path(), text).expect("the truth can be written");
    }

    /// What points receive [lx] of a sky of these luminances [cd/m2] and of a sun of an illuminance [lx], in all and straight from it.
    ///
    /// # Panics
    /// Where the suns of the truth are others.
    pub fn hour(&self, luminances: &[f64], toward: DVec3, lux: f64) -> [Vec<f64>; 2] {
        let points = self.sky[0].1.len();
        let mut total = vec![0.0; points];
        for ((_, row), luminance) in self.sky.iter().zip(luminances) {
            for (total, share) in total.iter_mut().zip(row) {
                *total += luminance * share;
            }
        }
        let mut straight = vec![0.0; points];
        if lux > 0.0 {
            let near = |(other, _): &&(DVec3, _)| other.distance(toward) < 1e-5;
            let sun = self.suns.iter().find(near);
            let (_, [all, own]) =
                sun.expect("the truth has this sun; TYNDALL_TRUTHS=year makes it anew");
            for i in 0..points {
                total[i] += lux * all[i];
                straight[i] = lux * own[i];
            }
        }
        [total, straight]
    }
}

/// What is compared of a year: the hours, and how many each stands for.
pub struct Sample {
    pub hours: Hours,
    pub each: usize,
}

/// A year's illuminances as if each hour were so many.
pub fn table_of(sample: &Sample, total: &[Vec<f64>], sun: &[Vec<f64>]) -> Table {
    let mut table = Table {
        hours: sample.hours.count,
        points: total[0].len(),
        ..Table::default()
    };
    for (i, hour) in sample.hours.lit.iter().enumerate() {
        for number in 0..sample.each {
            table.stamps.push(Stamp {
                number: hour.number + number,
                date: hour.date,
                hour: hour.hour,
                clock: f64::from(hour.hour) - 0.5,
                diffuse: hour.diffuse(),
            });
            table.total.extend(total[i].iter().map(|e| *e as f32));
            table.sun.extend(sun[i].iter().map(|e| *e as f32));
        }
    }
    table
}
