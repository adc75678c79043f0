//! Long work beside the calling thread, which meanwhile answers to Ctrl-C and tells how far it is.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use armtwin::follow::{Token, Watch};
use armtwin::workflow::WorkflowError;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::errors::{fault, of_job};

/// How often the caller looks for Ctrl-C, and the most often that progress is told.
const BEAT: Duration = Duration::from_millis(50);
/// As much as main threads have.
const STACK: usize = 8 << 20;

enum Event {
    Told(&'static str, u64, u64),
    Noted(String),
    Warned(String),
}

/// Sends what the engine tells to the calling thread.
struct Follower {
    events: Sender<Event>,
    token: Token,
    /// What was told last, and when.
    told: Mutex<Option<(&'static str, Instant)>>,
}

impl Follower {
    fn send(&self, event: Event) {
        // Who has gone does not listen.
        let _ = self.events.send(event);
    }
}

impl Watch for Follower {
    fn tell(&self, doing: &'static str, done: u64, of: u64) {
        let Ok(mut told) = self.told.lock() else { return };
        let fresh = told.is_none_or(|(before, at)| before != doing || at.elapsed() > BEAT);
        if fresh || done == of {
            *told = Some((doing, Instant::now()));
            self.send(Event::Told(doing, done, of));
        }
    }

    fn note(&self, text: &str) {
        self.send(Event::Noted(text.into()));
    }

    fn warn(&self, text: &str) {
        self.send(Event::Warned(text.into()));
    }

    fn stops(&self) -> bool {
        self.token.stops()
    }
}

/// Runs `work` without the interpreter. `listener` has `progress(doing, done, of)`, `note(text)` and
/// `warn(text)`; what they raise ends the work, as Ctrl-C does.
pub fn run<T: Send>(
    listener: &Bound<'_, PyAny>,
    work: impl FnOnce(&dyn Watch) -> Result<T, WorkflowError> + Send,
) -> PyResult<T> {
    let py = listener.py();
    let token = Token::default();
    thread::scope(|scope| {
        let (events, heard) = channel();
        let follower = Follower { events, token: token.clone(), told: Mutex::default() };
        let guarded = move || catch_unwind(AssertUnwindSafe(|| work(&follower)));
        let worker = thread::Builder::new()
            .stack_size(STACK)
            .spawn_scoped(scope, guarded)
            .map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
        let raised = listen(listener, heard, &token);
        let outcome = py.detach(|| worker.join()).and_then(|outcome| outcome);
        raised?;
        outcome.map_err(fault)?.map_err(of_job)
    })
}

/// Until the work has ended.
fn listen(listener: &Bound<'_, PyAny>, heard: Receiver<Event>, token: &Token) -> PyResult<()> {
    let py = listener.py();
    let mut heard = heard;
    let mut raised = Ok(());
    loop {
        let (back, event) = py.detach(move || {
            let event = heard.recv_timeout(BEAT);
            (heard, event)
        });
        heard = back;
        let answer = match event {
            Err(RecvTimeoutError::Disconnected) => return raised,
            _ if raised.is_err() => continue,
            Err(RecvTimeoutError::Timeout) => Ok(()),
            Ok(Event::Told(doing, done, of)) => {
                listener.call_method1("progress", (doing, done, of)).map(drop)
            }
            Ok(Event::Noted(text)) => listener.call_method1("note", (text,)).map(drop),
            Ok(Event::Warned(text)) => listener.call_method1("warn", (text,)).map(drop),
        };
        raised = answer.and_then(|()| py.check_signals());
        if raised.is_err() {
            token.stop();
        }
    }
}
