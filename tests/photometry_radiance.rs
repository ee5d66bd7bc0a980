//! Luminous intensity of IES files against RADIANCE's ies2rad and rtrace.
//!
//! E d^2 at points around a lamp at the origin that hangs straight down with C0 at +X. ies2rad reads types B and C; of type B it
//! has other angles than the standard's, the same in the planes H = 0 and V = 0.

mod common;

use glam::DVec3;
use serde_json::json;
use std::path::Path;
use tyndall::photometry::{Distribution, Pose, from_bytes};

const DEG: f64 = std::f64::consts::PI / 180.0;

/// A file of some type whose planes all differ.
fn file(kind: u32, horizontal: &[f64], vertical: &[f64]) -> String {
    // A plane that ends a turn is the first one.
    let own = |i: usize| if horizontal[i] == 360.0 { 0 } else { i };
    let planes: Vec<usize> = (0..horizontal.len()).map(own).collect();
    file_of(kind, horizontal, vertical, &planes)
}

/// A file whose planes are those of given numbers; equal ones are the same.
fn file_of(kind: u32, horizontal: &[f64], vertical: &[f64], planes: &[usize]) -> String {
    let row = |values: &[f64]| {
        values
            .iter()
            .map(f64::to_string)
            .collect::<Vec<_>>()
            .join(" ")
    };
    let value = |i: usize, j: usize| {
        let (i, j) = (i as f64, j as f64);
        500.0 + 300.0 * (1.7 * i + 0.4).sin() * (0.6 * j + 0.2).cos() + 17.0 * i + 5.0 * j
    };
    let mut lines = vec![
        "IESNA91".to_owned(),
        "TILT=NONE".to_owned(),
        format!(
            "1 1000 1.5 {} {} {kind} 2 0 0 0",
            vertical.len(),
            horizontal.len()
        ),
        "0.9 0.8 10".to_owned(),
        row(vertical),
        row(horizontal),
    ];
    for &plane in planes {
        // At the poles all planes meet.
        let at = |j: usize| match kind == 1 && [0.0, 180.0].contains(&vertical[j]) {
            true => value(0, j),
            false => value(plane, j),
        };
        lines.push(row(&(0..vertical.len()).map(at).collect::<Vec<_>>()));
    }
    lines.join("\n") + "\n"
}

fn steps(from: f64, to: f64, count: usize) -> Vec<f64> {
    let step = (to - from) / (count - 1) as f64;
    (0..count).map(|i| from + step * i as f64).collect()
}

/// The greatest relative difference, for each file, between the intensities that RADIANCE has toward the points and ours in a pose.
/// Of a file that is two texts the second is RADIANCE's.
fn worst(test: &str, files: &[[String; 2]], pose: &Pose, points: &[DVec3]) -> Option<Vec<f64>> {
    let theirs: Vec<&String> = files.iter().map(|[_, theirs]| theirs).collect();
    let places: Vec<[f64; 3]> = points.iter().map(DVec3::to_array).collect();
    let input = json!({ "files": theirs, "points": places }).to_string();
    let out = common::python(test, "ies.py", &input)?;
    let truths: Vec<Vec<f64>> = serde_json::from_str(&out).expect("ies.py prints JSON");
    let all = files.iter().zip(truths).map(|([ours, _], truth)| {
        let (lamp, _) = from_bytes(Path::new("lamp.ies"), ours.as_bytes(), 1).expect("it is one");
        let lamp = Distribution::Table(lamp.table);
        let off = |(p, e): (&DVec3, f64)| lamp.intensity(pose, *p) / (e * p.length_squared()) - 1.0;
        let off = points.iter().zip(truth).map(off);
        off.fold(0.0, |worst: f64, off| worst.max(off.abs()))
    });
    Some(all.collect())
}

/// Both read the same.
fn same(text: String) -> [String; 2] {
    [text.clone(), text]
}

#[test]
fn every_symmetry_of_type_c_stands_as_ies2rad_has_it() {
    let vertical = steps(0.0, 180.0, 13);
    // Quadrants that all differ, in the last; planes of uneven distances.
    let uneven = [0.0, 20.0, 45.0, 90.0, 130.0, 180.0, 250.0, 300.0, 360.0];
    // ies2rad takes C90 and C270 of such files for each other, and not of those that have all planes.
    let half = steps(90.0, 270.0, 9);
    let mirrored: Vec<usize> = (0..9).chain((0..8).rev()).collect();
    let all: Vec<f64> = steps(90.0, 450.0, 17);
    let from_0 = || (0..17).map(|i| (i + 12) % 16);
    let spelled: Vec<f64> = from_0().map(|i| all[i].rem_euclid(360.0)).collect();
    let spelled = [&spelled[..16], &[360.0]].concat();
    let planes: Vec<usize> = from_0().map(|i| mirrored[i]).collect();
    let files = [
        same(file(1, &[0.0], &vertical)),
        same(file(1, &steps(0.0, 90.0, 4), &vertical)),
        same(file(1, &steps(0.0, 180.0, 7), &vertical)),
        same(file(1, &uneven, &vertical)),
        [
            file(1, &half, &vertical),
            file_of(1, &spelled, &vertical, &planes),
        ],
    ];
    let pose = Pose::new(DVec3::NEG_Y, Some(DVec3::X)).expect("a pose");
    let point = |i: i32, j: i32| {
        let (theta, phi) = (7.0 + 14.3 * f64::from(j), 3.0 + 22.7 * f64::from(i));
        (3.0 + f64::from(j)) * pose.direction(theta * DEG, phi * DEG)
    };
    let points: Vec<DVec3> = (0..192).map(|n| point(n / 12, n % 12)).collect();
    let name = "every_symmetry_of_type_c_stands_as_ies2rad_has_it";
    let Some(found) = worst(name, &files, &pose, &points) else {
        return;
    };
    assert!(found.iter().all(|worst| *worst < 1e-4), "{found:?}");
    // Shown to notice: turned the other way, or by a quarter.
    let Pose { around, third, .. } = pose;
    for (around, third) in [(around, -third), (third, -around)] {
        let wrong = Pose {
            around,
            third,
            ..pose
        };
        let found = worst(name, &files[3..], &wrong, &points).expect("it has just run");
        assert!(found.iter().all(|worst| *worst > 0.3), "{found:?}");
    }
}

#[test]
fn type_b_stands_as_ies2rad_has_it() {
    // The beam goes down, V = +90 is at +X.
    let pose = Pose::new(DVec3::NEG_Y, Some(DVec3::X)).expect("a pose");
    let files = [
        same(file(2, &steps(-60.0, 60.0, 7), &steps(-75.0, 75.0, 9))),
        same(file(2, &steps(0.0, 60.0, 4), &steps(-75.0, 75.0, 9))),
    ];
    let arc = |toward: DVec3| {
        let angle = move |i: i32| f64::from(i) * 10.7 * DEG;
        (-5..=5).map(move |i| 5.0 * (angle(i).cos() * DVec3::NEG_Y + angle(i).sin() * toward))
    };
    let points: Vec<DVec3> = arc(pose.around).chain(arc(pose.third)).collect();
    let Some(found) = worst("type_b_stands_as_ies2rad_has_it", &files, &pose, &points) else {
        return;
    };
    assert!(found.iter().all(|worst| *worst < 1e-4), "{found:?}");
    let wrong = Pose {
        third: -pose.third,
        ..pose
    };
    let found = worst("type_b", &files[..1], &wrong, &points).expect("it has just run");
    assert!(found[0] > 0.3, "{found:?}");
}
