//! A twin for simulators that know nothing of it: URDF and MuJoCo's MJCF, each with the effects it can
//! hold and a comment on those it cannot.

mod mjcf;
mod plan;
#[cfg(test)]
mod tests;
mod urdf;

pub use plan::{JointPlan, Left, Plan};

use crate::twin::Twin;

/// What a twin can be written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    Mjcf,
    Urdf,
}

/// The file's text, and what of the twin is not in it.
pub struct Exported {
    pub text: String,
    pub left: Vec<Left>,
}

/// Writes `twin` for a simulator; `source` names it in the head comment.
pub fn export(twin: &Twin, target: Target, source: &str) -> Exported {
    let plan = Plan::of(twin);
    let mut left = plan.left.clone();
    left.extend(match target {
        Target::Mjcf => mjcf::left(&plan),
        Target::Urdf => urdf::left(&plan),
    });
    let head = head(twin, source, &left);
    let text = match target {
        Target::Mjcf => mjcf::write(&plan, &head),
        Target::Urdf => urdf::write(&plan, &head),
    };
    Exported { text, left }
}

/// Lines of the comment at the top.
fn head(twin: &Twin, source: &str, left: &[Left]) -> Vec<String> {
    let version = env!("CARGO_PKG_VERSION");
    let mut lines = vec![
        format!(
            "Made by `armtwin export` {version} from the twin {source} (robot {}).",
            twin.source
        ),
        "SI units: m, kg, rad, N.m, s.".into(),
    ];
    if left.is_empty() {
        lines.push("Everything the twin knows is in this file.".into());
    } else {
        lines.push("What the twin knows and this format cannot hold:".into());
        lines.extend(left.iter().map(|l| format!("  {l}")));
    }
    lines.iter().map(|line| in_comment(line)).collect()
}

/// Two hyphens end a comment in XML.
fn in_comment(text: &str) -> String {
    text.replace("--", "- -").replace(['<', '>'], " ")
}

/// Plain digits that read back as the same bits; without a negative zero.
fn number(x: f64) -> String {
    (x + 0.0).to_string()
}

fn numbers<'a>(values: impl IntoIterator<Item = &'a f64>) -> String {
    values.into_iter().map(|x| number(*x)).collect::<Vec<_>>().join(" ")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
