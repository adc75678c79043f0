//! The grids of a study and their cells.

use serde::{Deserialize, Serialize};

use crate::motion::Kind;

/// Signal-to-noise ratio of the current (arm) or of all channels (motor), dB.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Snr {
    Db(f64),
    Word(Clean),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Clean {
    None,
}

impl Snr {
    /// Infinite where there is no noise.
    pub fn db(self) -> f64 {
        match self {
            Self::Db(db) => db,
            Self::Word(Clean::None) => f64::INFINITY,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum System {
    /// `[arm]`
    #[default]
    Arm,
    /// `[motor]`
    Motor,
}

impl System {
    pub fn name(self) -> &'static str {
        match self {
            Self::Arm => "arm",
            Self::Motor => "motor",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    Pso,
    Nlse,
    Mcmc,
    Diagnosis,
    /// The motion alone, in a cost study.
    Simulation,
}

impl Method {
    pub fn name(self) -> &'static str {
        match self {
            Self::Pso => "pso",
            Self::Nlse => "nlse",
            Self::Mcmc => "mcmc",
            Self::Diagnosis => "diagnosis",
            Self::Simulation => "simulation",
        }
    }
}

/// The product of its axes; one left out has a single entry: what `[arm]` or `[motor]` says.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Grid {
    pub system: System,
    /// Names of `[arm.effects]` tables, or "none".
    pub effect: Vec<String>,
    /// Multiples of the effect's values.
    pub strength: Vec<f64>,
    pub trajectory: Vec<Kind>,
    pub duration_s: Vec<f64>,
    pub rate_hz: Vec<f64>,
    /// Numbers of joints that are fitted, counted from the base.
    pub joints: Vec<usize>,
    /// Numbers of the study's `terms` that are taken, in their order.
    pub terms: Vec<usize>,
    pub seed: Vec<u64>,
    /// Multiples of the steps of `[arm.quantisation]`; 0 rounds nothing.
    pub quantisation: Vec<f64>,
    pub snr_db: Vec<Snr>,
    pub method: Vec<Method>,
    /// Particles of a swarm, per parameter.
    pub particles: Vec<usize>,
}

/// One point of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Number of the cell, from 0 through all grids.
    pub number: usize,
    pub system: System,
    pub effect: Option<String>,
    pub strength: f64,
    pub trajectory: Option<Kind>,
    pub duration_s: Option<f64>,
    pub rate_hz: Option<f64>,
    pub joints: Option<usize>,
    pub terms: Option<usize>,
    pub seed: u64,
    pub quantisation: f64,
    pub snr_db: Option<Snr>,
    pub method: Method,
    pub particles: Option<usize>,
}

impl Grid {
    /// Lengths of the axes, slowest first; the last four share a motion.
    fn lengths(&self) -> [usize; 12] {
        [
            self.effect.len(),
            self.strength.len(),
            self.trajectory.len(),
            self.duration_s.len(),
            self.rate_hz.len(),
            self.joints.len(),
            self.terms.len(),
            self.seed.len(),
            self.quantisation.len(),
            self.snr_db.len(),
            self.method.len(),
            self.particles.len(),
        ]
        .map(|n| n.max(1))
    }

    pub fn cells(&self) -> usize {
        self.lengths().iter().product()
    }

    /// Cells that share a motion.
    pub fn block(&self) -> usize {
        self.lengths()[8..].iter().product()
    }

    /// The `index`-th point of this grid, numbered `number` in the study.
    pub fn cell(&self, index: usize, number: usize) -> Cell {
        let lengths = self.lengths();
        let mut at = [0; 12];
        let mut left = index;
        for axis in (0..lengths.len()).rev() {
            at[axis] = left % lengths[axis];
            left /= lengths[axis];
        }
        Cell {
            number,
            system: self.system,
            effect: self.effect.get(at[0]).cloned(),
            strength: self.strength.get(at[1]).copied().unwrap_or(1.0),
            trajectory: self.trajectory.get(at[2]).copied(),
            duration_s: self.duration_s.get(at[3]).copied(),
            rate_hz: self.rate_hz.get(at[4]).copied(),
            joints: self.joints.get(at[5]).copied(),
            terms: self.terms.get(at[6]).copied(),
            seed: self.seed.get(at[7]).copied().unwrap_or(1),
            quantisation: self.quantisation.get(at[8]).copied().unwrap_or(1.0),
            snr_db: self.snr_db.get(at[9]).copied(),
            method: self.method.get(at[10]).copied().unwrap_or(Method::Nlse),
            particles: self.particles.get(at[11]).copied(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_comes_once_and_those_of_a_motion_together() {
        let grid = Grid {
            strength: vec![0.5, 1.0],
            seed: vec![1, 2, 3],
            snr_db: vec![Snr::Db(10.0), Snr::Word(Clean::None)],
            method: vec![Method::Nlse, Method::Pso],
            ..Grid::default()
        };
        assert_eq!((grid.cells(), grid.block()), (24, 4));
        let cells: Vec<Cell> = (0..24).map(|i| grid.cell(i, i)).collect();
        for (i, a) in cells.iter().enumerate() {
            let same =
                |b: &&Cell| Cell { number: 0, ..(*b).clone() } == Cell { number: 0, ..a.clone() };
            assert_eq!(cells.iter().filter(same).count(), 1);
            let first = &cells[i / 4 * 4];
            assert_eq!((a.seed, a.strength), (first.seed, first.strength));
        }
        assert_eq!(cells[3].snr_db.map(Snr::db), Some(f64::INFINITY));
    }
}
