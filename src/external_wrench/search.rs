//! When something touches: the most probable course of a model that switches.
//!
//! Every course of modes has a Kalman filter of its own, which gives its log-evidence, force and
//! drift integrated out. Of all courses only the best are followed (Blom, Bar-Shalom, IEEE Trans.
//! Automatic Control 33(8), 1988, section II, on why the whole tree cannot be).

use std::rc::Rc;

use super::kalman::Belief;
use super::model::{Mode, Steps, Switching};

/// Courses followed per mode: they differ in when the contact began.
const FOLLOWED: usize = 6;
/// Courses less probable than the best by this are given up, nats.
const HOPELESS: f64 = 40.0;

#[derive(Clone)]
struct Course {
    belief: Belief,
    mode: Mode,
    log_evidence: f64,
    changes: Option<Rc<Change>>,
}

/// The last change of mode, and those before.
struct Change {
    step: usize,
    mode: Mode,
    before: Option<Rc<Change>>,
}

/// The mode at every step of the most probable course; `tell` hears how many steps are done.
pub fn course(steps: &Steps, switching: &Switching, tell: &dyn Fn(usize)) -> Vec<Mode> {
    let start = Course { belief: steps.start(), mode: None, log_evidence: 0.0, changes: None };
    let mut courses = vec![start];
    for k in 0..steps.len() {
        tell(k);
        courses = branched(&courses, k, steps.levers.len(), switching);
        for course in &mut courses {
            course.log_evidence += steps.step(&mut course.belief, k, course.mode);
        }
        courses = best(courses, steps.levers.len());
    }
    let first = courses.iter().max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence));
    modes(first.and_then(|course| course.changes.as_ref()), steps.len())
}

/// All that may come next. A contact begins from the best course without one.
fn branched(courses: &[Course], k: usize, places: usize, switching: &Switching) -> Vec<Course> {
    let next = |course: &Course, mode: Mode, log_probability: f64| {
        let mut next = course.clone();
        next.log_evidence += log_probability;
        if mode != course.mode {
            let before = course.changes.clone();
            next.changes = Some(Rc::new(Change { step: k, mode, before }));
            next.mode = mode;
        }
        next
    };
    let mut all = Vec::new();
    for course in courses {
        if course.mode.is_some() {
            all.push(next(course, course.mode, switching.goes_on));
            all.push(next(course, None, switching.ends));
        } else {
            all.push(next(course, None, switching.none));
        }
    }
    let free = courses.iter().filter(|c| c.mode.is_none());
    if let Some(free) = free.max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence)) {
        all.extend((0..places).map(|place| next(free, Some(place), switching.begins)));
    }
    all
}

/// The best of every mode, without those that are hopeless; the best free one always.
fn best(mut courses: Vec<Course>, places: usize) -> Vec<Course> {
    courses.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    let top = courses.first().map_or(0.0, |c| c.log_evidence);
    let mut followed = vec![0; places + 1];
    courses.retain(|course| {
        let count = &mut followed[course.mode.unwrap_or(places)];
        *count += 1;
        let hopeless = course.log_evidence < top - HOPELESS;
        *count <= FOLLOWED && !(hopeless && (course.mode.is_some() || *count > 1))
    });
    courses
}

fn modes(changes: Option<&Rc<Change>>, steps: usize) -> Vec<Mode> {
    let mut modes = vec![None; steps];
    let (mut end, mut next) = (steps, changes);
    while let Some(change) = next {
        modes[change.step..end].fill(change.mode);
        end = change.step;
        next = change.before.as_ref();
    }
    modes
}
