//! The diagnosis of a change, beside the watching: on one thread, one at a time.

use crossbeam::channel::{Receiver, bounded};

use crate::diagnosis::Settings;
use crate::twin::Twin;
use crate::watch::{Alarm, Answer, Memory, answer, usual};

/// Motion after a change that is waited for before it is diagnosed, s.
const AFTER_S: f64 = 60.0;
/// What will do where the source ends before, s.
const LEAST_S: f64 = 20.0;
/// Motion before it that it is held against, s.
const BEFORE_S: f64 = 90.0;

type Told = Result<Answer, String>;

pub struct Background {
    twin: Twin,
    waits: Option<Alarm>,
    works: Option<Receiver<Told>>,
    done: Option<Told>,
}

impl Background {
    pub fn new(twin: Twin) -> Self {
        Self { twin, waits: None, works: None, done: None }
    }

    /// Something changed; while one change is looked into, others are only told of.
    pub fn change(&mut self, alarm: Alarm) {
        if self.works.is_none() {
            self.waits.get_or_insert(alarm);
        }
    }

    /// Begins once there is enough motion since.
    pub fn look(&mut self, memory: &Memory) {
        self.begin(memory, AFTER_S);
    }

    pub fn look_for_the_last_time(&mut self, memory: &Memory) {
        self.begin(memory, LEAST_S);
    }

    fn begin(&mut self, memory: &Memory, after_s: f64) {
        let Some(alarm) = self.waits else { return };
        let Some(now) = memory.now().filter(|now| now - alarm.since >= after_s) else { return };
        self.waits = None;
        let before = memory.between(alarm.since - BEFORE_S, alarm.since);
        let after = memory.between(alarm.since, now);
        let twin = self.twin.clone();
        let (send, receive) = bounded(1);
        let work = move || {
            // One core at most: the arm is watched meanwhile.
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
            let told = pool.map_err(|e| e.to_string()).and_then(|pool| {
                let settings = Settings::default();
                let work = || answer(&usual(&twin, &before, &settings), &after, alarm, &settings);
                pool.install(work).map_err(|e| e.to_string())
            });
            // Nobody may be waiting any more.
            let _ = send.send(told);
        };
        match std::thread::Builder::new().name("diagnosis".into()).spawn(work) {
            Ok(_) => self.works = Some(receive),
            Err(e) => self.done = Some(Err(e.to_string())),
        }
    }

    /// What came of it, once.
    pub fn answer(&mut self) -> Option<Told> {
        if let Some(told) = self.works.as_ref().and_then(|works| works.try_recv().ok()) {
            self.works = None;
            return Some(told);
        }
        self.done.take()
    }

    /// Until what is under way is done.
    pub fn wait(&mut self) {
        if let Some(works) = self.works.take() {
            self.done = works.recv().ok();
        }
    }
}
