//! A diagnosis in sentences.

use super::{Cause, Diagnosis, Episode, Touch, UnexplainedJoint, Value, Verdict};

/// "joint 2", "joints 1, 3" or "the whole arm"; joints count from 1.
pub fn place(joints: &[usize]) -> String {
    match joints.len() {
        0 => "the whole arm".into(),
        1 => format!("joint {}", list(joints)),
        _ => format!("joints {}", list(joints)),
    }
}

/// "1, 3"
pub fn list(joints: &[usize]) -> String {
    joints.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// What is wrong with the twin, where, how sure that is, and how far it helps, in one sentence.
pub fn sentence(d: &Diagnosis) -> String {
    let torque = &d.shrink.torque;
    let shrinks = format!(
        "With it the gap shrinks from {:.2} to {:.2} N.m on a recording that was not searched ({} of \
         its mean square, {} to {}).",
        torque.before_nm,
        torque.after_nm,
        percent(torque.fraction),
        percent(torque.low),
        percent(torque.high),
    );
    let first = match d.verdict {
        Verdict::NoGap => format!(
            "No gap: the twin's torque agrees with the recorded one as far as its noise lets one \
             see ({:.2} N.m apart).",
            torque.before_nm
        ),
        Verdict::Explained => format!("{} {shrinks} No more than noise stays.", lacks(d)),
        Verdict::PartlyExplained => format!("{} {shrinks} {}", lacks(d), stays(d)),
        Verdict::Unexplained => format!(
            "The twin differs by {:.2} N.m{}, and nothing of the catalogue explains it better than \
             a discrepancy of any shape. {}",
            torque.before_nm,
            worst(d),
            stays(d)
        ),
    };
    first + &pushes(d)
}

/// The answer in two lines: what, where, how sure, how far.
pub fn headline(d: &Diagnosis) -> String {
    let torque = &d.shrink.torque;
    let shrinks = format!(
        " The gap shrinks from {:.2} to {:.2} N.m on a recording that was not searched.",
        torque.before_nm, torque.after_nm
    );
    let first = match d.verdict {
        Verdict::NoGap | Verdict::Unexplained => return sentence(d),
        Verdict::Explained | Verdict::PartlyExplained => lacks(d) + &shrinks,
    };
    first + &pushes(d)
}

/// What the causes leave: how much, where, and on what it depends.
pub fn stays(d: &Diagnosis) -> String {
    let left = &d.unexplained;
    if !left.above_noise {
        return format!("{:.2} N.m stay, no more than noise.", left.rms_nm);
    }
    let excess = |j: &&UnexplainedJoint| j.rms_nm - j.noise_floor_nm;
    let most = left.joints.iter().max_by(|a, b| excess(a).total_cmp(&excess(b)));
    let place = most.map_or(String::new(), |j| {
        let along = j.depends_on.first();
        let along = along.map_or(String::new(), |d| format!(", going along with {}", d.variable));
        format!(", most of it at joint {}{along}", j.joint)
    });
    format!("{:.2} N.m stay unexplained{place}.", left.rms_nm)
}

/// When something pushed at the arm, where a force on one link explains all joints.
fn pushes(d: &Diagnosis) -> String {
    let all = stretches(d, |e| e.touch.is_some());
    if all.is_empty() { all } else { format!(" Something pushes at the arm: {all}.") }
}

/// Stretches that a force at the flange would explain, and no force on a link over time does.
pub fn suspicions(d: &Diagnosis) -> String {
    stretches(d, |e| e.touch.is_none() && e.is_push())
}

/// `12.8 to 13.4 s (check, 41 N at link 5)`, one after the other.
fn stretches(d: &Diagnosis, which: impl Fn(&&Episode) -> bool) -> String {
    let one = |e: &Episode| {
        let Episode { start, end, recording, .. } = e;
        let touch = e.touch.as_ref();
        let touch =
            touch.map_or(String::new(), |t| format!(", {:.0} N at link {}", t.peak_n, t.link));
        format!("{start:.1} to {end:.1} s ({recording}{touch})")
    };
    d.episodes.iter().filter(which).map(one).collect::<Vec<_>>().join(", ")
}

/// Causes told at once; more are in the table.
const TOLD: usize = 3;

/// "The twin lacks payload or link_inertia at joint 6 (2.81 kg; 97 % sure)."; every effect once, with
/// all its joints and the least of their probabilities.
fn lacks(d: &Diagnosis) -> String {
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
        // Of several joints the table below says what looks the same at which.
        let or = first.equivalent.first().filter(|_| all.len() == 1);
        let or = or.map_or(String::new(), |e| match e.joints.is_empty() {
            true => format!(" or {}", e.effect),
            false => format!(" or {} at {}", e.effect, place(&e.joints)),
        });
        let value = if all.len() == 1 { value(first) } else { String::new() };
        format!("{name}{or} ({value}{} sure)", percent(least))
    };
    let mut named: Vec<String> = d.causes.iter().enumerate().filter(is_first).map(one).collect();
    let more = named.len().saturating_sub(TOLD);
    named.truncate(TOLD);
    if more > 0 {
        named.push(format!("{more} more"));
    }
    let list = match named.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => named.concat(),
    };
    format!("The twin lacks {list}.")
}

/// "payload_mass 2.81 kg, the twin has 0.14; "
fn value(cause: &Cause) -> String {
    let Some(first) = foremost(cause) else { return String::new() };
    let at = first.joint.map_or(String::new(), |j| format!(" at joint {j}"));
    let unit = if first.unit == "-" { String::new() } else { format!(" {}", first.unit) };
    let twin = cause.replaces.as_ref();
    let twin = twin.map_or(String::new(), |r| format!(", the twin has {}", short(r.twin)));
    format!("{} {}{unit}{at}{twin}; ", first.name, short(first.value))
}

/// `torque_constant: torque_gain_error 0.0223 (-0.0528 to 0.0974) helps and is in the mended twin; ...`
pub fn adjustment(a: &Cause) -> String {
    let value = foremost(a).map_or(String::new(), |v| {
        format!(": {} {} ({} to {})", parameter(v), short(v.value), short(v.low), short(v.high))
    });
    format!(
        "{} at {}{value} helps and is in the mended twin; it is not named, for its interval holds that \
         there is nothing",
        a.effect,
        place(&a.joints)
    )
}

/// What is told of a cause first: its first value; of many links that of the link that is off the most.
pub fn foremost(cause: &Cause) -> Option<&Value> {
    let first = cause.parameters.first()?;
    let alike = cause.parameters.iter().filter(|v| v.name == first.name);
    alike.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))
}

/// `link_mass` or, of several joints, `link_mass, joint 2`.
pub fn parameter(v: &Value) -> String {
    v.joint.map_or(v.name.clone(), |j| format!("{}, joint {j}", v.name))
}

/// A number in three significant digits.
fn short(x: f64) -> String {
    let digits = (2 - x.abs().max(1e-12).log10().floor() as i32).clamp(0, 6);
    format!("{x:.*}", digits as usize)
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
        e.touch.as_ref().map_or("-".into(), touch),
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
                          is more probable than none";

/// "97 %"; never "100 %" for less than that.
pub fn percent(share: f64) -> String {
    match share {
        s if s < 1.0 && s > 0.995 => format!("{:.1} %", (1000.0 * s).floor() / 10.0),
        s => format!("{:.0} %", 100.0 * s),
    }
}
