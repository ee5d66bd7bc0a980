//! OBJ and MTL files that nobody would write: they end, in time and memory, and lose no more than their lines.

mod common;

use common::obj::*;
use glam::DVec3;
use proptest::prelude::*;
use std::time::{Duration, Instant};
use tyndall::scene::{Geometry, Scene, from_bytes};

#[test]
fn time_and_memory_grow_with_the_file() {
    let seconds = |bytes: &[u8]| {
        let started = Instant::now();
        let _ = from_bytes("x/none.obj".as_ref(), bytes);
        started.elapsed()
    };
    let mib = 1 << 20;
    let fill = |unit: &str| {
        let text = unit.repeat(mib / unit.len());
        format!("{PLAIN}vt 0 0\nvn 0 0 1\n{text}\n")
    };
    for text in [
        format!("{PLAIN}f{}\n", " 1".repeat(mib / 2)),
        format!("{PLAIN}f{}\n", " 1 2 3 4".repeat(mib / 8)),
        fill("f 1 2 3 4\n"),
        fill("f 1/1/1 2/1/1 3/1/1 4/1/1\n"),
        fill("f 9 9 9\n"),
        fill("v 0 0\n"),
        fill("vt x\n"),
        fill("v 0 0 0\\\n"),
        fill("\\\n"),
        fill("\n"),
        fill("\r"),
        fill("x"),
        fill("a b\n"),
        fill("#\n"),
        fill("usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n"),
        fill("usemtl a\n"),
        (0..mib / 12)
            .map(|i| format!("usemtl {i}\nf 1 2 3\n"))
            .collect::<String>(),
        (0..mib / 24)
            .map(|i| format!("mtllib {i}.mtl {i}\n"))
            .collect::<String>(),
        (0..mib / 8).map(|i| format!("k{i}\n")).collect::<String>(),
        format!("{PLAIN}mtllib{}\n", " a".repeat(mib / 2)),
        format!("{PLAIN}mtllib{}\n", " a.mtl".repeat(mib / 6)),
        format!("{PLAIN}usemtl{}\n", " #".repeat(mib / 2)),
    ] {
        let took = seconds(text.as_bytes());
        assert!(
            took < Duration::from_secs(2),
            "{took:?}: {}",
            &text[..60.min(text.len())]
        );
    }
    let folder = folder();
    for unit in [
        "newmtl m\n",
        "Kd 1 1 1\n",
        "map_Kd -s 1 1 1 -o 0 0 0 tex.png\n",
        "map_Kd -s ",
        "d 0.5\n",
        "k 1\n",
    ] {
        folder.put(
            "m.mtl",
            format!("newmtl m\n{}", unit.repeat(mib / unit.len())),
        );
        let started = Instant::now();
        load(&folder, SQUARE);
        assert!(started.elapsed() < Duration::from_secs(2), "{unit}");
    }
    let many: String = (0..mib / 24)
        .map(|i| format!("newmtl {i}\nmap_Kd {i}.png\n"))
        .collect();
    folder.put("m.mtl", many);
    let started = Instant::now();
    load(&folder, SQUARE);
    assert!(started.elapsed() < Duration::from_secs(2));
}

/// A file with something of everything.
const GOOD: &str = "# a house\nmtllib m.mtl\no house\nv 0 0 0 1 1 1\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0.5 1\nvt 0 0\nvt 1 0\nvt 1 1\n\
    vn 0 0 1\nvn 0 1 0\ng walls\ns 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\nf 1 2 3 4\nf -1//2 -2//2 -5//2\nusemtl n\nf 5 2 3\nl 1 2\n";

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_end(bytes in proptest::collection::vec(any::<u8>(), 0..4000)) {
        let _ = from_bytes("none/a.obj".as_ref(), &bytes);
    }

    #[test]
    fn any_text_of_the_format_ends(text in "((v|vt|vn|f|fo|l|usemtl|mtllib|g|#|\\\\\n| )( ?-?[0-9/]{1,6}){0,7}[ \\\\]?[\n\r]{1,2}){0,60}") {
        let _ = from_bytes("none/a.obj".as_ref(), text.as_bytes());
    }

    #[test]
    fn any_materials_end(text in "(newmtl a\n)?((newmtl|Kd|d|Tr|map_Kd|map_d|Ns|illum|x)( (-s|-o|-clamp|on|xyz|tex.png|[0-9.e-]{1,5})){0,6}\n){0,40}") {
        let folder = folder();
        with_mtl(&folder, &text);
    }

    /// Whatever becomes of the words after a keyword: the other lines stand.
    #[test]
    fn a_mutation_loses_its_line(line in 0usize..22, junk in "[ -~]{0,30}") {
        let lines: Vec<&str> = GOOD.lines().collect();
        let keyword = lines[line].split(' ').next().unwrap_or_default();
        prop_assume!(!junk.ends_with('\\'));
        let mut mutated = lines.clone();
        let changed = format!("{keyword} {junk}");
        mutated[line] = &changed;
        let folder = folder();
        let scene = load(&folder, mutated.join("\n"));
        // Faces of which no number changed are there with their places.
        let lost = |face: &str| {
            let own = lines[line] == face;
            let number = lines[..=line].iter().filter(|l| l.starts_with("v ")).count();
            let names = face.split_whitespace().skip(1).any(|corner| {
                let index: i64 = corner.split('/').next().unwrap_or_default().parse().expect("a number");
                keyword == "v" && (if index < 0 { 6 + index } else { index }) == number as i64
            });
            own || names
        };
        let plain = load(&folder, GOOD);
        let faces: Vec<&str> = lines.iter().copied().filter(|l| l.starts_with("f ")).collect();
        let triangles = |scene: &Scene| -> Vec<[DVec3; 3]> {
            scene.mesh.triangles.iter().map(|t| t.vertices.map(|v| scene.mesh.positions[v as usize])).collect()
        };
        let (before, after) = (triangles(&plain), triangles(&scene));
        let mut at = 0;
        for face in faces {
            let count = face.split_whitespace().count() - 3;
            for triangle in &before[at..at + count] {
                prop_assert!(lost(face) || after.contains(triangle), "{} loses {}", changed, face);
            }
            at += count;
        }
    }
}

/// How much longer four times as much takes, from reading to the tree that rays search.
fn growth(text: impl Fn(usize) -> String, count: usize) -> f64 {
    let seconds = |count: usize| {
        let text = text(count);
        let started = Instant::now();
        if let Ok(scene) = from_bytes("x/none.obj".as_ref(), text.as_bytes()) {
            let geometry = Geometry::new(&scene);
            assert!(geometry.triangle_count() <= scene.mesh.triangles.len());
        }
        started.elapsed().as_secs_f64()
    };
    let short = seconds(count);
    // Where nothing is slow, clocks tell nothing.
    seconds(4 * count) / short.max(0.05)
}

#[test]
fn what_lies_in_one_place_takes_no_square_of_time() {
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\n";
    let grown = [
        (
            "corners again and again",
            growth(|n| format!("{corners}f{}\n", " 1 2 3".repeat(n)), 16_000),
        ),
        (
            "one triangle again and again",
            growth(|n| format!("{corners}{}", "f 1 2 3\n".repeat(n)), 15_000),
        ),
        (
            "corners without order",
            growth(
                |n| {
                    let points: String = (0..n)
                        .map(|i| format!("v {} {} 0\n", i * 7919 % n, i * 104_729 % n))
                        .collect();
                    let line: String = (1..=n).map(|i| format!(" {i}")).collect();
                    format!("{points}f{line}\n")
                },
                24_000,
            ),
        ),
    ];
    for (what, times) in grown {
        assert!(
            times < 8.0,
            "{what}: four times as much takes {times:.1} times"
        );
    }
}

#[test]
fn a_tree_of_boxes_that_are_all_the_same_has_an_end() {
    let near: String = (0..60_000)
        .map(|i| format!("v 0 0 {}\nf -1 2 3\n", 1.0 + f64::from(i) * f64::EPSILON))
        .collect();
    let text = format!("v 0 0 0\nv 1 0 0\nv 1 1 0\n{near}");
    let scene = from_bytes("x/none.obj".as_ref(), text.as_bytes()).expect("it loads");
    let started = Instant::now();
    assert_eq!(Geometry::new(&scene).triangle_count(), 60_000);
    // By the square of their number it was minutes.
    assert!(
        started.elapsed() < Duration::from_secs(10),
        "{:?}",
        started.elapsed()
    );
}

#[test]
fn a_triangle_that_is_there_twice_stops_light_once() {
    let once = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 5\nf 1 2 3\nf 1 2 4\n";
    let kept = |text: &str| {
        let scene = from_bytes("x/none.obj".as_ref(), text.as_bytes()).expect("it loads");
        (
            scene.mesh.triangles.len(),
            Geometry::new(&scene).triangle_count(),
        )
    };
    assert_eq!(kept(once), (2, 2));
    // Turned and mirrored, it covers the same points.
    assert_eq!(kept(&format!("{once}f 2 3 1\nf 3 2 1\n")), (4, 2));
}
