//! A study of many noises as a table and in sentences.

use super::render::{Grid, setting};
use super::study::{CONVENTIONS, Counts, Study};

/// Kept and covered, per parameter and convention, as shares in percent.
pub fn grid(study: &Study) -> Grid {
    Grid {
        title: title(study),
        header: vec![
            "parameter",
            "exists",
            "median error %",
            "largest",
            "kept: robust",
            "asymptotic",
            "paper's",
            "covered: robust",
            "asymptotic",
            "paper's",
        ],
        left: 2,
        rows: study.parameters.iter().map(row).collect(),
    }
}

fn title(study: &Study) -> String {
    format!(
        "Scenario {}, {}, measured: {}, {} noise seeds from {} ({} failed, {} ended at a minimum \
         of the cost): error, kept % (nominal 100 where the term exists, 1 where not) and coverage \
         % (nominal 99)",
        study.scenario,
        study.method,
        setting(&study.measured, &study.given),
        study.seeds,
        study.first_seed,
        study.failed,
        study.at_minimum
    )
}

fn row(c: &Counts) -> Vec<String> {
    let exists = match c.truth {
        _ if c.tests == 0 => "given",
        0.0 => "no",
        _ => "yes",
    };
    let mut row = vec![c.name.to_string(), exists.to_string()];
    let error = |e: Option<f64>| e.map_or("-".into(), |e| format!("{e:.2}"));
    row.extend([0, 1].map(|n| error(c.error_percent.map(|e| e[n]))));
    row.extend(c.kept.map(|n| share(n, c.tests)));
    row.extend(c.covered.map(|n| share(n, c.intervals)));
    row
}

fn share(count: usize, of: usize) -> String {
    match of {
        0 => "-".into(),
        _ => format!("{:.1}", 100.0 * count as f64 / of as f64),
    }
}

/// Existence and coverage by convention, over all terms of the study.
pub fn answer(study: &Study) -> String {
    let total = |exists: bool, of: &dyn Fn(&Counts) -> usize| -> usize {
        study.parameters.iter().filter(|c| (c.truth != 0.0) == exists).map(of).sum()
    };
    let mut text = String::new();
    for (n, convention) in CONVENTIONS.iter().enumerate() {
        let kept = |exists| (total(exists, &|c| c.kept[n]), total(exists, &|c| c.tests));
        let (true_kept, true_tests) = kept(true);
        let (false_kept, false_tests) = kept(false);
        let covered = |exists| total(exists, &|c| c.covered[n]);
        let intervals: usize = study.parameters.iter().map(|c| c.intervals).sum();
        text += &format!("* {convention}: {true_kept} of {true_tests} true terms kept, ");
        if false_tests > 0 {
            let rate = share(false_kept, false_tests);
            text += &format!(
                "{false_kept} of {false_tests} absent ones ({rate} % false positives, nominal 1), "
            );
        }
        let covered = covered(true) + covered(false);
        let coverage = share(covered, intervals);
        text += &format!(
            "{covered} of {intervals} intervals hold the truth ({coverage} %, nominal 99)\n"
        );
    }
    text
}
