//! How far points of the sun's disc are said to be from converged: that falls with more of them, and bounds what they are off by.

mod common;

use common::build::quad;
use common::views::far_slit;
use glam::DVec3;
use tyndall::accuracy::LayerError;
use tyndall::backend::check::Yardstick;
use tyndall::backend::convergence::Convergence;
use tyndall::conditions::Conditions;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::task::Task;

/// Sunlight from a far slit in fog and on a floor.
fn conditions() -> Conditions {
    let mut view = far_slit();
    let floor = quad(
        DVec3::new(-60.0, -9.0, 60.0),
        120.0 * DVec3::X,
        -120.0 * DVec3::Z,
    );
    let mesh = &mut view.scene.mesh;
    let positions: Vec<DVec3> = mesh.positions.to_vec();
    let mut triangles: Vec<[DVec3; 3]> = mesh
        .triangles
        .iter()
        .map(|triangle| triangle.vertices.map(|i| positions[i as usize]))
        .collect();
    triangles.extend(floor);
    view.scene.mesh = common::build::scene(&triangles, 90.0, 5.0).mesh;
    view.conditions([24, 96]).expect("it is sound")
}

/// A plan in which `suns` points stand for the disc.
fn plan(conditions: &Conditions, suns: f64) -> Plan<'_> {
    let overrules = Overrules {
        quality: Quality::Reference,
        set: ["shafts.suns", "surface_sun.suns"]
            .map(|knob| (knob.to_owned(), suns))
            .to_vec(),
        without: ["radiosity", "air_sky", "sky_dome"]
            .map(str::to_owned)
            .to_vec(),
        ..Overrules::default()
    };
    Plan::new(conditions, &overrules).expect("it is sound")
}

fn named<'l>(layers: &'l [LayerError], name: &str) -> &'l LayerError {
    let mut layers = layers.iter();
    layers.find(|l| l.layer == name).expect("it is there")
}

#[test]
fn the_figure_falls_with_more_points_and_bounds_the_error() {
    let conditions = conditions();
    // All pixels, so that both are of the same.
    let all = 24 * 96;
    let truth = Yardstick::new(&plan(&conditions, 4096.0), all, Task::unwatched());
    let truth = truth.expect("nothing stops it");
    let mut before = [f64::INFINITY; 2];
    for suns in [8.0, 32.0, 128.0, 512.0] {
        let plan = plan(&conditions, suns);
        let said = Convergence::of(&plan, all, Task::unwatched()).expect("nothing stops it");
        let said = said.expect("the disc is left to points");
        assert_eq!((said.points, said.pixels), (suns as usize, all));
        assert_eq!(said.layers.len(), 2, "{said:?}");
        let found = truth
            .compare(&plan, Task::unwatched())
            .expect("nothing stops it");
        for (name, before) in ["sun", "inscatter_sun"].into_iter().zip(&mut before) {
            let said = named(&said.layers, name).relative_rmse;
            let off = named(&found.layers, name).relative_rmse;
            println!("{name}: {suns} points, said {said:.2e}, off {off:.2e}");
            assert!(off <= said, "{name} is off by more than is said");
            assert!(
                said < 10.0 * off,
                "{name} is said to be far worse than it is"
            );
            assert!(said < 0.6 * *before, "{name} has not fallen");
            *before = said;
        }
        // Of some pixels the same is said, within what their number allows.
        let some = Convergence::of(&plan, 256, Task::unwatched()).expect("nothing stops it");
        for layer in some.expect("the disc is left to points").layers {
            let [low, high] = layer.interval;
            let whole = named(&said.layers, layer.layer).relative_rmse;
            assert!(
                0.8 * low < whole && whole < 1.25 * high,
                "{layer:?} {whole}"
            );
        }
    }
}

fn says_nothing(plan: &Plan) -> bool {
    let said = Convergence::of(plan, 64, Task::unwatched()).expect("nothing stops it");
    said.is_none()
}

#[test]
fn what_is_not_left_to_points_says_nothing() {
    let conditions = conditions();
    let high = Plan::new(&conditions, &Overrules::default()).expect("it is sound");
    assert!(says_nothing(&high));
    let mut point = far_slit();
    let sun = point.scene.sun.as_mut().expect("it has one");
    sun.diameter_deg = Some(0.0);
    let point = point.conditions([24, 96]).expect("it is sound");
    assert!(says_nothing(&plan(&point, 128.0)));
    // As at 1 there is nothing to halve.
    assert!(says_nothing(&plan(&conditions, 1.0)));
}
