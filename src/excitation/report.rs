//! What a designed motion tells, beside random sines, and how far it stays from its limits.

use std::collections::BTreeMap;

use serde::Serialize;

use super::ask::Ask;
use super::baseline::RandomSines;
use super::capsules::Surroundings;
use super::limits::{Held, Limits, Reached};
use super::question::{Answer, Question, Recorder};
use super::request::Request;
use crate::text::{paragraph, table};

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The two rivals to be told apart, as it was asked for.
    pub rivals: Option<[String; 2]>,
    pub seed: u64,
    pub seconds: f64,
    pub evaluations: usize,
    pub recorder: Recorder,
    pub around: Surroundings,
    pub radius_m: f64,
    pub tool_m: f64,
    pub clearance_m: f64,
    /// Limits as held by the commanded motion, and by the simulated arm.
    pub commanded: Held,
    pub simulated: Held,
    /// Every parameter that is asked for and can be told.
    pub told: Vec<Told>,
    pub groups: Vec<Group>,
    /// How many times narrower than with random sines, over all parameters (geometric mean).
    pub narrower: Option<f64>,
    /// Asked for, but it follows from other parameters whatever the motion.
    pub not_told: Vec<String>,
    /// Log-likelihood by which the recording will favour the one of two rivals that is there, nats.
    pub nats: Option<f64>,
    pub random_sines: Baseline,
}

/// One parameter. Half-widths are of expected 99 % intervals, in its unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Told {
    pub group: String,
    pub parameter: String,
    pub unit: &'static str,
    /// How large it, or an error of it, may well be.
    pub size: f64,
    pub half_width: f64,
    /// Median; absent where random sines do not determine it.
    pub random_sines_half_width: Option<f64>,
}

/// Parameters that belong together. Geometric means over them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    pub name: String,
    pub parameters: usize,
    /// How many of them this motion tells to less than their size.
    pub sharp: usize,
    /// Half-width over size.
    pub relative_half_width: f64,
    pub random_sines_relative_half_width: Option<f64>,
}

/// Random sines of the same length and limits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Baseline {
    pub motions: usize,
    pub drawn: usize,
    /// Range of the motions, rad: a smaller one where the asked range left too few that keep clear.
    pub range_rad: f64,
    /// Median log-likelihood in favour of the one of two rivals that is there, nats.
    pub nats: Option<f64>,
}

/// Standard deviations of a normal distribution within which 99 % lie.
const WITHIN_99: f64 = 2.575_829_303_548_901;

/// A rival that is ahead by so many nats is ahead for sure.
const DECIDES_NATS: f64 = 6.0;

pub(super) fn report(
    request: &Request,
    question: &Question<'_>,
    recorder: &Recorder,
    limits: &Limits<'_>,
    [commanded, simulated]: [Held; 2],
    answer: &Answer,
    random: &RandomSines,
) -> Report {
    let told: Vec<Told> = (question.told().into_iter().zip(&answer.deviations).enumerate())
        .map(|(i, (unknown, deviation))| Told {
            group: unknown.group.clone(),
            parameter: unknown.name.clone(),
            unit: unknown.unit,
            size: unknown.size,
            half_width: WITHIN_99 * deviation,
            random_sines_half_width: median(random, f64::INFINITY, |a| a.deviations[i])
                .map(|d| WITHIN_99 * d),
        })
        .collect();
    let rivals = match &request.ask {
        Ask::Apart(rivals) => Some(rivals.clone().map(|r| r.says())),
        Ask::Learn { .. } => None,
    };
    // Half the sum of squares that the other cannot imitate, over the noise.
    let nats = |a: &Answer| 0.5 * a.log_det.exp();
    let ratio = |t: &Told| Some(t.random_sines_half_width? / t.half_width);
    Report {
        seed: request.seed,
        seconds: request.seconds,
        evaluations: request.evaluations,
        recorder: recorder.clone(),
        around: request.around.clone(),
        radius_m: limits.capsules.radius,
        tool_m: request.tool_m,
        clearance_m: limits.clearance_m,
        commanded,
        simulated,
        groups: groups(&told),
        narrower: told.iter().map(ratio).collect::<Option<Vec<_>>>().and_then(|r| mean(&r)),
        told,
        not_told: question
            .not_told()
            .iter()
            .map(|u| format!("{} of {}", u.name, u.group))
            .collect(),
        nats: rivals.is_some().then(|| nats(answer)),
        random_sines: Baseline {
            motions: random.answers.len(),
            drawn: random.drawn,
            range_rad: random.range_rad,
            nats: rivals.is_some().then(|| median(random, 0.0, nats)).flatten(),
        },
        rivals,
    }
}

/// Median over the random motions; one that determines nothing counts as `worst`. `None` where the median
/// is such a one.
fn median(random: &RandomSines, worst: f64, of: impl Fn(&Answer) -> f64) -> Option<f64> {
    let value = |a: &Option<Answer>| a.as_ref().map_or(worst, &of);
    let mut all: Vec<f64> = random.answers.iter().map(value).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().filter(|x| x.is_finite())
}

/// Geometric.
fn mean(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().map(|v| v.ln()).sum();
    (!values.is_empty()).then(|| (sum / values.len() as f64).exp())
}

fn groups(told: &[Told]) -> Vec<Group> {
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    let mut members: Vec<Vec<&Told>> = Vec::new();
    for t in told {
        let next = members.len();
        let place = *places.entry(&t.group).or_insert(next);
        if place == next {
            members.push(Vec::new());
        }
        members[place].push(t);
    }
    let group = |m: Vec<&Told>| {
        let here: Vec<f64> = m.iter().map(|t| t.half_width / t.size).collect();
        let random = m.iter().map(|t| Some(t.random_sines_half_width? / t.size));
        Group {
            name: m.first().map_or_else(String::new, |t| t.group.clone()),
            parameters: m.len(),
            sharp: here.iter().filter(|w| **w < 1.0).count(),
            relative_half_width: mean(&here).unwrap_or(f64::INFINITY),
            random_sines_relative_half_width: random
                .collect::<Option<Vec<_>>>()
                .and_then(|r| mean(&r)),
        }
    };
    members.into_iter().map(group).collect()
}

/// For a terminal.
pub fn page(report: &Report) -> String {
    let mut page = match &report.rivals {
        Some(_) => rivals(report),
        None => widths(report),
    };
    page += &format!("\nLimits held\n{}", held(report));
    page
}

fn rivals(report: &Report) -> String {
    let Some([one, other]) = &report.rivals else { return String::new() };
    let of = |nats: Option<f64>| nats.map_or("nothing".into(), |n| format!("{n:.1} nats"));
    let (here, random) = (of(report.nats), of(report.random_sines.nats));
    format!(
        "{one} from {other}: {here} in {:.0} s; random sines {random} (median of {}).\n{}",
        report.seconds,
        report.random_sines.motions,
        paragraph(
            "",
            &format!(
                "Whichever of the two is there, at the size it may well have: the log-likelihood by \
                 which the recording favours it over the other. {}",
                match report.nats {
                    Some(nats) if nats >= DECIDES_NATS => "6 nats decide.",
                    _ => "Less than 6 nats decide nothing: a longer motion or wider limits may.",
                }
            )
        )
    )
}

fn widths(report: &Report) -> String {
    let by = report.narrower.map_or_else(
        || "random sines leave some of it undetermined".to_string(),
        |n| match n >= 1.0 {
            true => format!("{n:.2} times narrower than with random sines (geometric mean)"),
            false => format!(
                "{:.2} times wider than with random sines (geometric mean): try more --evaluations",
                1.0 / n
            ),
        },
    );
    let rows = report.groups.iter().map(|g| {
        let members: Vec<&Told> = report.told.iter().filter(|t| t.group == g.name).collect();
        let [here, random] = match members[..] {
            [t] => [Some(t.half_width), t.random_sines_half_width]
                .map(|w| w.map_or("-".into(), |w| format!("{} {}", short(w), t.unit))),
            _ => [Some(g.relative_half_width), g.random_sines_relative_half_width]
                .map(|w| w.map_or("-".into(), |w| format!("{:.1} %", 100.0 * w))),
        };
        let ratio = g.random_sines_relative_half_width.map(|r| r / g.relative_half_width);
        let ratio = ratio.map_or("-".into(), |r| format!("{r:.2}"));
        let sharp = format!("{} of {}", g.sharp, g.parameters);
        vec![g.name.clone(), sharp, here, random, ratio]
    });
    let header = ["asked for", "sharp", "this motion +-", "random sines +-", "ratio"];
    let mut text = format!(
        "{} parameters in {:.0} s: intervals {by}.\n\nExpected 99 % intervals\n{}\n",
        report.told.len(),
        report.seconds,
        table(&header, 1, rows)
    );
    text += &paragraph(
        "",
        &format!(
            "White noise of {} N.m on the joints' torque, {:.0} Hz; friction, rotor inertia and \
             offset of every joint are fitted along. Percentages: of what a parameter, or an error of \
             it, may well be, geometric mean over the group; sharp: parameters told to less than \
             that. Random sines: median of those {} of \
             {} drawn ones that hold the limits, of the same length, range {:.2} rad.",
            list(&report.recorder.noise_nm),
            report.recorder.rate_hz,
            report.random_sines.motions,
            report.random_sines.drawn,
            report.random_sines.range_rad,
        ),
    );
    if !report.not_told.is_empty() {
        text += &paragraph(
            "",
            &format!(
                "{} more follow from these, whatever the motion (base parameters): {}.",
                report.not_told.len(),
                report.not_told.join(", ")
            ),
        );
    }
    text
}

/// Three significant digits.
fn short(value: f64) -> String {
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0);
    format!("{value:.*}", digits as usize)
}

fn list(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|v| format!("{v:.2}")).collect();
    all.join(" ")
}

fn held(report: &Report) -> String {
    let share = |r: &Reached| format!("{:.1} % (joint {})", 100.0 * r.share(), r.joint);
    let maybe = |r: Option<&Reached>| r.map_or("-".into(), share);
    let row = |name: &str, held: &Held| {
        let closest = held.closest.as_ref().map_or("-".to_string(), |c| {
            format!("{:.0} mm, {} and {}", 1e3 * c.distance_m, c.between[0], c.between[1])
        });
        vec![
            name.to_string(),
            share(&held.angle_rad),
            share(&held.speed_rad_s),
            maybe(held.acceleration_rad_s2.as_ref()),
            maybe(held.torque_nm.as_ref()),
            closest,
        ]
    };
    let rows = [row("commanded", &report.commanded), row("simulated", &report.simulated)];
    let header = ["", "angle", "speed", "acceleration", "torque", "closest"];
    format!(
        "{}\n{}",
        table(&header, 1, rows.into_iter()),
        paragraph(
            "",
            &format!(
                "Largest shares of the limits. Links are capsules of {:.0} mm radius around the lines \
                 between joints; {:.0} mm between surfaces are kept.",
                1e3 * report.radius_m,
                1e3 * report.clearance_m
            )
        )
    )
}
