//! `STUDY.toml`: a question, the arm or motor it is asked of, and the grids.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::grid::{Cell, Grid, Method, System};
use crate::diagnosis;
use crate::effects;
use crate::files::sha256;
use crate::identification::{BESIDE, PAPER_LAW, Terms, adaptive_metropolis, pso};
use crate::limits::read_settings;
use crate::motor;
use crate::robot::builtin;
use crate::simulation::Scenario;
use crate::studies::StudyError;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Question {
    /// Do parameters come back, do intervals hold them, which terms are found?
    Identification,
    /// Is the effect that a twin lacks named?
    Diagnosis,
    /// How do time and memory grow?
    Cost,
}

impl Question {
    fn methods(self) -> &'static [Method] {
        match self {
            Self::Identification => &[Method::Pso, Method::Nlse, Method::Mcmc],
            Self::Diagnosis => &[Method::Diagnosis],
            Self::Cost => {
                &[Method::Pso, Method::Nlse, Method::Mcmc, Method::Diagnosis, Method::Simulation]
            }
        }
    }
}

/// The file as written; unknown keys are errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    pub title: String,
    pub question: Question,
    /// Effects that are fitted, by name.
    #[serde(default = "usual_terms")]
    pub terms: Vec<String>,
    /// A scenario, as `armtwin simulate` takes it; grids change it.
    #[serde(default)]
    pub arm: Scenario,
    /// A scenario, as `armtwin motor` takes it.
    #[serde(default, skip_serializing_if = "toml::Table::is_empty")]
    pub motor: toml::Table,
    /// Settings of the swarm on the arm; the motor's are in its scenario.
    #[serde(default)]
    pub pso: pso::Settings,
    /// Settings of the Markov chains.
    #[serde(default)]
    pub mcmc: adaptive_metropolis::Settings,
    #[serde(default)]
    pub diagnosis: diagnosis::Settings,
    pub grid: Vec<Grid>,
}

fn usual_terms() -> Vec<String> {
    PAPER_LAW.into_iter().chain(BESIDE).map(String::from).collect()
}

impl Study {
    /// # Errors
    /// If the file cannot be read or is no study.
    pub fn load(path: &Path) -> Result<Self, StudyError> {
        let text = read_settings(path).map_err(StudyError::io(path, "read"))?;
        Self::parse(&text, path)
    }

    /// `file` names the text in messages.
    ///
    /// # Errors
    /// If the text is no study; the message names the key.
    pub fn parse(text: &str, file: &Path) -> Result<Self, StudyError> {
        let wrong = |problem: String| StudyError::file(file, problem);
        let study: Self = toml::from_str(text)
            .map_err(|e| wrong(format!("not a valid study: {}", e.to_string().trim_end())))?;
        study.check().map_err(wrong)?;
        Ok(study)
    }

    fn check(&self) -> Result<(), String> {
        if self.grid.is_empty() {
            return Err("no [[grid]]: give one, or there is nothing to do".into());
        }
        Terms::named(self.terms.iter().map(String::as_str)).map_err(|e| format!("terms: {e}"))?;
        let dof = builtin(&self.arm.robot).map(|robot| robot.dof());
        for (number, grid) in self.grid.iter().enumerate() {
            let checked = self.check_grid(grid, dof.unwrap_or(usize::MAX));
            checked.map_err(|e| format!("[[grid]] {}: {e}", number + 1))?;
        }
        if dof.is_none() {
            let robot = &self.arm.robot;
            return Err(format!("arm.robot = \"{robot}\": a study takes the built-in arms alone"));
        }
        if self.grid.iter().any(|g| g.system == System::Arm) {
            self.arm.work_out("[arm]").map_err(|e| e.to_string())?;
        }
        if self.grid.iter().any(|g| g.system == System::Motor) {
            self.motor().map_err(|e| e.to_string())?;
        }
        Ok(())
    }

    fn check_grid(&self, grid: &Grid, dof: usize) -> Result<(), String> {
        let allowed = self.question.methods();
        if grid.method.is_empty() {
            return Err("no method: give a list of them".into());
        }
        if let Some(m) = grid.method.iter().find(|m| !allowed.contains(m)) {
            let known: Vec<_> = allowed.iter().map(|m| m.name()).collect();
            let (m, known) = (m.name(), known.join(", "));
            return Err(format!("method {m} does not answer this question; choose from {known}"));
        }
        if grid.system == System::Motor && self.question != Question::Identification {
            return Err("only a study of identification takes the motor".into());
        }
        for name in grid.effect.iter().filter(|n| *n != NO_EFFECT) {
            if effects::find(name).is_none() {
                return Err(format!("no effect `{name}`; choose from {}", effects::names()));
            }
            if !self.arm.effects.contains_key(name) {
                return Err(format!("effect `{name}` needs a table [arm.effects.{name}]"));
            }
        }
        match grid {
            _ if grid.joints.iter().any(|n| *n == 0 || *n > dof) => {
                Err(format!("joints: give 1 to {dof}"))
            }
            _ if grid.terms.iter().any(|n| *n == 0 || *n > self.terms.len()) => {
                Err(format!("terms: give 1 to {}", self.terms.len()))
            }
            _ if grid.quantisation.iter().any(|q| !(*q >= 0.0 && q.is_finite())) => {
                Err("quantisation: give multiples of the steps, 0 or more".into())
            }
            _ if grid.system == System::Motor && !grid.quantisation.is_empty() => {
                Err("quantisation: the motor's sensors do not round".into())
            }
            _ if grid.particles.contains(&0) => Err("particles: give at least 1".into()),
            _ => Ok(()),
        }
    }

    /// # Errors
    /// If `[motor]` is no scenario.
    pub fn motor(&self) -> Result<motor::scenario::Scenario, StudyError> {
        let text = self.motor.to_string();
        Ok(motor::scenario::Scenario::parse(&text)?)
    }

    /// Does any cell need a second recording?
    pub fn diagnoses(&self) -> bool {
        self.grid.iter().any(|g| g.method.contains(&Method::Diagnosis))
    }

    pub fn cells(&self) -> usize {
        self.grid.iter().map(Grid::cells).sum()
    }

    /// # Panics
    /// Never for numbers below [`Study::cells`].
    pub fn cell(&self, number: usize) -> Cell {
        let mut before = 0;
        for grid in &self.grid {
            if number < before + grid.cells() {
                return grid.cell(number - before, number);
            }
            before += grid.cells();
        }
        self.grid[0].cell(0, number)
    }

    /// Cells that share a motion, block after block.
    pub fn blocks(&self) -> Vec<Vec<usize>> {
        let mut blocks = Vec::new();
        let mut before = 0;
        for grid in &self.grid {
            let numbers: Vec<usize> = (before..before + grid.cells()).collect();
            blocks.extend(numbers.chunks(grid.block()).map(<[usize]>::to_vec));
            before += grid.cells();
        }
        blocks
    }

    /// SHA-256 of everything that results depend on: settings and version, not comments.
    pub fn digest(&self) -> String {
        let all = serde_json::json!([env!("CARGO_PKG_VERSION"), self]);
        sha256(all.to_string().as_bytes())
    }
}

/// Word in the place of an effect: the arm as the twin knows it.
pub const NO_EFFECT: &str = "none";

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Study, String> {
        Study::parse(text, Path::new("s.toml")).map_err(|e| e.to_string())
    }

    const HEAD: &str = "title = \"t\"\nquestion = \"identification\"\n";

    #[test]
    fn cells_are_numbered_through_all_grids() {
        let text = format!(
            "{HEAD}[[grid]]\nseed = [1, 2]\nsnr_db = [10, 20.5, \"none\"]\nmethod = [\"nlse\"]\n\
             [[grid]]\nmethod = [\"pso\", \"mcmc\"]\n"
        );
        let study = parsed(&text).unwrap();
        assert_eq!(study.cells(), 8);
        assert_eq!(study.blocks(), [vec![0, 1, 2], vec![3, 4, 5], vec![6, 7]]);
        assert_eq!((study.cell(4).seed, study.cell(4).number), (2, 4));
        assert_eq!(study.cell(7).method, Method::Mcmc);
        let reordered = parsed(&format!("# a comment\n{text}")).unwrap();
        assert_eq!(study.digest(), reordered.digest());
        let other = parsed(&text.replace("20.5", "21")).unwrap();
        assert_ne!(study.digest(), other.digest());
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (grid, word) in [
            ("", "grid"),
            ("[[grid]]\nseed = [1]\n", "no method"),
            ("[[grid]]\nmethod = [\"diagnosis\"]\n", "diagnosis"),
            ("[[grid]]\nmethod = [\"nlse\"]\neffect = [\"paylod\"]\n", "paylod"),
            ("[[grid]]\nmethod = [\"nlse\"]\neffect = [\"payload\"]\n", "[arm.effects.payload]"),
            ("[[grid]]\nmethod = [\"nlse\"]\nsnr = [1]\n", "snr"),
            ("[[grid]]\nmethod = [\"nlse\"]\nsystem = \"motor\"\n", "motor"),
            ("[[grid]]\nmethod = [\"nlse\"]\njoints = [7]\n", "1 to 6"),
            ("[[grid]]\nmethod = [\"nlse\"]\nquantisation = [-1]\n", "0 or more"),
        ] {
            let error = parsed(&format!("{HEAD}{grid}")).unwrap_err();
            assert!(error.starts_with("s.toml: ") && error.contains(word), "{grid}: {error}");
        }
    }
}
