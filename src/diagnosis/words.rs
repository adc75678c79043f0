//! A diagnosis in sentences.

use super::a_little_off::{LittleOff, a_little_off};
use super::{
    Cause, Checked, CrossValidated, Diagnosis, Episode, Position, PositionShrink, Touch,
    UnexplainedJoint, Value, Verdict,
};
use crate::effects::{self, Role};
use crate::numbers::{digits, rough};

/// "joint 2", "joints 1, 3" or "the whole arm"; joints count from 1.
pub fn place(joints: &[usize]) -> String {
    match joints.len() {
        0 => "the whole arm".into(),
        1 => format!("joint {}", list(joints)),
        _ => format!("joints {}", list(joints)),
    }
}

/// Where a cause acts, and which recording shows it where one alone does: the other may lack the cause, or the motion.
pub fn acts(cause: &Cause) -> String {
    let place = place(&cause.joints);
    match &cause.recording {
        Some(only) => format!("{place}, seen in the {only} recording alone"),
        None => place,
    }
}

/// "1, 3"
pub fn list(joints: &[usize]) -> String {
    joints.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// What is wrong with the twin, where, how sure that is, and how far it helps, in a few sentences.
pub fn sentence(d: &Diagnosis) -> String {
    let first = match d.verdict {
        Verdict::NoGap => no_gap(d),
        Verdict::Explained => format!("{} {} {}", lacks(d), shrinks(d), stays(d)),
        Verdict::PartlyExplained => format!("{} {} {}", lacks(d), shrinks(d), stays(d)),
        Verdict::Unexplained => format!("{} {}", unexplained(d), stays(d)),
    };
    let pushed = pushes(d);
    if pushed.is_empty() { first } else { format!("{first} {pushed}") }
}

/// Letters that stand on two lines of a page.
const TWO_LINES: usize = 160;

/// The answer in two lines: how much of what lies above the noise, and what explains it.
pub fn headline(d: &Diagnosis) -> String {
    let found = match d.verdict {
        Verdict::NoGap => return no_gap(d),
        Verdict::Unexplained => return unexplained(d),
        Verdict::Explained | Verdict::PartlyExplained => effects_found(d),
    };
    let goes = match (a_little_off(d), d.causes.iter().any(Cause::shows_in_torque)) {
        (Some(LittleOff { share, most }), _) => format!(
            "{} of the gap above the noise goes with links and torque that are a little off{}. Besides, t",
            percent(share),
            most.map_or(String::new(), |(joint, by)| {
                format!(" (most: torque of joint {joint}, {:+.0} %)", 100.0 * by)
            })
        ),
        (None, true) => explained(d),
        (None, false) => uncertain(d),
    };
    // The causes that count least wait for the table below.
    let told = |n: usize| format!("{goes}he twin lacks {}.", listed(&found, n));
    (1..=found.len())
        .rev()
        .map(told)
        .find(|t| t.chars().count() <= TWO_LINES)
        .unwrap_or_else(|| told(1))
}

/// Does what was found surely take the twin further from the recording that was not searched?
fn is_worse(d: &Diagnosis) -> bool {
    d.shrink.torque.above_noise().is_some_and(|[_, _, high]| high < 0.0)
}

/// What it means if it does.
const WORSE: &str = "what is found on one recording makes the other worse; the arm is not the same in both, \
                     perhaps its load";

fn explained(d: &Diagnosis) -> String {
    if let Some(position) = &d.position {
        let share = percent(position.cross_validated.fraction());
        return format!("{share} of the position error is explained: t");
    }
    if is_worse(d) {
        return "What is found on one recording makes the other worse: is the arm the same, with its \
                load? T"
            .into();
    }
    match d.shrink.torque.above_noise() {
        Some([share, ..]) => {
            format!("{} of the gap above the noise is explained: t", percent(share))
        }
        None => "The gap is no larger than the noise, and yet it is explained: t".into(),
    }
}

/// What takes torque off where no named cause does.
fn uncertain(d: &Diagnosis) -> String {
    // The share is that of a search which has not seen the check recording.
    let own = d.adjustments.iter().filter(|a| a.found_without_check);
    let names: Vec<String> = own.map(|a| a.effect.clone()).collect();
    match d.shrink.torque.above_noise() {
        Some([share, ..]) if !names.is_empty() => format!(
            "{} of the gap above the noise goes with {}, of which none is sure. Besides, t",
            percent(share),
            listed(&names, TOLD)
        ),
        _ if d.unexplained.above_noise => {
            let stays = d.unexplained.rms_nm;
            format!("No effect surely explains the {stays:.2} N.m of torque that stay. Besides, t")
        }
        _ => "T".into(),
    }
}

/// What belongs to the headline: the gap in N.m, what stays, and who pushed.
pub fn further(d: &Diagnosis) -> String {
    let sizes = match &d.position {
        Some(position) => position_shrinks(position),
        None => torque_shrinks(d),
    };
    let parts = match d.verdict {
        Verdict::NoGap => vec![pushes(d)],
        Verdict::Unexplained => vec![stays(d), pushes(d)],
        Verdict::Explained => vec![sizes, stays(d), pushes(d)],
        Verdict::PartlyExplained => vec![sizes, rest(d), pushes(d)],
    };
    parts.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(" ")
}

fn torque_shrinks(d: &Diagnosis) -> String {
    let torque = &d.shrink.torque;
    let goes = if is_worse(d) { "grows" } else { "shrinks" };
    format!(
        "The gap {goes} from {:.2} to {:.2} N.m (noise: {:.2} N.m) on a recording that was not \
         searched.",
        torque.before_nm, torque.after_nm, torque.noise_floor_nm
    )
}

/// What causes of position servos are decided by, and how well the mended twin predicts as it is.
fn position_shrinks(position: &Position) -> String {
    let CrossValidated { before_rad, after_rad } = position.cross_validated;
    let goes = if position.after_rad > position.before_rad { "grows" } else { "shrinks" };
    let [before, after, rms_before, rms_after] =
        [before_rad, after_rad, position.before_rad, position.after_rad].map(|rad| 1e3 * rad);
    format!(
        "The position error in stretches that were not fitted shrinks from {before:.2} to {after:.2} mrad (mean size, both \
         recordings). Where the check recording is predicted from the other one alone, it {goes} from {rms_before:.2} to \
         {rms_after:.2} mrad (rms)."
    )
}

/// How far all causes together take the gap down.
pub fn how_far(d: &Diagnosis) -> String {
    match &d.position {
        Some(position) if !d.causes.is_empty() => position_shrinks(position),
        _ => above_noise(d),
    }
}

/// Error of the simulated position (rad) without a cause, mrad.
pub fn error_without(before_rad: Option<f64>) -> String {
    before_rad.map_or_else(|| "runs away".into(), |rad| format!("{:.2}", 1e3 * rad))
}

/// What a cause takes off the check recording where it is added to all the others: sizes without and with it, root mean
/// square, and its share of the mean square. Of position servos the position counts, along the whole command.
pub fn takes_off(d: &Diagnosis, c: &Cause) -> (String, f64) {
    let is_own = |p: &&PositionShrink| (&p.effect, &p.joints) == (&c.effect, &c.joints);
    let by_position = d.position.iter().flat_map(|position| &position.causes).find(is_own);
    match by_position {
        Some(p) => {
            let (before, after) = (error_without(p.before_rad), 1e3 * p.after_rad);
            (format!("{before} -> {after:.2} mrad"), p.fraction)
        }
        None => {
            let Checked { check_before_nm, check_after_nm, fraction, .. } = c.shrink;
            (format!("{check_before_nm:.3} -> {check_after_nm:.3} N.m"), fraction)
        }
    }
}

/// In N.m, and as a share of what lies above the noise.
fn above_noise(d: &Diagnosis) -> String {
    let t = &d.shrink.torque;
    let share = match t.above_noise().map(|share| share.map(percent)) {
        _ if d.verdict == Verdict::NoGap => "nothing else is to be explained".into(),
        Some(_) if is_worse(d) => WORSE.into(),
        Some([share, low, high]) => format!(
            "{share} of the gap above the noise is explained (90 % interval {low} to {high}; shares are of \
             mean squares)"
        ),
        None => "nothing was above the noise".into(),
    };
    format!(
        "{:.2} -> {:.2} N.m, of which {:.2} N.m are noise, on a recording that was not searched: {share}",
        t.before_nm, t.after_nm, t.noise_floor_nm
    )
}

fn no_gap(d: &Diagnosis) -> String {
    let apart = d.shrink.torque.before_nm;
    match d.unexplained.beyond_tolerances_nm {
        Some(beyond) => format!(
            "No gap: the twin's torque agrees with the recorded one within what its links and torque are known to, as far \
             as noise lets one see ({apart:.2} N.m apart, {beyond:.2} with those of the mended twin)."
        ),
        None => format!(
            "No gap: the twin's torque agrees with the recorded one as far as its noise lets one see ({apart:.2} N.m apart)."
        ),
    }
}

fn unexplained(d: &Diagnosis) -> String {
    format!(
        "The twin differs by {:.2} N.m{}, and no effect of the catalogue explains it better than a \
         discrepancy of any shape.",
        d.shrink.torque.before_nm,
        worst(d)
    )
}

fn shrinks(d: &Diagnosis) -> String {
    if let Some(position) = &d.position {
        return position_shrinks(position);
    }
    let torque = &d.shrink.torque;
    if is_worse(d) {
        let [before, after] = [torque.before_nm, torque.after_nm];
        return format!("With it the gap grows from {before:.2} to {after:.2} N.m: {WORSE}.");
    }
    let share = torque.above_noise().map_or(String::new(), |share| {
        let [share, low, high] = share.map(percent);
        format!(": {share} of what lies above the noise ({low} to {high})")
    });
    format!(
        "With it the gap shrinks from {:.2} to {:.2} N.m on a recording that was not searched{share}.",
        torque.before_nm, torque.after_nm
    )
}

/// What the causes leave: how much, how much of it is noise, where the rest is, and on what it depends.
pub fn stays(d: &Diagnosis) -> String {
    let torque = &d.shrink.torque;
    let (stay, noise) = (torque.after_nm, torque.noise_floor_nm);
    match (d.unexplained.above_noise, d.unexplained.beyond_tolerances_nm) {
        (true, Some(beyond)) => format!(
            "{stay:.2} N.m stay, {noise:.2} N.m of them noise. {WITHIN} would leave {beyond:.2} N.m of it (they are in the \
             mended twin). {}",
            rest(d)
        ),
        (true, None) => format!("{stay:.2} N.m stay, {noise:.2} N.m of them noise. {}", rest(d)),
        (false, Some(beyond)) => format!(
            "{stay:.2} N.m stay. {WITHIN} leave {beyond:.2} N.m of it (they are in the mended twin), no more than noise.{}",
            slow_noise(d)
        ),
        (false, None) => format!("{stay:.2} N.m stay, no more than noise.{}", slow_noise(d)),
    }
}

const WITHIN: &str = "Links and torque that are off within what they are known to";

/// How far the noise lies above its floor, where slow noise does.
fn slow_noise(d: &Diagnosis) -> String {
    let louder = d.unexplained.noise_over_floor.sqrt();
    match d.unexplained.noise_over_floor > d.criteria.above_noise {
        true => format!(
            " All joints are at least {louder:.1} times as loud as the noise floor ({:.2} N.m), which holds no slow noise.",
            d.shrink.torque.noise_floor_nm
        ),
        false => String::new(),
    }
}

/// Where most of what stays above the noise is, and on what it depends.
fn rest(d: &Diagnosis) -> String {
    let rms = |j: &UnexplainedJoint| j.beyond_tolerances_nm.unwrap_or(j.rms_nm);
    let excess = |j: &&UnexplainedJoint| rms(j) - j.noise_floor_nm;
    let most = d.unexplained.joints.iter().max_by(|a, b| excess(a).total_cmp(&excess(b)));
    most.map_or(String::new(), |j| {
        let along = j.depends_on.first();
        let along = along.map_or(String::new(), |d| format!(", going along with {}", d.variable));
        format!("Most of the rest is at joint {}{along}.", j.joint)
    })
}

/// When something pushed at the arm, where a force on one link explains all joints.
pub fn pushes(d: &Diagnosis) -> String {
    let all = stretches(d, |e| e.touch.is_some());
    if all.is_empty() { all } else { format!("Something pushes at the arm: {all}.") }
}

/// Stretches that a force at the flange would explain, and no force on a link over time does.
pub fn suspicions(d: &Diagnosis) -> String {
    stretches(d, |e| e.touch.is_none() && e.is_push())
}

/// Stretches that come again with the motion: what the arm does there, or meets each time.
pub fn come_again(d: &Diagnosis) -> String {
    let all = stretches(d, |e| e.every_s.is_some());
    if all.is_empty() {
        return all;
    }
    format!(
        "More is left than anywhere in the other recording, each time the motion comes by: {all}. That is no push, but a \
         law that shows in this stretch of the motion alone, or something that the arm meets there."
    )
}

/// `12.8 to 13.4 s (check, 41 N at link 5)` or `11.0 to 11.2 s (fit, every 20.0 s)`, one after the other.
fn stretches(d: &Diagnosis, which: impl Fn(&&Episode) -> bool) -> String {
    let one = |e: &Episode| {
        let Episode { start, end, recording, .. } = e;
        let touch = e.touch.as_ref();
        let touch =
            touch.map_or(String::new(), |t| format!(", {} N at link {}", rough(t.peak_n), t.link));
        let every = e.every_s.map_or(String::new(), |s| format!(", every {s:.1} s"));
        format!("{start:.1} to {end:.1} s ({recording}{touch}{every})")
    };
    d.episodes.iter().filter(which).map(one).collect::<Vec<_>>().join(", ")
}

/// Causes told at once; more are in the table.
const TOLD: usize = 3;

/// "The twin lacks payload or link_inertia at joint 6 (2.81 kg; 97 % sure)."
fn lacks(d: &Diagnosis) -> String {
    format!("The twin lacks {}.", listed(&effects_found(d), TOLD))
}

/// The first `told` of them, and how many more there are.
fn listed(all: &[String], told: usize) -> String {
    let mut named = all[..told.min(all.len())].to_vec();
    if all.len() > told {
        named.push(format!("{} more", all.len() - told));
    }
    match named.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => named.concat(),
    }
}

/// `payload or link_inertia at joint 6 (2.81 kg; 97 % sure)`; every effect once, with all its joints and the
/// least of their probabilities.
fn effects_found(d: &Diagnosis) -> Vec<String> {
    let alike = |a: &Cause, b: &Cause| a.effect == b.effect && a.joints.len() == b.joints.len();
    let is_first = |(i, c): &(usize, &Cause)| !d.causes[..*i].iter().any(|before| alike(before, c));
    let one = |(_, first): (usize, &Cause)| {
        let all: Vec<&Cause> = d.causes.iter().filter(|c| alike(first, c)).collect();
        let mut joints: Vec<usize> = all.iter().flat_map(|c| c.joints.iter().copied()).collect();
        joints.sort_unstable();
        let least = all.iter().map(|c| c.probability).fold(1.0, f64::min);
        let name = match joints.is_empty() {
            true => first.effect.clone(),
            false => format!("{} at {}", first.effect, place(&joints)),
        };
        // Where there are several joints the table below says what looks the same at which.
        let or = first.equivalent.first().filter(|_| all.len() == 1);
        let or = or.map_or(String::new(), |e| match e.joints.is_empty() {
            true => format!(" or {}", e.effect),
            false => format!(" or {} at {}", e.effect, place(&e.joints)),
        });
        let value = if all.len() == 1 { value(first) } else { String::new() };
        format!("{name}{or} ({value}{} sure)", percent(least))
    };
    d.causes.iter().enumerate().filter(is_first).map(one).collect()
}

/// "payload_mass 2.81 kg, the twin has 0.14; "
fn value(cause: &Cause) -> String {
    let Some(first) = foremost(cause) else { return String::new() };
    let at = first.joint.map_or(String::new(), |j| format!(" at joint {j}"));
    let unit = if first.unit == "-" { String::new() } else { format!(" {}", first.unit) };
    let twin = cause.replaces.as_ref();
    let twin = twin.map_or(String::new(), |r| format!(", the twin has {}", digits(r.twin)));
    // A name that says no more than the effect's is not said again.
    let name = if first.name == cause.effect { String::new() } else { format!("{} ", first.name) };
    format!("{name}{}{unit}{at}{twin}; ", digits(first.value))
}

/// `torque_constant: torque_gain_error 0.0223 (-0.0528 to 0.0974) helps and is in the mended twin; it is not named,
/// for its interval holds that there is nothing`
pub fn adjustment(a: &Cause, why: &str) -> String {
    format!("{} helps and is in the mended twin; it is not named, for {why}", first_value(a))
}

/// `viscous_cubic at joint 1: viscous_cubic 9.53 (8.1 to 11) is in the mended twin as well: that curve of the joint bends as no
/// single law does`
pub fn law(a: &Cause) -> String {
    let value = first_value(a);
    format!(
        "{value} is in the mended twin as well: that curve of the joint bends as no single law does"
    )
}

/// An effect, where it acts, and the value that is told of it first.
fn first_value(a: &Cause) -> String {
    let value = foremost(a).map_or(String::new(), |v| {
        format!(": {} {} ({} to {})", parameter(v), digits(v.value), digits(v.low), digits(v.high))
    });
    format!("{} at {}{value}", a.effect, place(&a.joints))
}

/// What is told of a cause first: its first value, where the data tell it, or else the linear value that they tell best; of
/// many links that of the link that is off the most.
pub fn foremost(cause: &Cause) -> Option<&Value> {
    let first = cause.parameters.first()?;
    let parameters = effects::find(&cause.effect).map_or(&[][..], |e| e.about().parameters);
    let is_linear =
        |v: &Value| parameters.iter().any(|p| p.name == v.name && p.role == Role::Linear);
    if !is_linear(first) {
        return Some(first);
    }
    let linear = cause.parameters.iter().filter(|v| is_linear(v));
    let told: Vec<&Value> = linear.filter(|v| v.low > 0.0 || v.high < 0.0).collect();
    let own = told.iter().filter(|v| v.name == first.name);
    let largest = own.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()));
    let sharp = |v: &Value| v.value.abs() / (v.high - v.low);
    let best = largest.or_else(|| told.iter().max_by(|a, b| sharp(a).total_cmp(&sharp(b))));
    Some(best.copied().unwrap_or(first))
}

/// `link_mass` or, of several joints, `link_mass, joint 2`.
pub fn parameter(v: &Value) -> String {
    v.joint.map_or(v.name.clone(), |j| format!("{}, joint {j}", v.name))
}

/// The joint where most of the gap lies, in words.
fn worst(d: &Diagnosis) -> String {
    let joints = d.gap.joints.iter();
    match joints.max_by(|a, b| a.share.total_cmp(&b.share)).filter(|j| j.share > 0.0) {
        Some(j) => format!(", {} of it on joint {}", percent(j.share), j.joint),
        None => String::new(),
    }
}

/// Header and cells of a table of stretches that stand out.
pub const EPISODES: [&str; 7] =
    ["recording", "time s", "joints", "peak N.m", "force at the flange N", "explains", "touched"];

pub fn episode(e: &Episode) -> Vec<String> {
    let force: Vec<String> = e.force_n.iter().map(|f| format!("{f:.0}")).collect();
    vec![
        e.recording.clone(),
        format!("{:.1} .. {:.1}", e.start, e.end),
        list(&e.joints),
        format!("{:.1}", e.peak_nm),
        if e.is_push() { force.join(" ") } else { "-".into() },
        percent(e.explained.max(0.0)),
        match (&e.touch, e.every_s) {
            (Some(t), _) => touch(t),
            (None, Some(every_s)) => format!("no: every {every_s:.1} s"),
            (None, None) => "-".into(),
        },
    ]
}

/// `link 5 (83 %), 41 +- 6 N at 12.9 s`
fn touch(t: &Touch) -> String {
    let Touch { link, link_probability, peak_n, peak_sd_n, peak_time_s, .. } = t;
    let sure = percent(*link_probability);
    format!("link {link} ({sure}), {peak_n:.0} +- {peak_sd_n:.0} N at {peak_time_s:.1} s")
}

/// What that table shows.
pub const LOUDER: &str = "louder than anything in the other recording; a contact where one force \
                          at the flange explains it, touched where a force that changes with time \
                          is more probable than none, not where it comes again with the motion";

/// Where the motion kinks faster than smoothing at `cutoff_hz` follows: joints, and how many of their rows count little.
pub fn kinks(at: &[(usize, f64)], cutoff_hz: f64) -> Option<String> {
    let most = at.iter().map(|(_, lost)| *lost).reduce(f64::max)?;
    let joints: Vec<usize> = at.iter().map(|(joint, _)| *joint).collect();
    Some(format!(
        "the motion of {} kinks within a sample or two, faster than its smoothing at {cutoff_hz} Hz follows: up to {} of \
         a joint's rows count by less than half, for what they show may be the acceleration that is missing",
        place(&joints),
        percent(most)
    ))
}

/// "97 %"; never "100 %" for less than that.
pub fn percent(share: f64) -> String {
    match share {
        s if s < 1.0 && s > 0.995 => format!("{:.1} %", (1000.0 * s).floor() / 10.0),
        s => format!("{:.0} %", 100.0 * s),
    }
}
