//! Times of rows -> times of day.

use std::time::{SystemTime, UNIX_EPOCH};

/// What zero of the rows' clock is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Clock {
    /// A recording's own time.
    Own,
    /// Rows come as they are made: unix time less the rows' own, s, once there was a row.
    Day(Option<f64>),
}

impl Clock {
    pub fn day() -> Self {
        Self::Day(None)
    }

    /// The first row came now; so did one whose clock is another than before.
    pub fn set(&mut self, time: f64) {
        if let Self::Day(offset) = self {
            let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |d| d.as_secs_f64());
            let late = |offset: f64| (now - offset - time).abs() > LATE_S;
            if offset.is_none_or(late) {
                *offset = Some(now - time);
            }
        }
    }

    /// Unix time, or the recording's own, s.
    pub fn of(&self, time: f64) -> f64 {
        match self {
            Self::Own => time,
            Self::Day(offset) => time + offset.unwrap_or(0.0),
        }
    }

    /// `14:02:10 UTC`, or `62.0 s`.
    pub fn words(&self, time: f64) -> String {
        match self {
            Self::Own => format!("{time:.1} s"),
            Self::Day(_) => {
                let second = self.of(time) as u64 % 86400;
                let [h, m, s] = [second / 3600, second / 60 % 60, second % 60];
                format!("{h:02}:{m:02}:{s:02} UTC")
            }
        }
    }
}

/// Rows that are this much off the clock of this machine have another one, s: more than a queue holds.
const LATE_S: f64 = 300.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_day_are_told_where_rows_come_as_they_are_made() {
        assert_eq!(Clock::Day(Some(1_795_392_000.0)).words(50_530.0), "14:02:10 UTC");
        assert_eq!(Clock::Own.words(62.04), "62.0 s");
    }
}
