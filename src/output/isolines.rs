//! Lines of equal value through a grid of values, by marching squares.

use std::collections::HashMap;

/// Values on a grid, row by row; `None` where there is none.
pub struct Field<'a> {
    /// Values in a row.
    pub columns: usize,
    /// All values.
    pub values: &'a [Option<f64>],
}

/// An edge between neighbours: the first of the two, and whether the other is in the next row.
type Edge = (usize, bool);

/// The lines on which a field has a value, as points in columns and rows: linear between neighbours, and only where all four values
/// around are there. A closed line ends where it starts. Where a square has the value on all four sides, its mean tells how.
pub fn isolines(field: &Field, level: f64) -> Vec<Vec<[f64; 2]>> {
    let columns = field.columns.max(1);
    let rows = field.values.len() / columns;
    let mut pieces: Vec<[Edge; 2]> = Vec::new();
    for row in 0..rows.saturating_sub(1) {
        for column in 0..columns.saturating_sub(1) {
            let first = row * columns + column;
            let corners = [first, first + 1, first + columns + 1, first + columns];
            let [Some(a), Some(b), Some(c), Some(d)] = corners.map(|i| field.values[i]) else {
                continue;
            };
            let values = [a, b, c, d];
            let sides: [Edge; 4] = [
                (first, false),
                (first + 1, true),
                (first + columns, false),
                (first, true),
            ];
            let is_above = values.map(|v| v >= level);
            let crossed: Vec<usize> = (0..4)
                .filter(|i| is_above[*i] != is_above[(i + 1) % 4])
                .collect();
            let mut join = |i: usize, j: usize| pieces.push([sides[i], sides[j]]);
            match crossed[..] {
                [i, j] => join(i, j),
                [_, _, _, _] => {
                    // A line cuts off each corner that is unlike the middle.
                    let middle = 0.25 * values.iter().sum::<f64>() >= level;
                    for corner in (0..4).filter(|i| is_above[*i] != middle) {
                        join((corner + 3) % 4, corner);
                    }
                }
                _ => {}
            }
        }
    }
    let point = |(first, is_down): Edge| {
        let second = if is_down { first + columns } else { first + 1 };
        let value = |i: usize| field.values[i].unwrap_or(level);
        let (a, b) = (value(first), value(second));
        let share = if a == b { 0.5 } else { (level - a) / (b - a) };
        let at = [(first % columns) as f64, (first / columns) as f64];
        match is_down {
            true => [at[0], at[1] + share],
            false => [at[0] + share, at[1]],
        }
    };
    let mut at: HashMap<Edge, Vec<usize>> = HashMap::new();
    for (i, ends) in pieces.iter().enumerate() {
        ends.iter()
            .for_each(|end| at.entry(*end).or_default().push(i));
    }
    let mut is_used = vec![false; pieces.len()];
    let mut lines = Vec::new();
    for first in 0..pieces.len() {
        if std::mem::replace(&mut is_used[first], true) {
            continue;
        }
        let [start, end] = pieces[first];
        // From an end on, as far as it goes.
        let mut follow = |mut end: Edge| {
            let mut edges = Vec::new();
            while let Some(next) = at[&end].iter().copied().find(|i| !is_used[*i]) {
                is_used[next] = true;
                let [a, b] = pieces[next];
                end = if a == end { b } else { a };
                edges.push(end);
            }
            edges
        };
        let (after, before) = (follow(end), follow(start));
        let edges = before.into_iter().rev().chain([start, end]).chain(after);
        lines.push(edges.map(point).collect());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(columns: usize, rows: usize, of: impl Fn(f64, f64) -> f64) -> Vec<Option<f64>> {
        let all = (0..rows * columns).map(|i| ((i % columns) as f64, (i / columns) as f64));
        all.map(|(x, y)| Some(of(x, y))).collect()
    }

    #[test]
    fn lines_of_a_linear_field_are_straight() {
        let values = sampled(9, 7, |x, y| 3.0 * x + 2.0 * y);
        let field = Field {
            columns: 9,
            values: &values,
        };
        let lines = isolines(&field, 13.3);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].len() > 6);
        assert!(
            lines[0]
                .iter()
                .all(|[x, y]| (3.0 * x + 2.0 * y - 13.3).abs() < 1e-12)
        );
        assert!(isolines(&field, 99.0).is_empty());
    }

    #[test]
    fn lines_around_a_hill_are_closed_and_holes_have_none() {
        let hill = |x: f64, y: f64| 10.0 - (x - 6.0).hypot(y - 6.0);
        let mut values = sampled(13, 13, hill);
        let of = |values: &[Option<f64>]| {
            let lines = isolines(
                &Field {
                    columns: 13,
                    values,
                },
                6.5,
            );
            lines
                .into_iter()
                .map(|line| (line[0] == line[line.len() - 1], line))
                .collect::<Vec<_>>()
        };
        let whole = of(&values);
        assert_eq!(whole.len(), 1);
        let (is_closed, line) = &whole[0];
        assert!(is_closed);
        assert!(
            line.iter()
                .all(|[x, y]| ((x - 6.0).hypot(y - 6.0) - 3.5).abs() < 0.1)
        );
        // Without one of the values on it the line has two ends, beside the hole.
        values[6 * 13 + 10] = None;
        let broken = of(&values);
        assert!(broken.len() == 1 && !broken[0].0 && broken[0].1.len() < line.len());
    }

    #[test]
    fn saddles_are_cut_by_their_middle() {
        for (middle, joined) in [(0.6, 1.0), (0.4, 0.0)] {
            let (a, b) = (1.0, 2.0 * middle - 1.0);
            let values = [Some(a), Some(b), Some(b), Some(a)];
            let lines = isolines(
                &Field {
                    columns: 2,
                    values: &values,
                },
                0.5,
            );
            assert_eq!(lines.len(), 2);
            // The corner that each line cuts off.
            for line in lines {
                let [x, y] = [0, 1].map(|k: usize| line[0][k] + line[1][k]);
                let is_main = (x < 1.0) == (y < 1.0);
                assert_eq!(is_main, joined == 0.0, "{line:?}");
            }
        }
    }
}
