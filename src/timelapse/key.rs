//! What makes a picture what it is, as hashes: equal keys are equal pictures.
//!
//! A key takes in the version of tyndall, the whole content of the scene, all settings that change pictures, what computes, the instant and the
//! exposure. It says nothing of names: a scene that was moved, or frames that are numbered otherwise, have the keys that they had.

use crate::conditions::{Conditions, Request};
use crate::ephemeris::civil;
use crate::output::OutputSpace;
use crate::plan::Overrules;
use crate::scene::{Mesh, Scene, Texture};
use chrono::{DateTime, Utc};
use sha2::{Digest, Sha256};
use std::fmt::{Debug, Write};

/// A hash that takes text and numbers in.
struct Hash(Sha256);

impl Write for Hash {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.0.update(text);
        Ok(())
    }
}

impl Hash {
    fn new() -> Self {
        Hash(Sha256::new())
    }

    /// Anything, by its name. What is derived of `Debug` shows all of its fields, and numbers to the last bit.
    fn take(&mut self, name: &str, value: &dyn Debug) {
        // Hashing does not fail.
        let _ = write!(self, "{name}={value:?};");
    }

    fn numbers<const N: usize>(
        &mut self,
        name: &str,
        values: impl ExactSizeIterator<Item = [f64; N]>,
    ) {
        self.take(name, &values.len());
        for value in values.flatten() {
            self.0.update(value.to_bits().to_le_bytes());
        }
    }

    fn hexadecimal(self) -> String {
        let mut text = String::with_capacity(64);
        for byte in self.0.finalize() {
            let _ = write!(text, "{byte:02x}");
        }
        text
    }
}

/// Hash of everything that a scene says, whichever files it was read from.
pub fn of_scene(scene: &Scene) -> String {
    // All fields by name, so that none is forgotten. The moment is the frames' own; warnings and blinds, which years of daylight alone
    // close, change no picture.
    let Scene {
        name,
        mesh,
        materials,
        textures,
        emissions,
        cameras,
        lights,
        lamps,
        nodes,
        parts,
        no_material,
        north_deg,
        time: _,
        site,
        camera,
        sun,
        sky,
        ground,
        media,
        air,
        picture,
        shades: _,
        warnings: _,
    } = scene;
    let Mesh {
        positions,
        normals,
        uvs,
        colors,
        triangles,
    } = mesh;
    let mut hash = Hash::new();
    // Files hold the name.
    hash.take("name", name);
    hash.numbers("positions", positions.iter().map(|p| p.to_array()));
    hash.numbers("normals", normals.iter().map(|n| n.to_array()));
    hash.numbers("uvs", uvs.iter().map(|uv| uv.to_array()));
    hash.numbers("colors", colors.iter().map(|c| c.to_array()));
    hash.take("triangles", &triangles.len());
    for triangle in triangles {
        let [a, b, c] = triangle.vertices;
        for number in [a, b, c, triangle.material] {
            hash.0.update(number.to_le_bytes());
        }
    }
    for texture in textures {
        let Texture {
            name,
            width,
            height,
            pixels,
            wrap,
        } = texture;
        hash.take("texture", &(name, width, height, wrap));
        hash.0.update(pixels.as_flattened());
    }
    hash.take("materials", materials);
    hash.take("emissions", emissions);
    hash.take("cameras", cameras);
    hash.take("lights", lights);
    hash.take("lamps", lamps);
    hash.take("nodes", nodes);
    hash.take("parts", parts);
    hash.take("no_material", no_material);
    hash.take("north", north_deg);
    hash.take("site", site);
    hash.take("camera", camera);
    hash.take("sun", sun);
    hash.take("sky", sky);
    hash.take("ground", ground);
    hash.take("media", media);
    hash.take("air", air);
    hash.take("picture", picture);
    hash.hexadecimal()
}

/// Everything but the scene, the instant and the exposure that changes pictures or their files.
pub struct Settings<'a> {
    /// The view and how place and time are read; of the moment nothing counts.
    pub conditions: &'a Conditions,
    /// What the user wants otherwise.
    pub overrules: &'a Overrules,
    /// The clock of the place: files hold the time by it.
    pub clock: &'a str,
    /// The layers of an EXR.
    pub layers: &'a [&'static str],
    /// The colour space of EXR and HDR.
    pub space: &'a OutputSpace,
    /// What computes: the reference, or a device with its driver.
    pub backend: &'a str,
    /// The exposure of all frames [EV100], if it is one.
    pub exposure: Option<f64>,
    /// How many stops brighter than metered they are, if their exposure is planned.
    pub stops: f64,
}

/// Hash of settings.
pub fn of_settings(settings: &Settings<'_>) -> String {
    let Settings {
        conditions,
        overrules,
        clock,
        layers,
        space,
        backend,
        exposure,
        stops,
    } = settings;
    let mut hash = Hash::new();
    let view = &conditions.view;
    hash.take("camera", &view.camera);
    hash.take("size", &view.size);
    hash.take("samples", &view.samples);
    // The others say how a time is read, and each key holds an instant and what the clock shows.
    let Request {
        size: _,
        samples: _,
        camera: _,
        tier,
        timezone: _,
        fold: _,
        time_scale: _,
        delta_t,
        pressure_hpa,
        temperature_c,
    } = conditions.request();
    hash.take("sun", &(tier, delta_t, pressure_hpa, temperature_c));
    hash.take("clock", clock);
    // What is named in any order is one thing. Of one knob the last word counts, and an effect has more than one name: those stay in theirs.
    let mut overrules = (*overrules).clone();
    let knob = |(target, _): &(String, f64)| target.split_once('.').map(|(_, k)| k.to_owned());
    overrules.set.sort_by_cached_key(knob);
    overrules.force.sort();
    overrules.without.sort();
    let mut layers = layers.to_vec();
    layers.sort();
    hash.take("overrules", &overrules);
    hash.take("layers", &layers);
    hash.take("space", space);
    hash.take("backend", backend);
    hash.take("exposure", exposure);
    hash.take("stops", stops);
    hash.hexadecimal()
}

/// Hash of the time zone database.
pub fn of_time_zones() -> String {
    let mut hash = Hash::new();
    civil::tz_data(|name, data| {
        hash.take("zone", &(name, data.len()));
        hash.0.update(data);
    });
    hash.hexadecimal()
}

/// The key of a frame: `local` is its time by the clock of the place, which its files hold.
pub fn of_frame(
    scene_hash: &str,
    settings_hash: &str,
    (utc, local): (DateTime<Utc>, &str),
    ev100: f64,
) -> String {
    let mut hash = Hash::new();
    hash.take("version", &env!("CARGO_PKG_VERSION"));
    hash.take("scene", &scene_hash);
    hash.take("settings", &settings_hash);
    let instant = (utc.timestamp(), utc.timestamp_subsec_nanos());
    hash.take("instant", &instant);
    hash.take("local", &local);
    hash.take("ev100", &ev100.to_bits());
    hash.hexadecimal()
}
