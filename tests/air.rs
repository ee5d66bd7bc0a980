//! The clear air over a site: its coefficients, and what the sun loses to it.

use glam::DVec3;
use tyndall::colour::luminance;
use tyndall::medium::clear;
use tyndall::sky::sun::{Column, outside_the_atmosphere};
use tyndall::sky::{SunLight, SunPath};
use tyndall::units::{DEG, STANDARD_PRESSURE_HPA};

#[test]
fn the_clear_air_over_a_site_has_the_suns_own_depths() {
    let sea = SunPath::standard(40.0 * DEG, 3.0);
    let column = Column::new(&sea).unwrap();
    // Bucholtz 1995: 0.0971 at 550 nm, 0.0425 at 650, 0.1837 at 470; the green channel answers to about 540 nm.
    let [r, g, b] = column.molecules.to_array();
    assert!((0.055..0.085).contains(&r) && (0.09..0.11).contains(&g) && (0.19..0.24).contains(&b));
    // Near the ground as measured: 1.16e-5 per metre at 550 nm (Bucholtz 1995).
    let at_ground = g / clear::MOLECULES;
    assert!((at_ground / 1.16e-5 - 1.0).abs() < 0.05, "{at_ground}");
    // The aerosol's column is beta lambda^-1.3 of some wavelength of the channel, and nothing at turbidity 1.
    let beta = 0.046_083_658 * 3.0 - 0.045_860_26;
    for (tau, [short, long]) in
        column
            .aerosol
            .to_array()
            .iter()
            .zip([[0.56, 0.66], [0.52, 0.58], [0.43, 0.5f64]])
    {
        let (most, least) = (beta * short.powf(-1.3), beta * long.powf(-1.3));
        assert!((least..most).contains(tau), "{tau} {least} {most}");
    }
    let none = Column::new(&SunPath {
        turbidity: 1.0,
        ..sea
    })
    .unwrap();
    assert!(none.aerosol.max_element() < 1e-3);
    let high = Column::new(&SunPath {
        pressure_hpa: 0.5 * STANDARD_PRESSURE_HPA,
        ..sea
    })
    .unwrap();
    assert!(
        (high.molecules / column.molecules - 0.5)
            .abs()
            .max_element()
            < 1e-12
    );
    let outside = outside_the_atmosphere(1.0);
    assert!((128e3..134.5e3).contains(&luminance(outside)));

    // Above all air the sun is what it is outside the atmosphere, except for ozone and vapour, and never brighter; at any height
    // of the sun that is finite.
    for turbidity in [1.0, 2.0, 3.0, 6.0, 20.0] {
        let mut last = f64::INFINITY;
        for elevation in [-2.0, -0.3, 0.0, 0.1, 1.0, 3.0, 10.0, 30.0, 60.0, 90.0] {
            let path = SunPath::standard(elevation * DEG, turbidity);
            let column = Column::new(&path).unwrap();
            let depth: DVec3 = clear::overhead(&column, &path).unwrap().iter().sum();
            assert!(depth.is_finite() && depth.min_element() >= 0.0);
            assert!(depth.y <= last + 1e-9, "{turbidity} {elevation}");
            last = depth.y;
            let light = SunLight::new(&path).unwrap().full_illuminance;
            let above = light * depth.exp();
            assert!(
                above.cmple(outside * (1.0 + 1e-9)).all(),
                "{turbidity} {elevation}: {above}"
            );
            if elevation >= 3.0 && turbidity <= 6.0 {
                assert!(
                    luminance(above) > 0.6 * luminance(outside),
                    "{turbidity} {elevation}: {above}"
                );
            }
        }
    }
}
