//! A solver whose iterations are told while it runs.
//!
//! argmin's own observers live as long as the program, and cannot borrow who is to be told.

use argmin::core::{Error, IterState, KV, Problem, Solver, State as _, TerminationStatus};

use crate::progress::Cancelled;

/// The state of a minimiser without derivatives of its own over coordinates X.
pub(crate) type State<X> = IterState<X, (), (), (), (), f64>;

/// Another solver, which tells where it is and E there: first the start, then after each of its
/// iterations.
pub(crate) struct Observed<S, F> {
    pub(crate) solver: S,
    pub(crate) tell: F,
}

impl<S, F> Observed<S, F> {
    fn tell<X: Clone>(&self, state: &State<X>) -> Result<(), Error>
    where
        F: Fn(&X, f64) -> Result<(), Cancelled>,
    {
        if let Some(here) = state.get_param() {
            (self.tell)(here, state.get_cost())?;
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
            self.tell(state)?;
        }
        begun
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<O>,
        state: State<X>,
    ) -> Result<(State<X>, Option<KV>), Error> {
        // The state is large: it is looked at where it is.
        let next = self.solver.next_iter(problem, state);
        if let Ok((state, _)) = &next {
            self.tell(state)?;
        }
        next
    }

    fn terminate(&mut self, state: &State<X>) -> TerminationStatus {
        self.solver.terminate(state)
    }
}
