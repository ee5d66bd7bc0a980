//! IES LM-63 files: every form of them.

mod common;

use common::files::Folder;
use common::lamps::{IES, ies, refused, says, with};
use std::path::Path;
use tyndall::photometry::{Goniometer, Standard, Symmetry, from_bytes, read};

#[test]
fn an_ies_file_is_what_it_says() {
    let (lamp, warnings) = ies(IES);
    assert_eq!(lamp.standard, Standard::Lm63 { year: 1995 });
    assert_eq!(lamp.description, ["[TEST] 17", "[MANUFAC] nobody"]);
    assert_eq!(
        (lamp.symmetry, lamp.measured),
        (Symmetry::Quadrants, [4, 5])
    );
    assert_eq!((lamp.watts, lamp.lamp_lumens), (Some(60.0), Some(1000.0)));
    assert_eq!(
        (lamp.opening.shape, lamp.opening.size),
        ("box", [0.1, 0.2, 0.3])
    );
    let table = &lamp.table;
    assert_eq!(table.goniometer(), Goniometer::C);
    // Times the multiplier 2 and the ballast factor 0.5.
    for (c, gamma, candela) in [
        (0.0, 0.0, 100.0),
        (30.0, 60.0, 82.0),
        (90.0, 120.0, 8.0),
        (150.0, 60.0, 82.0),
        (210.0, 60.0, 82.0),
        (330.0, 60.0, 82.0),
        (180.0, 90.0, 40.0),
        (15.0, 45.0, (90.0 + 91.0 + 80.0 + 82.0) / 4.0),
        (0.0, 120.1, 0.0),
    ] {
        assert!((table.at(c, gamma) - candela).abs() < 1e-12, "{c} {gamma}");
    }
    // It ends at 120 degrees, with 8 of 100 cd.
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(says(
        &warnings,
        "8 cd at vertical angle 120 degrees, and nothing is taken to be beyond"
    ));
    let feet = with(IES, "1 2 0.1", "1 1 0.1");
    assert_eq!(ies(&feet).0.opening.size[1], 0.2 * 0.3048);
}

#[test]
fn every_edition_is_read_as_it_means_its_factors() {
    let factors = |first: &str| {
        with(
            &with(IES, "IESNA:LM-63-1995\n", first),
            "0.5 1 60",
            "0.5 0.8 60",
        )
    };
    for (first, year, factor) in [
        ("", 1986, 0.8),
        ("IESNA86\n", 1986, 0.8),
        ("IESNA91\n", 1991, 0.8),
        ("IESNA95\n", 1995, 1.0),
        ("IESNA:LM-63-1995\n", 1995, 1.0),
        ("IESNA:LM-63-2002\n", 2002, 1.0),
        ("IES:LM-63-2019\n", 2019, 1.0),
        ("IESNA:LM-63-2077\n", 2002, 1.0),
    ] {
        let (lamp, warnings) = ies(&factors(first));
        assert_eq!(lamp.standard, Standard::Lm63 { year }, "{first}");
        assert!(
            (lamp.table.at(0.0, 0.0) - 100.0 * factor).abs() < 1e-12,
            "{first}"
        );
        let odd = says(
            &warnings,
            "the number after the ballast factor, in line 6, is 0.8",
        );
        assert_eq!(odd, year == 1995 || year == 2002, "{first} {warnings:?}");
        assert_eq!(says(&warnings, "names no edition"), first.contains("2077"));
    }
    // Words of people before 1991.
    let old = with(IES, "IESNA:LM-63-1995\n", "A lamp\nof 1987\n");
    assert_eq!(ies(&old).0.description[..2], ["A lamp", "of 1987"]);
}

#[test]
fn all_ways_to_write_a_file_are_the_same_file() {
    let (first, _) = ies(IES);
    let bytes = |text: &[u8]| {
        from_bytes(Path::new("a.ies"), text, 1)
            .expect("it is read")
            .0
    };
    let dos = IES.replace('\n', "\r\n");
    for other in [
        dos.clone(),
        IES.replace('\n', "\r"),
        IES.replace('\n', "\r\r\n"),
        format!("{dos}\u{1a}"),
        format!("\u{feff}{IES}"),
        format!("\n\n{IES}\n\n"),
        IES.replace("TILT=NONE", " tilt = none "),
        // Numbers break over lines anywhere, and commas separate them too.
        IES.replace("30 60 90 120", "30\n60,90,\n\n120")
            .replace("91 82", "91,82"),
        IES.replace("2 1000 2 5 4", "2.0 1e3 +2. 5 4.0"),
    ] {
        assert_eq!(bytes(other.as_bytes()), first, "{other:?}");
    }
    let latin = [
        b"IESNA91\n[MANUFAC] K\xfchl\xb0\n".as_slice(),
        &IES.as_bytes()[44..],
    ]
    .concat();
    assert_eq!(bytes(&latin).description, ["[MANUFAC] K\u{fc}hl\u{b0}"]);
    let utf8 = format!("IESNA91\n[MANUFAC] K\u{fc}hl\u{b0}\n{}", &IES[44..]);
    assert_eq!(bytes(utf8.as_bytes()), bytes(&latin));
    let wide: Vec<u8> = [0xFF, 0xFE]
        .into_iter()
        .chain(IES.bytes().flat_map(|b| [b, 0]))
        .collect();
    let error = from_bytes(Path::new("a.ies"), &wide, 1).expect_err("UTF-16");
    assert!(
        error.to_string().starts_with("a.ies:1: the text is UTF-16"),
        "{error}"
    );
}

/// A file of some horizontal angles whose planes differ.
fn of_planes(kind: u32, horizontal: &[f64], vertical: &[f64]) -> String {
    let row = |values: &mut dyn Iterator<Item = f64>| {
        values.map(|v| v.to_string()).collect::<Vec<_>>().join(" ")
    };
    let [h, v] = [horizontal, vertical].map(|angles| row(&mut angles.iter().copied()));
    let (n, m) = (horizontal.len(), vertical.len());
    let mut text = format!("IESNA91\nTILT=NONE\n1 -1 1 {m} {n} {kind} 2 0 0 0\n1 1 10\n{v}\n{h}\n");
    for i in 0..n {
        text += &row(&mut (0..m).map(|j| (100 + 10 * i + j) as f64));
        text += "\n";
    }
    text
}

#[test]
fn every_symmetry_of_horizontal_angles_is_told_and_completed() {
    let vertical = [0.0, 45.0, 90.0];
    let at = |table: &tyndall::photometry::Table, c: f64| table.at(c, 45.0) - 1.0;
    for (angles, symmetry, expected) in [
        (vec![0.0], Symmetry::Axis, [100.0, 100.0, 100.0, 100.0]),
        (vec![22.5], Symmetry::Axis, [100.0, 100.0, 100.0, 100.0]),
        (
            vec![0.0, 90.0],
            Symmetry::Quadrants,
            [100.0, 110.0, 100.0, 110.0],
        ),
        (
            vec![0.0, 90.0, 180.0],
            Symmetry::Across0,
            [100.0, 110.0, 120.0, 110.0],
        ),
        (
            vec![90.0, 180.0, 270.0],
            Symmetry::Across90,
            [110.0, 100.0, 110.0, 120.0],
        ),
        (
            vec![-90.0, 0.0, 90.0],
            Symmetry::Across90,
            [110.0, 120.0, 110.0, 100.0],
        ),
        (
            vec![0.0, 90.0, 180.0, 270.0, 360.0],
            Symmetry::None,
            [140.0, 110.0, 120.0, 130.0],
        ),
        (
            vec![0.0, 90.0, 180.0, 270.0],
            Symmetry::None,
            [100.0, 110.0, 120.0, 130.0],
        ),
    ] {
        let (lamp, warnings) = ies(&of_planes(1, &angles, &vertical));
        assert_eq!(lamp.symmetry, symmetry, "{angles:?}");
        let found = [0.0, 90.0, 180.0, 270.0].map(|c| at(&lamp.table, c));
        // Of the turn's ends the last counts at 0: the first and the last plane should be the same.
        let found = if angles.len() == 5 {
            [
                at(&lamp.table, 359.999_999_999).round(),
                found[1],
                found[2],
                found[3],
            ]
        } else {
            found
        };
        assert_eq!(found, expected, "{angles:?}");
        assert_eq!(says(&warnings, "closes the turn"), angles.len() == 4);
        assert_eq!(lamp.lamp_lumens, None);
    }
    let said = refused("a.ies", &of_planes(1, &[0.0, 60.0, 120.0], &vertical));
    assert!(
        said.starts_with("a.ies:6: horizontal angles run from 0 to 120 degrees; expected 0 alone"),
        "{said}"
    );
}

#[test]
fn types_a_and_b_are_read_with_their_mirror() {
    for (kind, goniometer) in [(3, Goniometer::A), (2, Goniometer::B)] {
        let (lamp, warnings) = ies(&of_planes(kind, &[-30.0, 0.0, 40.0], &[-10.0, 0.0, 10.0]));
        assert_eq!(
            (lamp.table.goniometer(), lamp.symmetry),
            (goniometer, Symmetry::None)
        );
        assert_eq!(lamp.table.at(40.0, -10.0), 120.0);
        assert!(
            says(
                &warnings,
                "angle 40 degrees, and nothing is taken to be beyond"
            ) || says(&warnings, "angle 10 degrees")
        );
        let (lamp, _) = ies(&of_planes(kind, &[0.0, 40.0], &[-90.0, 90.0]));
        assert_eq!(lamp.symmetry, Symmetry::Across0);
        assert_eq!(lamp.table.horizontal(), [-40.0, 0.0, 40.0]);
        assert_eq!(
            (lamp.table.at(-40.0, 90.0), lamp.table.at(0.0, 90.0)),
            (111.0, 101.0)
        );
        // Nothing mirrors V: below V = 0 such a file has nothing, which is told.
        let (lamp, warnings) = ies(&of_planes(kind, &[0.0, 90.0], &[0.0, 90.0]));
        assert_eq!(lamp.table.at(0.0, -1.0), 0.0);
        assert!(
            says(&warnings, "cd at vertical angle 0 degrees"),
            "{warnings:?}"
        );
        let said = refused("a.ies", &of_planes(kind, &[0.0], &[-90.0, 90.0]));
        assert!(
            said.starts_with("a.ies:6: there is one horizontal angle"),
            "{said}"
        );
    }
}

#[test]
fn tilts_stand_in_the_file_or_beside_it() {
    let tilts = "2\n3\n0 45 90\n1 0.9 0.7\n";
    let included = with(IES, "TILT=NONE\n", &format!("TILT=INCLUDE\n{tilts}"));
    let (lamp, _) = ies(&included);
    let tilt = lamp.tilt.clone().expect("there are tilts");
    assert_eq!(
        (tilt.lamp, tilt.factors.as_slice()),
        (2, [1.0, 0.9, 0.7].as_slice())
    );
    for (angle, factor) in [
        (0.0, 1.0),
        (45.0, 0.9),
        (67.5, 0.8),
        (90.0, 0.7),
        (135.0, 0.9),
        (180.0, 1.0),
    ] {
        assert!((tilt.factor(angle) - factor).abs() < 1e-15, "{angle}");
    }
    assert_eq!(lamp.table, ies(IES).0.table);

    let folder = Folder::new();
    folder.put("lamp.tlt", tilts);
    // The name alone counts, whatever folders of another machine stand before it.
    for named in [
        "lamp.tlt",
        "C:\\data\\lamp.tlt",
        "/etc/lamp.tlt",
        "../lamp.tlt",
    ] {
        let path = folder.put("lamp.ies", with(IES, "TILT=NONE", &format!("TILT={named}")));
        assert_eq!(read(&path, 1).expect("it is read").0, lamp, "{named}");
    }
    let path = folder.put("lamp.ies", with(IES, "TILT=NONE", "TILT=other.tlt"));
    let error = read(&path, 1).expect_err("there is none").to_string();
    assert!(
        error.contains("lamp.ies:4: the tilts of `other.tlt` cannot be read"),
        "{error}"
    );
    folder.put("other.tlt", "1\n2\n0 x\n1 1\n");
    let error = read(&path, 1).expect_err("it is broken").to_string();
    assert!(
        error.contains("other.tlt:3: `x` is no number; expected tilt 2 of 2"),
        "{error}"
    );
    for (bad, words) in [
        (
            "TILT=INCLUDE\n4\n",
            "lamp.ies:5: the lamp's position in the luminaire is 4; expected a whole number from 1 to 3",
        ),
        (
            "TILT=INCLUDE\n1 2 10 5 1 1\n",
            "lamp.ies:5: tilt 2 of 2 is 5; expected ascending",
        ),
        (
            "TILT=INCLUDE\n1 2 10 50 1 -1\n",
            "lamp.ies:5: factor 2 of 2 for tilts is -1",
        ),
        (
            "TILT=INCLUDE\n1 99999999 1\n",
            "lamp.ies:5: 99999999 tilts are more than",
        ),
        ("TILT=\n", "lamp.ies:4: `TILT=` names no file"),
    ] {
        let said = refused("lamp.ies", &with(IES, "TILT=NONE\n", bad));
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn what_is_broken_in_an_ies_file_is_told_with_its_line() {
    for (what, instead, words) in [
        (
            "2 1000",
            "two 1000",
            "lamp.ies:5: `two` is no number; expected the number of lamps",
        ),
        (
            "2 1000",
            "2 -5",
            "lamp.ies:5: the lumens of a lamp are -5; expected a number from 0, or -1",
        ),
        (
            "1000 2 5",
            "1000 0 5",
            "lamp.ies:5: the multiplier of intensities is 0; expected a number above 0",
        ),
        (
            "2 5 4 1 2",
            "2 5.5 4 1 2",
            "lamp.ies:5: the number of vertical angles is 5.5",
        ),
        (
            "2 5 4 1 2",
            "2 1 4 1 2",
            "lamp.ies:5: the number of vertical angles is 1; expected a whole number from 2",
        ),
        (
            "2 5 4 1 2",
            "2 999999999 99999999 1 2",
            "lamp.ies:5: 999999999 vertical and 99999999 horizontal angles are more than",
        ),
        (
            "2 5 4 1 2",
            "2 1e18 1e19 1 2",
            "horizontal angles are more than the file has numbers",
        ),
        (
            "2 5 4 1 2",
            "2 5 4 7 2",
            "lamp.ies:5: the type of photometry is 7; expected a whole number from 1 to 3",
        ),
        ("2 5 4 1 2", "2 5 4 1 3", "lamp.ies:5: the unit of lengths"),
        (
            "0.5 1 60",
            "-0.5 1 60",
            "lamp.ies:6: the ballast factor is -0.5",
        ),
        (
            "0 30 60 90 120",
            "0 30 60 60 120",
            "lamp.ies:7: vertical angle 4 of 5 is 60 after 60",
        ),
        (
            "0 30 60 90 120",
            "0 30 60 90 190",
            "lamp.ies:7: vertical angle 5 of 5 is 190; expected 0 to 180 degrees",
        ),
        (
            "\n0 30 60 90\n",
            "\n0 30 60 nan\n",
            "lamp.ies:8: `nan` is no number; expected horizontal angle 4 of 4",
        ),
        (
            "93 84",
            "93 8x4",
            "lamp.ies:11: `8x4` is no number; expected the candela at vertical angle 60, horizontal angle 60",
        ),
        ("93 84", "93 1e999", "lamp.ies:11: `1e999` is no number"),
        (
            "100 95 86 47 8\n",
            "100 95\n",
            "lamp.ies:13: the file ends where the candela at vertical angle 60, horizontal angle 90 is expected",
        ),
        (
            "TILT=NONE",
            "TLIT=NONE",
            "the file ends without a line that begins with TILT=",
        ),
    ] {
        let said = refused("lamp.ies", &with(IES, what, instead));
        assert!(said.contains(words), "{said}");
    }
    let said = refused("a.txt", "hello\nworld\n");
    assert!(
        said.starts_with("a.txt:1: `hello`: no line begins with TILT="),
        "{said}"
    );
    let error = from_bytes(Path::new("a.ies"), IES.as_bytes(), 2).expect_err("one set");
    assert!(
        error.to_string().contains("lamp_set is 2, outside 1"),
        "{error}"
    );
}

#[test]
fn what_is_doubtful_is_told() {
    let (lamp, warnings) = ies(&with(IES, "43 6", "-43 -6"));
    assert!(
        says(&warnings, "lamp.ies:10: negative intensities, taken as 0"),
        "{warnings:?}"
    );
    assert_eq!(lamp.table.at(30.0, 90.0), 0.0);
    let (_, warnings) = ies(&(IES.to_owned() + "1 2 3\n"));
    assert!(says(
        &warnings,
        "`1` in line 13 and what follows stand after the last value"
    ));
    let (_, warnings) = ies(&with(IES, "100 93", "200 93"));
    assert!(
        says(&warnings, "its planes differ by 100 cd where they meet"),
        "{warnings:?}"
    );
    // About 450 lm: of lamps of 200, and of 20 000.
    assert!(says(
        &ies(&with(IES, "2 1000", "2 200")).1,
        "times the 200 lm of its lamps"
    ));
    assert!(says(
        &ies(&with(IES, "2 1000", "2 20000")).1,
        "times the 20000 lm of its lamps"
    ));
    let dark = of_planes(1, &[0.0], &[0.0, 90.0]).replace("100 101", "0 0");
    assert!(says(&ies(&dark).1, "no light in any direction"));
}
