use tyndall::gpu::Choice;
use tyndall::studies::{scenes, shafts};
fn main() {
    let only = std::env::args().nth(1).unwrap_or_default();
    let method = std::env::args().nth(2).unwrap_or_default();
    let side: u32 = std::env::args()
        .nth(3)
        .and_then(|s| s.parse().ok())
        .unwrap_or(512);
    let frames: usize = std::env::args()
        .nth(4)
        .and_then(|s| s.parse().ok())
        .unwrap_or(3);
    let extra = vec![("shadow.resolution".to_owned(), 4096.0)];
    for view in [
        scenes::slats(1.0),
        scenes::colonnade(),
        scenes::forest(700),
        scenes::gates(),
        scenes::slit(),
        scenes::mountains(),
        scenes::antisolar(),
    ] {
        if !only.is_empty() && !only.split(',').any(|o| o == view.name) {
            continue;
        }
        let conditions = view.conditions([side, side]).unwrap();
        let truth = shafts::truth(&conditions).unwrap();
        for trial in shafts::sweeps() {
            if !method.is_empty() && trial.method.name() != method {
                continue;
            }
            let o =
                shafts::measure(&conditions, &trial, &extra, Choice::Any, &truth, frames).unwrap();
            println!(
                "{:<10} {:<44} {:8.1} ms (maps {:6.1}) reads {:7.1} nodes {:6.1} rmse {:.5} p99 {:.4} bias {:+.5}  {:?}",
                view.name,
                trial.words(),
                o.in_scatter.as_secs_f64() * 1e3,
                o.maps.as_secs_f64() * 1e3,
                o.reads,
                o.nodes,
                o.relative_rmse,
                o.percentile_99,
                o.bias,
                o.passes
                    .iter()
                    .map(|(n, t)| format!("{n} {:.1}", t.as_secs_f64() * 1e3))
                    .collect::<Vec<_>>()
            );
        }
    }
}
