//! What the catalogue says of an effect, in the words of terminal and guide.

use crate::effects::{About, Effect, Parameter, Role, RoundTrip, Scope, Seen};

pub fn shows_as(seen: Seen) -> &'static str {
    match seen {
        Seen::Columns => "as torque, in the recorded motion through inverse dynamics",
        Seen::Channels => "as torque and motion that do not belong together in time",
        Seen::Simulation => {
            "only where the recorded command is simulated again: recorded motion and torque agree"
        }
    }
}

pub fn on(about: &About) -> &'static str {
    match about.scope {
        Scope::Joint => "each joint",
        Scope::Link => "each, felt by all",
        Scope::Arm => "the whole arm",
    }
}

pub fn enters(p: &Parameter) -> &'static str {
    match p.role {
        Role::Linear => "linear",
        Role::Nonlinear => "nonlinear",
    }
}

/// Large and small numbers by powers of ten.
pub fn number(x: f64) -> String {
    let plain = x == 0.0 || x.is_infinite() || (1e-3..1e5).contains(&x.abs());
    if plain { x.to_string() } else { format!("{x:e}") }
}

pub fn range(p: &Parameter) -> String {
    format!("{} to {}", number(p.min), number(p.max))
}

/// The number worked out by hand.
pub fn by_hand(effect: &dyn Effect) -> Option<String> {
    let worked = effect.worked()?;
    let given: Vec<_> = worked.values.iter().map(|(name, v)| format!("{name} {v}")).collect();
    let unit = if worked.unit == "-" { String::new() } else { format!(" {}", worked.unit) };
    let result = (1e4 * worked.result).round() / 1e4;
    Some(format!("{} = {result}{unit} ({})", worked.by_hand, given.join(", ")))
}

/// What comes back of its scenario.
pub fn comes_back(effect: &dyn Effect) -> Option<String> {
    Some(match effect.round_trip()? {
        RoundTrip::Fitted { strengths: [a, b], shows, .. } => {
            let all = "every fitted value in its 99 % interval or close by";
            let at = format!("at {a} and {b} times the scenario's strength");
            match shows.is_empty() {
                true => format!("{all}, {at}"),
                false => format!("{all}, {} told from zero, {at}", shows.join(" and ")),
            }
        }
        RoundTrip::Corrected { .. } => {
            "torque that the usual friction explains as well as without it, once its values are known"
                .into()
        }
        RoundTrip::Strays { joint, times } => format!(
            "nothing in the torque; joint {} is more than {times} times as far off its command",
            joint + 1
        ),
        RoundTrip::Followed { within } => format!(
            "every value within {:.0} %, from command and position alone",
            100.0 * within
        ),
        RoundTrip::Steps { channel, joint, parameter } => {
            format!("{channel} of joint {} on steps of {parameter}", joint + 1)
        }
    })
}
