//! How much light panes of glass let through, by the angle at which it meets them.
//!
//! A surface of glass (n = 1.52) lets through, of light polarised across (s) and along (p) the plane of incidence (Fresnel 1823),
//!
//! t_s = 4 n c c' / (c + n c')^2, t_p = 4 n c c' / (n c + c')^2, r = 1 - t,
//!
//! c the cosine of the angle of incidence, c' that within the glass. Between the two surfaces of a pane light goes to and fro; its
//! parts add without interference (Airy's sums of intensities), A being what the glass leaves of it on one way:
//!
//! T = t^2 A / (1 - r^2 A^2), R = r + r t^2 A^2 / (1 - r^2 A^2).
//!
//! Between several panes it does the same (Stokes 1862, "On the intensity of the light reflected from or transmitted through a pile of
//! plates"): T_12 = T_1 T_2 / (1 - R_1 R_2), R_12 = R_1 + T_1^2 R_2 / (1 - R_1 R_2). Each polarisation passes all panes; natural light
//! is half of each. On a slant the way within the glass is longer: A = a^(1 / c').
//!
//! All panes of a pile are alike. a is found from what the pile lets through at normal incidence, so that there it is exactly that. Clear
//! glass, a = 1, lets 0.918 through one pane and 0.849 through two. What is said to let more through has a coating that
//! reflects less: it counts as clear glass times a factor, so that at other angles it falls as that does, to nothing at 90 degrees.

/// Refractive index of glass.
pub const INDEX: f64 = 1.52;

/// The most panes one behind the other: through more of them light gets better on a slant than straight.
pub const MOST_PANES: u32 = 3;

/// How light meets a surface of glass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incidence {
    /// What a surface lets through, of light polarised across and along the plane of incidence [1].
    surface: [f64; 2],
    /// Length of the way through a pane, over its thickness.
    way: f64,
}

impl Incidence {
    /// Along the normal.
    pub const NORMAL: Incidence = Incidence {
        surface: [4.0 * INDEX / ((1.0 + INDEX) * (1.0 + INDEX)); 2],
        way: 1.0,
    };

    /// At an angle to the normal, by the size of its cosine, 0 to 1.
    pub fn new(cosine: f64) -> Self {
        let outside = cosine.abs().min(1.0);
        let inside = (1.0 - (1.0 - outside * outside) / (INDEX * INDEX)).sqrt();
        let both = 4.0 * INDEX * outside * inside;
        let across = outside + INDEX * inside;
        let along = INDEX * outside + inside;
        Incidence {
            surface: [both / (across * across), both / (along * along)],
            way: 1.0 / inside,
        }
    }

    /// What `count` panes let through that let `normal` through at normal incidence [1], 0 to 1; `count` is 1 to [`MOST_PANES`].
    pub fn transmittance(&self, normal: f64, count: u32) -> f64 {
        let [across, along] = self.surface;
        if normal <= 0.0 || across <= 0.0 {
            return 0.0;
        }
        let at_normal = |inner: f64| pile(Self::NORMAL.surface[0], inner, count);
        let both = |inner: f64| 0.5 * (pile(across, inner, count) + pile(along, inner, count));
        let clear = at_normal(1.0);
        if normal >= clear {
            return normal / clear * both(1.0);
        }
        // What a pile lets through goes nearly with the power `count` of what one way within does.
        let root = |ratio: f64| match count {
            1 => ratio,
            _ => ratio.powf(1.0 / f64::from(count)),
        };
        let mut inner = root(normal / clear);
        for _ in 0..STEPS {
            let step = root(normal / at_normal(inner));
            inner = (inner * step).min(1.0);
            if (step - 1.0).abs() < ENOUGH {
                break;
            }
        }
        both(inner.powf(self.way))
    }
}

/// Each step leaves less than a twentieth of the error.
const STEPS: usize = 16;

/// No step changes more any more [1].
const ENOUGH: f64 = 1e-14;

/// What `count` panes let through of one polarisation, a surface `t` of it and the glass `inner` on one way.
fn pile(t: f64, inner: f64, count: u32) -> f64 {
    let square = inner * inner;
    // 1 - r A, 1 - r^2 A^2 and 1 - R, without taking nearly equal numbers from each other.
    let once = (1.0 - inner) + t * inner;
    let round = once * (1.0 + (1.0 - t) * inner);
    // Near 90 degrees the square of t may be no number any more.
    let share = t / round;
    let through = share * t * inner;
    let taken = share * ((1.0 - square) + t * square);
    let (mut all, mut rest) = (through, taken);
    for _ in 1..count {
        // 1 - R_1 R_2.
        let between = rest + (1.0 - rest) * taken;
        rest -= all * (all / between) * (1.0 - taken);
        all *= through / between;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clear_pane_is_that_of_fresnels_formulae_by_angles() {
        for degrees in [5.0, 30.0, 45.0, 56.66, 70.0, 85.0f64] {
            let outside = degrees.to_radians();
            let inside = (outside.sin() / INDEX).asin();
            let across = ((outside - inside).sin() / (outside + inside).sin()).powi(2);
            let along = ((outside - inside).tan() / (outside + inside).tan()).powi(2);
            // All that goes to and fro between two surfaces that take nothing: (1 - r)^2 / (1 - r^2).
            let truth = 0.5 * ((1.0 - across) / (1.0 + across) + (1.0 - along) / (1.0 + along));
            let clear = (1.0 - 0.52f64.powi(2) / 2.52f64.powi(2))
                / (1.0 + 0.52f64.powi(2) / 2.52f64.powi(2));
            let found = Incidence::new(outside.cos()).transmittance(clear, 1);
            assert!((found - truth).abs() < 1e-12, "{degrees}: {found} {truth}");
        }
    }

    #[test]
    fn it_is_what_was_said_at_normal_incidence_and_falls_to_nothing() {
        for count in 1..=MOST_PANES {
            for normal in [1e-12, 1e-3, 0.1, 0.5, 0.72, 0.8, 0.9, 0.918, 0.95, 1.0] {
                let at = |cosine: f64| Incidence::new(cosine).transmittance(normal, count);
                let same = Incidence::NORMAL.transmittance(normal, count);
                assert!((at(1.0) / normal - 1.0).abs() < 1e-12, "{count} {normal}");
                assert!((same / normal - 1.0).abs() < 1e-12, "{count} {normal}");
                let mut last = at(1.0);
                for i in 1..=9000 {
                    let next = at((f64::from(i) * 1e-2).to_radians().cos());
                    let rises = next - last > 1e-12 * normal;
                    assert!(next >= 0.0 && !rises, "{count} {normal} {i}: {last} {next}");
                    last = next;
                }
                assert!(at(1e-9) < 1e-8 && at(0.0) == 0.0 && at(1e-300) < 1e-290);
                assert_eq!(Incidence::new(0.3).transmittance(0.0, count), 0.0);
            }
        }
    }
}
