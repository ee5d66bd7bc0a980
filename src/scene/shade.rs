//! What shades a ray under one beam: runs without light, runs that surfaces veil that let a part of it through, and runs that panes
//! colour.

use glam::DVec3;
use std::collections::BTreeMap;

/// A run of a ray between two distances [m].
pub type Run = [f64; 2];

/// What shades a ray under one beam.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shade {
    /// The runs that no light reaches, in order and apart from each other.
    pub dark: Vec<Run>,
    /// The runs that a surface veils, in no order: one for each triangle and solid part of it.
    pub veiled: Vec<Veiled>,
    /// The runs that a pane colours, in no order: one for each triangle and part of it that lets one colour through.
    pub tinted: Vec<Tinted>,
}

/// A run behind a pane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tinted {
    /// From where to where [m].
    pub run: Run,
    /// What the pane lets through, by channel of the working space [1].
    pub through: DVec3,
}

/// A run in the shade of one surface that lets light through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Veiled {
    /// From where to where [m].
    pub run: Run,
    /// Which material it is, among those that let light through, from 1.
    pub kind: u32,
    /// The share of light that it lets through.
    pub pass: f64,
}

impl Shade {
    /// Nothing shades the ray.
    pub(super) fn clear(&mut self) {
        self.dark.clear();
        self.veiled.clear();
        self.tinted.clear();
    }

    /// Whether nothing but what stops all light is in the way.
    pub(super) fn is_plain(&self) -> bool {
        self.veiled.is_empty() && self.tinted.is_empty()
    }

    /// Adds what a pane leaves of the light, from one place of the ray to another.
    pub(super) fn tint(&mut self, through: DVec3, [a, b]: Run, span: Run) {
        let run = [a.min(b).max(span[0]), a.max(b).min(span[1])];
        if run[1] > run[0] {
            self.tinted.push(Tinted { run, through });
        }
    }

    /// Adds what one surface shades, from one place of the ray to another: all of the light, or but for what a veil (which
    /// kind, and the share it lets through) leaves.
    pub(super) fn add(&mut self, veil: Option<(u32, f64)>, [a, b]: Run, span: Run, together: f64) {
        let run = [a.min(b).max(span[0]), a.max(b).min(span[1])];
        if run[1] <= run[0] {
            return;
        }
        match veil {
            None => insert(&mut self.dark, run, together),
            Some((kind, pass)) => self.veiled.push(Veiled { run, kind, pass }),
        }
    }

    /// The runs of [0, far] that light reaches, in order, and what does of it, by channel [1]: the product over the surfaces and panes on
    /// its way.
    pub fn lit(&self, far: f64) -> Vec<(Run, DVec3)> {
        let mut lit = self.left(far);
        lit.retain(|(_, left)| *left != DVec3::ZERO);
        lit
    }

    /// The same with what panes leave none of.
    fn left(&self, far: f64) -> Vec<(Run, DVec3)> {
        let lit = self.lit_in_part(far).into_iter();
        let lit = lit.map(|(run, pass)| (run, DVec3::splat(pass)));
        if self.tinted.is_empty() {
            return lit.collect();
        }
        let mut ahead: Vec<Tinted> = self.tinted.clone();
        ahead.sort_unstable_by(|a, b| b.run[0].total_cmp(&a.run[0]));
        let mut present: Vec<Tinted> = Vec::new();
        let mut found: Vec<(Run, DVec3)> = Vec::new();
        for ([from, to], share) in lit {
            let mut at = from;
            while at < to {
                while let Some(next) = ahead.pop_if(|next| next.run[0] <= at) {
                    present.push(next);
                }
                present.retain(|tinted| tinted.run[1] > at);
                let ends = present.iter().map(|tinted| tinted.run[1]);
                let starts = ahead.last().map(|next| next.run[0]);
                let end = ends.chain(starts).fold(to, f64::min);
                let left = present
                    .iter()
                    .fold(share, |left, tinted| left * tinted.through);
                match found.last_mut() {
                    Some((run, last)) if run[1] == at && *last == left => run[1] = end,
                    _ => found.push(([at, end], left)),
                }
                at = end;
            }
        }
        found
    }

    /// The runs of [0, far] that surfaces let light to, in order, and the share of it that they do.
    pub(super) fn lit_in_part(&self, far: f64) -> Vec<(Run, f64)> {
        let gaps = complement(&self.dark, far);
        if self.veiled.is_empty() {
            return gaps.map(|run| (run, 1.0)).collect();
        }
        let ends = |veil: &Veiled| [(veil.run[0], *veil, 1), (veil.run[1], *veil, -1)];
        let mut ends: Vec<(f64, Veiled, i32)> = self.veiled.iter().flat_map(ends).collect();
        ends.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut ends = ends.into_iter().peekable();
        let mut present: BTreeMap<u32, (f64, i32)> = BTreeMap::new();
        let mut lit: Vec<(Run, f64)> = Vec::new();
        for [from, to] in gaps {
            let mut at = from;
            let mut reach = |to: f64, present: &BTreeMap<u32, (f64, i32)>| {
                if to <= at {
                    return;
                }
                let pass = present.values().map(|(pass, count)| pass.powi(*count));
                let pass: f64 = pass.product();
                match lit.last_mut() {
                    // Two triangles of one pane.
                    Some((run, last)) if run[1] == at && *last == pass => run[1] = to,
                    _ => lit.push(([at, to], pass)),
                }
                at = to;
            };
            while let Some((place, veil, change)) = ends.next_if(|(place, ..)| *place < to) {
                reach(place, &present);
                present.entry(veil.kind).or_insert((veil.pass, 0)).1 += change;
            }
            reach(to, &present);
        }
        lit
    }

    /// The runs of [0, far] on which something keeps light off, and the share of it that is missing.
    pub fn missing(&self, far: f64) -> impl Iterator<Item = (Run, DVec3)> {
        let dark = self.dark.iter().map(|run| (*run, DVec3::ONE));
        let dimmed = (!self.is_plain()).then(|| self.left(far));
        let dimmed = dimmed.into_iter().flatten();
        let dimmed = dimmed.map(|(run, left)| (run, (1.0 - left).max(DVec3::ZERO)));
        dark.chain(dimmed.filter(|(_, missing)| *missing != DVec3::ZERO))
    }
}

/// Adds a run to sorted, separate ones, joined with those that it touches (within `together`).
pub(super) fn insert(runs: &mut Vec<Run>, run: Run, together: f64) {
    let first = runs.partition_point(|r| r[1] + together < run[0]);
    // Few, and each of them but one ends here: counting them is quicker than searching.
    let joined = runs[first..].iter();
    let joined = joined.take_while(|r| r[0] <= run[1] + together);
    let after = first + joined.count();
    if first == after {
        runs.insert(first, run);
        return;
    }
    runs[first] = [run[0].min(runs[first][0]), run[1].max(runs[after - 1][1])];
    runs.drain(first + 1..after);
}

/// Whether one of the sorted, separate runs holds all of [from, to].
pub(super) fn holds(runs: &[Run], from: f64, to: f64) -> bool {
    let after = runs.partition_point(|r| r[0] <= from);
    after > 0 && runs[after - 1][1] >= to
}

/// Adds the parts of [from, to] that are in none of the sorted, separate runs.
pub(super) fn gaps(runs: &[Run], from: f64, to: f64, gaps: &mut Vec<Run>) {
    let mut at = from;
    for run in &runs[runs.partition_point(|r| r[1] <= from)..] {
        if run[0] >= to {
            break;
        }
        if run[0] > at {
            gaps.push([at, run[0]]);
        }
        at = run[1];
    }
    if at < to {
        gaps.push([at, to]);
    }
}

/// The runs of [0, far] between the given ones: from dark to lit and back.
pub fn complement(runs: &[Run], far: f64) -> impl Iterator<Item = Run> + '_ {
    let starts = std::iter::once(0.0).chain(runs.iter().map(|r| r[1]));
    let ends = runs.iter().map(|r| r[0]).chain(std::iter::once(far));
    starts.zip(ends).map(|(a, b)| [a, b]).filter(|[a, b]| b > a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_runs_become_one_and_the_rest_is_lit() {
        let mut runs = Vec::new();
        for run in [[5.0, 6.0], [1.0, 2.0], [2.0, 3.0], [1.5, 1.6]] {
            insert(&mut runs, run, 0.0);
        }
        assert!(holds(&runs, 1.2, 2.5) && !holds(&runs, 2.5, 5.5) && !holds(&runs, 0.5, 0.7));
        assert_eq!(runs, [[1.0, 3.0], [5.0, 6.0]]);
        let lit: Vec<Run> = complement(&runs, 6.0).collect();
        assert_eq!(lit, [[0.0, 1.0], [3.0, 5.0]]);
    }

    #[test]
    fn veils_multiply_where_they_overlap() {
        let veil = |run: Run, kind: u32, pass: f64| Veiled { run, kind, pass };
        let shade = Shade {
            dark: vec![[4.0, 5.0]],
            veiled: vec![
                veil([1.0, 2.0], 1, 0.5),
                // The other triangle of the same pane.
                veil([2.0, 3.0], 1, 0.5),
                veil([2.5, 8.0], 2, 0.25),
                veil([6.0, 7.0], 2, 0.25),
            ],
            tinted: Vec::new(),
        };
        let lit = shade.lit_in_part(10.0);
        assert_eq!(
            lit,
            [
                ([0.0, 1.0], 1.0),
                ([1.0, 2.5], 0.5),
                ([2.5, 3.0], 0.125),
                ([3.0, 4.0], 0.25),
                ([5.0, 6.0], 0.25),
                ([6.0, 7.0], 0.0625),
                ([7.0, 8.0], 0.25),
                ([8.0, 10.0], 1.0),
            ]
        );
        let missing: f64 = shade
            .missing(10.0)
            .map(|([a, b], share)| share.x * (b - a))
            .sum();
        let reaching: f64 = lit.iter().map(|([a, b], share)| share * (b - a)).sum();
        assert!((missing + reaching - 10.0).abs() < 1e-12);
    }

    #[test]
    fn panes_colour_what_is_lit() {
        let red = DVec3::new(0.5, 0.25, 0.0);
        let tinted = |run: Run, through: DVec3| Tinted { run, through };
        let shade = Shade {
            dark: vec![[4.0, 5.0]],
            veiled: vec![Veiled {
                run: [6.0, 7.0],
                kind: 1,
                pass: 0.5,
            }],
            tinted: vec![
                tinted([2.0, 4.5], red),
                tinted([1.0, 2.0], red),
                tinted([3.0, 6.5], DVec3::splat(0.5)),
            ],
        };
        let expected = [
            ([0.0, 1.0], DVec3::ONE),
            ([1.0, 3.0], red),
            ([3.0, 4.0], 0.5 * red),
            ([5.0, 6.0], DVec3::splat(0.5)),
            ([6.0, 6.5], DVec3::splat(0.25)),
            ([6.5, 7.0], DVec3::splat(0.5)),
            ([7.0, 8.0], DVec3::ONE),
        ];
        assert_eq!(shade.lit(8.0), expected);
        let sum = |runs: &mut dyn Iterator<Item = (Run, DVec3)>| -> DVec3 {
            runs.map(|([a, b], share)| share * (b - a)).sum()
        };
        let all = sum(&mut shade.missing(8.0)) + sum(&mut shade.lit(8.0).into_iter());
        assert!((all - 8.0).abs().max_element() < 1e-12);
    }
}
