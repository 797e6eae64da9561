//! The side of the worker of the browser: it fits what the page orders.

use std::cell::Cell;
use std::ops::ControlFlow;

use brdf_fit::{Observer, Step};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{DedicatedWorkerGlobalScope, MessageEvent};
use web_time::{Duration, Instant};

use super::order::{Answer, Order};
use crate::worker::report;

/// The shortest time between steps that only count. There are thousands, and each wakes the page.
const BETWEEN_STEPS: Duration = Duration::from_millis(40);

/// Waits for orders, and carries them out.
pub(super) fn serve() {
    // A panic ends the worker. The page starts another one.
    std::panic::set_hook(Box::new(|panic| {
        answer(&Answer::Aborted(format!("internal error: {panic}")));
    }));
    let ordered = Closure::<dyn FnMut(MessageEvent)>::new(|message: MessageEvent| {
        let text = message.data().as_string().unwrap_or_default();
        answer(&match serde_json::from_str(&text) {
            Ok(order) => fit(&order),
            Err(error) => Answer::Aborted(format!("internal error: {error}")),
        });
    });
    scope().set_onmessage(Some(ordered.as_ref().unchecked_ref()));
    ordered.forget();
    answer(&Answer::Ready);
}

fn fit(order: &Order) -> Answer {
    let report = report(
        &order.measurements,
        &order.options,
        &order.left_out,
        order.depth,
        &StepSender,
        &|found| answer(&Answer::Found(Box::new(found))),
    );
    Answer::Fitted(Box::new(report))
}

/// Sends the steps of a fit. The page cancels it by ending the worker.
struct StepSender;

impl Observer for StepSender {
    fn step(&self, step: &Step) -> ControlFlow<()> {
        if step.e_percent.is_some() || step.part.is_some() || is_due() {
            answer(&Answer::Step(*step));
        }
        ControlFlow::Continue(())
    }
}

/// Whether no step that only counts was sent for a while.
fn is_due() -> bool {
    thread_local! {
        static SENT: Cell<Option<Instant>> = const { Cell::new(None) };
    }
    let is_due = SENT
        .get()
        .is_none_or(|sent| sent.elapsed() >= BETWEEN_STEPS);
    if is_due {
        SENT.set(Some(Instant::now()));
    }
    is_due
}

fn answer(answer: &Answer) {
    if let Ok(text) = serde_json::to_string(answer) {
        let _ = scope().post_message(&JsValue::from_str(&text));
    }
}

fn scope() -> DedicatedWorkerGlobalScope {
    js_sys::global().unchecked_into()
}
