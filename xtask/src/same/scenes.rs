//! The scene files of the pictures that are compared.

use std::fmt::Write;
use std::path::Path;

/// Paris on a summer's afternoon.
const PARIS: &str = r#"mesh = "court.obj"
time = "2026-06-21T17:30:00+02:00"
[site]
latitude = 48.8584
longitude = 2.2945
elevation = 35.0
timezone = "Europe/Paris"
"#;

const BOX: &str = r#"[[medium]]
shape = "box"
min = [-6.0, 0.0, -6.0]
max = [6.0, 4.0, 6.0]
scattering = 0.03
absorption = 0.002
phase = { kind = "henyey-greenstein", g = 0.6 }
"#;

const INSIDE: &str = "[camera]
eye = [0.5, 1.6, 5.5]
target = [-0.3, 1.5, 0.0]
fov_y = 65.0
";

const ABOVE: &str = r#"[camera]
eye = [9.0, 9.0, 12.0]
target = [0.0, 1.5, 0.0]
projection = "orthographic"
height = 16.0
"#;

const AROUND: &str = r#"[camera]
eye = [0.5, 1.6, 3.5]
target = [-0.3, 1.5, 0.0]
projection = "panorama"
[[medium]]
shape = "haze"
top = 8.0
scattering = [0.01, 0.02, 0.03]
"#;

const PEAKS: &str = r#"mesh = "peaks.obj"
time = "2026-03-21T18:10:00+01:00"
[site]
latitude = 46.0
longitude = 7.7
elevation = 1600.0
timezone = "Europe/Zurich"
[camera]
eye = [300.0, 30.0, 400.0]
target = [-600.0, 320.0, -2200.0]
fov_y = 55.0
[[medium]]
shape = "air"
"#;

const SUNWARD: &str = r#"mesh = "court.obj"
[sun]
azimuth = 2.0
elevation = 12.0
[sky]
model = "preetham"
turbidity = 3.0
[camera]
eye = [0.5, 1.6, 5.5]
target = [0.6, 3.4, -3.0]
fov_y = 70.0
[[medium]]
shape = "height"
base = 0.0
scale_height = 900.0
far = 20000.0
scattering = 2e-3
absorption = 1e-4
"#;

/// Three mountains.
const PEAKS_OBJ: &str = "v 0 0 0
v 800 420 -1500
v -900 610 -2200
v 1600 0 -1400
v -1800 0 -2000
v 200 0 -2600
v 3000 900 -6000
v 5000 0 -5800
v 1200 0 -6500
f 2 4 6
f 2 6 1
f 2 1 4
f 3 5 6
f 3 6 1
f 3 1 5
f 7 8 9
f 7 9 4
";

/// Writes all files into a folder.
pub fn write(folder: &Path) -> Result<(), String> {
    for (name, text) in [
        ("court.toml", [PARIS, INSIDE, BOX].concat()),
        ("orthographic.toml", [PARIS, ABOVE, BOX].concat()),
        ("panorama.toml", [PARIS, AROUND].concat()),
        ("peaks.toml", PEAKS.into()),
        ("sunward.toml", SUNWARD.into()),
        ("court.obj", court()),
        ("peaks.obj", PEAKS_OBJ.into()),
    ] {
        let path = folder.join(name);
        std::fs::write(&path, text)
            .map_err(|e| format!("{} cannot be written: {e}", path.display()))?;
    }
    Ok(())
}

/// Three walls, nine slats over them and four pillars: boxes, each from its least to its greatest corner [m].
fn court() -> String {
    let walls = [
        [[-6.0, 0.0, -6.3], [6.0, 4.0, -6.0]],
        [[-6.3, 0.0, -6.0], [-6.0, 4.0, 6.0]],
        [[6.0, 0.0, -6.0], [6.3, 4.0, 6.0]],
    ];
    let slats = (0..9).map(|i| {
        let z = -6.0 + 1.3 * f64::from(i);
        [[-6.0, 3.8, z], [6.0, 4.0, z + 0.6]]
    });
    let pillars = (0..4).map(|i| {
        let x = -4.0 + 2.4 * f64::from(i);
        [[x, 0.0, -2.0], [x + 0.3, 3.8, -1.7]]
    });
    let mut obj = String::new();
    for ([a, b], first) in walls
        .into_iter()
        .chain(slats)
        .chain(pillars)
        .zip((1..).step_by(8))
    {
        for z in [a[2], b[2]] {
            for [x, y] in [[a[0], a[1]], [b[0], a[1]], [b[0], b[1]], [a[0], b[1]]] {
                let _ = writeln!(obj, "v {x:.1} {y:.1} {z:.1}");
            }
        }
        for face in ["0321", "4567", "0154", "1265", "2376", "3047"] {
            let _ = write!(obj, "f");
            for corner in face.bytes() {
                let _ = write!(obj, " {}", first + u32::from(corner - b'0'));
            }
            let _ = writeln!(obj);
        }
    }
    obj
}
