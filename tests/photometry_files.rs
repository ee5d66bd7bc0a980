//! Photometric files by others, and damaged ones.

mod common;

use common::lamps::{IES, ldt, plain, with};
use std::path::Path;
use tyndall::photometry::{Symmetry, from_bytes, read};
use tyndall::split_mix::SplitMix;

/// A text damaged in one of many ways.
fn damaged(text: &str, random: &mut SplitMix) -> Vec<u8> {
    let mut pick = |n: usize| (random.unit() * n as f64) as usize;
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    let at = pick(lines.len());
    let junk = [
        "x",
        "",
        "-1",
        "1e999",
        "nan",
        "0",
        "99999999999",
        "-",
        "1,2,3",
        "\u{fc}",
        "\0",
        "360",
        "TILT=NONE",
    ];
    match pick(8) {
        0 => drop(lines.remove(at)),
        1 => lines.insert(at, lines[at].clone()),
        2 => lines.truncate(at),
        3 => {
            let other = pick(lines.len());
            lines.swap(at, other);
        }
        4 => lines[at].clear(),
        5 => lines.insert(at, junk[pick(junk.len())].into()),
        _ => {
            let mut words: Vec<String> = lines[at].split(' ').map(String::from).collect();
            let word = pick(words.len());
            words[word] = junk[pick(junk.len())].into();
            lines[at] = words.join(" ");
        }
    }
    let mut bytes = lines.join("\n").into_bytes();
    if pick(6) == 0 && !bytes.is_empty() {
        let at = pick(bytes.len());
        bytes[at] = pick(256) as u8;
    }
    bytes
}

#[test]
fn damaged_files_are_refused_with_a_line_or_are_lamps_all_the_same() {
    let included = with(IES, "TILT=NONE\n", "TILT=INCLUDE\n1\n2\n0 90\n1 0.5\n");
    let quarter = ldt(
        4,
        &[0.0, 90.0, 180.0, 270.0],
        &vec![vec![3.0, 2.0]; 2],
        &[0.0, 90.0],
    );
    let mut random = SplitMix(63);
    let mut errors = 0;
    for (name, text) in [
        ("a.ies", IES),
        ("a.ies", &included),
        ("a.ldt", &quarter),
        ("a.ldt", &plain()),
    ] {
        for _ in 0..500 {
            let bytes = damaged(text, &mut random);
            match from_bytes(Path::new(name), &bytes, 1) {
                Ok((lamp, _)) => {
                    assert!(
                        lamp.table
                            .candela()
                            .iter()
                            .all(|v| v.is_finite() && *v >= 0.0)
                    );
                    assert!(lamp.table.flux().is_finite() && lamp.table.cone().is_finite());
                }
                Err(error) => {
                    errors += 1;
                    let said = error.to_string();
                    let line = said
                        .strip_prefix(name)
                        .and_then(|rest| rest.strip_prefix(':'));
                    let line = line.and_then(|rest| rest.split(':').next()?.parse::<usize>().ok());
                    let count = bytes.iter().filter(|b| **b == b'\n').count() + 2;
                    assert!(
                        line.is_some_and(|line| (1..=count).contains(&line)),
                        "{said}"
                    );
                    assert!(said.len() < 400, "{said}");
                }
            }
        }
    }
    assert!(errors > 600, "{errors}");
}

#[test]
fn real_files_have_the_flux_that_they_state() {
    let Some(data) = common::data("real_files_have_the_flux_that_they_state") else {
        return;
    };
    // What each states in words or numbers, and what it is a share of.
    for (file, set, lumens, symmetry, measured) in [
        (
            "radiance_examp1_ledalite_lm63_95.ies",
            1,
            5297.0,
            Symmetry::Quadrants,
            [5, 73],
        ),
        ("bega_11719_lm63_95.ies", 1, 775.0, Symmetry::Axis, [1, 37]),
        (
            "erco_iku_isym1_utf8bom.ldt",
            1,
            611.9,
            Symmetry::Axis,
            [1, 91],
        ),
        (
            "tulux_isym4_2lampsets.ldt",
            1,
            1983.0,
            Symmetry::Quadrants,
            [37, 73],
        ),
        (
            "tulux_isym4_2lampsets.ldt",
            2,
            2643.0,
            Symmetry::Quadrants,
            [37, 73],
        ),
    ] {
        let (lamp, warnings) =
            read(&data.join("photometry").join(file), set).unwrap_or_else(|e| panic!("{e}"));
        assert!(
            (lamp.table.flux() / lumens - 1.0).abs() < 2e-3,
            "{file}: {}",
            lamp.table.flux()
        );
        assert_eq!(
            (lamp.symmetry, lamp.measured),
            (symmetry, measured),
            "{file}"
        );
        assert!(warnings.is_empty(), "{file}: {warnings:?}");
    }
}
