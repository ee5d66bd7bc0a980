//! The scene file: what it says, and what is wrong with it.

mod common;

use common::files::*;
use glam::{DVec2, DVec3};
use serde_json::Value;
use std::collections::BTreeSet;
use tyndall::medium::{ClearAir, Phase, Shape};
use tyndall::scene::{self, Projection};

#[test]
fn toml_says_all_that_it_holds() {
    let folder = Folder::new();
    folder.put("room.obj", ROOM);
    let scene = folder.load("room.toml", EXAMPLE_TOML).expect("it loads");
    assert_eq!(scene.name, "room.toml");
    assert_eq!(scene.time.as_deref(), Some("2026-06-21T18:30:00+02:00"));
    let site = scene.site.expect("a site");
    assert_eq!(
        (site.latitude_deg, site.longitude_deg, site.elevation),
        (48.8584, 2.2945, 35.0)
    );
    assert_eq!(site.timezone.as_deref(), Some("Europe/Paris"));
    let camera = scene.camera.expect("a camera");
    assert_eq!(
        (camera.eye, camera.up, camera.shift),
        (DVec3::new(0.0, 1.6, 5.0), DVec3::Y, DVec2::new(0.25, 0.0))
    );
    assert!(camera.forward.distance(DVec3::new(0.0, -0.1, -5.0)) < 1e-12);
    assert_eq!(
        camera.projection,
        Projection::Perspective {
            fov_y: 60f64.to_radians()
        }
    );
    let sun = scene.sun.expect("a sun");
    assert_eq!((sun.azimuth_deg, sun.elevation_deg), (120.0, 30.0));
    assert_eq!((sun.illuminance, sun.diameter_deg), (Some(1.0), Some(0.0)));
    assert_eq!(scene.sky.model.as_deref(), Some("cie:12"));
    assert_eq!(
        (
            scene.sky.turbidity,
            scene.sky.direct_normal,
            scene.sky.diffuse_horizontal
        ),
        (Some(3.0), Some(800.0), Some(100.0))
    );
    assert_eq!(
        (
            scene.ground.enabled,
            scene.ground.height,
            scene.ground.albedo
        ),
        (true, Some(0.0), 0.2)
    );
    assert_eq!(scene.media.len(), 3);
    assert_eq!(
        scene.media[0].shape,
        Shape::Box {
            min: DVec3::new(-4.0, 0.0, -5.0),
            max: DVec3::new(4.0, 4.0, 5.0)
        }
    );
    assert_eq!(scene.media[0].scattering, DVec3::splat(0.04));
    assert_eq!(scene.media[0].phase, Phase::HenyeyGreenstein { g: 0.7 });
    assert_eq!(scene.media[1].shape, Shape::Haze { top: 60.0 });
    assert_eq!(scene.media[1].scattering, DVec3::new(0.001, 0.002, 0.003));
    assert_eq!(
        (scene.media[1].absorption, scene.media[1].phase),
        (DVec3::ZERO, Phase::Isotropic)
    );
    assert_eq!(
        scene.media[2].shape,
        Shape::Height {
            base: 0.0,
            scale_height: 1200.0,
            far: 60_000.0
        }
    );
    assert_eq!(
        (scene.media[2].absorption, scene.media[2].phase),
        (DVec3::splat(4e-6), Phase::Rayleigh)
    );
    let air = ClearAir {
        turbidity: Some(2.5),
        base: Some(10.0),
        far: 80_000.0,
        molecules_scale_height: 8000.0,
        aerosol_scale_height: 1500.0,
        aerosol_albedo: 0.95,
        aerosol_phase: Phase::Fog { droplet: 1e-6 },
    };
    assert_eq!(scene.air, Some(air));
    let plain = folder.load("air.toml", "[[medium]]\nshape = \"air\"\n");
    assert_eq!(plain.expect("it loads").air, Some(ClearAir::default()));
    assert_eq!(
        (
            scene.picture.size,
            scene.picture.samples,
            scene.picture.exposure_ev100
        ),
        (Some([960, 600]), Some(8), Some(9.5))
    );

    for (kind, phase) in [
        ("\"isotropic\"", Phase::Isotropic),
        (
            "\"cornette-shanks\", g = -0.3",
            Phase::CornetteShanks { g: -0.3 },
        ),
        ("\"nishita-hazy\"", Phase::NishitaHazy),
        ("\"nishita-murky\"", Phase::NishitaMurky),
        (
            "\"draine\", g = 0.4, a = 3",
            Phase::Draine { g: 0.4, a: 3.0 },
        ),
        (
            "\"fog\", droplet_um = 8",
            Phase::Fog {
                droplet: 8.0 * 1e-6,
            },
        ),
    ] {
        let text = format!(
            "[[medium]]\nshape = \"haze\"\ntop = 1\nscattering = 1\nphase = {{ kind = {kind} }}\n"
        );
        assert_eq!(
            folder.load("phase.toml", text).expect("it loads").media[0].phase,
            phase
        );
    }
    let scene = folder.load("open.toml", "time = 2026-06-21T18:30:00+02:00\n[camera]\neye=[0,1,0]\ntarget=[0,1,1]\nprojection=\"orthographic\"\nheight=2\n").expect("a scene without a mesh");
    assert_eq!(
        scene.time.as_deref(),
        Some("2026-06-21T18:30:00+02:00"),
        "TOML's own dates do as well"
    );
    assert_eq!(
        scene.camera.map(|c| c.projection),
        Some(Projection::Orthographic { height: 2.0 })
    );
    assert!(scene.mesh.triangles.is_empty());
}

#[test]
fn toml_puts_the_mesh_in_its_place() {
    let folder = Folder::new();
    folder.put("room.obj", ROOM);
    let scene = folder
        .load(
            "room.toml",
            "mesh = \"room.obj\"\nscale = 0.001\nup = \"z\"\norigin = [1e6, 2e6, -3e6]\n",
        )
        .expect("it loads");
    let expected = [DVec3::ZERO, DVec3::X * 0.001, DVec3::NEG_Z * 0.001]
        .map(|p| p + DVec3::new(1e6, 2e6, -3e6));
    assert_eq!(scene.mesh.positions, expected);
    assert_eq!(scene.mesh.normals[0], DVec3::Y, "Z up has become Y up");
    let [a, b, c] = expected;
    assert!(
        (b - a).cross(c - a).y > 0.0,
        "and the front is still in front"
    );
}

#[test]
fn toml_errors_name_file_line_key_and_remedy() {
    let folder = Folder::new();
    folder.put("room.obj", ROOM);
    let base = "mesh = \"room.obj\"\n";
    for (text, expected) in [
        (
            "north = 1\nlatitud = 3",
            &["bad.toml:3: latitud", "no key `latitud`"][..],
        ),
        (
            "[site]\nlatitud = 3",
            &["bad.toml:3: site.latitud", "did you mean `latitude`"],
        ),
        (
            "latitude = 3",
            &["bad.toml:2: latitude", "belongs in [site]"],
        ),
        (
            "[[medium]]\nshape = \"box\"\nmin = [0,0,0]\nmaks = [1,1,1]",
            &["bad.toml:5: medium[0].maks", "did you mean `max`"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = 1\nmin = [0,0,0]",
            &["bad.toml:6: medium[0].min"],
        ),
        (
            "[site]\nsuburb = 3",
            &["bad.toml:3: site.suburb", "Known here: latitude"],
        ),
        (
            "[[medium]]\nshape = \"bocks\"",
            &["bad.toml:3: medium[0].shape", "did you mean \"box\""],
        ),
        (
            "[[medium]]\ntop = 1",
            &["bad.toml:2: medium[0]", "`shape` is missing", "\"haze\""],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3",
            &["bad.toml:2: medium[0]", "`scattering` is missing"],
        ),
        (
            "[medium]\nshape = \"haze\"",
            &["bad.toml:2: medium", "double brackets"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = [1, -1, 1]",
            &["bad.toml:5: medium[0].scattering[1]", "-1"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = 1\nphase = { kind = \"henyey-greenstein\", g = 1 }",
            &["bad.toml:6: medium[0].phase.g", "-1 to 1", "excluded"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = 1\nphase = { kind = \"fog\", droplet_um = 51 }",
            &["bad.toml:6: medium[0].phase.droplet_um", "0.01 to 50"],
        ),
        (
            "[[medium]]\nshape = \"air\"\nturbidity = 0.5",
            &["bad.toml:4: medium[0].turbidity", "1 to 20"],
        ),
        (
            "[[medium]]\nshape = \"air\"\n[[medium]]\nshape = \"air\"",
            &["bad.toml:5: medium[1].shape", "one clear air"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = 1\nphase = { kind = \"mie\" }",
            &["bad.toml:6: medium[0].phase.kind", "nishita-hazy"],
        ),
        (
            "[[medium]]\nshape = \"haze\"\ntop = 3\nscattering = 1\nphase = \"rayleigh\"",
            &["bad.toml:6: medium[0].phase", "a table with `kind`"],
        ),
        (
            "[[medium]]\nshape = \"box\"\nmin = [0,0,0]\nmax = [1,0,1]\nscattering = 1",
            &["bad.toml:5: medium[0].max", "holds nothing"],
        ),
        (
            "[site]\nlatitude = 91\nlongitude = 0",
            &[
                "bad.toml:3: site.latitude",
                "91 degrees",
                "-90 to 90 degrees",
            ],
        ),
        (
            "[site]\nlatitude = nan\nlongitude = 0",
            &["bad.toml:3: site.latitude", "nan"],
        ),
        (
            "scale = inf",
            &["bad.toml:2: scale", "inf", "lower end excluded"],
        ),
        ("scale = 0", &["bad.toml:2: scale", "0"]),
        (
            "north = \"east\"",
            &["bad.toml:2: north", "the text \"east\" instead of a number"],
        ),
        (
            "origin = [0, 0]",
            &["bad.toml:2: origin", "2 elements instead of 3"],
        ),
        (
            "origin = [0, true, 0]",
            &["bad.toml:2: origin[1]", "true instead of a number"],
        ),
        ("up = \"x\"", &["bad.toml:2: up", "\"y\", \"z\""]),
        (
            "[sky]\nmodel = \"cie:17\"",
            &["bad.toml:3: sky.model", "cie:1"],
        ),
        (
            "[picture]\nsize = [960.5, 600]",
            &["bad.toml:3: picture.size[0]", "whole number"],
        ),
        (
            "[picture]\nsamples = 0",
            &["bad.toml:3: picture.samples", "1 to 65536"],
        ),
        (
            "[camera]\neye = [0,0,0]\ntarget = [0,0,0]",
            &["bad.toml:4: camera.target", "where the eye is"],
        ),
        (
            "[camera]\neye = [0,0,0]\ntarget = [0,0,1]\nheight = 2",
            &["bad.toml:5: camera.height"],
        ),
        (
            "[camera]\neye = [0,0,0]\ntarget = [0,0,1]\nfov_y = 180",
            &["bad.toml:5: camera.fov_y", "0 to 180 degrees"],
        ),
        (
            "[camera]\neye = [0,0,0]",
            &["bad.toml:2: camera", "`target` is missing"],
        ),
        ("north = = 3", &["bad.toml:2"]),
    ] {
        let error = folder.refused("bad.toml", format!("{base}{text}\n"));
        for what in expected {
            assert!(error.contains(what), "{text}\n`{what}` is not in: {error}");
        }
    }
    let error = folder.refused("gone.toml", "\nmesh = \"gone.glb\"\n");
    assert!(
        error.contains("gone.toml:2: mesh") && error.contains("gone.glb"),
        "{error}"
    );
    let error = folder.refused("self.toml", "mesh = \"self.toml\"\n");
    assert!(error.contains("cannot be the mesh"), "{error}");
    assert!(
        folder
            .refused("latin.toml", b"north = 1\n# \xe9\n")
            .contains("latin.toml:2")
    );
}

/// Every key that a table in TOML holds, with `[]` for each array of tables.
fn keys(value: &toml::Value, path: &str, into: &mut BTreeSet<String>) {
    match value {
        toml::Value::Table(table) => {
            for (name, value) in table {
                let path = format!("{path}.{name}");
                keys(value, &path, into);
                into.insert(path);
            }
        }
        toml::Value::Array(list) => list.iter().for_each(|v| keys(v, path, into)),
        _ => {}
    }
}

/// Every key that a schema knows, likewise.
fn schema_keys(root: &Value, schema: &Value, path: &str, into: &mut BTreeSet<String>) {
    if let Some(pointer) = schema["$ref"].as_str() {
        let target = root
            .pointer(&pointer[1..])
            .unwrap_or_else(|| panic!("{pointer} leads nowhere"));
        schema_keys(root, target, path, into);
    }
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        let path = format!("{path}.{name}");
        schema_keys(root, property, &path, into);
        into.insert(path);
    }
    for one in schema["oneOf"].as_array().into_iter().flatten() {
        schema_keys(root, one, path, into);
    }
    if schema["items"].is_object() {
        schema_keys(root, &schema["items"], path, into);
    }
}

#[test]
fn schema_and_example_know_the_same_keys() {
    let schema = scene::schema();
    let (mut known, mut used) = (BTreeSet::new(), BTreeSet::new());
    schema_keys(&schema, &schema, "", &mut known);
    keys(
        &toml::from_str(EXAMPLE_TOML).expect("valid TOML"),
        "",
        &mut used,
    );
    // An orthographic camera's, which the example's perspective one cannot have.
    used.insert(".camera.height".into());
    // Layers and ellipsoids have tests of their own.
    let shapes = r#"
        [[medium]]
        bottom = 0.0
        waves = [{ amplitude = 0.1, wavelength = 1.0, direction = 0.0, phase = 0.0 }]
        [[medium]]
        center = [0.0, 0.0, 0.0]
        radii = [1.0, 1.0, 1.0]
        rotation = [0.0, 0.0, 0.0]
        edge = "soft"
    "#;
    keys(&toml::from_str(shapes).expect("valid TOML"), "", &mut used);
    // Draine's phase function, which the example does not use.
    used.insert(".medium.phase.a".into());
    // What a lamp takes from other files, which the example does without.
    for key in ["node", "distribution.path", "distribution.lamp_set"] {
        used.insert(format!(".light.{key}"));
    }
    // Panes have tests of their own.
    for key in ["", ".material", ".transmittance", ".image", ".panes"] {
        used.insert(format!(".pane{key}"));
    }
    // Blinds have, too.
    for key in [
        "",
        ".windows",
        ".transmittance",
        ".openness",
        ".reflectance",
    ] {
        used.insert(format!(".shade{key}"));
    }
    // And so have reflectances by name.
    for key in ["", ".name", ".reflectance"] {
        used.insert(format!(".material{key}"));
    }
    assert_eq!(known, used);
    assert!(!schema.to_string().contains("null"), "TOML has no null");
}
