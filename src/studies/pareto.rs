//! The Pareto front: measurements that no other beats at the same cost.

/// Which of these pairs of cost and error (of any units, less is better) are on the front, in their order.
///
/// One is on it when no other is as good in both and better in one; equal pairs are on it together. What is not finite is no
/// measurement: it is never on the front, and beats nothing. Along the front, errors fall as costs rise.
pub fn front(cost_and_error: &[[f64; 2]]) -> Vec<bool> {
    let measured = |i: &usize| cost_and_error[*i].iter().all(|v| v.is_finite());
    let mut order: Vec<usize> = (0..cost_and_error.len()).filter(measured).collect();
    // Finite numbers are always in order.
    order.sort_by(|a, b| {
        let order = cost_and_error[*a].partial_cmp(&cost_and_error[*b]);
        order.unwrap_or(std::cmp::Ordering::Equal)
    });
    let mut on_front = vec![false; cost_and_error.len()];
    let mut last: Option<[f64; 2]> = None;
    for i in order {
        let here = cost_and_error[i];
        if last.is_none_or(|last| here[1] < last[1] || here == last) {
            on_front[i] = true;
            last = Some(here);
        }
    }
    on_front
}

#[cfg(test)]
mod tests {
    use super::front;

    /// The definition, word by word.
    fn by_definition(pairs: &[[f64; 2]]) -> Vec<bool> {
        let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
        let on = |p: &[f64; 2]| {
            p.iter().all(|v| v.is_finite())
                && !pairs
                    .iter()
                    .any(|q| q.iter().all(|v| v.is_finite()) && beats(q, p))
        };
        pairs.iter().map(on).collect()
    }

    #[test]
    fn ties_and_what_is_no_measurement() {
        assert_eq!(front(&[]), [false; 0]);
        assert_eq!(front(&[[1.0, 1.0]]), [true]);
        // The same twice; the same cost; the same error.
        assert_eq!(front(&[[1.0, 1.0], [1.0, 1.0]]), [true, true]);
        assert_eq!(front(&[[1.0, 2.0], [1.0, 1.0]]), [false, true]);
        assert_eq!(front(&[[2.0, 1.0], [1.0, 1.0]]), [false, true]);
        assert_eq!(front(&[[0.0, 1.0], [-0.0, 2.0]]), [true, false]);
        let (nan, infinite) = (f64::NAN, f64::INFINITY);
        let broken = [
            [nan, 0.0],
            [0.0, nan],
            [-infinite, 0.0],
            [1.0, infinite],
            [5.0, 5.0],
        ];
        assert_eq!(front(&broken), [false, false, false, false, true]);
    }

    #[test]
    fn the_front_is_what_its_definition_says_and_falls() {
        let mut state = 1_u64;
        for round in 0..200 {
            // Few values, so that there are ties.
            let mut value = || {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                let value = (state >> 33) % 7;
                if value == 6 && round % 2 == 0 {
                    f64::NAN
                } else {
                    value as f64
                }
            };
            let pairs: Vec<[f64; 2]> = (0..12).map(|_| [value(), value()]).collect();
            let on_front = front(&pairs);
            assert_eq!(on_front, by_definition(&pairs), "{pairs:?}");
            let mut along: Vec<_> = pairs.iter().zip(&on_front).filter(|(_, on)| **on).collect();
            along.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
            for pair in along.windows(2) {
                let [(a, _), (b, _)] = [pair[0], pair[1]];
                assert!(a == b || a[0] < b[0] && a[1] > b[1], "{pairs:?}");
            }
        }
    }
}
