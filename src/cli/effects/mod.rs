//! `armtwin effects [NAME]`: the catalogue.

mod example;
mod guide;
mod typical;
mod words;

use std::fmt::Write as _;

use self::example::{example, rounded};
use self::words::{by_hand, comes_back, enters, number, on, range, shows_as};
use super::outputs::Output;
use super::{out, save};
use crate::effects::{About, CATALOGUE, Effect, Parameter, find, names};
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
    let causes =
        all.clone().map(|about| vec![about.name.into(), about.law.into(), on(about).into()]);
    format!(
        "{}\n\n{}\n\nJoint 2 of a UR5 turns around; recorded before and after the effect came, on the way \
         out and back\n\n{}\n\nTorque the drive must supply on top of the rigid body, N.m; typical for a joint \
         of a UR5.\nCause, remedy and source of one effect: armtwin effects NAME",
        table(&header, 5, rows),
        table(&["effect", "law", "acts on"], 3, causes),
        table(
            &["effect", "channel", "out", "after", "back", "after"],
            2,
            all.filter_map(out_and_back)
        )
    )
}

fn row(about: &About, p: &Parameter) -> Vec<String> {
    let texts = [about.name, p.name, p.symbol, p.unit, enters(p)].map(String::from);
    [texts.to_vec(), vec![range(p), number(p.typical)]].concat()
}

/// The example at an instant on the way out and at one on the way back.
fn out_and_back(about: &'static About) -> Option<Vec<String>> {
    let example = example(find(about.name)?)?;
    let two = |x: &[f64]| [x.get(1), x.last()].map(|x| x.map_or("-".into(), |x| rounded(*x, 3)));
    let ([out, back], [out_after, back_after]) = (two(&example.before), two(&example.after));
    Some(vec![about.name.into(), example.channel.into(), out, out_after, back, back_after])
}

fn details(about: &About) -> String {
    let mut text = format!("{}  ({})\n\n  {}\n\n", about.name, on(about), about.law);
    let effect = find(about.name);
    let said = |what: fn(&dyn Effect) -> Option<String>| effect.and_then(what).unwrap_or_default();
    for (label, what) in [
        ("shows", said(|e| Some(shows_as(e.seen()).into()))),
        ("cause", about.cause.into()),
        ("remedy", about.remedy.into()),
        ("source", about.source.into()),
        ("by hand", said(by_hand)),
        ("back", said(comes_back)),
    ] {
        text += &paragraph(&format!("  {label:<8}"), &what);
    }
    let header = ["parameter", "symbol", "unit", "enters", "sign", "range", "typical", "absent at"];
    let rows = about.parameters.iter().map(|p| {
        let absent = if p.null.is_nan() { "-".into() } else { p.null.to_string() };
        let texts = [p.name, p.symbol, p.unit, enters(p), sign(p)].map(String::from);
        [texts.to_vec(), vec![range(p), number(p.typical), absent]].concat()
    });
    let _ = write!(text, "\n{}\n\n", table(&header, 5, rows));
    if let Some(example) = effect.and_then(example) {
        let mut rows = example.rows().into_iter();
        let header = rows.next().unwrap_or_default();
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        let _ = write!(text, "Joint 2 of a UR5 turns around:\n{}\n\n", table(&header, 1, rows));
    }
    text += &examples(about);
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

fn sign(p: &Parameter) -> &'static str {
    if p.min < 0.0 { "either" } else { "not negative" }
}
