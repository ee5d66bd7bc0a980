//! What is refused, named or cleaned before anything is computed: files that would be lost, flags in vain, names that a
//! terminal would obey, output that cannot be written.

mod common;

use common::{stderr, tyndall};
use std::process::Command;

/// A folder with a textured wall, `wall.obj`, and a scene file of it, `wall.toml`, with a sun, a place and a time.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("it is written");
    };
    put(
        "wall.obj",
        "mtllib wall.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl brick\nf 1/1 2/1 3/1\n",
    );
    put("wall.mtl", "newmtl brick\nmap_Kd brick.png\n");
    put(
        "wall.toml",
        "mesh = \"wall.obj\"\ntime = \"2026-06-21T12:00Z\"\n[sun]\nazimuth = 180\nelevation = 30\n[picture]\nsize = [8, 5]\n",
    );
    image::RgbImage::new(2, 2)
        .save(folder.path().join("brick.png"))
        .expect("the picture is written");
    folder
}

#[test]
fn no_file_is_written_over_another_of_the_same_command() {
    let folder = folder();
    let brick = std::fs::read(folder.path().join("brick.png")).expect("it is there");
    let cases: [&[&str]; 6] = [
        &["--report", "a.exr", "-o", "a.exr"],
        &["--report", "./a.exr", "-o", "a.exr"],
        &["-o", "a.png", "-o", "./a.png"],
        &["-o", "a.png", "-o", "../SELF/a.png"],
        &["-o", "brick.png"],
        &["--report", "wall.toml"],
    ];
    let name = folder.path().file_name().expect("a name").to_string_lossy();
    for flags in cases {
        let flags: Vec<String> = flags.iter().map(|f| f.replace("SELF", &name)).collect();
        let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
        let output = tyndall(
            folder.path(),
            &[&["render", "wall.toml"], &flags[..]].concat(),
        );
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {said}");
        assert!(!said.contains("effects"), "{flags:?}: {said}");
        assert!(!folder.path().join("a.exr").exists());
        assert!(!folder.path().join("a.png").exists());
    }
    let still = std::fs::read(folder.path().join("brick.png")).expect("it is there");
    assert!(still == brick);
}

#[test]
fn what_has_no_effect_beside_a_sun_is_named() {
    let folder = folder();
    let plan = |flags: &[&str]| {
        let output = tyndall(folder.path(), &[&["plan", "wall.toml"], flags].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    let in_vain = "the sun is given, so these have no effect: ";
    let own = plan(&["--pressure", "900", "--tz", "+02:00", "--tier", "day"]);
    let names = "time, time zone, tier, pressure\n";
    assert!(own.contains(&format!("{in_vain}{names}")), "{own}");
    // A sun on the command line takes the place of what the file says, as flags do.
    let flag = plan(&["--sun", "90,20"]);
    assert!(!flag.contains(in_vain), "{flag}");
    let both = plan(&[
        "--sun",
        "90,20",
        "--at",
        "48,2",
        "--time",
        "2026-06-21T12:00Z",
    ]);
    assert!(both.contains(&format!("{in_vain}place, time\n")), "{both}");
    let used = plan(&[
        "--at",
        "48,2",
        "--tz",
        "+02:00",
        "--time",
        "2026-06-21T12:00",
    ]);
    assert!(
        !used.contains(in_vain) && used.contains("10:00:00 UTC"),
        "{used}"
    );
}

#[test]
fn flags_have_the_ranges_of_the_scene_file() {
    let folder = folder();
    for flags in [
        &["--eye", "1e300,0,0", "--target", "0,0,0"][..],
        &["--eye", "0,1,5", "--target", "0,1,1e300"],
        &["--eye", "1e12,5,5", "--target", "0,0,0"],
        &["--north", "1e300"],
        &["--eye", "0,1,5", "--target", "0,1,0", "--fov", "1e-9"],
    ] {
        let output = tyndall(folder.path(), &[&["plan", "wall.toml"], flags].concat());
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {said}");
        assert!(said.contains("outside"), "{flags:?}: {said}");
    }
}

#[test]
fn no_name_reaches_the_terminal_as_a_command_to_it() {
    let folder = folder();
    let output = tyndall(folder.path(), &["plan", "a\u{1b}[31m\nb.glb"]);
    assert_eq!(output.status.code(), Some(2));
    let missing = stderr(&output);
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\u{1b}[31m\u{7}\u{202e}\nf 1 2 3\n";
    std::fs::write(folder.path().join("name.obj"), obj).expect("it is written");
    let output = tyndall(folder.path(), &["plan", "name.obj", "--sun", "180,30"]);
    assert!(output.status.success());
    let named = stderr(&output);
    for text in [&missing, &named] {
        assert!(text.contains("[31m"), "{text:?}");
        let obeyed = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
        assert!(!text.contains(obeyed), "{text:?}");
    }
    assert_eq!(missing.lines().count(), 2, "{missing:?}");
}

#[test]
fn the_size_of_studies_is_not_that_of_a_scene_of_ones_own() {
    let folder = folder();
    let study = ["accuracy", "wall.toml", "--effect", "radiosity"];
    for more in [&["--study", "scene"][..], &[]] {
        let size = ["--study-size", "24x16"];
        let output = tyndall(folder.path(), &[&study, more, &size].concat());
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("named with --size"), "{said}");
    }
}

#[test]
fn what_is_measured_and_why_it_is_dark_is_said_to_who_wants_quiet() {
    let folder = folder();
    let light = ["surface_sun", "radiosity", "sky_dome", "sun_disc"];
    let dark: Vec<&str> = light.iter().flat_map(|name| ["--without", name]).collect();
    let fixed = ["render", "wall.toml", "--backend", "reference", "-q"];
    let check = ["--check", "4", "-o", "a.png"];
    let output = tyndall(folder.path(), &[&fixed[..], &check, &dark].concat());
    let said = stderr(&output);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("check      "), "{said}");
    assert!(
        said.contains("--without leaves out light: surface_sun, radiosity"),
        "{said}"
    );
}

#[test]
fn a_mesh_that_is_a_folder_is_an_error_of_its_key() {
    let folder = folder();
    for mesh in [".", "", "wall"] {
        std::fs::create_dir_all(folder.path().join("wall")).expect("a folder");
        let text = format!("# a mesh\nmesh = \"{mesh}\"\n");
        std::fs::write(folder.path().join("folder.toml"), text).expect("it is written");
        let output = tyndall(folder.path(), &["plan", "folder.toml", "--sun", "180,30"]);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        for word in ["folder.toml:2", "mesh", "is a folder"] {
            assert!(said.contains(word), "`{word}` is not in {said}");
        }
    }
}

#[test]
fn a_small_tolerance_is_written_with_an_exponent() {
    let folder = folder();
    let output = tyndall(
        folder.path(),
        &["plan", "wall.toml", "--tolerance", "1e-300"],
    );
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(table.contains("less than 1e-300 of"), "{table}");
}

#[cfg(target_os = "linux")]
#[test]
fn help_that_cannot_be_written_is_status_1() {
    for arguments in [&["help"][..], &["--version"], &["render", "--help"]] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full");
        let output = Command::new(env!("CARGO_BIN_EXE_tyndall"))
            .args(arguments)
            .stdout(full.expect("a device that is full"))
            .output()
            .expect("tyndall starts");
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert!(stderr(&output).contains("standard output"), "{arguments:?}");
    }
}
