//! Lamps as a GPU has them: which scenes' it can do, and their numbers for the shaders (`shaders/common/lamps.wgsl`).
//!
//! All places are relative to the eye, taken from it in f64. Lamps are gone through in parts of the work, one run of a pass each, so that no
//! run takes more turns of its loops than drivers allow; a pixel whose run would is left to the reference ([`super::When::Parts`]).

use super::{Number, Settings};
use crate::colour::luminance;
use crate::conditions::Conditions;
use crate::conditions::lamps::{Lamp, Spot};
use crate::medium::{Medium, Shape};
use crate::photometry::{Distribution, Goniometer, Table};
use crate::scene::LampForm;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

/// Texels of a lamp, and of a spot of one.
pub const LAMP_TEXELS: u32 = 12;
/// Those of a spot.
pub const SPOT_TEXELS: u32 = 3;

/// Runs of a pass that goes through lamps.
const MOST_PARTS: usize = 16;

/// The most media whose light shaders integrate: each bends the light of all others.
const MOST_MEDIA: usize = 16;

/// What is brighter has no squares in f32 [cd].
const BRIGHTEST: f64 = 1e25;

/// So many numbers, a whole one each, are told apart in f32.
const MOST_TEXELS: usize = 1 << 23;

/// Whether a device can do the lamps of a scene, on its surfaces or in its air; why not, if it cannot.
///
/// # Errors
/// The reason, as part of a sentence.
pub fn fits_device(conditions: &Conditions, in_air: bool) -> Result<(), &'static str> {
    let media = &conditions.air.media;
    let geometry = &conditions.geometry;
    if media.iter().any(Medium::is_curved) {
        return Err("the borders of a layer or an ellipsoid are curved");
    }
    if media.len() > MOST_MEDIA {
        return Err("there are more than 16 media");
    }
    if geometry.has_veils() {
        return Err("surfaces let a part of the light through");
    }
    if geometry.panes().is_some() {
        return Err("panes colour the light");
    }
    if in_air && geometry.has_holes() {
        return Err("surfaces have holes");
    }
    if conditions.lamps.iter().any(|lamp| lamp.glow().is_some()) {
        return Err("surfaces shine");
    }
    let names = || conditions.scene.materials.iter().map(|m| &m.name);
    let is_twice = |name: &str| names().filter(|other| *other == name).count() > 1;
    let ignored = |lamp: &Lamp| lamp.ignored().is_some_and(is_twice);
    if conditions.lamps.iter().any(ignored) {
        return Err("several materials have the name of one that a lamp ignores");
    }
    if conditions
        .lamps
        .iter()
        .any(|lamp| lamp.greatest_intensity() > BRIGHTEST)
    {
        return Err("a lamp is too bright for 32 bits");
    }
    let numbers: usize = tables(conditions).iter().map(|t| t.candela().len()).sum();
    if numbers + LAMP_TEXELS as usize * conditions.lamps.len() > MOST_TEXELS {
        return Err("the tables of lamps are too large");
    }
    Ok(())
}

/// All spots that stand for the lamps, each with its lamp's number.
fn spots(conditions: &Conditions, points: u32) -> Vec<(usize, Spot)> {
    let lamps = conditions.lamps.iter().enumerate();
    lamps
        .flat_map(|(i, lamp)| lamp.spots(points).into_iter().map(move |spot| (i, spot)))
        .collect()
}

/// The points, each way, of a lamp with an extent; without any an effect divides lamps itself.
fn points(settings: &Settings<'_>) -> u32 {
    settings
        .values
        .iter()
        .find(|(name, _)| *name == "points")
        .map_or(0, |(_, value)| *value as u32)
}

/// In how many parts a pass goes through lamps, or their spots.
pub fn parts(conditions: &Conditions, settings: &Settings<'_>) -> u32 {
    let count = match points(settings) {
        0 => conditions.lamps.len(),
        points => spots(conditions, points).len(),
    };
    count.clamp(1, MOST_PARTS) as u32
}

/// Numbers that both passes know.
pub fn knobs(conditions: &Conditions, settings: &Settings<'_>) -> Vec<(&'static str, Number)> {
    vec![
        ("parts", Number::Count(parts(conditions, settings))),
        ("left_out", Number::float(settings.get("left_out"))),
        ("luminous_red", Number::float(luminance(DVec3::X))),
        ("luminous_green", Number::float(luminance(DVec3::Y))),
        ("luminous_blue", Number::float(luminance(DVec3::Z))),
    ]
}

/// The most that all media scatter in any direction [1/(m sr)]; without bound where one thins with height.
pub fn strongest(conditions: &Conditions) -> f64 {
    let media = conditions.air.media.iter();
    let scattering = media.filter(|medium| medium.scattering != DVec3::ZERO);
    scattering
        .map(|medium| match medium.shape {
            Shape::Height { .. } | Shape::Air { .. } => 1e30,
            _ => medium.scattering.max_element() * medium.phase.peak(),
        })
        .sum()
}

/// The tables of all lamps, each once.
fn tables(conditions: &Conditions) -> Vec<Arc<Table>> {
    let mut tables: Vec<Arc<Table>> = Vec::new();
    for lamp in conditions.lamps.iter() {
        if let Distribution::Table(table) = &lamp.distribution
            && !tables.iter().any(|other| Arc::ptr_eq(other, table))
        {
            tables.push(table.clone());
        }
    }
    tables
}

fn four(v: DVec3, w: f64) -> [f32; 4] {
    v.as_vec3().extend(w as f32).to_array()
}

/// Lamps, their spots if the effect has any, and their tables, as `shaders/common/lamps.wgsl` reads them.
pub fn texels(conditions: &Conditions, settings: &Settings<'_>) -> Vec<[f32; 4]> {
    let spots = match points(settings) {
        0 => Vec::new(),
        points => spots(conditions, points),
    };
    let eye = conditions.view.camera.eye;
    let lamps = &conditions.lamps;
    let first_spot = 1 + LAMP_TEXELS as usize * lamps.len();
    let first_table = first_spot + SPOT_TEXELS as usize * spots.len();
    let mut texels = vec![[
        lamps.len() as f32,
        spots.len() as f32,
        first_spot as f32,
        0.0,
    ]];
    let tables = tables(conditions);
    let written: Vec<Vec<[f32; 4]>> = tables.iter().map(|table| of_table(table)).collect();
    let begin = |table: &Arc<Table>| {
        let before = tables.iter().take_while(|other| !Arc::ptr_eq(other, table));
        first_table
            + before
                .zip(&written)
                .map(|(_, texels)| texels.len())
                .sum::<usize>()
    };
    for lamp in lamps.iter() {
        let table = match &lamp.distribution {
            Distribution::Table(table) => begin(table),
            _ => 0,
        };
        texels.extend(of_lamp(lamp, eye, table, ignored(conditions, lamp)));
    }
    for (lamp, spot) in &spots {
        let (side, kind) = match spot.side {
            None => (DVec3::ZERO, 0.0),
            Some((side, counts)) => (side, 1.0 + f64::from(u8::from(counts))),
        };
        texels.push(four(spot.position - eye, *lamp as f64));
        texels.push(four(side, kind));
        texels.push([spot.share as f32, spot.radius as f32, 0.0, 0.0]);
    }
    texels.extend(written.into_iter().flatten());
    texels
}

/// One more than the material that does not shade a lamp; 0: all do.
fn ignored(conditions: &Conditions, lamp: &Lamp) -> usize {
    let mut names = conditions.scene.materials.iter().map(|m| m.name.as_str());
    lamp.ignored()
        .and_then(|ignored| names.position(|name| name == ignored))
        .map_or(0, |index| index + 1)
}

/// The numbers of a distribution: which formula, the first four and the fifth.
fn formula(distribution: &Distribution) -> (u32, [f64; 5]) {
    match *distribution {
        Distribution::Isotropic => (EVEN, [0.0; 5]),
        Distribution::NishitaSpot { spread, sharpness } => {
            (SPOT, [spread, sharpness, 0.0, 0.0, 0.0])
        }
        Distribution::Daisy {
            spread,
            sharpness,
            petals,
            ratio,
        } => (DAISY, [spread, sharpness, f64::from(petals), ratio, 0.0]),
        Distribution::PolkaDots {
            spread,
            sharpness,
            petals,
            ratio,
            rings,
        } => {
            let numbers = [
                spread,
                sharpness,
                f64::from(petals),
                ratio,
                f64::from(rings),
            ];
            (DOTS, numbers)
        }
        Distribution::Elliptical {
            spread: [a, b],
            sharpness,
        } => (ELLIPSE, [a, sharpness, b, 0.0, 0.0]),
        Distribution::Cone { inner, outer } => (CONE, [inner, outer, 0.0, 0.0, 0.0]),
        Distribution::Table(_) => (TABLE, [0.0; 5]),
    }
}

/// Kinds of distributions, and of what light comes from, as the shaders number them.
pub const EVEN: u32 = 0;
/// Equation 7 of Nishita et al.
pub const SPOT: u32 = 1;
/// Equation 9.
pub const DAISY: u32 = 2;
/// Equation 10.
pub const DOTS: u32 = 3;
/// Equation 7 with an elliptical cone.
pub const ELLIPSE: u32 = 4;
/// A spot of glTF.
pub const CONE: u32 = 5;
/// Measured values.
pub const TABLE: u32 = 6;
/// A point.
pub const POINT: u32 = 0;
/// A line.
pub const LINE: u32 = 1;
/// A rectangle.
pub const RECTANGLE: u32 = 2;
/// A sphere.
pub const SPHERE: u32 = 3;

fn of_lamp(lamp: &Lamp, eye: DVec3, table: usize, ignored: usize) -> [[f32; 4]; 12] {
    let (kind, [a, b, c, d, e]) = formula(&lamp.distribution);
    let cone = lamp.distribution.cone();
    // Where all directions are inside, rounded angles are too.
    let widest = if cone < PI { cone } else { 4.0 };
    let (form, edges, size) = match lamp.form {
        // Faces stay with the reference ([`fits_device`]).
        LampForm::Point | LampForm::Faces { .. } => (POINT, [DVec3::ZERO; 2], 0.0),
        LampForm::Line { to } => {
            let edge = to - lamp.position;
            (LINE, [edge, DVec3::ZERO], edge.length())
        }
        LampForm::Rectangle { edges: [a, b] } => (RECTANGLE, [a, b], a.cross(b).length().sqrt()),
        LampForm::Sphere { radius } => (SPHERE, [DVec3::ZERO; 2], radius),
    };
    let side = edges[0].cross(edges[1]).normalize_or_zero();
    let side = side * side.dot(lamp.pose.toward).signum();
    let [outer, inner] = lamp.cone_weights();
    let weights = |weights: Option<DVec3>| {
        four(
            weights.unwrap_or_default(),
            f64::from(u8::from(weights.is_some())),
        )
    };
    [
        four(lamp.position - eye, f64::from(kind)),
        four(lamp.pose.toward, widest),
        four(lamp.pose.around, ignored as f64),
        four(lamp.pose.third, table as f64),
        four(lamp.intensity, lamp.greatest_intensity()),
        [a, b, c, d].map(|number| number as f32),
        [
            e,
            lamp.distribution.detail(),
            f64::from(form),
            lamp.extent(),
        ]
        .map(|n| n as f32),
        four(edges[0], size),
        four(edges[1], 0.0),
        four(side, cone.cos()),
        weights(outer),
        weights(inner),
    ]
}

/// How its angles lie; how many there are; where they begin and how far apart they are, 0 where that differs; then both lists and the
/// values.
fn of_table(table: &Table) -> Vec<[f32; 4]> {
    let step = |angles: &[f64]| {
        let step = (angles[angles.len() - 1] - angles[0]) / (angles.len() - 1) as f64;
        let is_even =
            |(i, angle): (usize, &f64)| (angle - angles[0] - step * i as f64).abs() < 1e-9;
        match angles.iter().enumerate().all(is_even) {
            true => step,
            false => 0.0,
        }
    };
    let (across, up) = (table.horizontal(), table.vertical());
    let goniometer = match table.goniometer() {
        Goniometer::A => 0.0,
        Goniometer::B => 1.0,
        Goniometer::C => 2.0,
    };
    let mut numbers = vec![goniometer, across.len() as f64, up.len() as f64, 0.0];
    numbers.extend([across[0], step(across), up[0], step(up)]);
    numbers.extend(across.iter().chain(up).chain(table.candela()));
    numbers
        .chunks(4)
        .map(|four| [0, 1, 2, 3].map(|i| four.get(i).map_or(0.0, |number| *number as f32)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_keeps_all_its_numbers() {
        let candela: Vec<f64> = (0..10).map(f64::from).collect();
        let table = Table::new(
            Goniometer::C,
            vec![0.0, 360.0],
            vec![0.0, 10.0, 20.0, 30.0, 45.0],
            candela,
        )
        .expect("it is sound");
        let texels = of_table(&table);
        assert_eq!(texels[0], [2.0, 2.0, 5.0, 0.0]);
        // Its vertical angles are not even.
        assert_eq!(texels[1], [0.0, 360.0, 0.0, 0.0]);
        let rest = texels[2..].concat();
        assert_eq!(rest[..7], [0.0, 360.0, 0.0, 10.0, 20.0, 30.0, 45.0]);
        assert_eq!(
            rest[7..17],
            [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
        );
        assert!(rest[17..].iter().all(|number| *number == 0.0));
    }
}
