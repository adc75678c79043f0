//! Rows of a study of identification, read back from its table.

use crate::effects;
use crate::studies::sweep::table::Table;

/// Conventions of intervals and tests, in the order of [`Seen::intervals`].
pub const CONVENTIONS: [&str; 3] = ["robust", "asymptotic", "paper"];
/// Significance level of all tests.
pub const ALPHA: f64 = 0.01;

/// One parameter in one cell.
#[derive(Debug, Clone)]
pub struct Seen {
    pub cell: u64,
    pub system: String,
    /// Where several strengths are studied, the effect's own parameters say theirs.
    pub label: String,
    pub parameter: String,
    /// Its effect has strength 0.
    pub absent: bool,
    /// Strength of the effect, as a multiple of the study's values.
    pub strength: f64,
    /// Quantisation as a multiple of the sensors' steps.
    pub quantisation: f64,
    /// From 1 at the base; 0 for a motor.
    pub joint: u64,
    pub snr_db: f64,
    pub method: String,
    pub truth: f64,
    pub value: f64,
    /// low, high, p
    pub intervals: [[f64; 3]; 3],
    pub given: bool,
    pub kept: bool,
}

impl Seen {
    /// |value - truth| / |truth|; `None` where the truth is zero.
    pub fn error(&self) -> Option<f64> {
        (self.truth != 0.0).then(|| ((self.value - self.truth) / self.truth).abs())
    }

    /// A motor's SNR is that of all its channels; an arm keeps the noise of its encoders.
    pub fn noiseless(&self) -> bool {
        self.system == "motor" && self.snr_db.is_infinite()
    }

    pub fn held(&self, convention: usize) -> bool {
        let [low, high, _] = self.intervals[convention];
        low <= self.truth && self.truth <= high
    }

    /// Does the convention's test say that the parameter is not zero? Robust, and of Markov
    /// chains, only where the tool stands by it.
    pub fn told(&self, convention: usize) -> bool {
        (convention > 0 || self.given) && self.intervals[convention][2] <= ALPHA
    }

    /// Is it a term that could be absent?
    pub fn is_term(&self) -> bool {
        let others = ["static", "stribeck_velocity", "J", "K", "L", "R", "T_s", "omega_s"];
        !others.contains(&self.parameter.as_str())
    }
}

/// All rows that did not fail.
pub fn seen(cells: &Table) -> Vec<Seen> {
    let strengths = cells.numbers("strength");
    let several = strengths.iter().any(|s| Some(s) != strengths.first());
    let texts = |name: &str, i: usize| cells.texts(name).get(i).cloned().unwrap_or_default();
    let number = |name: &str, i: usize| cells.numbers(name).get(i).copied().unwrap_or(f64::NAN);
    let flag = |name: &str, i: usize| cells.flags(name).get(i).copied().unwrap_or(false);
    let row = |i: usize| {
        let parameter = texts("parameter", i);
        let own = several && belongs(&texts("effect", i), &parameter);
        let label = match own {
            true => format!("{parameter} x {}", strengths[i]),
            false => parameter.clone(),
        };
        let interval = |names: [&str; 3]| names.map(|name| number(name, i));
        Seen {
            cell: cells.wholes("cell").get(i).copied().unwrap_or(0),
            system: texts("system", i),
            label,
            parameter,
            absent: own && strengths[i] == 0.0,
            strength: number("strength", i),
            quantisation: number("quantisation", i),
            joint: cells.wholes("joint").get(i).copied().unwrap_or(0),
            snr_db: number("snr_db", i),
            method: texts("method", i),
            truth: number("truth", i),
            value: number("value", i),
            intervals: [
                interval(["low", "high", "p"]),
                interval(["asymptotic_low", "asymptotic_high", "asymptotic_p"]),
                interval(["paper_low", "paper_high", "paper_p"]),
            ],
            given: flag("given", i),
            kept: flag("kept", i),
        }
    };
    (0..cells.rows()).filter(|i| texts("failed", *i).is_empty()).map(row).collect()
}

fn belongs(effect: &str, parameter: &str) -> bool {
    let about = effects::find(effect).map(|e| e.about());
    about.is_some_and(|a| a.parameters.iter().any(|p| p.name == parameter))
}

/// Different texts in the order they come.
pub fn in_order<'a>(texts: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut all = Vec::new();
    for text in texts {
        if !all.contains(&text) {
            all.push(text);
        }
    }
    all
}
