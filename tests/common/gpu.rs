//! Whether there is a device to test on.

use super::not_run;

/// Whether there is a graphics adapter, of software at least; noted without one.
///
/// # Panics
/// Without one when `REQUIRE_GPU=1`, as in CI: there a missing adapter is a failure.
pub fn gpu(test: &str) -> bool {
    let found = !tyndall::backend::gpu::adapters::report()
        .adapters
        .is_empty();
    if !found {
        let required = std::env::var_os("REQUIRE_GPU").is_some_and(|value| value == "1");
        assert!(
            !required,
            "REQUIRE_GPU is 1 and there is no graphics adapter"
        );
        not_run(test, "there is no graphics adapter");
    }
    found
}
