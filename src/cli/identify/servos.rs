//! `armtwin identify` of position servos, for people.

use std::path::Path;

use anyhow::bail;

use super::Args;
use crate::cli::twin::Arm;
use crate::cli::{out, save};
use crate::diagnosis::By;
use crate::report::{paragraph, table};
use crate::servo::{Estimate, PositionGap};
use crate::workflow::{IdentifiedServos, Told};

/// Prints and writes what was found.
pub fn run(args: &Args, arm: &Arm, found: &IdentifiedServos) -> anyhow::Result<()> {
    out::page(&format!("{}\n{}\n\n{}", arm.line(), By::Simulation.line(), page(found)));
    if let Some(path) = &args.json {
        save::document(path, &found.document())?;
    }
    if let Some(path) = &args.save_twin {
        found.fitted.twin.save(path)?;
        println!("\nTwin with these values: {}", path.display());
    }
    Ok(())
}

/// What only torque can tell is refused before the work begins.
pub fn refuse_flags(args: &Args) -> anyhow::Result<()> {
    let flags = [
        ("--report", args.report.is_some()),
        ("--save-urdf", args.save_urdf.is_some()),
        ("--loaded", args.load.given().is_some()),
    ];
    if let Some((flag, _)) = flags.iter().find(|(_, given)| *given) {
        bail!(
            "{flag} needs recorded torque: leave it out where an arm is identified by simulation"
        );
    }
    Ok(())
}

fn page(found: &IdentifiedServos) -> String {
    let fitted = &found.fitted;
    let ended = match fitted.stop.converged() {
        true => "converged",
        false => "at the most evaluations",
    };
    format!(
        "{}\n{} position errors, {} simulations of all of it, {:.1} s; ended: {ended}\n\nPosition error, mean \
         size and root mean square in mrad; rounding: what the encoder's steps alone leave\n{}{}",
        values(&fitted.estimates),
        fitted.samples,
        fitted.evaluations,
        found.seconds,
        errors(found),
        offsets(found)
    )
}

/// What loggers did otherwise.
fn offsets(found: &IdentifiedServos) -> String {
    let first = found.fit.first().map_or_else(String::new, name);
    let line = |told: &Told| told.time_offset.and_then(|o| o.line(&name(told), &first));
    let lines = found.fit.iter().chain(&found.check).filter_map(line);
    lines.map(|line| format!("\n\n{}", paragraph("", &line))).collect()
}

fn name(told: &Told) -> String {
    let source = Path::new(&told.provenance.source);
    source.file_name().map_or_else(String::new, |n| n.to_string_lossy().into())
}

fn errors(found: &IdentifiedServos) -> String {
    let head = ["recording", "joint", "mean before", "after", "rms before", "after", "rounding"];
    let fit = found.fit.iter().zip(&found.fitted.before).zip(&found.fitted.after);
    let fit = fit.flat_map(|((told, before), after)| rows("fit", told, before, after));
    let check = found.check.iter().zip(&found.checked);
    let check = check.flat_map(|(told, [before, after])| rows("check", told, before, after));
    table(&head, 1, fit.chain(check))
}

fn rows(kind: &str, told: &Told, before: &PositionGap, after: &PositionGap) -> Vec<Vec<String>> {
    let name = name(told);
    let mrad = |rad: f64| format!("{:.2}", 1e3 * rad);
    let both = before.joints.iter().zip(&after.joints);
    both.map(|(b, a)| {
        vec![
            format!("{kind} {name}"),
            b.joint.to_string(),
            mrad(b.mean_abs_rad),
            mrad(a.mean_abs_rad),
            mrad(b.rms_rad),
            mrad(a.rms_rad),
            mrad(b.rounding_rad),
        ]
    })
    .collect()
}

fn values(estimates: &[Estimate]) -> String {
    let head = ["parameter", "joint", "value", "99 % interval", "unit", ""];
    let row = |e: &Estimate| {
        let interval = match e.identifiable {
            true => format!("{:.4} .. {:.4}", e.low, e.high),
            false => String::new(),
        };
        let remark = match (e.identifiable, e.at_bound) {
            (false, _) => "not told by these data",
            (_, true) => "at its bound",
            _ => "",
        };
        vec![
            e.name.to_string(),
            e.joint.map_or_else(|| "arm".into(), |j| j.to_string()),
            format!("{:.4}", e.value),
            interval,
            e.unit.into(),
            remark.into(),
        ]
    };
    table(&head, 1, estimates.iter().map(row)) + "\n"
}
