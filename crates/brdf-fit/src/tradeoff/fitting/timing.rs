//! The times of alternatives that are compared.

use std::hint::black_box;
use web_time::Instant;

/// Smallest number of runs of each alternative.
const FEWEST: usize = 3;

/// Largest number of runs of each alternative: with more, the median hardly changes.
const MOST: usize = 101;

/// No further turn begins after this time, in seconds.
const ENOUGH: f64 = 2.0;

/// The times of several runs of each of the alternatives, in seconds.
///
/// The alternatives run in turns, so that other load on the machine affects all of them alike.
pub(super) fn times<T, R>(alternatives: &[T], run: impl Fn(&T) -> R) -> Vec<Vec<f64>> {
    let begun = Instant::now();
    let mut times = vec![Vec::new(); alternatives.len()];
    for turn in 0..MOST {
        if turn >= FEWEST && begun.elapsed().as_secs_f64() >= ENOUGH {
            break;
        }
        for (alternative, times) in alternatives.iter().zip(&mut times) {
            let started = Instant::now();
            black_box(run(black_box(alternative)));
            times.push(started.elapsed().as_secs_f64());
        }
    }
    times
}

/// The median of the values, the mean of the two middle ones for an even number of them; NaN for
/// none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    match (values.get(half), values.len() % 2) {
        (None, _) => f64::NAN,
        (Some(middle), 1) => *middle,
        (Some(above), _) => 0.5 * (values[half - 1] + above),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_value_or_the_mean_of_two() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(Vec::new()).is_nan());
    }

    #[test]
    fn all_alternatives_run_in_turns_and_equally_often() {
        let order = std::cell::RefCell::new(Vec::new());
        let times = times(&["a", "b"], |name| order.borrow_mut().push(*name));
        assert_eq!(order.borrow()[..4], ["a", "b", "a", "b"]);
        assert!((FEWEST..=MOST).contains(&times[0].len()));
        assert_eq!(times[0].len(), times[1].len());
        assert!(times.iter().flatten().all(|&seconds| seconds >= 0.0));
    }
}
