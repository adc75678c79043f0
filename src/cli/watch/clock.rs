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

/// `2026-11-23` of unix time, s (Hinnant, "chrono-compatible low-level date algorithms", days to civil).
pub fn day(unix_s: f64) -> String {
    let z = (unix_s / 86400.0).floor() as i64 + 719_468;
    let era = z.div_euclid(146_097);
    let doe = z.rem_euclid(146_097);
    let yoe = (doe - doe / 1460 + doe / 36_524 - doe / 146_096) / 365;
    let doy = doe - (365 * yoe + yoe / 4 - yoe / 100);
    let mp = (5 * doy + 2) / 153;
    let d = doy - (153 * mp + 2) / 5 + 1;
    let m = if mp < 10 { mp + 3 } else { mp - 9 };
    let y = yoe + era * 400 + i64::from(m <= 2);
    format!("{y:04}-{m:02}-{d:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_those_of_the_calendar() {
        for (unix, date) in
            [(0.0, "1970-01-01"), (951_827_696.0, "2000-02-29"), (1_795_392_000.0, "2026-11-23")]
        {
            assert_eq!(day(unix), date);
        }
        assert_eq!(Clock::Day(Some(1_795_392_000.0)).words(50_530.0), "14:02:10 UTC");
        assert_eq!(Clock::Own.words(62.04), "62.0 s");
    }
}
