//! A solver that reports its iterations while it runs.
//!
//! argmin's own observers have to be `'static` and cannot borrow an [`Observer`](crate::progress::Observer).

use argmin::core::{Error, IterState, KV, Problem, Solver, State as _, TerminationStatus};

use crate::progress::Cancelled;

/// The state of a minimiser over the coordinates X, whose derivatives argmin does not store.
pub(crate) type State<X> = IterState<X, (), (), (), (), f64>;

/// Wraps a solver and passes its parameters and E to `notify`: at the start, and after each
/// iteration.
pub(crate) struct Observed<S, F> {
    pub(crate) solver: S,
    pub(crate) notify: F,
}

impl<S, F> Observed<S, F> {
    fn notify<X: Clone>(&self, state: &State<X>) -> Result<(), Error>
    where
        F: Fn(&X, f64) -> Result<(), Cancelled>,
    {
        if let Some(here) = state.get_param() {
            (self.notify)(here, state.get_cost())?;
        }
        Ok(())
    }
}

impl<X, O, S, F> Solver<O, State<X>> for Observed<S, F>
where
    X: Clone,
    S: Solver<O, State<X>>,
    F: Fn(&X, f64) -> Result<(), Cancelled>,
{
    fn name(&self) -> &str {
        self.solver.name()
    }

    fn init(
        &mut self,
        problem: &mut Problem<O>,
        state: State<X>,
    ) -> Result<(State<X>, Option<KV>), Error> {
        let begun = self.solver.init(problem, state);
        if let Ok((state, _)) = &begun {
            self.notify(state)?;
        }
        begun
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<O>,
        state: State<X>,
    ) -> Result<(State<X>, Option<KV>), Error> {
        // The state is large and therefore borrowed.
        let next = self.solver.next_iter(problem, state);
        if let Ok((state, _)) = &next {
            self.notify(state)?;
        }
        next
    }

    fn terminate(&mut self, state: &State<X>) -> TerminationStatus {
        self.solver.terminate(state)
    }
}
