//! The Pareto front of a trade-off.

/// Which of the choices, each given as (cost, error), are on the Pareto front: no other choice is
/// better in one of the two and at least as good in the other.
///
/// Of equal choices, all or none are on the front. A choice with a cost or an error that is not
/// finite is never on it and does not dominate any other.
///
/// # Examples
///
/// ```
/// use brdf_fit::tradeoff::pareto::pareto;
///
/// let front = pareto(&[(1.0, 0.5), (2.0, 0.1), (3.0, 0.2)]);
/// assert_eq!(front, [true, true, false]);
/// ```
pub fn pareto(choices: &[(f64, f64)]) -> Vec<bool> {
    let on_front = |&choice: &(f64, f64)| {
        is_finite(choice) && !choices.iter().any(|&other| dominates(other, choice))
    };
    choices.iter().map(on_front).collect()
}

fn is_finite((cost, error): (f64, f64)) -> bool {
    cost.is_finite() && error.is_finite()
}

fn dominates(a: (f64, f64), b: (f64, f64)) -> bool {
    is_finite(a) && a.0 <= b.0 && a.1 <= b.1 && a != b
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const INF: f64 = f64::INFINITY;

    #[test]
    fn the_front_of_nothing_is_empty_and_a_single_choice_is_on_it() {
        assert!(pareto(&[]).is_empty());
        assert_eq!(pareto(&[(1.0, 1.0)]), [true]);
    }

    #[test]
    fn equal_choices_are_on_the_front_together() {
        assert_eq!(pareto(&[(1.0, 1.0), (1.0, 1.0)]), [true, true]);
        assert_eq!(pareto(&[(0.0, 1.0), (-0.0, 1.0)]), [true, true]);
    }

    #[test]
    fn of_two_choices_equal_in_one_the_better_in_the_other_dominates() {
        assert_eq!(pareto(&[(1.0, 1.0), (1.0, 2.0)]), [true, false]);
        assert_eq!(pareto(&[(2.0, 1.0), (1.0, 1.0)]), [false, true]);
    }

    #[test]
    fn a_choice_that_is_not_finite_is_not_on_the_front_and_dominates_none() {
        let choices = [
            (f64::NAN, 0.0),
            (0.0, f64::NAN),
            (INF, 0.0),
            (0.0, INF),
            (-INF, 0.0),
            (1.0, 1.0),
        ];
        assert_eq!(pareto(&choices), [false, false, false, false, false, true]);
    }

    proptest! {
        #[test]
        fn a_choice_that_is_not_on_the_front_is_dominated_by_one_that_is(
            choices in prop::collection::vec((0_u8..20, 0_u8..20), 0..40),
        ) {
            let choices: Vec<(f64, f64)> =
                choices.into_iter().map(|(x, y)| (f64::from(x), f64::from(y))).collect();
            let front = pareto(&choices);
            for (i, &choice) in choices.iter().enumerate() {
                let by_front =
                    (0..choices.len()).any(|j| front[j] && dominates(choices[j], choice));
                prop_assert_eq!(front[i], !by_front);
            }
        }
    }
}
