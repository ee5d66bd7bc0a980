//! Light scattered once toward the eye along one ray: the integral that every method takes over its lit runs.

use super::Air;
use super::body::Body;
use super::curved::CurvedTerm;
use super::exponential::{attenuated, exponential_integral, gauss};
use super::height::HeightTerm;
use super::local::LocalScattering;
use super::shape::FARTHEST;
use crate::beam::Beam;
use glam::DVec3;

/// A piece of a ray on which every homogeneous medium is either there or not and its depth toward the sun is linear.
#[derive(Debug, Clone)]
struct Piece {
    from: f64,
    to: f64,
    /// Optical depth eye to point to sun, of the homogeneous media: at `from` and its slope.
    depth: DVec3,
    slope: DVec3,
    /// Sum of scattering coefficient times phase function [1/(m sr)] of the homogeneous media.
    source: DVec3,
    /// Whether a medium of curved borders is there, or between there and the sun.
    is_curved: bool,
}

/// Light of a beam scattered once toward the eye along one ray, ready to be integrated over lit runs.
///
/// The integrand is the sum over media of sigma_s p(mu) e^-(tau_eye + tau_sun). Homogeneous media make the exponent piecewise
/// linear; a height medium alone has a closed form too (its exponent is linear in its own optical depth); mixtures are
/// integrated by Gauss-Legendre quadrature on short enough parts. The depth through media of curved borders is exact at every place, but
/// bends where the way to the sun begins to cross them once more: there parts are halved until they agree with their halves.
///
/// Light of a local beam has no such forms: its integral is by quadrature throughout.
pub struct Scattering<'a> {
    pieces: Vec<Piece>,
    heights: Vec<HeightTerm>,
    curved: Vec<CurvedTerm<'a>>,
    local: Option<LocalScattering<'a>>,
}

impl<'a> Scattering<'a> {
    /// Prepares the first `distance` metres of a ray under a beam.
    pub fn new(air: &'a Air, origin: DVec3, direction: DVec3, distance: f64, beam: &Beam) -> Self {
        let toward_sun = match *beam {
            Beam::Parallel { toward, .. } => toward,
            Beam::Local {
                position, radius, ..
            } => {
                return Scattering {
                    pieces: Vec::new(),
                    heights: Vec::new(),
                    curved: Vec::new(),
                    local: Some(LocalScattering::new(
                        air, origin, direction, distance, position, radius,
                    )),
                };
            }
        };
        let one_minus_mu = 0.5 * (direction - toward_sun).length_squared();
        let distance = distance.min(FARTHEST);
        // What does not meet the plane of ray and sun is neither on the ray nor between it and the sun.
        let across = direction.cross(toward_sun);
        let mut borders = vec![0.0, distance];
        let mut heights = Vec::new();
        let mut curved: Vec<CurvedTerm> = Vec::new();
        let mut regions = Vec::new();
        let mut stretches = Vec::new();
        let mut own = Vec::new();
        for medium in &air.media {
            let source = medium.scattering * medium.phase.value(one_minus_mu);
            let body = air.body(medium);
            if let Some(Body::Region(region)) = body
                && region.meets(origin, across)
            {
                own.clear();
                own.extend([0.0, distance]);
                region.bends(origin, direction, toward_sun, &mut own);
                own.retain(|t| (0.0..=distance).contains(t));
                own.sort_unstable_by(f64::total_cmp);
                // Between its own bends a region's depth is linear: it is nothing throughout, or it counts.
                let matters = |from: f64, to: f64| {
                    let at = |share: f64| origin + (from + share * (to - from)) * direction;
                    region.holds(at(0.5))
                        || [0.25, 0.75]
                            .map(at)
                            .iter()
                            .any(|p| region.depth(*p, toward_sun) > 0.0)
                };
                let before = stretches.len();
                for pair in own.windows(2).filter(|pair| matters(pair[0], pair[1])) {
                    stretches.push((pair[0], pair[1], regions.len()));
                }
                if stretches.len() > before {
                    borders.extend_from_slice(&own);
                    regions.push((region, medium.extinction(), source));
                }
            }
            if let Some(body) = body {
                let ray = [origin, direction];
                let term = CurvedTerm::new(medium, body, ray, distance, toward_sun, source);
                borders.extend(term.iter().flat_map(|term| &term.borders));
                curved.extend(term);
            }
            heights.extend(HeightTerm::new(
                medium, origin, direction, toward_sun, source,
            ));
        }
        borders.sort_unstable_by(f64::total_cmp);
        stretches.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut coming = stretches.into_iter().peekable();
        // Where the stretches at hand end and whose they are, by region: many boxes along a ray are met one by one.
        let mut present: Vec<(f64, usize)> = Vec::new();
        let mut pieces = Vec::with_capacity(borders.len());
        let mut eye_depth = DVec3::ZERO;
        for pair in borders.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let length = to - from;
            if length <= 0.0 {
                continue;
            }
            present.retain(|(end, _)| *end > from);
            while let Some((_, end, region)) = coming.next_if(|(start, ..)| *start <= from) {
                if end > from {
                    let at = present.partition_point(|(_, other)| *other < region);
                    present.insert(at, (end, region));
                }
            }
            let mut piece = Piece {
                from,
                to,
                depth: eye_depth,
                slope: DVec3::ZERO,
                source: DVec3::ZERO,
                is_curved: curved.iter().any(|term| term.reaches(from + 0.5 * length)),
            };
            // Both samples lie inside the piece: at its ends the depth may jump (a face parallel to the sun's rays).
            let inner = [0.25, 0.75].map(|f| origin + (from + f * length) * direction);
            let middle = origin + (from + 0.5 * length) * direction;
            for (region, extinction, source) in present.iter().map(|(_, i)| &regions[*i]) {
                let [a, b] = inner.map(|p| region.depth(p, toward_sun));
                let inside = region.holds(middle);
                let slope = (b - a) / (0.5 * length);
                piece.depth += *extinction * (a - 0.25 * length * slope).max(0.0);
                piece.slope += *extinction * slope;
                if inside {
                    piece.slope += *extinction;
                    piece.source += *source;
                    eye_depth += *extinction * length;
                }
            }
            pieces.push(piece);
        }
        Scattering {
            pieces,
            heights,
            curved,
            local: None,
        }
    }

    /// The integral over the lit part [from, to] of the ray: times the beam's [`Beam::strength`] it is luminance. [1/sr] of parallel
    /// light, [1/(m2 sr)] of a local beam.
    pub fn integrate(&self, from: f64, to: f64) -> DVec3 {
        if let Some(local) = &self.local {
            return local.integrate(from, to);
        }
        let mut sum = DVec3::ZERO;
        let first = self.pieces.partition_point(|piece| piece.to <= from);
        for piece in self.pieces[first..].iter().take_while(|p| p.from < to) {
            let (a, b) = (from.max(piece.from), to.min(piece.to));
            if b > a {
                sum += self.integrate_piece(piece, a, b);
            }
        }
        sum
    }

    /// Where along the ray media begin and end, or their depth toward the sun bends [m].
    pub fn borders(&self) -> impl Iterator<Item = f64> + '_ {
        self.pieces.iter().map(|piece| piece.from).skip(1)
    }

    /// The integral over a part between two of [`Scattering::borders`] of parallel light, of which at each of `nodes`, places of 0 to 1
    /// and weights of a quadrature, a share arrives, by channel. In between shares are those of the polynomial through them.
    pub fn integrate_shares<const N: usize>(
        &self,
        [from, to]: [f64; 2],
        nodes: &[(f64, f64); N],
        shares: &[DVec3; N],
    ) -> DVec3 {
        let middle = 0.5 * (from + to);
        let piece = self.pieces.partition_point(|piece| piece.to <= middle);
        let Some(piece) = self.pieces.get(piece) else {
            return DVec3::ZERO;
        };
        let length = to - from;
        if piece.is_curved {
            let share = |t: f64| between(nodes, shares, (t - from) / length);
            return self.settled(piece, from, to, &share);
        }
        let densities = |t: f64| self.heights.iter().map(move |h| h.profile.density(t));
        let mut parts = vec![(0.0, 1.0, 32u32)];
        let mut sum = DVec3::ZERO;
        // As by `quadrature`, of less degree.
        while let Some((start, end, halvings)) = parts.pop() {
            let (a, b) = (from + start * length, from + end * length);
            let (first, last) = (self.depth(piece, a), self.depth(piece, b));
            let seen = first.min(last).cmplt(DVec3::splat(OPAQUE));
            if !seen.any() {
                continue;
            }
            let uneven = (0..3).any(|i| seen.test(i) && (last[i] - first[i]).abs() > 0.5);
            let steep = densities(a)
                .zip(densities(b))
                .any(|(p, q)| p.max(q) > std::f64::consts::E * p.min(q));
            if halvings > 0 && (uneven || steep) {
                let middle = 0.5 * (start + end);
                parts.push((start, middle, halvings - 1));
                parts.push((middle, end, halvings - 1));
                continue;
            }
            let is_whole = start == 0.0 && end == 1.0;
            let mut part = DVec3::ZERO;
            for (k, (node, weight)) in nodes.iter().enumerate() {
                let place = start + node * (end - start);
                let share = match is_whole {
                    true => shares[k],
                    false => between(nodes, shares, place),
                };
                part += *weight * share * self.integrand(piece, from + place * length);
            }
            sum += (end - start) * length * part;
        }
        sum
    }

    fn integrate_piece(&self, piece: &Piece, a: f64, b: f64) -> DVec3 {
        let mut start = piece.depth + piece.slope * (a - piece.from);
        let middle = 0.5 * (piece.from + piece.to);
        let dark = |term: &HeightTerm| term.source == DVec3::ZERO;
        let scatters = |term: &CurvedTerm| term.source != DVec3::ZERO && term.density(middle) > 0.0;
        if piece.source == DVec3::ZERO
            && self.heights.iter().all(dark)
            && !self.curved.iter().any(scatters)
        {
            return DVec3::ZERO;
        }
        if piece.is_curved {
            return self.settled(piece, a, b, &|_| DVec3::ONE);
        }
        for term in &self.curved {
            start += term.eye_depth(middle);
        }
        if self.heights.is_empty() {
            let channel =
                |i: usize| exponential_integral(start[i], piece.slope[i], b - a) * piece.source[i];
            let first = channel(0);
            let grey = |v: DVec3| v.x == v.y && v.y == v.z;
            return if grey(start) && grey(piece.slope) && grey(piece.source) {
                DVec3::splat(first)
            } else {
                DVec3::new(first, channel(1), channel(2))
            };
        }
        if let [term] = &self.heights[..]
            && start == DVec3::ZERO
            && piece.slope == DVec3::ZERO
            && piece.source == DVec3::ZERO
        {
            return term.integrate(a, b);
        }
        self.quadrature(piece, a, b)
    }

    /// Optical depth from the eye to the point at `t` and on to the sun.
    fn depth(&self, piece: &Piece, t: f64) -> DVec3 {
        let curved = self.curved.iter().map(|term| match piece.is_curved {
            true => term.depth(t),
            false => term.eye_depth(t),
        });
        self.depth_of_even(piece, t) + curved.sum::<DVec3>()
    }

    /// That of all media but those of curved borders.
    fn depth_of_even(&self, piece: &Piece, t: f64) -> DVec3 {
        let homogeneous = piece.depth + piece.slope * (t - piece.from);
        self.heights
            .iter()
            .fold(homogeneous, |depth, term| depth + term.depth(t))
    }

    fn integrand(&self, piece: &Piece, t: f64) -> DVec3 {
        let source = self.heights.iter().fold(piece.source, |source, term| {
            source + term.source * term.profile.density(t)
        });
        let source = self.curved.iter().fold(source, |source, term| {
            source + term.source * term.density(t)
        });
        if source == DVec3::ZERO {
            return source;
        }
        attenuated(source, self.depth(piece, t))
    }

    /// The integral of the integrand times a weight over a part of a piece with curved borders: Gauss-Legendre quadrature on parts
    /// that are halved until they agree with their halves, and until no depth changes by much in one.
    fn settled(&self, piece: &Piece, a: f64, b: f64, weight: &dyn Fn(f64) -> DVec3) -> DVec3 {
        let mut ends = vec![a, b];
        for term in self.curved.iter() {
            ends.extend(term.cuts(a, b));
        }
        ends.sort_unstable_by(f64::total_cmp);
        let whole = |from: f64, to: f64| {
            gauss(from, to, &|t| match self.integrand(piece, t) {
                DVec3::ZERO => DVec3::ZERO,
                light => weight(t) * light,
            })
        };
        let mut parts: Vec<(f64, f64, DVec3, u32)> = ends
            .windows(2)
            .filter(|pair| pair[1] > pair[0])
            .take_while(|pair| self.least_depth(piece, pair[0], b).min_element() < OPAQUE)
            .map(|pair| (pair[0], pair[1], whole(pair[0], pair[1]), HALVINGS))
            .collect();
        let roughly: DVec3 = parts.iter().map(|(.., found, _)| *found).sum();
        let mut left_over = MOST_PARTS;
        let mut sum = DVec3::ZERO;
        while let Some((from, to, found, halvings)) = parts.pop() {
            let seen = self
                .least_depth(piece, from, to)
                .cmplt(DVec3::splat(OPAQUE));
            if !seen.any() {
                continue;
            }
            left_over = usize::saturating_sub(left_over, 1);
            let middle = 0.5 * (from + to);
            let (left, right) = (whole(from, middle), whole(middle, to));
            let finer = left + right;
            let off = (finer - found).abs().max_element();
            let (first, last) = (self.depth(piece, from), self.depth(piece, to));
            let uneven = (0..3).any(|i| {
                seen.test(i) && first[i].min(last[i]) < OPAQUE && (last[i] - first[i]).abs() > 2.0
            });
            let most = roughly.max(sum).max(finer).max_element();
            if halvings == 0 || left_over == 0 || (off <= SETTLED * most && !uneven) {
                sum += finer;
                continue;
            }
            parts.push((middle, to, right, halvings - 1));
            parts.push((from, middle, left, halvings - 1));
        }
        sum
    }

    /// No depth on a part of a piece is less: that of media with curved borders grows from the eye, others have theirs at an end.
    fn least_depth(&self, piece: &Piece, from: f64, to: f64) -> DVec3 {
        let ends = [from, to].map(|t| self.depth_of_even(piece, t));
        let curved = self.curved.iter().map(|term| term.eye_depth(from));
        ends[0].min(ends[1]) + curved.sum::<DVec3>()
    }

    /// Gauss-Legendre quadrature on parts over which neither the optical depth nor a density changes by more than a factor
    /// e, found by halving; where the optical depth is beyond [`OPAQUE`] nothing is added. On such parts the integrand is
    /// nearly a polynomial, and eight points leave a relative error below 1e-11.
    fn quadrature(&self, piece: &Piece, a: f64, b: f64) -> DVec3 {
        const START: usize = 8;
        let densities = |t: f64| self.heights.iter().map(move |h| h.profile.density(t));
        let cut = |i: usize| a + (b - a) * i as f64 / START as f64;
        let mut parts: Vec<(f64, f64, u32)> =
            (0..START).map(|i| (cut(i), cut(i + 1), 64)).collect();
        let mut sum = DVec3::ZERO;
        while let Some((from, to, halvings)) = parts.pop() {
            let (first, last) = (self.depth(piece, from), self.depth(piece, to));
            let seen = first.min(last).cmplt(DVec3::splat(OPAQUE));
            if !seen.any() {
                continue;
            }
            let uneven = (0..3).any(|i| seen.test(i) && (last[i] - first[i]).abs() > 1.0);
            let steep = densities(from)
                .zip(densities(to))
                .any(|(p, q)| p.max(q) > std::f64::consts::E * p.min(q));
            if halvings > 0 && (uneven || steep) {
                let middle = 0.5 * (from + to);
                parts.push((from, middle, halvings - 1));
                parts.push((middle, to, halvings - 1));
                continue;
            }
            sum += gauss(from, to, &|t| self.integrand(piece, t));
        }
        sum
    }
}

/// The polynomial through values at nodes (Lagrange), not below zero.
fn between<const N: usize>(nodes: &[(f64, f64); N], values: &[DVec3; N], place: f64) -> DVec3 {
    let weight = |i: usize| {
        let others = (0..N).filter(|j| *j != i).map(|j| nodes[j].0);
        others
            .map(|other| (place - other) / (nodes[i].0 - other))
            .product::<f64>()
    };
    let sum: DVec3 = (0..N).map(|i| weight(i) * values[i]).sum();
    sum.max(DVec3::ZERO)
}

/// Parts whose halves agree to this share of the whole are not halved any more.
const SETTLED: f64 = 1e-6;

/// After so many parts none is halved any more: light that comes level through thousands of waves.
const MOST_PARTS: usize = 1 << 14;

/// A part is halved at most so often for its own sake.
const HALVINGS: u32 = 48;

/// An optical depth through which nothing is seen: e^-100 of the sun is less than a photon.
const OPAQUE: f64 = 100.0;
