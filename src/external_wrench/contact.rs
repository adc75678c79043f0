//! A stretch in which something touches, as a contact: where, when, how strong.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::Criteria;
use super::left::Friction;
use super::model::{Mode, Steps};
use super::places::Place;
use super::smooth::{Smoothed, log_evidence, smooth};

/// Somebody pushes, a tool touches, a wall is in the way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    pub recording: String,
    /// Beginning and end of the contact in the recording, s.
    pub start_s: f64,
    pub end_s: f64,
    /// Link that is touched, from 1 at the base: the most probable one.
    pub link: usize,
    pub link_probability: f64,
    /// Probability of every link, base to wrist; sums to 1.
    pub links: Vec<f64>,
    /// Joints, from 1, that feel more of it at its peak than what the twin leaves without it.
    pub joints: Vec<usize>,
    /// Point of the link at which it is thought to act, in the link's frame, m.
    pub point_m: [f64; 3],
    pub peak_time_s: f64,
    /// Largest force, N, and its standard deviation, in which other places have their part.
    pub peak_n: f64,
    pub peak_sd_n: f64,
    /// Force on the arm at its peak, N, base axes.
    pub force_n: [f64; 3],
    /// Integral of the force's size over time, N.s.
    pub impulse_ns: f64,
    pub trace: Vec<Instant>,
    /// Share of the stretch's squared residual, in variances of what the twin leaves, that this force
    /// takes off.
    pub explained: f64,
    /// Log-evidence for this contact over none, nats, its probability beforehand counted in.
    pub log_odds: f64,
}

impl Contact {
    /// Counts time from elsewhere: all times grow by so much, s.
    pub fn shift(&mut self, by_s: f64) {
        let Self { start_s, end_s, peak_time_s, trace, .. } = self;
        let all = trace.iter_mut().map(|instant| &mut instant.time_s);
        all.chain([start_s, end_s, peak_time_s]).for_each(|time| *time += by_s);
    }
}

/// Size of a force at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Instant {
    pub time_s: f64,
    pub force_n: f64,
    pub sd_n: f64,
}

/// A stretch of steps that something touches, and what is known around it.
pub struct Stretch<'a> {
    pub recording: &'a str,
    pub steps: &'a Steps,
    pub places: &'a [Place],
    pub times: &'a [f64],
    pub criteria: &'a Criteria,
    /// The whole course.
    pub modes: &'a [Mode],
    pub from: usize,
    pub until: usize,
    /// Log-probability beforehand that a contact begins somewhere and ends, beside none.
    pub beforehand: f64,
}

impl Stretch<'_> {
    pub fn contact(&self) -> Contact {
        let touched = |place: Mode| {
            let mut modes = self.modes.to_vec();
            modes[self.from..self.until].fill(place);
            modes
        };
        let evidence: Vec<f64> = (0..self.places.len())
            .map(|place| log_evidence(self.steps, &touched(Some(place))))
            .collect();
        let weights = weights(self.places, &self.tempered(&evidence));
        let smoothed: Vec<Smoothed> = weights
            .iter()
            .enumerate()
            .filter(|(_, weight)| **weight > NEGLIGIBLE)
            .map(|(place, _)| smooth(self.steps, &touched(Some(place))))
            .collect();
        let kept: Vec<usize> = (0..weights.len()).filter(|i| weights[*i] > NEGLIGIBLE).collect();
        let links = links(self.places, &weights, self.steps.joints);
        let link = largest(&links);
        let first = (0..kept.len())
            .filter(|i| self.places[kept[*i]].link == link)
            .max_by(|a, b| weights[kept[*a]].total_cmp(&weights[kept[*b]]))
            .unwrap_or(0);
        let (place, best) = (kept[first], &smoothed[first]);
        let peak = self.peak(best);
        let (force, covariance) = &best.force[peak];
        let along = along(force, covariance);
        let others: f64 = kept
            .iter()
            .zip(&smoothed)
            .map(|(i, other)| {
                let (f, c) = &other.force[self.peak(other)];
                weights[*i] * (self::along(f, c) + (f.norm() - force.norm()).powi(2))
            })
            .sum();
        let without = log_evidence(self.steps, &touched(None));
        Contact {
            recording: self.recording.into(),
            start_s: self.times[self.from],
            end_s: self.times[self.until - 1],
            link: link + 1,
            link_probability: links[link],
            links,
            joints: self.joints(place, peak, force),
            point_m: self.places[place].point.into(),
            peak_time_s: self.times[peak],
            peak_n: force.norm(),
            peak_sd_n: others.max(along).sqrt(),
            force_n: (*force).into(),
            impulse_ns: self.inside().map(|k| best.force[k].0.norm() * self.steps.dt).sum(),
            trace: self.inside().map(|k| self.instant(best, k)).collect(),
            explained: self.explained(place, best),
            log_odds: evidence[place] - without + self.beforehand,
        }
    }

    fn inside(&self) -> std::ops::Range<usize> {
        self.from..self.until
    }

    /// What the twin leaves is systematic for as long as a force lasts: evidence that gathers in
    /// that time is counted once. At rest friction takes its share of a push as a whole: there the
    /// whole contact is counted once.
    fn tempered(&self, evidence: &[f64]) -> Vec<f64> {
        let rests = self.steps.friction[self.from].iter().all(|f| *f == Friction::Rests);
        let whole = if rests { self.inside().len() as f64 * self.steps.dt } else { 0.0 };
        let once = (self.steps.dt / self.criteria.force_s.max(whole)).min(1.0);
        evidence.iter().map(|e| once * e).collect()
    }

    fn peak(&self, smoothed: &Smoothed) -> usize {
        let size = |k: &usize| smoothed.force[*k].0.norm();
        self.inside().max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(self.from)
    }

    fn instant(&self, smoothed: &Smoothed, k: usize) -> Instant {
        let (force, covariance) = &smoothed.force[k];
        let (force_n, sd_n) = (force.norm(), along(force, covariance).sqrt());
        Instant { time_s: self.times[k], force_n, sd_n }
    }

    fn joints(&self, place: usize, k: usize, force: &Vector3<f64>) -> Vec<usize> {
        let felt = |j: &usize| {
            let lever = Vector3::from(self.steps.levers[place][k][*j]);
            lever.dot(force).abs() > self.steps.spread[k][*j]
        };
        (0..self.steps.joints).filter(felt).map(|j| j + 1).collect()
    }

    fn explained(&self, place: usize, smoothed: &Smoothed) -> f64 {
        let (mut before, mut after) = (0.0, 0.0);
        for k in self.inside() {
            for j in 0..self.steps.joints {
                let scale = self.steps.spread[k][j].powi(2) + self.steps.white[k][j];
                let lever = Vector3::from(self.steps.levers[place][k][j]);
                let gap = self.steps.residual[k][j];
                before += gap.powi(2) / scale;
                after += (gap + lever.dot(&smoothed.force[k].0)).powi(2) / scale;
            }
        }
        1.0 - after / before.max(f64::MIN_POSITIVE)
    }
}

/// Places less probable than this have no part in a peak's uncertainty.
const NEGLIGIBLE: f64 = 1e-3;

/// Variance of a force's size: of the force along itself.
fn along(force: &Vector3<f64>, covariance: &nalgebra::Matrix3<f64>) -> f64 {
    let direction = force.try_normalize(0.0).unwrap_or_else(Vector3::x);
    direction.dot(&(covariance * direction)).max(0.0)
}

/// Probabilities of the places: all links alike beforehand, all places of a link alike.
fn weights(places: &[Place], evidence: &[f64]) -> Vec<f64> {
    let top = evidence.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let alike = |place: &Place| places.iter().filter(|p| p.link == place.link).count() as f64;
    let raw: Vec<f64> =
        places.iter().zip(evidence).map(|(p, e)| (e - top).exp() / alike(p)).collect();
    let sum: f64 = raw.iter().sum();
    raw.into_iter().map(|w| w / sum).collect()
}

fn links(places: &[Place], weights: &[f64], joints: usize) -> Vec<f64> {
    let mut links = vec![0.0; joints];
    places.iter().zip(weights).for_each(|(place, weight)| links[place.link] += weight);
    links
}

fn largest(values: &[f64]) -> usize {
    (0..values.len()).max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0)
}
