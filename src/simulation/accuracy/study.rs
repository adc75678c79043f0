//! All measurements together, and the page they make.

use super::{AccuracyError, Balance, Bench, Consistency, Deviation, Friction};
use super::{balance, consistency, creep, deviations};
use crate::robot::Robot;
use crate::simulation::setup::Clock;
use crate::simulation::{Experiment, truth};

/// Everything docs/accuracy.md reports, except durations.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Study {
    pub viscous: Vec<Deviation>,
    pub dry: Vec<Deviation>,
    pub consistency: Vec<Consistency>,
    pub noise_nm: Vec<f64>,
    pub energy: Vec<Balance>,
    pub creep: Vec<Creep>,
}

#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Creep {
    pub step_s: f64,
    /// rad after 2 s at half of the breakaway torque, and at 1.05 times that torque.
    pub held_rad: f64,
    pub released_rad: f64,
}

/// Microseconds, measured by whoever has a clock.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Costs {
    pub rapier_us: f64,
    pub closed_loop_us: f64,
    pub reference_us: f64,
}

const STEPS_S: [f64; 5] = [2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4];
const DURATION_S: f64 = 10.0;
const POSE_RAD: [f64; 6] = [0.0, -1.6, 1.1, -1.2, -1.5, 0.0];

impl Study {
    /// On the UR5 and along the first recording of `made`; takes about a minute. `watch` is told
    /// what comes next.
    pub fn run(
        robot: &Robot,
        made: &Experiment,
        watch: &mut dyn FnMut(&str),
    ) -> Result<Self, AccuracyError> {
        let bench = |dry, viscous| Bench::new(robot.clone(), Friction { dry, viscous });
        let both = bench(1.0, 1.0);
        watch("smooth motion against the reference");
        let viscous = deviations(&bench(0.0, 1.0), DURATION_S, &STEPS_S)?;
        watch("motion with stick-slip against the reference");
        let dry = deviations(&both, DURATION_S, &STEPS_S)?;
        watch("torque consistency");
        let consistency = STEPS_S.iter().map(|&step_s| consistent(made, step_s));
        let consistency = consistency.collect::<Result<Vec<_>, _>>()?;
        watch("energy and stiction");
        let energy = STEPS_S.iter().map(|&h| balance(&both, DURATION_S, h));
        let creep = STEPS_S.iter().map(|&step_s| {
            Ok(Creep {
                step_s,
                held_rad: creep(&both, &POSE_RAD, 0.5, 2.0, step_s)?,
                released_rad: creep(&both, &POSE_RAD, 1.05, 2.0, step_s)?,
            })
        });
        Ok(Self {
            viscous,
            dry,
            noise_nm: noise(made, &consistency),
            consistency,
            energy: energy.collect::<Result<_, _>>()?,
            creep: creep.collect::<Result<_, AccuracyError>>()?,
        })
    }
}

/// With the controller at the same rate, whatever the step.
fn consistent(made: &Experiment, step_s: f64) -> Result<Consistency, AccuracyError> {
    let mut setup = made.setup.clone();
    let times = setup.clock.step_s / step_s;
    let scaled = |steps: usize| (steps as f64 * times).round() as usize;
    setup.clock = Clock {
        step_s,
        steps_per_hold: scaled(setup.clock.steps_per_hold),
        steps_per_sample: scaled(setup.clock.steps_per_sample),
    };
    Ok(consistency(&setup, &made.fit)?)
}

/// The torque noise of the scenario, to hold the residuals against.
fn noise(made: &Experiment, rows: &[Consistency]) -> Vec<f64> {
    let ratio = made.setup.noise.snr_db.map_or(0.0, |db| 10f64.powf(-db / 20.0));
    rows.first().map_or(Vec::new(), |r| r.torque_nm.iter().map(|rms| rms * ratio).collect())
}

impl Study {
    /// docs/accuracy.md.
    pub fn page(&self, costs: &Costs) -> String {
        let program = truth::program();
        format!(
            include_str!("page.md"),
            version = program.version,
            rapier = program.rapier,
            viscous = against_reference(&self.viscous),
            dry = against_reference(&self.dry),
            consistency = self.consistency_table(),
            energy = self.energy_table(),
            creep = self.creep_table(),
            rapier_us = costs.rapier_us,
            closed_loop_us = costs.closed_loop_us,
            reference_us = costs.reference_us,
            duration = DURATION_S,
        )
    }

    fn consistency_table(&self) -> String {
        let cells = |x: &[f64]| x.iter().map(|x| format!(" {x:.5} |")).collect::<String>();
        let mut text =
            String::from("| | joint 1 | 2 | 3 | 4 | 5 | 6 |\n|---|---|---|---|---|---|---|\n");
        for row in &self.consistency {
            text += &format!("| {} ms |{}\n", 1e3 * row.step_s, cells(&row.residual_nm));
        }
        text += &format!("| noise of the sensors |{}\n", cells(&self.noise_nm));
        if let Some(row) = self.consistency.first() {
            text += &format!("| torque |{}\n", cells(&row.torque_nm));
        }
        text.trim_end().into()
    }

    fn energy_table(&self) -> String {
        let mut text = String::from(
            "| step | work, J | stored, J | heat, J | left open |\n|---|---|---|---|---|\n",
        );
        for b in &self.energy {
            let (ms, open) = (1e3 * b.step_s, 100.0 * b.open_share());
            let Balance { work, stored, heat, .. } = b;
            text += &format!("| {ms} ms | {work:.4} | {stored:.4} | {heat:.4} | {open:.4} % |\n");
        }
        text.trim_end().into()
    }

    fn creep_table(&self) -> String {
        let mut text =
            String::from("| step | held: crept, rad | released: moved, rad |\n|---|---|---|\n");
        for c in &self.creep {
            let Creep { held_rad, released_rad, .. } = c;
            text += &format!("| {} ms | {held_rad:.1e} | {released_rad:.3} |\n", 1e3 * c.step_s);
        }
        text.trim_end().into()
    }
}

fn against_reference(rows: &[Deviation]) -> String {
    let mut text = String::from("| step | largest error, rad | order |\n|---|---|---|\n");
    for row in rows {
        let order = row.order.map_or(String::new(), |o| format!("{o:.2}"));
        text += &format!("| {} ms | {:.2e} | {order} |\n", 1e3 * row.step_s, row.position_rad);
    }
    text.trim_end().into()
}
