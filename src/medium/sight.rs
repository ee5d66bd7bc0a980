//! How much of what the air scatters along a ray reaches the eye.
//!
//! Of light that media of one kind scatter toward the eye with a source J (per unit of their scattering coefficient), the eye
//! gets W J, where
//!
//! W(T) = integral_0^T sum sigma_s(t) e^-tau(t) dt,
//!
//! the sum over the media of that kind, tau the optical depth of all media between the eye and the place. Homogeneous media make
//! tau piecewise linear and a height medium alone has a closed form too; where both meet, or two that thin with height,
//! Gauss-Legendre quadrature is taken on short enough parts, as in [`super::Scattering`].

use super::Air;
use super::exponential::{NODES, exponential_integral, phi1};
use super::height::Height;
use super::line::Chord;
use super::phase::Phase;
use super::shape::{FARTHEST, Medium, Shape};
use glam::DVec3;

/// Media that send on light alike: of the same phase function, and either all clear air or none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kind {
    /// How they scatter.
    pub phase: Phase,
    /// Whether the models of sun and sky hold their light already.
    pub is_clear_air: bool,
}

impl Kind {
    fn of(medium: &Medium) -> Self {
        Kind {
            phase: medium.phase,
            is_clear_air: medium.is_clear_air(),
        }
    }
}

/// The kinds of media in the air that scatter light, in the order in which they come.
pub fn kinds(air: &Air) -> Vec<Kind> {
    let mut kinds = Vec::new();
    for medium in air.media.iter().filter(|m| m.scattering != DVec3::ZERO) {
        let kind = Kind::of(medium);
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    kinds
}

/// How dense a medium is along a ray that is not as dense everywhere.
#[derive(Debug, Clone, Copy)]
enum Profile {
    Height(Height),
    Smoke(Chord),
}

impl Profile {
    fn density(&self, t: f64) -> f64 {
        match self {
            Profile::Height(height) => height.density(t),
            Profile::Smoke(chord) if t < chord.from || t > chord.to => 0.0,
            Profile::Smoke(chord) => chord.density(t),
        }
    }

    /// Integral of the density between two distances [m].
    fn length(&self, from: f64, to: f64) -> f64 {
        match self {
            Profile::Height(height) => height.length(from, to),
            Profile::Smoke(chord) => chord.length(from, to),
        }
    }

    /// Whether quadrature on a part needs it shorter.
    fn is_steep(&self, from: f64, to: f64) -> bool {
        match self {
            Profile::Height(height) => {
                let (p, q) = (height.density(from), height.density(to));
                p.max(q) > std::f64::consts::E * p.min(q)
            }
            Profile::Smoke(_) => false,
        }
    }
}

/// A medium along a ray that thins with height, or toward its rim.
#[derive(Debug, Clone, Copy)]
struct Thinning {
    profile: Profile,
    extinction: DVec3,
    scattering: DVec3,
    kind: Option<usize>,
}

/// A piece of a ray on which every homogeneous medium is either there or not.
#[derive(Debug, Clone, Copy)]
struct Piece {
    from: f64,
    to: f64,
    /// Optical depth of the homogeneous media from the eye to `from`, and its slope [1/m].
    depth: DVec3,
    slope: DVec3,
}

/// A homogeneous medium, and the stretch of the ray on which it is.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    from: f64,
    to: f64,
    medium: usize,
}

/// The weights of the air along a ray. One of these serves many rays, one after another.
#[derive(Debug, Clone)]
pub struct Sight {
    kinds: usize,
    air: Air,
    /// Which kind each medium is, if it scatters.
    media: Vec<Option<usize>>,
    thinning: Vec<Thinning>,
    pieces: Vec<Piece>,
    /// Of each piece, one after another, the scattering coefficient of each kind among the homogeneous media [1/m].
    scattering: Vec<DVec3>,
    stretches: Vec<Stretch>,
    borders: Vec<f64>,
}

impl Sight {
    /// Prepares it for the air of a scene; kinds are counted as [`kinds`] lists them.
    pub fn new(air: &Air) -> Self {
        let kinds = kinds(air);
        let kind_of = |medium: &Medium| {
            let scatters = medium.scattering != DVec3::ZERO;
            kinds
                .iter()
                .position(|kind| scatters && *kind == Kind::of(medium))
        };
        Sight {
            kinds: kinds.len(),
            media: air.media.iter().map(kind_of).collect(),
            air: air.clone(),
            thinning: Vec::new(),
            pieces: Vec::new(),
            scattering: Vec::new(),
            stretches: Vec::new(),
            borders: Vec::new(),
        }
    }

    /// How many kinds there are.
    pub fn kinds(&self) -> usize {
        self.kinds
    }

    /// Turns it to the first `distance` metres of a ray.
    pub fn aim(&mut self, origin: DVec3, direction: DVec3, distance: f64) {
        let distance = distance.min(FARTHEST);
        self.thinning.clear();
        self.stretches.clear();
        self.borders.clear();
        self.borders.extend([0.0, distance]);
        for (number, (medium, kind)) in self.air.media.iter().zip(&self.media).enumerate() {
            let thinning = |profile| Thinning {
                profile,
                extinction: medium.extinction(),
                scattering: medium.scattering,
                kind: *kind,
            };
            if let Some(body) = self.air.body(medium) {
                for chord in body.chords(origin, direction, distance) {
                    self.borders.extend([chord.from, chord.to]);
                    match chord.bulge {
                        Some(_) => self.thinning.push(thinning(Profile::Smoke(chord))),
                        None => self.stretches.push(Stretch {
                            from: chord.from,
                            to: chord.to,
                            medium: number,
                        }),
                    }
                }
            } else if let Shape::Height {
                base, scale_height, ..
            }
            | Shape::Air {
                base, scale_height, ..
            } = medium.shape
            {
                let height = Height::new(base, scale_height, origin, direction);
                self.thinning.push(thinning(Profile::Height(height)));
            }
        }
        self.borders.sort_unstable_by(f64::total_cmp);
        self.stretches
            .sort_unstable_by(|a, b| a.from.total_cmp(&b.from));
        self.cut();
    }

    /// Cuts the ray into pieces at the borders of homogeneous media.
    fn cut(&mut self) {
        self.pieces.clear();
        self.scattering.clear();
        let mut present: Vec<Stretch> = Vec::new();
        let mut coming = self.stretches.iter().peekable();
        let mut depth = DVec3::ZERO;
        for pair in self.borders.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            if to <= from {
                continue;
            }
            present.retain(|stretch| stretch.to > from);
            while let Some(stretch) = coming.next_if(|stretch| stretch.from <= from) {
                if stretch.to > from {
                    present.push(*stretch);
                }
            }
            let first = self.scattering.len();
            self.scattering.resize(first + self.kinds, DVec3::ZERO);
            let mut slope = DVec3::ZERO;
            for stretch in &present {
                let medium = &self.air.media[stretch.medium];
                let kind = &self.media[stretch.medium];
                slope += medium.extinction();
                if let Some(kind) = kind {
                    self.scattering[first + kind] += medium.scattering;
                }
            }
            self.pieces.push(Piece {
                from,
                to,
                depth,
                slope,
            });
            depth += slope * (to - from);
        }
    }

    /// Optical depth from the eye to a place of the ray [1].
    pub fn depth(&self, t: f64) -> DVec3 {
        let piece = self.pieces.partition_point(|piece| piece.from <= t);
        match self.pieces.get(piece.saturating_sub(1)) {
            Some(piece) => self.depth_in(piece, t.min(piece.to)),
            None => DVec3::ZERO,
        }
    }

    fn depth_in(&self, piece: &Piece, t: f64) -> DVec3 {
        let homogeneous = piece.depth + piece.slope * (t - piece.from);
        self.thinning.iter().fold(homogeneous, |depth, thinning| {
            depth + thinning.extinction * thinning.profile.length(0.0, t)
        })
    }

    /// Adds to `sums`, one for each kind, the weights of the part [from, to] of the ray [1], RGB.
    pub fn add(&self, from: f64, to: f64, sums: &mut [DVec3]) {
        let first = self.pieces.partition_point(|piece| piece.to <= from);
        let scattering = self.scattering.chunks_exact(self.kinds.max(1));
        for (piece, scattering) in self.pieces.iter().zip(scattering).skip(first) {
            if piece.from >= to {
                break;
            }
            let (a, b) = (from.max(piece.from), to.min(piece.to));
            if b > a {
                self.add_piece(piece, scattering, a, b, sums);
            }
        }
    }

    fn add_piece(&self, piece: &Piece, scattering: &[DVec3], a: f64, b: f64, sums: &mut [DVec3]) {
        let start = piece.depth + piece.slope * (a - piece.from);
        match &self.thinning[..] {
            [] => {
                if scattering.iter().all(|s| *s == DVec3::ZERO) {
                    return;
                }
                let channel = |i: usize| exponential_integral(start[i], piece.slope[i], b - a);
                let through = channels(
                    start == DVec3::splat(start.x) && piece.slope == DVec3::splat(piece.slope.x),
                    channel,
                );
                for (sum, scattering) in sums.iter_mut().zip(scattering) {
                    *sum += *scattering * through;
                }
            }
            [alone] if piece.slope == DVec3::ZERO => {
                let Some(kind) = alone.kind else { return };
                let before = start + alone.extinction * alone.profile.length(0.0, a);
                let run = alone.profile.length(a, b);
                let change = alone.extinction * run;
                let channel = |i: usize| (-before[i]).exp() * run * phi1(change[i]);
                let grey = before == DVec3::splat(before.x) && change == DVec3::splat(change.x);
                sums[kind] += alone.scattering * channels(grey, channel);
            }
            _ => self.quadrature(piece, scattering, a, b, sums),
        }
    }

    /// Gauss-Legendre quadrature on parts over which neither the optical depth nor a density changes by more than a factor e.
    fn quadrature(&self, piece: &Piece, scattering: &[DVec3], a: f64, b: f64, sums: &mut [DVec3]) {
        let mut parts = vec![(a, b, 64)];
        while let Some((from, to, halvings)) = parts.pop() {
            let (first, last) = (self.depth_in(piece, from), self.depth_in(piece, to));
            if first.min_element() > OPAQUE {
                continue;
            }
            let uneven = (0..3).any(|i| first[i] < OPAQUE && last[i] - first[i] > 1.0);
            let mut thinning = self.thinning.iter();
            let steep = thinning.any(|thinning| thinning.profile.is_steep(from, to));
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            if halvings > 0 && (uneven || steep) {
                parts.push((from, middle, halvings - 1));
                parts.push((middle, to, halvings - 1));
                continue;
            }
            for [x, weight] in NODES {
                for t in [middle - half * x, middle + half * x] {
                    let through = half * weight * exp(-self.depth_in(piece, t));
                    for (sum, scattering) in sums.iter_mut().zip(scattering) {
                        *sum += *scattering * through;
                    }
                    for thinning in &self.thinning {
                        if let Some(kind) = thinning.kind {
                            sums[kind] +=
                                thinning.scattering * (thinning.profile.density(t) * through);
                        }
                    }
                }
            }
        }
    }
}

/// An optical depth through which nothing is seen.
const OPAQUE: f64 = 100.0;

/// A value by channel, found once where all channels have the same.
fn channels(grey: bool, value: impl Fn(usize) -> f64) -> DVec3 {
    let first = value(0);
    match grey {
        true => DVec3::splat(first),
        false => DVec3::new(first, value(1), value(2)),
    }
}

fn exp(v: DVec3) -> DVec3 {
    channels(v == DVec3::splat(v.x), |i| v[i].exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    const GREY: DVec3 = DVec3::new(0.03, 0.03, 0.03);

    fn medium(shape: Shape, scattering: DVec3, absorption: DVec3, phase: Phase) -> Medium {
        Medium {
            shape,
            scattering,
            absorption,
            phase,
        }
    }

    fn cube(half: f64) -> Shape {
        Shape::Box {
            min: DVec3::splat(-half),
            max: DVec3::splat(half),
        }
    }

    /// Media of every shape and of two kinds.
    fn mixed() -> Air {
        let thinning = Shape::Height {
            base: -3.0,
            scale_height: 9.0,
            far: 1e4,
        };
        let air = |scale_height| Shape::Air {
            base: -10.0,
            scale_height,
            far: 1e4,
            overhead: DVec3::ZERO,
        };
        Air {
            media: vec![
                medium(cube(5.0), GREY, 0.3 * GREY, Phase::Isotropic),
                medium(cube(2.0), 2.0 * GREY, DVec3::ZERO, Phase::Rayleigh),
                medium(
                    Shape::Haze { top: 4.0 },
                    DVec3::new(0.01, 0.02, 0.03),
                    DVec3::ZERO,
                    Phase::Isotropic,
                ),
                medium(thinning.clone(), 0.5 * GREY, 0.1 * GREY, Phase::Rayleigh),
                medium(air(20.0), 0.1 * GREY, DVec3::ZERO, Phase::Rayleigh),
                medium(thinning, DVec3::ZERO, 0.1 * GREY, Phase::Rayleigh),
            ],
            ground: -10.0,
        }
    }

    /// The weights by many small steps.
    fn stepped(air: &Air, origin: DVec3, direction: DVec3, distance: f64) -> Vec<DVec3> {
        const STEPS: usize = 40_000;
        let kinds = kinds(air);
        let mut sums = vec![DVec3::ZERO; kinds.len()];
        let step = distance / STEPS as f64;
        for i in 0..STEPS {
            let t = step * (i as f64 + 0.5);
            let through = exp(-air.optical_depth(origin, direction, t)) * step;
            for medium in &air.media {
                let kind = kinds.iter().position(|kind| *kind == Kind::of(medium));
                let alone = Air {
                    media: vec![Medium {
                        absorption: DVec3::ZERO,
                        ..medium.clone()
                    }],
                    ground: air.ground,
                };
                if let Some(kind) = kind {
                    sums[kind] += alone.extinction_at(origin + t * direction) * through;
                }
            }
        }
        sums
    }

    #[test]
    fn weights_are_the_integrals_that_they_are_said_to_be() {
        let mixed = mixed();
        let only = |kept: &[usize]| Air {
            media: kept.iter().map(|i| mixed.media[*i].clone()).collect(),
            ground: mixed.ground,
        };
        let rays = [
            (DVec3::new(-7.0, 1.0, 0.3), DVec3::new(0.96, 0.0, 0.28)),
            (DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.48, 0.6, 0.64)),
            (DVec3::new(3.0, 12.0, 3.0), DVec3::new(-0.36, -0.8, -0.48)),
        ];
        for air in [
            only(&[0]),
            only(&[0, 1, 2]),
            only(&[3]),
            only(&[0, 3]),
            mixed.clone(),
        ] {
            let mut sight = Sight::new(&air);
            for (origin, direction) in rays {
                let distance = 20.0;
                sight.aim(origin, direction, distance);
                let truth = stepped(&air, origin, direction, distance);
                let mut whole = vec![DVec3::ZERO; truth.len()];
                sight.add(0.0, distance, &mut whole);
                let mut parts = vec![DVec3::ZERO; truth.len()];
                for pair in [0.0, 1.3, 8.0, 20.0].windows(2) {
                    sight.add(pair[0], pair[1], &mut parts);
                }
                for ((whole, part), truth) in whole.iter().zip(&parts).zip(&truth) {
                    let close = |v: &DVec3| (*v - *truth).abs().max_element() < 2e-4;
                    assert!(close(whole) && close(part), "{whole} {part} {truth}");
                    assert!((*whole - *part).abs().max_element() < 1e-9);
                }
                let depth = air.optical_depth(origin, direction, distance);
                assert!((sight.depth(distance) - depth).abs().max_element() < 1e-12);
            }
        }
    }
}
