//! Joint states, one after the other -> columns, base to wrist.

use super::message::JointState;
use super::names;
use crate::recording::bag_map::{BagMap, Clock};

/// What may come in a joint state, as RTDE calls it; effort has no meaning yet.
pub const SIGNALS: [&str; 3] = ["actual_q", "actual_qd", "effort"];
/// Drivers publish before they have measured anything; more rows without a number are no start-up.
const MOST_LEADING: usize = 100;
/// No quantity of an arm is larger.
const LARGEST: f64 = 1e12;

#[derive(Default)]
pub struct Joints {
    /// Names from base to wrist.
    pub names: Vec<String>,
    /// Names in the last message, and where the arm's joints are among them.
    last: Vec<String>,
    order: Option<Vec<usize>>,
    /// ns
    stamped: Vec<i64>,
    pub logged: Vec<i64>,
    /// Values by signal and joint; a signal that is not sent has no joints.
    signals: [Vec<Vec<f64>>; 3],
    /// Joints of the first message that is not the arm's.
    pub strangers: Vec<String>,
    foreign: usize,
    repeated: usize,
}

/// A finished set of columns.
pub struct Sampled {
    /// ns
    pub stamps: Vec<i64>,
    pub logged: Vec<i64>,
    /// Signal and one column per joint.
    pub signals: Vec<(&'static str, Vec<Vec<f64>>)>,
    pub notes: Vec<String>,
}

impl Joints {
    pub fn samples(&self) -> usize {
        self.logged.len()
    }

    /// Number of columns of all signals together.
    pub fn columns(&self) -> usize {
        self.signals.iter().map(Vec::len).sum()
    }

    /// Takes a message; says what is wrong with it.
    pub fn add(&mut self, state: &JointState, logged: i64, map: &BagMap) -> Result<(), String> {
        if self.last.is_empty() || self.last != state.names {
            self.order = names::find(&state.names, map.joints.as_deref()).map_err(|what| {
                format!("{what}; name the joints in a column map: [bag] joints = [\"...\"]")
            })?;
            self.last = state.names.iter().map(|n| n.to_string()).collect();
        }
        let Some(order) = &self.order else {
            self.foreign += 1;
            if self.strangers.is_empty() {
                self.strangers.clone_from(&self.last);
            }
            return Ok(());
        };
        let found = || order.iter().map(|k| &self.last[*k]);
        if self.names.is_empty() {
            self.names = found().cloned().collect();
        } else if !found().eq(&self.names) {
            let (now, before) = (found().cloned().collect::<Vec<_>>(), self.names.join(", "));
            return Err(format!("its joints are {}, before {before}", now.join(", ")));
        }
        if state.position.is_empty() {
            return Err("it has no positions".into());
        }
        if map.time == Clock::Header
            && state.stamp != 0
            && self.stamped.last() == Some(&state.stamp)
        {
            self.repeated += 1;
            return Ok(());
        }
        let sent = [&state.position, &state.velocity, &state.effort];
        for (k, (columns, values)) in self.signals.iter_mut().zip(sent).enumerate() {
            if self.logged.is_empty() {
                columns.resize(if values.is_empty() { 0 } else { order.len() }, Vec::new());
            }
            if columns.is_empty() != values.is_empty() {
                let field = ["position", "velocity", "effort"][k];
                let now = if values.is_empty() { "is missing" } else { "was missing before" };
                return Err(format!("its {field} {now}; every message must have the same fields"));
            }
            for (column, at) in columns.iter_mut().zip(order) {
                column.push(values[*at]);
            }
        }
        self.stamped.push(state.stamp);
        self.logged.push(logged);
        Ok(())
    }

    /// Judges the whole: which clock, which signals, from which sample on.
    pub fn finish(mut self, clock: Clock) -> Result<Sampled, (usize, String)> {
        let mut notes = Vec::new();
        if self.foreign > 0 {
            notes.push(format!(
                "left out {} message(s) of other joints ({})",
                self.foreign,
                self.strangers.join(", ")
            ));
        }
        if self.repeated > 0 {
            notes.push(format!("left out {} message(s) with a stamp seen before", self.repeated));
        }
        let unstamped = self.stamped.iter().all(|s| *s == 0);
        if unstamped && clock == Clock::Header {
            notes.push("the headers have no stamps: time is that of the recorder".into());
        }
        let by_log = clock == Clock::Log || unstamped;
        let mut stamps =
            if by_log { self.logged.clone() } else { std::mem::take(&mut self.stamped) };
        for (signal, columns) in SIGNALS.iter().zip(&mut self.signals).skip(1) {
            if !columns.is_empty() && columns.iter().flatten().all(|v| v.is_nan()) {
                columns.clear();
                notes.push(format!("{signal} is NaN throughout: left out"));
            }
        }
        let leading = self.leading()?;
        if leading > 0 {
            notes.push(format!("dropped {leading} leading sample(s) without a number"));
            stamps.drain(..leading);
            self.logged.drain(..leading);
            self.signals.iter_mut().flatten().for_each(|column| drop(column.drain(..leading)));
        }
        let sent = SIGNALS.into_iter().zip(self.signals).filter(|(_, columns)| !columns.is_empty());
        Ok(Sampled { stamps, logged: self.logged, signals: sent.collect(), notes })
    }

    /// How many samples at the start lack a number; any later one is refused.
    fn leading(&self) -> Result<usize, (usize, String)> {
        let garbage = |k: usize| {
            let all = SIGNALS.iter().zip(&self.signals);
            let mut cells =
                all.flat_map(|(s, c)| c.iter().enumerate().map(move |(j, c)| (s, j, c[k])));
            cells.find(|(_, _, v)| v.is_nan() || v.abs() > LARGEST)
        };
        let samples = self.samples();
        let leading = (0..samples.min(MOST_LEADING)).take_while(|k| garbage(*k).is_some()).count();
        match (leading..samples).find_map(|k| garbage(k).map(|found| (k, found))) {
            None => Ok(leading),
            Some((k, (signal, joint, value))) => {
                let name = &self.names[joint];
                Err((k + 1, format!("{signal} of {name} is {value:e}")))
            }
        }
    }
}
