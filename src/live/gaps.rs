//! Gaps in the clock of who made the rows.

/// Steps longer than this many usual ones are gaps.
const GAP: f64 = 1.5;

/// What the time stamps of rows say of what is missing between them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gaps {
    step_s: f64,
    last: Option<f64>,
    /// How many, the longest (s), and rows that would have been in them.
    pub count: u64,
    pub longest_s: f64,
    pub missing: u64,
    /// Rows whose time is not after that of the row before.
    pub repeated: u64,
}

/// What a time stamp is beside the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    Usual,
    Gap(f64),
    /// Time stood still or went back by so much, s.
    Back(f64),
}

impl Gaps {
    pub fn new(rate_hz: f64) -> Self {
        Self { step_s: 1.0 / rate_hz, ..Self::default() }
    }

    /// Takes the next time stamp, s.
    pub fn step(&mut self, time: f64) -> Step {
        let Some(last) = self.last.replace(time) else { return Step::Usual };
        let step = time - last;
        if step <= 0.0 {
            self.repeated += 1;
            return Step::Back(-step);
        }
        if step <= GAP * self.step_s {
            return Step::Usual;
        }
        self.count += 1;
        self.longest_s = self.longest_s.max(step);
        self.missing += ((step / self.step_s).round() as u64).saturating_sub(1);
        Step::Gap(step)
    }

    /// The clock begins anew.
    pub fn forget(&mut self) {
        self.last = None;
    }

    /// One sentence without its full stop; `None` where there is nothing to say.
    pub fn words(&self) -> Option<String> {
        let Self { count, longest_s, missing, .. } = self;
        (*count > 0).then(|| {
            format!(
                "the controller's clock has {count} gaps, the longest {longest_s:.3} s: {missing} rows were \
                 not sent; they are left as gaps"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_counted_and_time_that_stands_is_no_gap() {
        let mut gaps = Gaps::new(125.0);
        let steps: Vec<Step> = [0.0, 0.008, 0.016, 0.016, 0.04, 0.048, 1.048]
            .into_iter()
            .map(|t| gaps.step(t))
            .collect();
        assert!(matches!(steps[3], Step::Back(0.0)) && matches!(steps[4], Step::Gap(_)));
        assert_eq!((gaps.count, gaps.missing, gaps.repeated), (2, 2 + 124, 1));
        assert!(gaps.words().unwrap().contains("2 gaps, the longest 1.000 s: 126 rows"));
        assert_eq!(Gaps::new(125.0).words(), None);
    }
}
