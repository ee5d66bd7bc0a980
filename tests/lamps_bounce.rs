//! Lamp light that a surface has reflected, held to sums over the pool of light.

mod common;

use common::build::*;
use common::night::*;
use glam::{DVec3, dvec3};
use std::f64::consts::{PI, TAU};
use tyndall::backend::Wanted;
use tyndall::effect::Field;
use tyndall::photometry::Distribution;
use tyndall::scene::{Ground, LampEntry};

/// What a plane at y = 0 of an albedo, which a lamp lights, gives to a point that faces a direction [lx]: over the lamp's
/// directions, each with its part of the flux, to where it meets the plane.
fn from_the_pool(lamp: &LampEntry, albedo: f64, point: DVec3, normal: DVec3) -> f64 {
    let axis = lamp.toward.normalize();
    let (u, v) = axis.any_orthonormal_pair();
    let cone = lamp.distribution.cone();
    let (rings, around) = (2_000, 400);
    let mut sum = 0.0;
    for i in 0..rings {
        let theta = cone * (f64::from(i) + 0.5) / f64::from(rings);
        let solid = theta.sin() * (cone / f64::from(rings)) * TAU / f64::from(around);
        let flux = lamp.intensity.y * lamp.distribution.relative(theta, 0.0) * solid;
        for k in 0..around {
            let (y, x) = (TAU * (f64::from(k) + 0.5) / f64::from(around)).sin_cos();
            let direction = theta.cos() * axis + theta.sin() * (x * u + y * v);
            if direction.y >= 0.0 {
                continue;
            }
            let way = lamp.position - lamp.position.y / direction.y * direction - point;
            let square = way.length_squared();
            let toward = way / square.sqrt();
            let cosines = normal.dot(toward).max(0.0) * (-toward.y).max(0.0);
            sum += albedo * flux * cosines / (PI * square);
        }
    }
    sum
}

#[test]
fn beams_of_any_width_send_on_all_of_their_light() {
    let points = [
        (dvec3(0.6, 1.0, 0.2), -DVec3::Y),
        (dvec3(3.0, 1.5, -1.0), dvec3(-1.0, -0.4, 0.2).normalize()),
        (dvec3(-0.8, 0.15, 0.9), dvec3(1.0, -0.1, -0.6).normalize()),
    ];
    let floor = cuboid(dvec3(-6.0, -0.2, -6.0), dvec3(6.0, 0.0, 6.0));
    for (spread, toward) in [
        (0.3, DVec3::NEG_Y),
        (1.0, dvec3(0.13, -1.0, 0.07)),
        (4.0, DVec3::NEG_Y),
        (15.0, dvec3(-0.2, -1.0, 0.1)),
        (40.0, DVec3::NEG_Y),
    ] {
        let mut lamp = lamp(dvec3(0.31, 3.5, 0.17), 1e4, spot(spread, 0.3));
        lamp.toward = toward;
        let scene = night(&floor, vec![lamp.clone()]);
        let found = received(scene, &points, Wanted::Reference, Field::Indirect);
        for (found, (point, normal)) in found.iter().zip(points) {
            let exact = from_the_pool(&lamp, 0.5, point, normal);
            let off = found / exact - 1.0;
            println!("{spread} degrees, at {point}: {:.3} %", 100.0 * off);
            // What is about as narrow as a tile is known less well.
            let most = match spread {
                0.0..2.0 => 0.08,
                2.0..10.0 => 0.06,
                _ => 0.03,
            };
            assert!(off.abs() < most, "{spread} {point}: {found} {exact}");
        }
    }
}

#[test]
fn bare_ground_sends_on_the_light_of_lamps_over_it() {
    let mut scene = night(
        &nothing(),
        vec![lamp(dvec3(30.0, 6.0, 0.0), 1e4, Distribution::Isotropic)],
    );
    scene.ground = Ground {
        enabled: true,
        height: Some(0.0),
        albedo: 0.3,
    };
    let lamp = scene.lamps[0].clone();
    let points = [
        (dvec3(30.0, 5.0, 2.0), -DVec3::Y),
        (dvec3(26.0, 1.0, 1.0), dvec3(1.0, -0.3, 0.0).normalize()),
        (dvec3(40.0, 4.0, 8.0), dvec3(-1.0, -0.3, -0.5).normalize()),
    ];
    let found = received(scene, &points, Wanted::Reference, Field::Indirect);
    for (found, (point, normal)) in found.iter().zip(points) {
        let exact = from_the_pool(&lamp, 0.3, point, normal);
        let off = found / exact - 1.0;
        println!("at {point}: {:.3} %", 100.0 * off);
        // Its patches are as wide as the lamp is high, and their tiles an eighth of that.
        assert!(off.abs() < 0.04, "{point}: {found} {exact}");
    }
}
