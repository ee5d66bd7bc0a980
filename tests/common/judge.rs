//! A scene as the programs of others are told of it: triangles, reflectances, sky, sun and ground in numbers.

use super::rooms::{Room, open_ground};
use glam::DVec3;
use serde_json::{Value, json};
use tyndall::colour::luminance;
use tyndall::conditions::{Conditions, toward};

/// How far the ground is a surface, on which shadows fall; beyond, it has the radiance of open land [m].
const EXTENT: f64 = 60.0;

/// A room under one sky, in red, green and blue of the working space, or under three, of each the luminance.
pub fn world(room: &Room, skies: &[Conditions]) -> Value {
    let each = |of: &dyn Fn(&Conditions) -> DVec3| match skies {
        [one] => of(one).to_array(),
        [a, b, c] => [a, b, c].map(|c| luminance(of(c))),
        _ => unreachable!("one sky or three"),
    };
    let triangles: Vec<Vec<f64>> = (room.triangles.iter())
        .map(|(corners, material)| {
            let numbers = corners.iter().flat_map(|c| c.to_array());
            numbers.chain([f64::from(*material)]).collect()
        })
        .collect();
    let sky = |c: &Conditions| c.sky.clone().expect("there is one");
    let row = |elevation: i32| {
        let at = |azimuth: i32| {
            let [azimuth, elevation] = [azimuth, elevation].map(|v| f64::from(v).to_radians());
            let d = toward(azimuth, elevation, 0.0);
            each(&|c| sky(c).radiance(DVec3::new(d.x, d.y.max(0.0), d.z)))
        };
        (0..=360).map(at).collect::<Vec<[f64; 3]>>()
    };
    let suns: Vec<Vec<f64>> = (skies.iter().enumerate())
        .filter(|(_, c)| c.sun.shines())
        .map(|(k, c)| {
            let light = c.sun.light.illuminance;
            let mut channels = [0.0; 3];
            match skies.len() {
                1 => channels = light.to_array(),
                _ => channels[k] = luminance(light),
            }
            [c.sun.toward.to_array(), channels].concat()
        })
        .collect();
    let far = each(&|c| {
        let light = c.sun.light.illuminance;
        open_ground(
            room.ground,
            sky(c).horizontal_illuminance(),
            light,
            c.sun.toward,
        )
    });
    let ground = skies[0].ground.expect("there is one");
    json!({
        "triangles": triangles,
        "materials": room.working().iter().map(|r| r.to_array()).collect::<Vec<_>>(),
        "sky": (0..=90).map(row).collect::<Vec<_>>(),
        "suns": suns,
        "ground": {
            "height": ground.height,
            "albedo": ground.albedo.to_array(),
            "extent": EXTENT,
            "far": far,
        },
    })
}
