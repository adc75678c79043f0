//! A diagnosis in sentences.

use super::{Cause, Diagnosis, Episode, TorqueShrink, Verdict};

/// Times the share that all joints together lose, from which on a joint is worth a word of its own.
const HIDDEN: f64 = 2.0;

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

/// What is wrong with the twin, how sure that is, and what adding it brings, in one sentence.
pub fn sentence(d: &Diagnosis) -> String {
    verdict(d) + &pushes(d)
}

fn verdict(d: &Diagnosis) -> String {
    let torque = &d.shrink.torque;
    let shrunk = format!(
        "the gap shrinks from {:.2} to {:.2} N.m{} on the check recording ({} of its mean square, {} to {})",
        torque.before_nm,
        torque.after_nm,
        mostly(torque),
        percent(torque.fraction),
        percent(torque.low),
        percent(torque.high),
    );
    match d.verdict {
        Verdict::NoGap => format!(
            "No gap: the twin's torque agrees with the recorded one as far as its noise lets one \
             see ({:.2} N.m apart).",
            torque.before_nm
        ),
        Verdict::Explained => {
            format!(
                "The twin lacks {}; with it {shrunk}, and nothing systematic is left.",
                causes(d)
            )
        }
        Verdict::PartlyExplained => format!(
            "The twin lacks {}; with it {shrunk}, but something systematic is left{}.",
            causes(d),
            remark(&d.leftover.says)
        ),
        Verdict::Unexplained => format!(
            "The twin differs by {:.2} N.m{}, and no effect of the catalogue is shown to be the \
             cause{}.",
            torque.before_nm,
            worst(d),
            remark(&d.leftover.says)
        ),
    }
}

/// Of the joint where most of its own gap is gone, if the noise of the others hides that in the sum.
fn mostly(torque: &TorqueShrink) -> String {
    let most = torque.joints.iter().max_by(|a, b| a.fraction.total_cmp(&b.fraction));
    match most.filter(|j| j.fraction > HIDDEN * torque.fraction.max(0.0)) {
        Some(j) => {
            format!(" (from {:.2} to {:.2} at joint {})", j.before_nm, j.after_nm, j.joint)
        }
        None => String::new(),
    }
}

/// When something pushed at the arm, as far as one force explains what stands out there.
fn pushes(d: &Diagnosis) -> String {
    let times = |e: &Episode| format!("{:.1} to {:.1} s ({})", e.start, e.end, e.recording);
    let all: Vec<String> = d.episodes.iter().filter(|e| e.is_push()).map(times).collect();
    match all.is_empty() {
        true => String::new(),
        false => format!(" Something pushes at the flange: {}.", all.join(", ")),
    }
}

/// Every effect once, with all its joints and the least of their probabilities.
fn causes(d: &Diagnosis) -> String {
    let alike = |a: &Cause, b: &Cause| a.effect == b.effect && a.joints.len() == b.joints.len();
    let is_first = |(i, c): &(usize, &Cause)| !d.causes[..*i].iter().any(|before| alike(before, c));
    let one = |(_, first): (usize, &Cause)| {
        let all: Vec<&Cause> = d.causes.iter().filter(|c| alike(first, c)).collect();
        let mut joints: Vec<usize> = all.iter().flat_map(|c| c.joints.iter().copied()).collect();
        joints.sort_unstable();
        let least = all.iter().map(|c| c.probability).fold(1.0, f64::min);
        let same = all.iter().any(|c| !c.equivalent.is_empty());
        let also = if same { ", or what looks the same here" } else { "" };
        format!("{} at {} ({}{also})", first.effect, place(&joints), percent(least))
    };
    let named: Vec<String> = d.causes.iter().enumerate().filter(is_first).map(one).collect();
    match named.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => named.concat(),
    }
}

/// Where most of the gap lies.
fn worst(d: &Diagnosis) -> String {
    let joints = d.gap.joints.iter();
    match joints.max_by(|a, b| a.share.total_cmp(&b.share)).filter(|j| j.share > 0.0) {
        Some(j) => format!(", {} of it on joint {}", percent(j.share), j.joint),
        None => String::new(),
    }
}

fn remark(text: &str) -> String {
    let text = text.trim().trim_end_matches('.');
    if text.is_empty() { String::new() } else { format!(" ({text})") }
}

/// Header and cells of a table of stretches that stand out.
pub const EPISODES: [&str; 6] =
    ["recording", "time s", "joints", "peak N.m", "force at the flange N", "explains"];

pub fn episode(e: &Episode) -> Vec<String> {
    let force: Vec<String> = e.force_n.iter().map(|f| format!("{f:.0}")).collect();
    vec![
        e.recording.clone(),
        format!("{:.1} .. {:.1}", e.start, e.end),
        list(&e.joints),
        format!("{:.1}", e.peak_nm),
        if e.is_push() { force.join(" ") } else { "-".into() },
        percent(e.explained.max(0.0)),
    ]
}

/// What that table shows.
pub const LOUDER: &str = "louder than anything in the other recording; a contact where one force \
                          at the flange explains it";

/// "97 %"; never "100 %" for less than that.
pub fn percent(share: f64) -> String {
    match share {
        s if s < 1.0 && s > 0.995 => format!("{:.1} %", (1000.0 * s).floor() / 10.0),
        s => format!("{:.0} %", 100.0 * s),
    }
}
