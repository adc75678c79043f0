//! An identification on one screen: values with intervals, how well they fit, what was found.

use super::{Report, links, print, scale};
use crate::identification::{self, JointEstimate, MethodResult, ParameterEstimate, Standing};
use crate::report::{table, to_uncertainty};
use crate::workflow::words;

pub fn print(report: &Report<'_>) {
    let what =
        [Some(&report.fit), report.check.as_ref()].into_iter().flatten().zip(["fit", "check"]);
    for (used, what) in what {
        println!("{what:8} {}", used.provenance.source);
        used.provenance.notes.iter().for_each(|note| println!("         {note}"));
    }
    print::searched(&report.located).iter().for_each(|line| println!("searched {line}"));
    report.scaled.iter().for_each(scale::print);
    let Some(result) = report.preferred() else { return };
    println!(
        "\nValues by {}, +- half the width of the 99 % interval; (0?): the interval holds zero, the \
         parameter may be absent",
        result.method.to_uppercase()
    );
    println!("{}", values(result));
    println!("\n{}", agreement(&report.results));
    result.arm.iter().for_each(|p| println!("arm: {} {}", p.name, with_unit(p)));
    report.links_spread.iter().for_each(|spread| print::payload_note(*spread));
    report.dropped.iter().filter(|d| !d.is_empty()).for_each(|dropped| {
        println!("\nNot shown by these data and left out:");
        words::dropped(dropped).iter().for_each(|line| println!("  {line}"));
    });
    print::reasons(result);
    report.rigid_body.iter().for_each(links::print);
    println!("\nWhat {} found", result.method);
    identification::verdict(result).iter().for_each(|line| println!("  {line}"));
    let (version, seed) = (env!("CARGO_PKG_VERSION"), report.settings.seed);
    println!("\narmtwin {version}, seed {seed}; tests, other intervals and searches: --full");
}

/// Values with intervals; then how well the torque fits.
fn values(result: &MethodResult) -> String {
    let left = |mse: f64| format!("{:.3}", mse.sqrt());
    let quality: [Quality<'_>; 3] = [
        ("torque left, fit", "N.m", &|j| Some(left(j.fit.mse_nm2))),
        ("torque left, check", "N.m", &|j| j.check.map(|c| left(c.mse_nm2))),
        ("share explained, fit", "R2", &|j| Some(format!("{:.4}", j.fit.r2))),
    ];
    by_joint(result, |_, p| Some(cell(p)), &[&quality[..], &[EXPLAINED_ON_CHECK]].concat())
}

/// What is said of a joint as a whole: name, unit, text.
type Quality<'a> = (&'a str, &'a str, &'a dyn Fn(&JointEstimate) -> Option<String>);

pub const EXPLAINED_ON_CHECK: Quality<'static> =
    ("share explained, check", "R2", &|j| j.check.map(|c| format!("{:.4}", c.r2)));

/// A row per parameter, a column per joint; then a row per `quality` that any joint has.
pub fn by_joint(
    result: &MethodResult,
    cell: impl Fn(usize, &ParameterEstimate) -> Option<String>,
    quality: &[Quality<'_>],
) -> String {
    let mut names: Vec<(&str, &str)> = Vec::new();
    for p in result.joints.iter().flat_map(|j| &j.parameters) {
        if !names.iter().any(|(name, _)| *name == p.name) {
            names.push((&p.name, &p.unit));
        }
    }
    let joints: Vec<String> = result.joints.iter().map(|j| format!("joint {}", j.joint)).collect();
    let header: Vec<&str> =
        ["parameter", "unit"].into_iter().chain(joints.iter().map(String::as_str)).collect();
    let row = |name: &str, unit: &str, cells: Vec<String>| {
        [name.to_string(), unit.to_string()].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let values = names.iter().map(|(name, unit)| {
        let of = |j: &JointEstimate| {
            let p = j.parameters.iter().find(|p| p.name == *name);
            p.and_then(|p| cell(j.joint, p)).unwrap_or_else(|| "-".into())
        };
        row(name, unit, result.joints.iter().map(of).collect())
    });
    let quality = quality.iter().filter_map(|(what, unit, of)| {
        let cells: Vec<Option<String>> = result.joints.iter().map(of).collect();
        let some = cells.iter().any(Option::is_some);
        some.then(|| row(what, unit, cells.into_iter().map(Option::unwrap_or_default).collect()))
    });
    table(&header, 2, values.chain(quality))
}

/// `6.21 +-0.05`, `not determined`
fn cell(p: &ParameterEstimate) -> String {
    if !p.identifiable {
        return "not determined".into();
    }
    let [value, _, _] = to_uncertainty(p.value, p.low, p.high);
    let digits = value.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    let half = (p.high - p.value).max(p.value - p.low);
    let remark = match (identification::standing(p), p.at_bound) {
        (_, true) => " at bound",
        (Standing::MayBeZero, _) => " (0?)",
        _ => "",
    };
    format!("{value} +-{half:.digits$}{remark}")
}

fn with_unit(p: &ParameterEstimate) -> String {
    format!("{} {}", cell(p), p.unit)
}

/// Costs within this share of each other are the same minimum.
const SAME: f64 = 1e-4;

/// Where one method ends above another, in a line.
pub fn agreement(results: &[MethodResult]) -> String {
    let names: Vec<String> = results.iter().map(|r| r.method.to_uppercase()).collect();
    let Some(joints) = results.iter().map(|r| r.joints.len()).min().filter(|_| results.len() > 1)
    else {
        return format!("fitted by {}", names.concat());
    };
    let above = |j: usize| {
        let costs = results.iter().map(|r| r.joints[j].cost);
        let least = costs.clone().fold(f64::INFINITY, f64::min);
        costs.fold(0.0, |most: f64, c| most.max(c / least - 1.0))
    };
    let apart: Vec<String> =
        (0..joints).filter(|j| above(*j) > SAME).map(|j| (j + 1).to_string()).collect();
    match apart.is_empty() {
        true => format!("{} agree: the same cost at every joint to 0.01 %", names.join(" and ")),
        false => {
            let most = (0..joints).map(above).fold(0.0, f64::max);
            format!(
                "{} differ at joint {}: one of them ends up to {:.2} % above the other's cost (--full)",
                names.join(" and "),
                apart.join(", "),
                100.0 * most
            )
        }
    }
}
