//! The scenes that are built in: sound, lit by what they are made for, and what their generator makes.

mod common;

use common::build::*;
use std::path::Path;
use tyndall::conditions::{Conditions, Request};
use tyndall::effect::Field;
use tyndall::plan::Quality;
use tyndall::scene::{BUILTIN, Scene, builtin_files};

#[test]
fn every_built_in_scene_shows_the_light_it_is_made_for_and_is_warned_of_nothing() {
    let request = Request {
        size: Some([32, 20]),
        samples: Some(1),
        ..Request::default()
    };
    for name in BUILTIN.into_iter().filter(|name| *name != "nave") {
        let scene = Scene::builtin(name).expect("it loads");
        let seen = Conditions::new(scene, &request).expect("it is sound");
        // Sunlight through glass, which is said not to reflect.
        let (made_for, said) = match name {
            "window" => ([Field::Sun, Field::InscatterSun], 1),
            _ => ([Field::Lights, Field::InscatterLights], 0),
        };
        assert_eq!(seen.warnings.len(), said, "{name}: {:?}", seen.warnings);
        let frame = render_at(&seen, Quality::Draft, LEAST);
        for field in made_for {
            let values = layer(&frame, field);
            let bright = values.iter().filter(|v| v.y > 0.01).count();
            assert!(
                bright > values.len() / 20,
                "{name}: {} has {bright}",
                field.name()
            );
        }
    }
}

#[test]
fn a_written_scene_is_the_one_that_is_built_in() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in BUILTIN {
        let (about, files) = builtin_files(name).expect("it is there");
        assert!(!about.is_empty());
        for (file, bytes) in files {
            std::fs::write(folder.path().join(file), bytes).expect("it can be written");
        }
        let written = tyndall::scene::load(&folder.path().join(files[0].0)).expect("it loads");
        let built_in = Scene::builtin(name).expect("it loads");
        assert_eq!(written.mesh.positions, built_in.mesh.positions, "{name}");
        assert_eq!(written.lamps, built_in.lamps, "{name}");
        assert_eq!(written.media, built_in.media, "{name}");
        assert_eq!(written.emissions, built_in.emissions, "{name}");
    }
}

#[test]
fn the_files_in_the_repository_are_what_the_generator_makes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("a folder");
    let test = "the_files_in_the_repository_are_what_the_generator_makes";
    let into = folder.path().display().to_string();
    if common::python(test, "shipped_scenes.py", &into).is_none() {
        return;
    }
    let mut count = 0;
    for scene in std::fs::read_dir(root.join("data/scenes")).expect("a folder") {
        let scene = scene.expect("it can be read");
        for file in std::fs::read_dir(scene.path()).expect("a folder") {
            let file = file.expect("it can be read").path();
            let made = folder
                .path()
                .join(scene.file_name())
                .join(file.file_name().expect("a name"));
            let same = std::fs::read(&made).ok() == std::fs::read(&file).ok();
            assert!(
                same,
                "{} is not what `python data/scenes.py` makes",
                file.display()
            );
            count += 1;
        }
    }
    assert!(count > 10, "{count}");
}
