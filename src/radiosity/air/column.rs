//! The air's source along one eye ray, and its mean as far as each distance.

use super::knots::Knots;
use crate::medium::Sight;
use crate::scene::Ray;
use glam::DVec3;

/// What is behind air of more than this optical depth [1] is not looked at.
const HIDDEN: f64 = 14.0;

/// Parts of a ray whose weight is less [1] are not looked at.
const FAINT: f64 = 1e-9;

/// J at the knots of an eye ray, as far as the eye sees, and the weights of the air as far as each.
pub struct Column {
    /// How far the eye sees [m]; infinite toward the sky.
    pub end: f64,
    kinds: usize,
    stretches: Vec<Stretch>,
    /// By stretch and kind: W as far as its end [1].
    weights: Vec<DVec3>,
    /// By knot: J of each kind [cd/m2]; `None` where the eye does not see, or where there is no air before and behind.
    sources: Vec<Option<Vec<DVec3>>>,
    /// J just before what the eye sees, and the knot behind that.
    last: Option<(usize, Vec<DVec3>)>,
}

/// What is between one knot and the next.
struct Stretch {
    /// Whether there is air.
    filled: bool,
    /// Where in it the middle of its weight is, from 0 to 1/2, by channel.
    middle: DVec3,
}

impl Column {
    /// Looks along a ray as far as `end`; `source` tells J of each kind of media at a place of it.
    pub fn new(
        ray: &Ray,
        end: f64,
        knots: &Knots,
        sight: &mut Sight,
        source: impl Fn(DVec3) -> Vec<DVec3>,
    ) -> Self {
        let kinds = sight.kinds();
        sight.aim(ray.origin, ray.direction, f64::INFINITY);
        let mut sum = vec![DVec3::ZERO; kinds];
        let (mut stretches, mut weights) = (Vec::new(), Vec::new());
        let mut depth = DVec3::ZERO;
        for pair in knots.distances().windows(2) {
            let before = sum.clone();
            sight.add(pair[0], pair[1], &mut sum);
            weights.extend_from_slice(&sum);
            let behind = sight.depth(pair[1]);
            stretches.push(Stretch {
                filled: (sum.iter().zip(&before)).any(|(a, b)| (*a - *b).max_element() > FAINT),
                middle: middle(behind - depth),
            });
            depth = behind;
            if depth.min_element() > HIDDEN {
                break;
            }
        }
        let count = stretches
            .iter()
            .rposition(|s| s.filled)
            .map_or(0, |k| k + 1);
        stretches.truncate(count);
        weights.truncate(count * kinds);
        let filled = |knot: usize| {
            let behind = stretches.get(knot).is_some_and(|s| s.filled);
            behind || knot > 0 && stretches[knot - 1].filled
        };
        let behind = knots
            .distances()
            .partition_point(|t| *t < end * (1.0 - 1e-9));
        let source_at = |t: f64| source(ray.at(t));
        let sources = (0..=count)
            .map(|k| (k < behind && filled(k)).then(|| source_at(knots.distances()[k])))
            .collect();
        let last = (0 < behind && behind <= count && stretches[behind - 1].filled).then(|| {
            let before = knots.distances()[behind - 1];
            (behind, source_at(end - 1e-3 * (end - before)))
        });
        Column {
            end,
            kinds,
            stretches,
            weights,
            sources,
            last,
        }
    }

    /// The means of J as far as each knot. Where this ray sees no farther, J is what `others`, rays around it, have there.
    pub fn means(&self, others: &[&Column]) -> Means {
        let source = |knot: usize| {
            let own = self.sources[knot].clone();
            let around = || mean(others.iter().filter_map(|other| other.source(knot)));
            let last = || self.last.as_ref().filter(|(at, _)| *at == knot);
            own.or_else(around)
                .or_else(|| last().map(|(_, source)| source.clone()))
        };
        let kinds = self.kinds;
        let mut values = vec![DVec3::NAN; kinds];
        let mut sums = vec![DVec3::ZERO; kinds];
        let mut before = source(0);
        for (k, stretch) in self.stretches.iter().enumerate() {
            let after = source(k + 1);
            if stretch.filled {
                let (Some(a), Some(b)) = (&before, &after) else {
                    break;
                };
                for kind in 0..kinds {
                    let weight = self.weight(k + 1, kind) - self.weight(k, kind);
                    let between = a[kind] + stretch.middle * (b[kind] - a[kind]);
                    sums[kind] += between * weight;
                }
            }
            values.extend((0..kinds).map(|kind| ratio(sums[kind], self.weight(k + 1, kind))));
            before = after;
        }
        let known = values.len() / kinds.max(1);
        // Before there is any air the mean is what it is where air begins.
        for i in (0..values.len().saturating_sub(kinds)).rev() {
            if values[i].is_nan() {
                values[i] = values[i + kinds];
            }
        }
        Means {
            kinds,
            values,
            is_whole: known > self.stretches.len(),
        }
    }

    /// Where air ends, or nothing is seen for all the air before it [m].
    pub fn air_end(&self, knots: &Knots) -> f64 {
        knots.distances()[self.stretches.len()]
    }

    fn source(&self, knot: usize) -> Option<&Vec<DVec3>> {
        self.sources.get(knot)?.as_ref()
    }

    /// W as far as a knot.
    fn weight(&self, knot: usize, kind: usize) -> DVec3 {
        match knot {
            0 => DVec3::ZERO,
            _ => self.weights[(knot - 1) * self.kinds + kind],
        }
    }
}

/// The means of J along a ray, weighted as the eye sees it, as far as each knot.
pub struct Means {
    kinds: usize,
    /// By knot and kind; not a number where there is no air of that kind.
    values: Vec<DVec3>,
    /// Whether all air of the ray is known.
    is_whole: bool,
}

impl Means {
    /// Those of a ray of which nothing is known.
    pub fn none(kinds: usize) -> Self {
        Means {
            kinds,
            values: vec![DVec3::NAN; kinds],
            is_whole: false,
        }
    }

    /// The mean of a kind as far as a distance, of which `knot` is the last knot before, if it is known there and there is such
    /// air.
    pub fn at(&self, knots: &Knots, knot: usize, distance: f64, kind: usize) -> Option<DVec3> {
        let last = self.values.len() / self.kinds - 1;
        let value = |knot: usize| self.values[knot * self.kinds + kind];
        let found = match knot < last {
            true => {
                let (before, after) = (value(knot), value(knot + 1));
                before + knots.share(knot, distance) * (after - before)
            }
            false if self.is_whole => value(last),
            false => DVec3::NAN,
        };
        (!found.is_nan()).then_some(found)
    }
}

/// Where in a stretch of even air the middle of what is seen of it is, from 0 to 1/2, from its optical depth.
fn middle(depth: DVec3) -> DVec3 {
    let of = |depth: f64| match depth.abs() < 1e-3 {
        true => 0.5 - depth / 12.0,
        false => 1.0 / depth - 1.0 / depth.exp_m1(),
    };
    DVec3::new(of(depth.x), of(depth.y), of(depth.z))
}

/// The mean by channel; not a number without weight. A channel without weight takes no part where others have one.
fn ratio(sum: DVec3, weight: DVec3) -> DVec3 {
    if weight.max_element() <= 0.0 {
        return DVec3::NAN;
    }
    let of = |i: usize| match weight[i] > 0.0 {
        true => sum[i] / weight[i],
        false => 0.0,
    };
    DVec3::new(of(0), of(1), of(2))
}

fn mean<'a>(mut of: impl Iterator<Item = &'a Vec<DVec3>>) -> Option<Vec<DVec3>> {
    let mut sum = of.next()?.clone();
    let mut count = 1.0;
    for one in of {
        for (sum, value) in sum.iter_mut().zip(one) {
            *sum += *value;
        }
        count += 1.0;
    }
    sum.iter_mut().for_each(|sum| *sum /= count);
    Some(sum)
}
