//! How long things take that are compared.

use std::hint::black_box;
use std::time::Instant;

/// At least so many runs of each.
const FEWEST: usize = 3;

/// At most so many runs of each: the median no longer changes much.
const MOST: usize = 101;

/// No more runs are begun after this time, in seconds.
const ENOUGH: f64 = 2.0;

/// The times of several runs of each of the things, in seconds.
///
/// They run in turns, so that what else the machine does meets all of them alike.
pub(super) fn times<T, R>(things: &[T], run: impl Fn(&T) -> R) -> Vec<Vec<f64>> {
    let begun = Instant::now();
    let mut times = vec![Vec::new(); things.len()];
    for turn in 0..MOST {
        if turn >= FEWEST && begun.elapsed().as_secs_f64() >= ENOUGH {
            break;
        }
        for (thing, times) in things.iter().zip(&mut times) {
            let started = Instant::now();
            black_box(run(black_box(thing)));
            times.push(started.elapsed().as_secs_f64());
        }
    }
    times
}

/// The middle one of the values, or the mean of the two; not a number where there are none.
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
    fn the_median_is_in_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(Vec::new()).is_nan());
    }

    #[test]
    fn all_things_run_in_turns_and_equally_often() {
        let order = std::cell::RefCell::new(Vec::new());
        let times = times(&["a", "b"], |thing| order.borrow_mut().push(*thing));
        assert_eq!(order.borrow()[..4], ["a", "b", "a", "b"]);
        assert!((FEWEST..=MOST).contains(&times[0].len()));
        assert_eq!(times[0].len(), times[1].len());
        assert!(times.iter().flatten().all(|&seconds| seconds >= 0.0));
    }
}
