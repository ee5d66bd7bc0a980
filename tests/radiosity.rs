//! Light that surfaces receive from sky, sun and each other, against closed forms: through points with normals alone.

mod common;

use common::build::quad;
use common::receive::*;
use common::rooms::panel;
use glam::{DVec3, dvec3};
use std::f64::consts::PI;
use tyndall::conditions::Receiver;
use tyndall::scene::Scene;
use tyndall::studies::scenes::Corners;

type Surfaces = Vec<(Corners, f64)>;

/// More rays and finer outlines than by default: light of small parts of what a point sees converges with them.
const FINE: Settings = &[("radiosity.rays", 16_384.0), ("radiosity.outline", 2e-4)];
/// Rays for single points that see a lit surface far away, whose outline nothing but rays finds.
const MANY_RAYS: Settings = &[("radiosity.rays", 65_536.0)];

/// Form factors and what is made of them.
const ALLOWED: f64 = 0.01;

fn grey(triangles: impl IntoIterator<Item = Corners>, reflectance: f64) -> Surfaces {
    triangles.into_iter().map(|t| (t, reflectance)).collect()
}

/// One small triangle far below everything, since a scene must have one.
fn speck() -> Surfaces {
    let low = dvec3(0.0, -50.0, 0.0);
    grey([[low, low + 1e-3 * DVec3::X, low + 1e-3 * DVec3::Z]], 0.0)
}

/// Directions that are spread over the sphere.
fn directions(count: usize) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |i| {
        let y = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
        let angle = 2.399_963_229_728_653 * i as f64;
        let level = (1.0 - y * y).sqrt();
        dvec3(level * angle.cos(), y, level * angle.sin())
    })
}

#[test]
fn open_land_lights_by_sky_sun_and_ground() {
    let mut off = Deviations::default();
    let scene = ground(
        sun(sky(surfaces(&speck()), "uniform:5000"), [100.0, 30.0], 6e4),
        0.0,
        0.3,
    );
    let points: Vec<Receiver> = directions(24).map(|n| at(3.0 * DVec3::Y, n)).collect();
    let found = receive_by(scene, &points, FINE);
    let whole = 5000.0 * PI;
    // View factors of a half space: (1 + cos) / 2 of the sky, (1 - cos) / 2 of the ground, which the sun lights too.
    let sky: Vec<f64> = points
        .iter()
        .map(|p| 0.5 * (1.0 + p.normal.y) * whole)
        .collect();
    let up = whole + 6e4 * 30f64.to_radians().sin();
    let ground: Vec<f64> = points
        .iter()
        .map(|p| 0.3 * up * 0.5 * (1.0 - p.normal.y))
        .collect();
    off.near_of(whole, "sky", &y(&found.sky), &sky, ALLOWED);
    off.near_of(0.3 * up, "ground", &y(&found.indirect), &ground, ALLOWED);
    off.end();
}

#[test]
fn without_a_ground_nothing_comes_from_below() {
    let mut off = Deviations::default();
    let scene = sky(surfaces(&speck()), "uniform:5000");
    let points: Vec<Receiver> = directions(24).map(|n| at(3.0 * DVec3::Y, n)).collect();
    let found = receive(scene, &points);
    let whole = 5000.0 * PI;
    let sky: Vec<f64> = points
        .iter()
        .map(|p| 0.5 * (1.0 + p.normal.y) * whole)
        .collect();
    off.near_of(whole, "sky", &y(&found.sky), &sky, ALLOWED);
    assert!(found.indirect.iter().all(|v| *v == DVec3::ZERO));
    off.end();
}

#[test]
fn a_huge_wall_takes_half_the_sky() {
    let mut off = Deviations::default();
    let wall = quad(dvec3(-1e4, 0.0, -1.0), DVec3::X * 2e4, DVec3::Y * 1e4);
    let scene = sky(surfaces(&grey(wall, 0.0)), "uniform:5000");
    let points: Vec<Receiver> = [0.0, 1.0, 5.0, 30.0]
        .map(|x| at(dvec3(x, 0.3, x), DVec3::Y))
        .to_vec();
    let corners = rectangle(dvec3(-1e4, 0.0, -1.0), DVec3::X * 2e4, DVec3::Y * 1e4);
    let truth = |p: &Receiver| 5000.0 * PI * (1.0 - form_factor(p, &corners));
    let truth: Vec<f64> = points.iter().map(truth).collect();
    assert!(
        (truth[0] / (2500.0 * PI) - 1.0).abs() < 1e-3,
        "{}",
        truth[0]
    );
    off.near(
        "half a sky",
        &y(&receive(scene, &points).sky),
        &truth,
        ALLOWED,
    );
    off.end();
}

/// A plate with a hole, 40 by 40, of which one unit vector is `along` and one `up`.
fn pierced(corner: DVec3, along: DVec3, up: DVec3, hole: [f64; 4]) -> Surfaces {
    let [a, b, c, d] = hole.map(|v| v + 20.0);
    let corner = corner - 20.0 * (along + up);
    grey(panel(corner, along, up, [40.0, 40.0], &[[a, b, c, d]]), 0.0)
}

/// Sides of a black box that is open where `walls` stand: below and around points near the origin.
fn closed_below() -> Surfaces {
    grey(
        quad(dvec3(-20.0, -1.0, -20.0), DVec3::X * 40.0, DVec3::Z * 40.0),
        0.0,
    )
}

#[test]
fn openings_give_the_sky_that_their_form_factor_says() {
    let mut off = Deviations::default();
    // A roof at y = 1 that reaches far, with walls down to the floor, and a unit square hole in it over the point's corner.
    let roof = pierced(DVec3::Y, DVec3::X, DVec3::Z, [0.0, 1.0, 0.0, 1.0]);
    let point = at(DVec3::ZERO, DVec3::Y);
    let hole = rectangle(DVec3::Y, DVec3::X, DVec3::Z);
    assert!((form_factor(&point, &hole) - 0.138_531_6).abs() < 1e-7);
    let aside = at(DVec3::ZERO, DVec3::X);
    let window = rectangle(DVec3::X, DVec3::Y, DVec3::Z);
    assert!((form_factor(&point, &window) - 0.055_734_2).abs() < 1e-7);

    let skirt = |s: Surfaces| {
        let mut s = [s, closed_below()].concat();
        for side in [
            quad(dvec3(-20.0, -1.0, -20.0), DVec3::X * 40.0, DVec3::Y * 2.0),
            quad(dvec3(-20.0, -1.0, 20.0), DVec3::X * 40.0, DVec3::Y * 2.0),
            quad(dvec3(-20.0, -1.0, -20.0), DVec3::Z * 40.0, DVec3::Y * 2.0),
            quad(dvec3(20.0, -1.0, -20.0), DVec3::Z * 40.0, DVec3::Y * 2.0),
        ] {
            s.extend(grey(side, 0.0));
        }
        s
    };
    let scene = sky(surfaces(&skirt(roof)), "uniform:5000");
    let points: Vec<Receiver> = [
        DVec3::ZERO,
        dvec3(0.5, 0.0, 0.5),
        dvec3(0.5, 0.9, 0.5),
        dvec3(-3.0, 0.2, 2.0),
        dvec3(8.0, -0.9, 0.3),
    ]
    .map(|p| at(p, DVec3::Y))
    .into_iter()
    .chain([at(DVec3::ZERO, dvec3(1.0, 2.0, 0.5)), aside])
    .collect();
    let truth: Vec<f64> = points
        .iter()
        .map(|p| 5000.0 * PI * form_factor(p, &hole))
        .collect();
    off.near(
        // The farthest point sees the hole as a four thousandth of its view.
        "a hole in a roof",
        &y(&receive_by(scene, &points, FINE).sky),
        &truth,
        2.0 * ALLOWED,
    );

    // A window in a wall at x = 1, from y = 0 to 1 and z = 0 to 1; behind it a black room.
    let wall = pierced(DVec3::X, DVec3::Y, DVec3::Z, [0.0, 1.0, 0.0, 1.0]);
    let mut room = wall;
    for side in [
        quad(dvec3(-20.0, 20.0, -20.0), DVec3::X * 21.0, DVec3::Z * 40.0),
        quad(dvec3(-20.0, -20.0, -20.0), DVec3::X * 21.0, DVec3::Z * 40.0),
        quad(dvec3(-20.0, -20.0, -20.0), DVec3::X * 21.0, DVec3::Y * 40.0),
        quad(dvec3(-20.0, -20.0, 20.0), DVec3::X * 21.0, DVec3::Y * 40.0),
        quad(dvec3(-20.0, -20.0, -20.0), DVec3::Y * 40.0, DVec3::Z * 40.0),
    ] {
        room.extend(grey(side, 0.0));
    }
    let scene = sky(surfaces(&room), "uniform:5000");
    let points: Vec<Receiver> = [
        at(DVec3::ZERO, DVec3::Y),
        at(DVec3::ZERO, DVec3::X),
        at(dvec3(0.7, -0.5, 0.5), DVec3::Y),
        at(dvec3(-6.0, 0.0, 2.0), dvec3(1.0, 1.0, 0.0)),
        at(dvec3(-15.0, -4.0, -4.0), DVec3::Y),
    ]
    .to_vec();
    // Only what stands above the point's horizon shows sky.
    let truth = |p: &Receiver| {
        let seen = clipped(&window, p.position, DVec3::Y);
        5000.0 * PI * form_factor(p, &seen)
    };
    let truth: Vec<f64> = points.iter().map(truth).collect();
    off.near(
        "a window",
        &y(&receive_by(scene, &points, FINE).sky),
        &truth,
        ALLOWED,
    );
    off.end();
}

#[test]
fn an_overcast_sky_comes_through_openings_as_quadrature_says() {
    let mut off = Deviations::default();
    for (name, corner, a, b) in [
        ("roof", dvec3(0.0, 2.0, 0.0), DVec3::X * 2.0, DVec3::Z * 1.5),
        (
            "window",
            dvec3(3.0, 0.4, -0.5),
            DVec3::Y * 1.3,
            DVec3::Z * 2.0,
        ),
    ] {
        let (along, up) = (a.normalize(), b.normalize());
        let mut parts = pierced(corner, along, up, [0.0, a.length(), 0.0, b.length()]);
        // A black box around the points, 40 wide, against the pierced plate.
        let inward = match name {
            "roof" => DVec3::NEG_Y,
            _ => DVec3::NEG_X,
        };
        let middle = corner + 20.0 * inward;
        let (p, q, r) = (20.0 * along, 20.0 * up, 20.0 * inward);
        for (out, s, t) in [(p, q, r), (-p, q, r), (q, p, r), (-q, p, r), (r, p, q)] {
            parts.extend(grey(quad(middle + out - s - t, 2.0 * s, 2.0 * t), 0.0));
        }
        let points: Vec<Receiver> = [
            at(dvec3(0.3, 0.1, 0.2), DVec3::Y),
            at(dvec3(-2.0, 0.0, 1.0), DVec3::Y),
            at(dvec3(1.0, 0.2, 0.4), dvec3(0.3, 1.0, 0.2)),
            at(dvec3(0.0, 0.3, 0.0), DVec3::X),
        ]
        .to_vec();
        let conditions = conditions(sky(surfaces(&parts), "cie:16"), &points);
        let dome = conditions.sky.clone().expect("it was asked for");
        let nodes = gauss(48);
        let normal = a.cross(b);
        let truth = |p: &Receiver| -> f64 {
            let mut sum = 0.0;
            for &(u, wu) in &nodes {
                for &(v, wv) in &nodes {
                    let way = corner + u * a + v * b - p.position;
                    let toward = way.normalize();
                    let element = toward.dot(normal).abs() / way.length_squared() * wu * wv;
                    let cosine = toward.dot(p.normal).max(0.0);
                    if toward.y > 0.0 {
                        sum += tyndall::colour::luminance(dome.radiance(toward)) * cosine * element;
                    }
                }
            }
            sum
        };
        let truth: Vec<f64> = points.iter().map(truth).collect();
        let found = received_by(&conditions, tyndall::backend::Wanted::Reference, FINE);
        off.near(
            &format!("overcast through a {name}"),
            &y(&found.sky),
            &truth,
            ALLOWED,
        );
    }
    off.end();
}

/// A surface that the sun lights and nothing else does.
fn sunlit(parts: &Surfaces, at: [f64; 2]) -> Scene {
    sun(surfaces(parts), at, 1e5)
}

#[test]
fn squares_send_each_other_what_their_form_factors_say() {
    let mut off = Deviations::default();
    let square = grey(quad(DVec3::ZERO, DVec3::X, DVec3::Z), 0.5);
    let corners = rectangle(DVec3::ZERO, DVec3::X, DVec3::Z);
    let lit = 0.5 * 1e5 * 50f64.to_radians().sin();
    for (name, factor, corner, a, b, normal) in [
        (
            "parallel",
            0.199_824_9,
            DVec3::Y,
            DVec3::X,
            DVec3::Z,
            DVec3::NEG_Y,
        ),
        (
            "parallel and close",
            0.826_994_5,
            0.1 * DVec3::Y,
            DVec3::X,
            DVec3::Z,
            DVec3::NEG_Y,
        ),
        (
            "perpendicular",
            0.200_043_8,
            DVec3::ZERO,
            DVec3::Y,
            DVec3::Z,
            DVec3::X,
        ),
    ] {
        // Points where the other square would be, without the square: nothing stands in the sun.
        let nodes = over_rectangle(corner, a, b, normal, 24);
        let points: Vec<Receiver> = nodes.iter().map(|(p, _)| *p).collect();
        let mean = |of: &dyn Fn(usize) -> f64| -> f64 {
            nodes
                .iter()
                .enumerate()
                .map(|(i, (_, weight))| weight * of(i))
                .sum()
        };
        let exact = mean(&|i| form_factor(&points[i], &corners));
        assert!((exact / factor - 1.0).abs() < 1e-3, "{name}: {exact}");
        let found = y(&receive(sunlit(&square, [250.0, 50.0]), &points).indirect);
        off.near(name, &[mean(&|i| found[i])], &[factor * lit], ALLOWED);
        let some: Vec<Receiver> = points.iter().copied().step_by(5).collect();
        let found = y(&receive_by(sunlit(&square, [250.0, 50.0]), &some, FINE).indirect);
        let truth: Vec<f64> = (some.iter())
            .map(|p| lit * form_factor(p, &corners))
            .collect();
        off.near(
            &format!("{name}, each point"),
            &found,
            &truth,
            2.0 * ALLOWED,
        );
    }
    off.end();
}

/// A disc of many corners around the vertical at the origin.
fn disc(radius: f64, height: f64, corners: usize) -> Vec<DVec3> {
    let corner = |i: usize| {
        let (sin, cos) = (2.0 * PI * i as f64 / corners as f64).sin_cos();
        dvec3(radius * cos, height, radius * sin)
    };
    (0..corners).map(corner).collect()
}

/// Triangles from the first corner of a polygon to its edges: needles, most of them.
fn fan(polygon: &[DVec3]) -> Vec<Corners> {
    (polygon[1..].windows(2))
        .map(|edge| [polygon[0], edge[0], edge[1]])
        .collect()
}

#[test]
fn discs_and_spheres_have_their_form_factors() {
    let mut off = Deviations::default();
    // From an element to a disc on its axis: r^2 / (r^2 + h^2).
    let polygon = disc(1.0, 0.0, 192);
    let lit = 0.5 * 1e5 * 50f64.to_radians().sin();
    let points: Vec<Receiver> = [0.3, 1.0, 2.0, 6.0]
        .map(|h| at(h * DVec3::Y, DVec3::NEG_Y))
        .to_vec();
    let truth: Vec<f64> = points
        .iter()
        .map(|p| lit / (1.0 + p.position.y.powi(2)))
        .collect();
    let scene = sunlit(&grey(fan(&polygon), 0.5), [250.0, 50.0]);
    let found = receive_by(scene, &points, MANY_RAYS);
    off.near("a disc", &y(&found.indirect), &truth, ALLOWED);

    // Between equal discs as far apart as their radius: 0.3819660.
    let nodes: Vec<(Receiver, f64)> = (gauss(16).iter())
        .flat_map(|&(u, weight)| {
            // Equal areas for equal shares of the radius' square.
            let each = move |k: usize| {
                let (sin, cos) = (2.0 * PI * (k as f64 + 0.3) / 8.0).sin_cos();
                let r = u.sqrt();
                (at(dvec3(r * cos, 1.0, r * sin), DVec3::NEG_Y), weight / 8.0)
            };
            (0..8).map(each).collect::<Vec<_>>()
        })
        .collect();
    let points: Vec<Receiver> = nodes.iter().map(|(p, _)| *p).collect();
    let found = receive(sunlit(&grey(fan(&polygon), 0.5), [250.0, 50.0]), &points);
    let found = y(&found.indirect);
    let mean: f64 = nodes
        .iter()
        .zip(&found)
        .map(|((_, weight), f)| weight * f)
        .sum();
    off.near("two discs", &[mean], &[0.381_966_0 * lit], ALLOWED);

    // A black sphere takes (r / d)^2 of a uniform sky from an element that faces it.
    let ball = sphere(1.0, 96, 48, |_| true);
    let mut ball = grey(ball, 0.0);
    for (corners, _) in &mut ball {
        for corner in corners {
            corner.y += 3.0;
        }
    }
    let points: Vec<Receiver> = [0.0, 1.0, 1.8].map(|h| at(h * DVec3::Y, DVec3::Y)).to_vec();
    let truth: Vec<f64> = (points.iter())
        .map(|p| 5000.0 * PI * (1.0 - (3.0 - p.position.y).powi(-2)))
        .collect();
    let found = receive(sky(surfaces(&ball), "uniform:5000"), &points);
    off.near("a sphere", &y(&found.sky), &truth, ALLOWED);
    off.end();
}

/// The faces of a sphere of meridians and parallels around the vertical whose middles are kept.
fn sphere(radius: f64, around: usize, down: usize, keep: impl Fn(DVec3) -> bool) -> Vec<Corners> {
    let corner = |i: usize, j: usize| {
        let (sin_a, cos_a) = (2.0 * PI * (i % around) as f64 / around as f64).sin_cos();
        let (sin_z, cos_z) = (PI * j as f64 / down as f64).sin_cos();
        radius * dvec3(sin_z * cos_a, cos_z, sin_z * sin_a)
    };
    let mut faces = Vec::new();
    for j in 0..down {
        for i in 0..around {
            let [a, b] = [corner(i, j), corner(i + 1, j)];
            let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
            if keep(0.25 * (a + b + c + d)) {
                if j > 0 {
                    faces.push([a, b, c]);
                }
                if j + 1 < down {
                    faces.push([a, c, d]);
                }
            }
        }
    }
    faces
}

/// Ulbricht's sphere: through a port at its top the sky lights all of it alike, and E = pi L f / (1 - r (1 - f)), where f is the
/// port's share of the sphere.
#[test]
fn a_sphere_with_a_port_returns_one_over_one_less_its_albedo() {
    let mut off = Deviations::default();
    let (around, down, open) = (64, 32, 8);
    // Down to 45 degrees from the top there is no wall.
    let edge = (PI * f64::from(open) / f64::from(down)).cos();
    let faces = sphere(2.0, around, down as usize, |middle| {
        middle.normalize().y < edge
    });
    let rim = disc(2.0 * (1.0 - edge * edge).sqrt(), 2.0 * edge, around);
    let points: Vec<Receiver> = (directions(40))
        .filter(|d| d.y < 0.6)
        .map(|d| at(1.985 * d, -d))
        .collect();
    // The share as points on the wall see it: 0.1464 for a true sphere.
    let shares: Vec<f64> = points.iter().map(|p| form_factor(p, &rim)).collect();
    let f = shares.iter().sum::<f64>() / shares.len() as f64;
    assert!((f / (0.5 * (1.0 - edge)) - 1.0).abs() < 0.01, "{f}");
    for albedo in [0.2, 0.5, 0.9, 0.999] {
        let scene = sky(surfaces(&grey(faces.clone(), albedo)), "uniform:5000");
        let total = y(&receive_by(scene, &points, FINE).total());
        let mean = total.iter().sum::<f64>() / total.len() as f64;
        let truth = 5000.0 * PI * f / (1.0 - albedo * (1.0 - f));
        // What patches receive from outside is not scaled with the rest of their rows: half of a per cent is reached only where
        // little or nearly all is sent on.
        off.near(&format!("albedo {albedo}"), &[mean], &[truth], 0.012);
        off.near(
            &format!("albedo {albedo}, each"),
            &total,
            &vec![truth; total.len()],
            0.02,
        );
    }
    off.end();
}

/// Where nothing absorbs, everything has the sky's radiance, whatever stands there.
#[test]
fn all_is_white_in_a_white_world() {
    let mut off = Deviations::default();
    let mut parts = grey(
        panel(
            DVec3::ZERO,
            DVec3::X,
            DVec3::Y,
            [4.0, 3.0],
            &[[1.0, 3.0, 1.0, 2.5]],
        ),
        1.0,
    );
    for (corner, a, b) in [
        (DVec3::ZERO, DVec3::X * 4.0, DVec3::NEG_Z * 5.0),
        (dvec3(0.0, 3.0, 0.0), DVec3::X * 4.0, DVec3::NEG_Z * 5.0),
        (DVec3::ZERO, DVec3::Y * 3.0, DVec3::NEG_Z * 5.0),
        (dvec3(4.0, 0.0, 0.0), DVec3::Y * 3.0, DVec3::NEG_Z * 5.0),
        (dvec3(0.0, 0.0, -5.0), DVec3::X * 4.0, DVec3::Y * 3.0),
    ] {
        parts.extend(grey(quad(corner, a, b), 1.0));
    }
    let scene = ground(sky(surfaces(&parts), "uniform:5000"), -0.5, 1.0);
    let points: Vec<Receiver> = [
        at(dvec3(2.0, 0.8, -2.5), DVec3::Y),
        at(dvec3(0.4, 2.0, -4.5), DVec3::X),
        at(dvec3(3.5, 2.9, -0.2), DVec3::NEG_Y),
        at(dvec3(2.0, 1.5, 1.0), DVec3::NEG_Z),
        at(dvec3(7.0, 0.2, 3.0), DVec3::Y),
    ]
    .to_vec();
    let total = y(&receive(scene, &points).total());
    off.near("white", &total, &[5000.0 * PI; 5], 0.005);
    off.end();
}

/// What is shaded on the ground does not light: a roof's shadow far from the roof, seen from above.
#[test]
fn the_ground_is_dark_where_a_roof_shades_it() {
    let mut off = Deviations::default();
    let height = 12.0;
    let roof = quad(dvec3(-4.0, height, -3.0), DVec3::X * 8.0, DVec3::Z * 6.0);
    let elevation = 20f64.to_radians();
    let scene = ground(sunlit(&grey(roof, 0.0), [90.0, 20.0]), 0.0, 0.4);
    // The sun stands in the east: the shadow lies in the west, beyond the mesh.
    let shift = -height / elevation.tan() * DVec3::X - height * DVec3::Y;
    let shadow = rectangle(
        dvec3(-4.0, height, -3.0) + shift,
        DVec3::X * 8.0,
        DVec3::Z * 6.0,
    );
    let lit = 0.4 * 1e5 * elevation.sin();
    let points: Vec<Receiver> = [
        at(dvec3(-33.0, 3.0, 0.0), DVec3::NEG_Y),
        at(dvec3(-33.0, 0.5, 2.0), DVec3::NEG_Y),
        at(dvec3(-28.0, 6.0, 4.0), DVec3::NEG_X),
        at(dvec3(-45.0, 2.0, 0.0), DVec3::X),
        at(dvec3(5.0, 2.0, 0.0), DVec3::NEG_Y),
    ]
    .to_vec();
    let truth = |p: &Receiver| lit * (0.5 * (1.0 - p.normal.y) - form_factor(p, &shadow));
    let truth: Vec<f64> = points.iter().map(truth).collect();
    let found = y(&receive(scene, &points).indirect);
    eprintln!("{found:.0?} {truth:.0?}");
    // The first two have the shadow below them, whose edge is known to about a metre.
    off.near_of(lit, "above the shadow", &found[..2], &truth[..2], 0.04);
    off.near("beside the shadow", &found[2..], &truth[2..], 0.01);
    off.end();
}
