#[test]
fn speed() {
    let p = std::env::var("OBJ").unwrap();
    for _ in 0..4 {
        let t = std::time::Instant::now();
        let s = tyndall::scene::load(std::path::Path::new(&p))
            .map(|s| (s.mesh.triangles.len(), s.mesh.positions.len(), s.warnings));
        println!("{:?} {:?}", t.elapsed(), s);
    }
    println!(
        "{}",
        std::fs::read_to_string("/proc/self/status")
            .unwrap()
            .lines()
            .find(|l| l.starts_with("VmHWM"))
            .unwrap()
    );
}
