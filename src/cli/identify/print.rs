//! Tables of an identification for people.

use super::{Report, links, scale};
use crate::identification::{
    self, Dropped, Interval, JointEstimate, Located, MethodResult, ParameterEstimate, Standing,
};
use crate::report::{table, to_uncertainty};
use crate::workflow::{Used, words};

pub fn print(report: &Report<'_>) {
    println!("armtwin {}  identify  seed {}", env!("CARGO_PKG_VERSION"), report.settings.seed);
    println!("robot    {}", report.twin.source);
    print_source("fit", &report.fit);
    report.check.iter().for_each(|c| print_source("check", c));
    if let Some(scaled) = &report.scaled {
        println!("loaded   {}", scaled.loaded.source);
    }
    println!("fitted   {}", report.terms.names().join(", "));
    if report.args.arm.twin.is_some() && report.args.terms.is_empty() && report.args.with.is_empty()
    {
        println!(
            "         (what the twin lists without values; more by --with paper,rotor_inertia,offset)"
        );
    }
    searched(&report.located).iter().for_each(|line| println!("searched {line}"));
    println!("signals  {}", words::signals(report));
    report.dropped.iter().for_each(|d| print_dropped(d));
    report.scaled.iter().for_each(scale::print);
    for result in &report.results {
        print_method(result);
    }
    report.links_spread.iter().for_each(|spread| payload_note(*spread));
    report.rigid_body.iter().for_each(links::print);
    if let Some(result) = report.results.last() {
        println!("\nWhat {} found", result.method);
        identification::verdict(result).iter().for_each(|line| println!("  {line}"));
    }
}

/// How sure a payload is beside links that are as unsure as these data say.
pub fn payload_note(spread: f64) {
    println!(
        "\npayload: beside links within {:.1} % of the model's, as these data call for; a twin that is \
         saved has the value that fits best with the model's links",
        100.0 * spread
    );
}

/// Which nonlinear parameters were searched for and where they are none, one line per effect.
pub fn searched(located: &[Located]) -> Vec<String> {
    let mut effects: Vec<&str> = located.iter().map(|l| l.effect.about().name).collect();
    effects.dedup();
    let line = |effect: &str| {
        let here: Vec<&Located> =
            located.iter().filter(|l| l.effect.about().name == effect).collect();
        let joints = |shown: bool| {
            let of = here.iter().filter(|l| l.open.is_empty() != shown);
            of.map(|l| (l.joint + 1).to_string()).collect::<Vec<_>>().join(", ")
        };
        let Some(found) = here.iter().find(|l| !l.open.is_empty()) else {
            return format!("{effect}: shows at no joint");
        };
        let absent = match joints(false) {
            none if none.is_empty() => String::new(),
            joints => format!("; not shown and left out at joint {joints}"),
        };
        format!(
            "{effect}: {} from {} starts at joint {}, which no p counts{absent}",
            found.searched().join(", "),
            found.starts,
            joints(true)
        )
    };
    effects.into_iter().map(line).collect()
}

fn print_dropped(all: &[Dropped]) {
    println!("dropped  {}", if all.is_empty() { "nothing: every term is shown" } else { "" });
    words::dropped(all).iter().for_each(|line| println!("         {line}"));
}

fn print_source(what: &str, used: &Used) {
    let provenance = &used.provenance;
    println!("{what:8} {} ({})", provenance.source, provenance.format);
    for note in provenance.notes.iter().chain(&used.samples.notes) {
        println!("         {note}");
    }
}

const PARAMETERS: [&str; 14] = [
    "joint",
    "parameter",
    "unit",
    "value",
    "99 % low",
    "high",
    "t",
    "p",
    "white noise low",
    "high",
    "Eq. 8 low",
    "high",
    "searched within",
    "",
];

fn print_method(result: &MethodResult) {
    println!("\n{}", result.method.to_uppercase());
    let joints = result
        .joints
        .iter()
        .flat_map(|j| j.parameters.iter().map(move |p| parameter_row(j.joint.to_string(), p)));
    let arm = result.arm.iter().map(|p| parameter_row("arm".into(), p));
    println!("{}", table(&PARAMETERS, 3, joints.chain(arm)));
    print_intervals(result);
    let checked = result.joints.iter().any(|j| j.check.is_some());
    println!("\n{}", table(&search_header(checked), 1, result.joints.iter().map(search_row)));
    reasons(result);
}

fn print_intervals(result: &MethodResult) {
    let joints = result.joints.iter().flat_map(|j| j.parameters.iter().map(move |p| (j.joint, p)));
    let posterior = |(joint, p)| posterior_row(joint, p);
    let rows: Vec<Vec<String>> = joints.filter_map(posterior).collect();
    let others = "white noise: as if neighbouring residuals had nothing to do with each other, too narrow; \
                  Eq. 8: the paper's, too narrow by sqrt(n)";
    if rows.is_empty() {
        println!(
            "99 %: holds for residuals that hang together in time; t: value over standard error; p: chance of \
             such a value if there were none; {others}"
        );
        return;
    }
    println!(
        "99 %: credible, from a prior uniform within the bounds and autoregressive noise; value: \
         posterior mean; t: mean over standard deviation; p: twice the posterior mass beyond zero; \
         {others}"
    );
    println!("\n{}", table(&POSTERIOR, 2, rows));
}

const POSTERIOR: [&str; 11] = [
    "joint",
    "parameter",
    "mean",
    "median",
    "sd",
    "99 % low",
    "high",
    "R-hat",
    "ESS bulk",
    "ESS tail",
    "",
];

fn posterior_row(joint: usize, p: &ParameterEstimate) -> Option<Vec<String>> {
    let q = p.posterior?;
    let mut row = vec![joint.to_string(), p.name.clone()];
    row.extend([q.mean, q.median, q.standard_deviation, q.low, q.high].map(number));
    row.push(format!("{:.4}", q.convergence.r_hat));
    row.extend([q.convergence.ess_bulk, q.convergence.ess_tail].map(|n| format!("{n:.0}")));
    row.push(if q.converged { "" } else { "not converged" }.into());
    Some(row)
}

fn parameter_row(joint: String, p: &ParameterEstimate) -> Vec<String> {
    let remark = remark(p);
    let ends = |i: &Interval| [number(i.low), number(i.high)];
    let [value, low, high] = to_uncertainty(p.value, p.low, p.high);
    let mut row = vec![joint, p.name.clone(), p.unit.clone(), value];
    if p.identifiable {
        row.extend([low, high, format!("{:.1}", p.statistic), words::chance(p.p)]);
        row.extend(ends(&p.asymptotic));
        row.extend(ends(&p.paper));
    } else {
        row.extend(std::iter::repeat_n("-".to_string(), 8));
    }
    row.push(format!("{} .. {}", p.bounds[0], p.bounds[1]));
    row.push(remark.into());
    row
}

/// What stands beside a parameter's numbers.
fn remark(p: &ParameterEstimate) -> &'static str {
    match (identification::standing(p), p.at_bound) {
        (Standing::Open, _) => "not determined",
        (_, true) => "at its bound",
        (Standing::MayBeZero, false) => "may be zero",
        (Standing::Shown, false) => "",
    }
}

fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if !(1e-4..1e5).contains(&a) => format!("{x:.2e}"),
        a if a < 0.1 => format!("{x:.5}"),
        a if a < 10.0 => format!("{x:.4}"),
        _ => format!("{x:.3}"),
    }
}

fn search_header(checked: bool) -> Vec<&'static str> {
    let mut header =
        vec!["joint", "samples", "cost N.m", "evaluations", "ms", "stopped", "R2", "R2 (Eq. 20)"];
    header.push("MSE (N.m)2");
    if checked {
        header.extend(["check R2", "check R2 (Eq. 20)", "check MSE (N.m)2"]);
    }
    header
}

fn search_row(j: &JointEstimate) -> Vec<String> {
    let mut row = vec![
        j.joint.to_string(),
        j.samples.to_string(),
        format!("{:.6}", j.cost),
        j.evaluations.to_string(),
        format!("{:.2}", 1e3 * j.seconds),
        j.stopped.replace('_', " "),
    ];
    for g in std::iter::once(&j.fit).chain(&j.check) {
        row.extend([
            format!("{:.4}", g.r2),
            format!("{:.4}", g.r2_printed),
            format!("{:.4}", g.mse_nm2),
        ]);
    }
    row
}

/// Why parameters are not determined, one line per joint and reason.
pub fn reasons(result: &MethodResult) {
    let mut lines: Vec<(String, String, Vec<String>)> = Vec::new();
    let joints = result.joints.iter().map(|j| (format!("joint {}", j.joint), &j.parameters));
    for (place, parameters) in joints.chain([("arm".to_string(), &result.arm)]) {
        for p in parameters {
            let Some(why) = &p.why_not else { continue };
            match lines.iter_mut().find(|l| l.0 == place && l.1 == *why) {
                Some(line) => line.2.push(p.name.clone()),
                None => lines.push((place.clone(), why.clone(), vec![p.name.clone()])),
            }
        }
    }
    if !lines.is_empty() {
        println!("\nNot determined by these data:");
    }
    for (place, why, names) in lines {
        println!("  {place}, {}: {why}", names.join(", "));
    }
}
