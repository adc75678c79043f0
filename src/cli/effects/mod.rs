//! `armtwin effects [NAME]`: the catalogue.

mod guide;

use std::fmt::Write as _;

use super::outputs::Output;
use super::{out, save};
use crate::effects::{About, CATALOGUE, Parameter, Role, Scope, Seen, find, names};
use crate::files;
use crate::report::{paragraph, table};

/// List the physical effects the twin can inject and explain
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  armtwin effects              all effects and their parameters
  armtwin effects stribeck     one effect: law, cause, remedy, source, how to write it in a file
  armtwin effects --json       everything, for a program
  armtwin effects --guide      the chapter of the user's guide, in Markdown")]
pub struct Args {
    /// Show one effect in full
    #[arg(value_name = "NAME", value_parser = about)]
    effect: Option<&'static About>,
    /// Write everything as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
    /// Print the user's guide to all effects
    #[arg(long, conflicts_with_all = ["effect", "json"])]
    guide: bool,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let all = || CATALOGUE.iter().map(|e| e.about());
    if args.guide {
        out::document(&guide::chapter());
        return Ok(());
    }
    let (effect, json) = args.asked();
    if json.as_deref().is_some_and(files::is_stdout) {
        out::leave_to_the_file();
    }
    println!("{}", effect.map_or_else(|| overview(all()), details));
    match (json, effect) {
        (Some(path), Some(about)) => save::document(&path, about),
        (Some(path), None) => save::document(&path, &all().collect::<Vec<_>>()),
        (None, _) => Ok(()),
    }
}

impl Args {
    /// `--json NAME` names an effect, not a file.
    fn asked(&self) -> (Option<&'static About>, Option<Output>) {
        let file = self.json.as_ref().filter(|_| self.effect.is_none()).and_then(|f| f.to_str());
        match file.and_then(find) {
            Some(effect) => (Some(effect.about()), Some(Output::stdout())),
            None => (self.effect, self.json.clone()),
        }
    }
}

fn about(name: &str) -> Result<&'static About, String> {
    let effect = find(name).ok_or_else(|| format!("choose from {}", names()))?;
    Ok(effect.about())
}

fn overview(all: impl Iterator<Item = &'static About> + Clone) -> String {
    let header = ["effect", "parameter", "symbol", "unit", "enters", "range", "typical"];
    let rows = all.clone().flat_map(|about| about.parameters.iter().map(move |p| row(about, p)));
    let causes = all.map(|about| vec![about.name.into(), about.law.into(), on(about).into()]);
    format!(
        "{}\n\n{}\n\nTorque the drive must supply on top of the rigid body, N.m; typical for a joint \
         of a UR5.\nCause, remedy and source of one effect: armtwin effects NAME",
        table(&header, 5, rows),
        table(&["effect", "law", "acts on"], 3, causes)
    )
}

fn row(about: &About, p: &Parameter) -> Vec<String> {
    let texts = [about.name, p.name, p.symbol, p.unit, enters(p)].map(String::from);
    [texts.to_vec(), vec![range(p), number(p.typical)]].concat()
}

fn details(about: &About) -> String {
    let mut text = format!("{}  ({})\n\n  {}\n\n", about.name, on(about), about.law);
    let seen = find(about.name).map_or("", |e| shows_as(e.seen()));
    for (label, what) in [
        ("shows", seen),
        ("cause", about.cause),
        ("remedy", about.remedy),
        ("source", about.source),
    ] {
        text += &paragraph(&format!("  {label:<8}"), what);
    }
    let header = ["parameter", "symbol", "unit", "enters", "sign", "range", "typical", "absent at"];
    let rows = about.parameters.iter().map(|p| {
        let absent = if p.null.is_nan() { "-".into() } else { p.null.to_string() };
        let texts = [p.name, p.symbol, p.unit, enters(p), sign(p)].map(String::from);
        [texts.to_vec(), vec![range(p), number(p.typical), absent]].concat()
    });
    let _ = write!(text, "\n{}\n\n{}", table(&header, 5, rows), examples(about));
    text
}

/// What a scenario and a twin say to have this effect.
fn examples(about: &About) -> String {
    let values = |per_line: fn(&Parameter) -> String| -> String {
        about.parameters.iter().map(per_line).collect::<Vec<_>>().join("\n")
    };
    let typical = values(|p| format!("  {} = {:?}", p.name, p.typical));
    format!(
        "To simulate it, in SCENARIO.toml:\n  [effects.{0}]\n{typical}\n\n\
         To let a twin know it, in TWIN.toml (without values it is fitted):\n  [twin]\n  \
         effects = [\"{0}\"]\n  [twin.values]\n{typical}",
        about.name
    )
}

fn shows_as(seen: Seen) -> &'static str {
    match seen {
        Seen::Columns => "as torque, in the recorded motion through inverse dynamics",
        Seen::Channels => "as torque and motion that do not belong together in time",
        Seen::Simulation => {
            "only where the recorded command is simulated again: recorded motion and torque agree"
        }
    }
}

fn on(about: &About) -> &'static str {
    match about.scope {
        Scope::Joint => "each joint",
        Scope::Link => "each, felt by all",
        Scope::Arm => "the whole arm",
    }
}

fn enters(p: &Parameter) -> &'static str {
    match p.role {
        Role::Linear => "linear",
        Role::Nonlinear => "nonlinear",
    }
}

fn sign(p: &Parameter) -> &'static str {
    if p.min < 0.0 { "either" } else { "not negative" }
}

/// Large and small numbers by powers of ten.
fn number(x: f64) -> String {
    let plain = x == 0.0 || x.is_infinite() || (1e-3..1e5).contains(&x.abs());
    if plain { x.to_string() } else { format!("{x:e}") }
}

fn range(p: &Parameter) -> String {
    format!("{} to {}", number(p.min), number(p.max))
}
