//! What links' masses take up within what they are known to: never silently.
//!
//! Beside the causes all links get a change of mass and of first moment, each expected to be as large
//! as the twin's values are said to be unsure; the same values act at all joints.

use super::Settings;
use super::discrepancy::{MASSES, mass_errors};
use super::fit::Fit;
use super::independent::LEVEL;
use super::observed::Observed;
use crate::regression::bounds::Bounds;
use crate::regression::{Blocks, Column, Raw};
use crate::robot::{Body, body_regressor_series};
use crate::statistics::normal_quantile;

/// A link that is heavier or lighter than the twin's.
struct Change<'a> {
    link: &'a str,
    kg: f64,
    /// Half the width of its 90 % interval, kg.
    half: f64,
    /// Change as a share of the link's mass.
    share: f64,
}

/// What links' masses take up beside the causes, in words; `None` where that is no more than noise.
pub fn says(fit: &Fit<'_>, settings: &Settings) -> Option<String> {
    let Settings { mass_error, centre_error_m, .. } = *settings;
    if mass_error <= 0.0 {
        return None;
    }
    let (changes, taken_nm) = changes(fit, settings);
    let (joint, nm) = taken_nm.into_iter().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let sure = changes.iter().filter(|c| c.kg.abs() > c.half);
    let sure: Vec<String> = sure.map(|c| c.says(mass_error)).collect();
    let links = if sure.is_empty() { "no link by itself".into() } else { sure.join(", ") };
    let known = format!("{:.0} %, centres to {:.0} mm", 100.0 * mass_error, 1e3 * centre_error_m);
    (nm.powi(2) > fit.data.least(joint)).then(|| {
        format!(
            "links' masses, known to {known}, take up {nm:.2} N.m at joint {}: {links}",
            joint + 1
        )
    })
}

/// Change of every link, and the torque that all changes together give at each joint (root mean square, N.m).
fn changes<'a>(fit: &Fit<'a>, settings: &Settings) -> (Vec<Change<'a>>, Vec<f64>) {
    // They stand for themselves here.
    let mut sizes = fit.sizes.clone();
    sizes.iter_mut().for_each(|s| s[MASSES] = 0);
    let fit = fit.clone().beside(sizes);
    let bodies = &fit.data.twin.robot.bodies;
    let raw: Vec<Raw> = (0..bodies.len()).flat_map(|link| columns(&fit, link)).collect();
    let columns: Vec<Column> = raw.iter().map(|c| Column::new(c, &fit.metric)).collect();
    let expected: Vec<f64> = bodies.iter().flat_map(|b| mass_errors(b, settings)).collect();
    let projected = fit.system.project(&columns, &expected);
    let (x, _) = projected.solve(&Bounds::unbounded(columns.len()));
    let variances = projected.variances();
    let z = normal_quantile(1.0 - LEVEL);
    let change = |(link, body): (usize, &'a Body)| Change {
        link: &body.name,
        kg: x[4 * link],
        half: z * variances[4 * link].sqrt(),
        share: x[4 * link] / body.inertia.mass,
    };
    let changes = bodies.iter().enumerate().map(change).collect();
    let taken = |j: usize| taken_up(&fit, &raw, x.as_slice(), j);
    (changes, (0..fit.data.joints()).map(taken).collect())
}

impl Change<'_> {
    /// `link 3 +0.31 kg (13 %, more than the 5 % it is said to be known to)`
    fn says(&self, known_to: f64) -> String {
        let Self { link, kg, half, share } = self;
        let percent = 100.0 * share.abs();
        let more = match share.abs() > known_to {
            true => format!(", more than the {:.0} % it is said to be known to", 100.0 * known_to),
            false => String::new(),
        };
        format!("{link} {kg:+.2} kg ({:+.2} to {:+.2}; {percent:.0} %{more})", kg - half, kg + half)
    }
}

/// Torque per unit of a link's mass and first moments, at the rows.
fn columns(fit: &Fit<'_>, link: usize) -> Vec<Raw> {
    let part = |p: &&Observed<'_>| {
        let samples = p.samples;
        let robot = &p.twin.robot;
        let all = body_regressor_series(robot, &samples.q, &samples.qd, &samples.qdd, link);
        let rows =
            |i: usize| Blocks((0..p.joints()).map(|j| p.block(j, all[i].joint(j))).collect());
        (0..4).map(rows).collect::<Vec<Blocks>>()
    };
    let parts: Vec<Vec<Blocks>> = fit.data.parts.iter().map(part).collect();
    (0..4).map(|i| fit.data.raw(parts.iter().map(|p| p[i].clone()).collect())).collect()
}

/// Root mean square of what the changes give at a joint, N.m.
fn taken_up(fit: &Fit<'_>, columns: &[Raw], x: &[f64], joint: usize) -> f64 {
    let mut sum = Blocks((0..fit.data.joints()).map(|_| Vec::new()).collect());
    columns.iter().zip(x).for_each(|(c, x)| sum.gather(*x, &c.rows));
    (sum.squares()[joint] / fit.data.count(joint).max(1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const LINK: usize = 2;

    /// The fit of a twin to an arm whose link is heavier by a share of its mass, seen `with` it.
    fn of_arm<T>(heavier: f64, with: impl FnOnce(&Fit<'_>, &Settings) -> T) -> T {
        let twin = Twin::default();
        let mut arm = twin.clone();
        arm.robot.bodies[LINK].inertia.mass *= 1.0 + heavier;
        let mut made = samples(6, 4000, |j, t| 0.7 * ((0.9 + 0.2 * j as f64) * t).sin());
        made.torque = arm.torque(&arm.motion(&made));
        noisy(&mut made, 0.3);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let settings = Settings::default();
        let data = Data::new(vec![&observed], &settings);
        with(&Fit::plain(&data, Model::of(&twin)), &settings)
    }

    #[test]
    fn what_links_take_up_is_told() {
        let said = of_arm(0.04, says).expect("a link that is 4 % heavier");
        assert!(said.contains("take up") && said.contains("N.m at joint"), "{said}");
    }

    #[test]
    fn of_an_exact_twin_nothing_is_told() {
        assert_eq!(of_arm(0.0, says), None);
    }

    /// Masses of neighbouring links are told apart by little: each interval holds the truth all the
    /// same.
    #[test]
    fn intervals_hold_the_change() {
        const HEAVIER: f64 = 0.04;
        of_arm(HEAVIER, |fit, settings| {
            for (link, change) in changes(fit, settings).0.iter().enumerate() {
                let mass = fit.data.twin.robot.bodies[link].inertia.mass;
                let truth = if link == LINK { HEAVIER * mass } else { 0.0 };
                let (kg, half) = (change.kg, change.half);
                assert!((kg - truth).abs() < half, "link {link}: {kg} +- {half}, {truth} kg");
            }
        });
    }
}
