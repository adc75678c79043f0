//! What links' masses and the scale of torque take up within what they are known to: told, and put into the mended
//! twin, never silently.
//!
//! Beside the causes all links get a change of mass and of first moment, and each joint's torque a factor, each expected
//! to be as large as its tolerance; the same values act at all joints.

use super::candidate::{Candidate, Place, SCALE};
use super::fit::Fit;
use super::independent::LEVEL;
use super::limits::{Off, Stated};
use super::tolerances::{self, PER_LINK};
use super::{Cause, Checked, Settings, Value};
use crate::effects::{Effect, find};
use crate::regression::Blocks;
use crate::statistics::normal_quantile;

/// What the tolerances hold.
pub struct Within {
    /// With the size that is most likely of all together: for the mended twin.
    likely: Changes,
    /// As unsure as the twin is said to be: one link may be off and the others exact.
    unsure: Changes,
}

/// Changes of all links and of the scales of torque.
struct Changes {
    /// Of every link its mass (kg) and first moments (kg.m), in the order of `link_inertia`.
    links: Vec<Value>,
    /// Share by which each joint's recorded torque is larger.
    scales: Vec<Value>,
    /// Root mean square of what the changes of links give at each joint, N.m.
    taken_nm: Vec<f64>,
}

impl Within {
    /// `None` where the twin is exact.
    pub fn new(fit: &Fit<'_>) -> Option<Self> {
        let stated = Stated::new(fit)?;
        let [inertia, gain] = [find("link_inertia")?, find(SCALE)?];
        let z = normal_quantile(1.0 - LEVEL);
        let value = |effect: &dyn Effect, k: usize, joint: usize, off: &Off| {
            let p = &effect.about().parameters[k];
            let (name, unit) = (p.name.into(), p.unit.into());
            let Off { value, sd, .. } = *off;
            let [low, high] = [value - z * sd, value + z * sd];
            Value { name, joint: Some(joint), unit, value, low, high, at_bound: false }
        };
        let at = |share: f64| {
            let [links, scales] = stated.off(share);
            let of_link =
                |(i, off): (usize, &Off)| value(inertia, i % PER_LINK, i / PER_LINK + 1, off);
            let of_scale = |(j, off): (usize, &Off)| value(gain, 0, j + 1, off);
            let taken = |j: usize| taken_up(&stated, &links, j);
            Changes {
                links: links.iter().enumerate().map(of_link).collect(),
                scales: scales.iter().enumerate().map(of_scale).collect(),
                taken_nm: (0..fit.data.joints()).map(taken).collect(),
            }
        };
        let likely = tolerances::size(fit.sizes.tolerances);
        Some(Self { likely: at(likely), unsure: at(1.0) })
    }

    /// Factors on the torque that was recorded, joint by joint.
    pub fn scales(&self) -> Vec<f64> {
        self.likely.scales.iter().map(|v| 1.0 + v.value).collect()
    }

    /// What the mended twin has of it.
    pub fn adjustments(&self) -> Vec<Cause> {
        let Changes { links, scales, .. } = &self.likely;
        let place = Place::Links(scales.len());
        let all = [("link_inertia", &links[..]), (SCALE, &scales[..])];
        let adjustment = |(name, values): (&str, &[Value])| {
            let effect = find(name)?;
            Some(adjustment(Candidate::new(effect, place), values))
        };
        all.into_iter().filter_map(adjustment).collect()
    }

    /// In words; `None` where it is no more than noise.
    pub fn says(&self, fit: &Fit<'_>, settings: &Settings) -> Option<String> {
        let Settings { mass_error, centre_error_m, .. } = *settings;
        let bodies = &fit.data.twin.robot.bodies;
        let Changes { links, scales, taken_nm } = &self.unsure;
        let taken = taken_nm.iter().enumerate();
        let (joint, nm) = taken.max_by(|a, b| a.1.total_cmp(b.1))?;
        let masses = links.iter().step_by(PER_LINK).zip(bodies);
        let sure = masses.filter(|(v, _)| v.low > 0.0 || v.high < 0.0);
        let sure: Vec<String> =
            sure.map(|(v, b)| mass(v, &b.name, b.inertia.mass, mass_error)).collect();
        let links = if sure.is_empty() { "no link by itself".into() } else { sure.join(", ") };
        let known =
            format!("{:.0} %, centres to {:.0} mm", 100.0 * mass_error, 1e3 * centre_error_m);
        let largest = scales.iter().max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))?;
        let [scale, low, high] = [largest.value, largest.low, largest.high].map(|v| 100.0 * v);
        (nm.powi(2) > fit.data.least(joint)).then(|| {
            format!(
                "links' masses, known to {known}, take up {nm:.2} N.m at joint {}: {links}; with them the scale of \
                 torque, known to {:.0} %, of joint {}: {scale:+.1} % ({low:+.1} to {high:+.1}). Motions without a \
                 known load hardly tell the two apart; both are in the mended twin",
                joint + 1,
                100.0 * mass_error,
                largest.joint.unwrap_or(0)
            )
        })
    }
}

/// `link 3 +0.31 kg (+0.10 to +0.52; 13 %, more than the 5 % it is said to be known to)`
fn mass(change: &Value, link: &str, kg: f64, known_to: f64) -> String {
    let Value { value, low, high, .. } = change;
    let share = (value / kg).abs();
    let more = match share > known_to {
        true => format!(", more than the {:.0} % it is said to be known to", 100.0 * known_to),
        false => String::new(),
    };
    format!("{link} {value:+.2} kg ({low:+.2} to {high:+.2}; {:.0} %{more})", 100.0 * share)
}

/// What a twin's tolerances hold: no cause, and not told from nothing by itself.
fn adjustment(candidate: Candidate, values: &[Value]) -> Cause {
    let about = candidate.effect.about();
    Cause {
        effect: about.name.into(),
        joints: candidate.place.joints(),
        probability: 0.0,
        equivalent: Vec::new(),
        parameters: values.to_vec(),
        shrink: Checked::default(),
        replaces: None,
        recording: None,
        found_without_check: false,
        cause: about.cause.into(),
        remedy: about.remedy.into(),
    }
}

/// Root mean square of what the changes of links give at a joint, N.m.
fn taken_up(stated: &Stated<'_>, links: &[Off], joint: usize) -> f64 {
    let data = stated.fit.data;
    let mut sum = Blocks((0..data.joints()).map(|_| Vec::new()).collect());
    stated.raw.iter().zip(links).for_each(|(c, off)| sum.gather(off.value, &c.rows));
    (sum.squares()[joint] / data.count(joint).max(1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const LINK: usize = 2;

    /// What the tolerances hold of an arm whose link is heavier by a share of its mass.
    fn of_arm<T>(heavier: f64, with: impl FnOnce(Option<Within>, &Fit<'_>, &Settings) -> T) -> T {
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
        let plain = Fit::plain(&data, Model::of(&twin));
        let sizes = plain.likely_sizes(&[0, 1, 2, 3, 4, 5]);
        let fit = plain.beside(sizes);
        with(Within::new(&fit), &fit, &settings)
    }

    #[test]
    fn what_links_take_up_is_told() {
        let said = of_arm(0.04, |within, fit, settings| within?.says(fit, settings));
        let said = said.expect("a link that is 4 % heavier");
        assert!(said.contains("take up") && said.contains("N.m at joint"), "{said}");
    }

    #[test]
    fn of_an_exact_twin_nothing_is_told() {
        assert!(of_arm(0.0, |within, _, _| within.is_none()));
    }

    /// Masses of neighbouring links are told apart by little: each interval holds the truth all the
    /// same. So does that of a joint's scale of torque.
    #[test]
    fn intervals_hold_the_change() {
        const HEAVIER: f64 = 0.04;
        of_arm(HEAVIER, |within, fit, _| {
            let within = within.expect("a link that is 4 % heavier");
            let bodies = fit.data.twin.robot.bodies.iter();
            for (link, (v, body)) in
                within.unsure.links.iter().step_by(PER_LINK).zip(bodies).enumerate()
            {
                let truth = if link == LINK { HEAVIER * body.inertia.mass } else { 0.0 };
                assert!(v.low < truth && truth < v.high, "link {link}: {v:?}, {truth} kg");
            }
            for v in &within.unsure.scales {
                assert!(v.low < 0.0 && 0.0 < v.high, "{v:?}");
            }
        });
    }

    /// All links heavier by as much look like torque that is recorded too large: what the two come to together is
    /// told.
    #[test]
    fn the_mended_twin_has_what_was_taken_up() {
        const HEAVIER: f64 = 0.04;
        of_arm(HEAVIER, |within, fit, _| {
            let mended = crate::diagnosis::mend(
                fit.data.twin,
                &std::collections::BTreeMap::new(),
                &within.unwrap().adjustments(),
            );
            let samples = fit.data.parts[0].samples;
            let torque = |twin: &Twin| twin.torque(&twin.motion(samples));
            let [mended, given] = [torque(&mended), torque(fit.data.twin)];
            let gap = |torque: &crate::series::JointSeries| {
                let pairs = samples.torque.joint(1).iter().zip(torque.joint(1));
                pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
            };
            assert!(gap(&mended) < 0.8 * gap(&given), "{} {}", gap(&mended), gap(&given));
        });
    }
}
