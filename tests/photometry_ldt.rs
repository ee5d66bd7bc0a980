//! EULUMDAT files: every form of them.

mod common;

use common::lamps::{ldt, plain, refused, says, with};
use std::path::Path;
use tyndall::photometry::{Photometry, Standard, Symmetry, from_bytes};
use tyndall::{Error, Warning};

fn read_ldt(text: &str, set: usize) -> (Photometry, Vec<Warning>) {
    from_bytes(Path::new("a.ldt"), text.as_bytes(), set).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn every_symmetry_of_eulumdat_is_the_same_as_all_planes() {
    let all: Vec<f64> = (0..8).map(|i| 45.0 * f64::from(i)).collect();
    let gammas = [0.0, 60.0, 90.0];
    let plane = |key: f64| vec![100.0, 80.5 + key, 3.0 + 0.5 * key];
    // The key of a plane is the same for all that a symmetry mirrors.
    type Key = fn(f64) -> f64;
    let keys: [(u32, Symmetry, Key, Vec<f64>); 5] = [
        (0, Symmetry::None, |c| c / 9.0, all.clone()),
        (1, Symmetry::Axis, |_| 7.0, vec![0.0]),
        (
            2,
            Symmetry::Across0,
            |c| c.min(360.0 - c),
            vec![0.0, 45.0, 90.0, 135.0, 180.0],
        ),
        (
            3,
            Symmetry::Across90,
            |c| {
                (c - 90.0)
                    .rem_euclid(360.0)
                    .min((90.0 - c).rem_euclid(360.0))
            },
            vec![270.0, 315.0, 0.0, 45.0, 90.0],
        ),
        (
            4,
            Symmetry::Quadrants,
            |c| (c % 180.0).min(180.0 - c % 180.0),
            vec![0.0, 45.0, 90.0],
        ),
    ];
    for (isym, symmetry, key, stored) in keys {
        let planes = |angles: &[f64]| angles.iter().map(|c| plane(key(*c))).collect::<Vec<_>>();
        let (lamp, _) = read_ldt(&ldt(isym, &all, &planes(&stored), &gammas), 1);
        let (whole, _) = read_ldt(&ldt(0, &all, &planes(&all), &gammas), 1);
        assert_eq!(
            (lamp.symmetry, lamp.measured),
            (symmetry, [stored.len(), 3])
        );
        for c in 0..=720 {
            let c = 0.5 * f64::from(c);
            for gamma in [0.0, 20.0, 60.0, 77.0, 90.0] {
                let (a, b) = (lamp.table.at(c, gamma), whole.table.at(c, gamma));
                assert!((a - b).abs() < 1e-12, "{isym} {c} {gamma}: {a} {b}");
            }
        }
        // cd per 1000 lm, of 2000.
        let at = stored[stored.len() - 1];
        let found = lamp.table.at(at, 60.0);
        assert!((found - 2.0 * (80.5 + key(at))).abs() < 1e-12);
    }
}

#[test]
fn an_eulumdat_file_is_what_it_says() {
    let (lamp, warnings) = read_ldt(&plain(), 1);
    assert_eq!(lamp.standard, Standard::Eulumdat);
    assert_eq!(
        lamp.description,
        ["Nobody", "17", "A lamp", "4", "a.ldt", "today"]
    );
    assert_eq!(
        (lamp.lamp_lumens, lamp.luminaire_lumens),
        (Some(2000.0), Some(1000.0))
    );
    assert_eq!((lamp.watts, lamp.lamp_sets), (Some(25.5), [1, 1]));
    assert_eq!(
        (lamp.opening.shape, lamp.opening.size),
        ("disc", [0.08, 0.08, 0.0])
    );
    assert_eq!(lamp.table.at(123.0, 60.0), 161.0);
    // Nearly 790 lm, where the light output ratio has 1000.
    assert!(
        says(&warnings, "times the 1000 lm that it states"),
        "{warnings:?}"
    );
    let (double, _) = read_ldt(&with(&plain(), "1,0\r\n", "2\r\n"), 1);
    assert_eq!(double.table.at(0.0, 0.0), 400.0);
    let (_, warnings) = read_ldt(&with(&plain(), "1,0\r\n0\r\n", "0\r\n15\r\n"), 1);
    assert!(says(
        &warnings,
        "conversion factor in line 24 is 0; 1 is taken"
    ));
    assert!(says(&warnings, "measured at a tilt of 15 degrees"));
    // A negative number of lamps: the flux is the luminaire's own.
    let (lamp, _) = read_ldt(
        &with(
            &with(&plain(), "\r\n2\r\nLED", "\r\n-1\r\nLED"),
            "\r\n50\r\n1,0",
            "\r\n100\r\n1,0",
        ),
        1,
    );
    assert_eq!(
        (lamp.lamp_lumens, lamp.luminaire_lumens),
        (None, Some(2000.0))
    );
    for other in [
        plain().replace("\r\n", "\n"),
        format!("\u{feff}{}", plain()),
        plain() + "\r\n\r\n",
    ] {
        assert_eq!(read_ldt(&other, 1), read_ldt(&plain(), 1));
    }
}

#[test]
fn a_set_of_lamps_is_chosen() {
    let one = "1\r\n2\r\nLED\r\n2000\r\nwhite\r\n80\r\n25,5\r\n";
    let by_set = "3\r\n2\r\nLED\r\n2000\r\nwhite\r\n80\r\n25,5\r\n1\r\nHQL\r\n3500,5\r\nwarm\r\n70\r\n40\r\n-1\r\nX\r\n900\r\nw\r\n90\r\n\r\n";
    let by_part = "3\r\n2\r\n1\r\n-1\r\nLED\r\nHQL\r\nX\r\n2000\r\n3500,5\r\n900\r\nwhite\r\nwarm\r\nw\r\n80\r\n70\r\n90\r\n25,5\r\n40\r\n\r\n";
    for sets in [by_set, by_part] {
        let text = with(&plain(), one, sets);
        for (set, lumens, watts) in [
            (1, 2000.0, Some(25.5)),
            (2, 3500.5, Some(40.0)),
            (3, 900.0, None),
        ] {
            let (lamp, _) = read_ldt(&text, set);
            assert_eq!((lamp.lamp_sets, lamp.watts), ([3, set], watts));
            assert!((lamp.table.at(0.0, 0.0) - 0.1 * lumens).abs() < 1e-12);
            assert_eq!(lamp.lamp_lumens, (set < 3).then_some(lumens));
        }
        for set in [0, 4] {
            let error = from_bytes(Path::new("a.ldt"), text.as_bytes(), set).expect_err("no set");
            assert!(matches!(error, Error::Domain { .. }));
            assert!(
                error
                    .to_string()
                    .contains("outside 1 to 3, the sets of lamps of a.ldt:26"),
                "{error}"
            );
        }
    }
}

#[test]
fn what_is_broken_in_an_eulumdat_file_is_told_with_its_line() {
    let quarter = ldt(
        4,
        &[0.0, 90.0, 180.0, 270.0],
        &vec![vec![3.0, 2.0]; 2],
        &[0.0, 90.0],
    );
    for (text, what, instead, words) in [
        (
            &plain(),
            "\r\n3\r\n1\r\n",
            "\r\n3\r\n5\r\n",
            "a.ldt:3: the symmetry is 5; expected a whole number from 0 to 4",
        ),
        (
            &plain(),
            "\r\n3\r\n1\r\n1\r\n",
            "\r\n3\r\n1\r\n0\r\n",
            "a.ldt:4: the number of C planes is 0",
        ),
        (
            &plain(),
            "\r\n3\r\n1\r\n1\r\n0\r\n3\r\n",
            "\r\n3\r\n0\r\n99999999\r\n0\r\n3333333333\r\n",
            "a.ldt:6: 99999999 planes of 3333333333 intensities are more than",
        ),
        (
            &plain(),
            "1,0\r\n",
            "-1,0\r\n",
            "a.ldt:24: the conversion factor of intensities is -1",
        ),
        (
            &plain(),
            "\r\n1\r\n2\r\nLED",
            "\r\n0\r\n2\r\nLED",
            "a.ldt:26: the number of sets of lamps is 0",
        ),
        (
            &plain(),
            "2000",
            "0",
            "a.ldt:29: the luminous flux of lamp set 1 is 0; expected lumens above 0",
        ),
        (
            &plain(),
            "2000",
            "many",
            "a.ldt:29: `many` is no number; expected the luminous flux of lamp set 1",
        ),
        (
            &plain(),
            "0\r\n60\r\n90\r\n",
            "0\r\n60\r\n9,,0\r\n",
            "a.ldt:46: `9,,0` is no number; expected gamma angle 3 of 3",
        ),
        (
            &plain(),
            "0\r\n60\r\n90\r\n",
            "0\r\n60\r\n50\r\n",
            "a.ldt:46: gamma angle 3 of 3 is 50 after 60",
        ),
        (
            &plain(),
            "80,5",
            "8o,5",
            "a.ldt:48: `8o,5` is no number; expected the intensity at gamma 60 in the plane C0",
        ),
        (
            &plain(),
            "3,25\r\n",
            "",
            "a.ldt:49: the file ends where the intensity at gamma 90 in the plane C0 is expected",
        ),
        (
            &quarter,
            "90\r\n180",
            "80\r\n180",
            "a.ldt:44: C angle 2 of 4 is 80; expected 90 with this symmetry",
        ),
        (
            &quarter,
            "\r\n4\r\n4\r\n",
            "\r\n4\r\n5\r\n",
            "a.ldt:4: there are 5 C planes; expected a multiple of 4",
        ),
    ] {
        let said = refused("a.ldt", &with(text, what, instead));
        assert!(said.starts_with(words), "{said}");
    }
    let (_, warnings) = read_ldt(&(plain() + "7\r\n"), 1);
    assert!(
        says(&warnings, "`7` in line 50 and what follows"),
        "{warnings:?}"
    );
}
