//! Sunlight in the air at sparse places of slices.

mod common;

use common::flat::*;
use common::shafts::*;
use tyndall::effect::Method;

/// Some drivers count the turns of all loops of an invocation and end them at 65 535: light is lost where one invocation has to
/// find the borders of several rays. At a tolerance of 0 every sample is integrated.
#[test]
fn no_light_is_lost_among_hundreds_of_borders() {
    let test = "no_light_is_lost_among_hundreds_of_borders";
    if !common::gpu(test) {
        return;
    }
    let (period, share) = (0.05, 0.4);
    let conditions = fence(period, share).conditions([128, 96]).expect("sound");
    let all = light(&by_reference(&open(&conditions), &[]));
    let truth = light(&by_reference(&conditions, &[]));
    let set: Settings = &[("shafts.tolerance", 0.0)];
    let found = light(&by_gpu(&conditions, Method::Epipolar, set));
    let through = mean(&found) / mean(&all);
    let off = apart(&found, &truth);
    eprintln!("{through:.4} of {share}, RMSE {off:.4}");
    assert!((through / share - 1.0).abs() < 0.01, "{through}");
    // About what rows are off by.
    assert!(off < 0.03, "{off}");
}
