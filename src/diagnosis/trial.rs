//! A candidate with values, tried on a fit.

use std::sync::Arc;

use super::candidate::{Candidate, Term};
use super::fit::{Fit, expected};
use crate::regression::{Column, bounds::Bounds};
use crate::twin::Twin;

/// Share of the distance between starts: a value that is closer to a start has hardly left it.
const AWAY: f64 = 0.25;

/// A candidate with values, and what it gains in log-likelihood over the fit it is added to.
#[derive(Debug, Clone)]
pub struct Trial {
    pub candidate: Candidate,
    pub linear: Vec<f64>,
    pub nonlinear: Vec<f64>,
    pub gain: f64,
    /// Half the weighted squares of the residual where it acts: no gain is larger.
    pub most: f64,
    /// Where the search began.
    pub starts: Arc<Vec<Vec<f64>>>,
}

impl Trial {
    /// The candidate at one of its starts, not tried yet.
    pub fn at(candidate: Candidate, nonlinear: Vec<f64>, starts: Arc<Vec<Vec<f64>>>) -> Self {
        let (gain, most) = (f64::NEG_INFINITY, 0.0);
        Self { candidate, linear: vec![], nonlinear, gain, most, starts }
    }

    pub fn term(&self) -> Term {
        let held = self.linear.iter().map(|v| *v == 0.0).collect();
        let (candidate, nonlinear) = (self.candidate, self.nonlinear.clone());
        let (linear, searched) = (self.linear.clone(), self.searched());
        let starts = self.starts.len();
        Term { linear, searched, held, starts, ..Term::new(candidate, nonlinear) }
    }

    /// Log-likelihood it is ahead of other values of the same candidate, nats: gains are in units of
    /// what there was before, of which the better one may leave little.
    pub fn ahead_of(&self, other: &Self) -> f64 {
        let left = (self.most - self.gain).max(f64::MIN_POSITIVE);
        (self.gain - other.gain) * (self.most / left).max(1.0)
    }

    /// The nonlinear parameters that are searched: those that differ among the starts.
    pub fn searched(&self) -> Vec<usize> {
        let starts = &self.starts;
        let differs = |i: &usize| starts.iter().any(|s| s[*i] != starts[0][*i]);
        (0..self.nonlinear.len()).filter(differs).collect()
    }
}

/// A term of a model as a trial on the fit without it.
pub fn tried(fit: &Fit<'_>, term: &Term) -> Trial {
    let starts = Arc::new(term.candidate.starts(&fit.motion(), fit.data.twin));
    let at = Trial::at(term.candidate, term.nonlinear.clone(), starts);
    evaluate(fit, &at, term.nonlinear.clone())
}

/// Bounds of the linear parameters.
pub fn linear_bounds(candidate: Candidate, twin: &Twin) -> Bounds {
    let ranges = (0..candidate.linear()).map(|i| candidate.range(i, twin));
    let (lower, upper) = ranges.map(|[min, max]| (min, max)).unzip();
    Bounds::new(lower, upper).unwrap_or_else(|_| Bounds::unbounded(candidate.linear()))
}

/// The trial at other nonlinear parameters.
pub fn evaluate(fit: &Fit<'_>, trial: &Trial, nonlinear: Vec<f64>) -> Trial {
    let at = Trial { nonlinear, ..trial.clone() };
    match at.candidate.senses() {
        true => with_sensor(fit, at),
        false => with_columns(fit, at),
    }
}

fn with_columns(fit: &Fit<'_>, at: Trial) -> Trial {
    let raw = fit.raw(at.candidate, &at.nonlinear);
    let columns = Column::all(&raw, &fit.metric);
    let priors = expected(fit.data, at.candidate, &at.nonlinear, &raw);
    let projected = fit.system.project(&columns, &priors);
    let (linear, gain) = projected.solve(&linear_bounds(at.candidate, fit.data.twin));
    Trial { linear: linear.as_slice().to_vec(), gain, most: most(fit, &columns), ..at }
}

/// Half the weighted squares of what `fit` leaves at the joints that columns touch.
fn most(fit: &Fit<'_>, columns: &[Column]) -> f64 {
    let touched = |j: &usize| columns.iter().any(|c| c.touches(*j));
    let joints = (0..fit.squares.len()).filter(touched);
    joints.map(|j| 0.5 * fit.system.weights[j] * fit.squares[j]).sum()
}

/// A sensor changes every column: everything is fitted again.
fn with_sensor(fit: &Fit<'_>, at: Trial) -> Trial {
    let new = Fit::new(fit.data, fit.model.with(at.term()), fit.sizes.clone());
    let weights = &fit.system.weights;
    let change = fit.squares.iter().zip(&new.squares).zip(weights);
    let gain = change.map(|((before, after), w)| 0.5 * w * (before - after)).sum();
    Trial { gain, ..at }
}

/// Standard deviations of a trial's linear parameters, its nonlinear ones given and all others free,
/// in the noise that the trial leaves.
pub fn spread(fit: &Fit<'_>, trial: &Trial) -> Vec<f64> {
    let columns = fit.columns(trial.candidate, &trial.nonlinear);
    let most = trial.most.max(f64::MIN_POSITIVE);
    let noise = ((trial.most - trial.gain) / most).clamp(0.0, 1.0);
    let projected = fit.system.project(&columns, &vec![f64::INFINITY; columns.len()]);
    projected.variances().into_iter().map(|v| (noise * v).sqrt()).collect()
}

/// Is parameter `i` a reference that follows from the linear ones?
pub fn settled(trial: &Trial, i: usize) -> bool {
    let mut moved = trial.nonlinear.clone();
    let linear: Vec<f64> = trial.linear.iter().map(|v| 1.7 * v + 1e-3).collect();
    trial.candidate.settle(&linear, &mut moved);
    moved[i] != trial.nonlinear[i]
}

/// The starts next to the value of nonlinear parameter `i`, other than one it hardly left; beyond
/// the last one as far as to the one before, within the range.
pub fn neighbours(trial: &Trial, i: usize, twin: &Twin) -> [f64; 2] {
    let [min, max] = trial.candidate.range(trial.candidate.linear() + i, twin);
    let now = trial.nonlinear[i];
    if let Some(ends) = trial.candidate.effect.bracket(&trial.nonlinear, i) {
        return ends.map(|end| end.clamp(min, max));
    }
    // Evenly spaced in ratio or difference.
    let by_ratio = min > 0.0;
    let scale = |x: f64| if by_ratio { x.ln() } else { x };
    let mut starts: Vec<f64> = trial.starts.iter().map(|s| scale(s[i])).collect();
    starts.sort_by(f64::total_cmp);
    let gaps = starts.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap > 0.0);
    let (now, away) = (scale(now), AWAY * gaps.fold(f64::INFINITY, f64::min));
    let below = starts.iter().rfind(|s| **s < now - away);
    let above = starts.iter().find(|s| **s > now + away);
    let [low, high] = match (below, above) {
        (Some(below), Some(above)) => [*below, *above],
        (Some(below), None) => [*below, 2.0 * now - below],
        (None, Some(above)) => [2.0 * now - above, *above],
        (None, None) => return [min, max],
    };
    [low, high].map(|end| if by_ratio { end.exp() } else { end }.clamp(min, max))
}
