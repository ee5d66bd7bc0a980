//! The sun's disc in the air on a device: against the reference, which is as exact as thousands of points.

mod common;

use common::shafts::{by_gpu, by_reference, error};
use common::soft::*;
use tyndall::effect::Method;

#[test]
fn edges_in_the_air_are_those_of_the_reference() {
    let test = "edges_in_the_air_are_those_of_the_reference";
    if !common::gpu(test) {
        return;
    }
    for (name, triangles, sun) in &casters() {
        for (k, camera) in cameras().into_iter().enumerate() {
            let conditions = view(triangles, *sun, camera)
                .conditions([24, 18])
                .expect("sound");
            let truth = by_reference(&conditions, &[]);
            let by_method =
                |method, set: &[(&str, f64)]| error(&by_gpu(&conditions, method, set), &truth).0;
            let found = by_method(Method::Rectified, &[]);
            let points = by_method(Method::Rectified, &[("shafts.disc", 0.0)]);
            let set = [("shafts.disc", 0.0), ("shafts.suns", 1.0)];
            let point = by_method(Method::Rectified, &set);
            let march = by_method(
                Method::March,
                &[
                    ("shafts_march.steps", 512.0),
                    ("shafts_march.halvings", 5.0),
                ],
            );
            println!(
                "{name}, camera {k}: {:.3} %, march {:.3} %, 4 points {:.2} %, a point {:.2} %",
                100.0 * found,
                100.0 * march,
                100.0 * points,
                100.0 * point
            );
        }
    }
}
