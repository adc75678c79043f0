//! docs/case-studies.md: the paper's figures and ours, side by side.

use std::collections::BTreeMap;

use super::boxes::Boxed;
use super::figures::Figure;
use super::motor::{Results, section};
use super::paper::{Printed, TABLE_V, TABLE_VI};
use super::ur5::Study;
use super::versus::Duel;
use super::versus_tables::{tight, versus};
use crate::identification::{Goodness, LEVEL, ParameterEstimate};
use crate::text::markdown_table;

/// All that the page shows.
pub struct Page<'a> {
    /// How it was made.
    pub command: String,
    pub injected: BTreeMap<&'static str, Vec<f64>>,
    pub synthetic: &'a Study,
    /// Absent without the recordings.
    pub real: Option<&'a Study>,
    /// By law and recording.
    pub duels: Vec<(String, Vec<Duel>)>,
    /// By law, on the synthetic recording.
    pub boxed: Vec<(String, Vec<Boxed>)>,
    pub figures: &'a [Figure],
    /// The DC motor; absent where it was left out.
    pub motor: Option<Results>,
}

impl Page<'_> {
    pub fn markdown(&self) -> String {
        [
            self.head(),
            self.table_v(),
            self.existence(),
            self.table_vi(),
            versus(&self.duels),
            tight(&self.boxed),
            self.posterior(),
            self.pictures(),
            self.motor.as_ref().map_or("## DC motor\n\nLeft out (--no-motor).\n".into(), section),
        ]
        .join("\n")
    }

    fn studies(&self) -> impl Iterator<Item = &Study> {
        std::iter::once(self.synthetic).chain(self.real)
    }

    fn head(&self) -> String {
        let real = match self.real {
            Some(r) => format!(
                "Real: the UR5 recording {} is fitted, {} is the check.",
                r.fit.source, r.check.source
            ),
            None => "**The real UR5 recordings were not there when this page was made: their \
                     columns are left out.**"
                .into(),
        };
        format!(
            "# The paper's case studies, reproduced\n\nMade by `{}` (armtwin {}); no number on \
             this page is typed by hand.\n\n## UR5\n\nSynthetic: `scenarios/ur5_paper.toml`, a UR5 \
             in rapier whose injected friction is what the paper's Table V identified by PSO, 28 dB. \
             {real} All fits: Eq. 1, rotor inertia (the paper has none) and current offset, all \
             intervals 99 % and robust to autocorrelation unless said otherwise.\n",
            self.command,
            env!("CARGO_PKG_VERSION")
        )
    }

    fn table_v(&self) -> String {
        let mut header = vec![
            "joint",
            "parameter",
            "paper PSO",
            "paper NLSE",
            "paper [LBCI UBCI]",
            "paper p",
            "injected",
        ];
        header.extend(["synthetic PSO", "synthetic NLSE", "reduced", "99 %", "p", "term"]);
        if self.real.is_some() {
            header.extend(["real PSO", "real NLSE", "reduced", "99 %", "p", "term"]);
        }
        let rows: Vec<_> = TABLE_V.iter().map(|printed| self.row_v(printed)).collect();
        let marks = TABLE_V.iter().filter_map(|r| {
            r.misprint.map(|m| format!("* {} of joint {}: {m}.\n", r.symbol, r.joint))
        });
        format!(
            "### Table V: parameters\n\nSI units. `?` marks misprints. tau_v2 and tau_v3 are taken \
             out joint by joint, the larger robust p first, until those left are significant; \
             \"reduced\" is NLSE then, with its interval and p. \"term\": kept (p below 0.01), not \
             shown, or dropped with the p it had when it went.\n\n{}\n{}",
            markdown_table(&header, 2, &rows),
            marks.collect::<String>()
        )
    }

    fn row_v(&self, r: &Printed) -> Vec<String> {
        let mark = if r.misprint.is_some() { " ?" } else { "" };
        let [low, high] = r.interval;
        let injected = self.injected.get(r.parameter).and_then(|v| v.get(r.joint - 1));
        let mut row = vec![
            r.joint.to_string(),
            format!("{}{mark}", r.symbol),
            number(r.pso),
            number(r.nlse),
            format!("[{} {}]", number(low), number(high)),
            number(r.p),
            injected.map_or("-".into(), |v| number(*v)),
        ];
        self.studies().for_each(|s| row.extend(ours(s, r)));
        row
    }

    fn existence(&self) -> String {
        let count = |s: &Study| {
            let powers = TABLE_V
                .iter()
                .filter(|r| ["viscous_quadratic", "viscous_cubic"].contains(&r.parameter));
            let dropped = powers.filter(|r| s.dropped(r.joint, r.parameter).is_some()).count();
            format!("{dropped} of 12 on the {} recording", s.name)
        };
        let counts: Vec<_> = self.studies().map(count).collect();
        format!(
            "The paper finds tau_v2 and tau_v3 to be zero at every joint. The robust test drops them \
             in {}.\n",
            counts.join(" and ")
        )
    }

    fn table_vi(&self) -> String {
        let mut header = vec!["joint", "paper R2 % PSO", "NLSE", "paper MSE (N.m)2 PSO", "NLSE"];
        for s in self.studies() {
            header.extend(match s.name {
                "real" => {
                    ["real R2 % PSO", "NLSE", "real R2 % (Eq. 20) NLSE", "real MSE PSO", "NLSE"]
                }
                _ => ["syn. R2 % PSO", "NLSE", "syn. R2 % (Eq. 20) NLSE", "syn. MSE PSO", "NLSE"],
            });
        }
        let values: Vec<Vec<f64>> = (0..6).map(|j| self.values_vi(j)).collect();
        let mut rows = Vec::new();
        for (set, joints) in [("mean 1-3", 0..3), ("mean 4-6", 3..6)] {
            let cells = |v: &[f64]| v.iter().map(|x| number(*x)).collect::<Vec<_>>();
            for j in joints.clone() {
                rows.push([vec![(j + 1).to_string()], cells(&values[j])].concat());
            }
            let mean: Vec<f64> = (0..values[0].len())
                .map(|k| joints.clone().map(|j| values[j][k]).sum::<f64>() / 3.0)
                .collect();
            rows.push([vec![set.to_string()], cells(&mean)].concat());
        }
        format!(
            "### Table VI: prediction of the check recording\n\nR2 is 1 - SSE/SST; the paper's Eq. \
             20 stands beside it and can exceed 100 %.\n\n{}",
            markdown_table(&header, 1, &rows)
        )
    }

    fn values_vi(&self, j: usize) -> Vec<f64> {
        let mut row = [TABLE_VI[j].r2_percent, TABLE_VI[j].mse_nm2].concat();
        for s in self.studies() {
            let of = |method: &str, f: fn(&Goodness) -> f64| {
                let result = s.results.iter().find(|r| r.method == method);
                result.and_then(|r| r.joints.get(j)?.check.as_ref().map(f)).unwrap_or(f64::NAN)
            };
            row.extend([
                of("pso", |g| 100.0 * g.r2),
                of("nlse", |g| 100.0 * g.r2),
                of("nlse", |g| 100.0 * g.r2_printed),
                of("pso", |g| g.mse_nm2),
                of("nlse", |g| g.mse_nm2),
            ]);
        }
        row
    }

    fn posterior(&self) -> String {
        let mut text = String::from(
            "### Posteriors by Markov chains\n\nUniform priors within the catalogue's bounds, \
             autoregressive Gaussian noise; four chains from Stribeck velocities spread over their \
             whole range. Converged means rank-normalised split R-hat below 1.01 and 400 effective \
             draws in bulk and tails. A posterior believes its model: on real recordings, where the \
             residual is not noise but what the law lacks, it is narrower than the robust \
             interval.\n\n",
        );
        let header = [
            "joint",
            "parameter",
            "mean",
            "median",
            "99 % credible",
            "R-hat",
            "ESS bulk",
            "ESS tail",
            "NLSE",
            "99 % robust",
            "prior",
            "",
        ];
        for s in self.studies() {
            let rows: Vec<_> = (1..=6).flat_map(|joint| rows_posterior(s, joint)).collect();
            text += &format!("{}\n\n{}\n", capital(s.name), markdown_table(&header, 2, &rows));
        }
        text
    }

    fn pictures(&self) -> String {
        let list =
            self.figures.iter().map(|f| format!("![{0}]({1})\n\n{0}\n\n", f.caption, f.file()));
        format!(
            "### Figures 5 to 17\n\nThe same in the viewer, paths in space: `armtwin case-studies \
             --out DIR --rrd FILE.rrd`.\n\n{}",
            list.collect::<String>()
        )
    }
}

fn ours(s: &Study, r: &Printed) -> Vec<String> {
    let value = |method| s.estimate(method, r.joint, r.parameter).map_or(f64::NAN, |e| e.value);
    let mut row = vec![number(value("pso")), number(value("nlse"))];
    let reduced = s.reduced(r.joint, r.parameter);
    let term = match (s.dropped(r.joint, r.parameter), reduced) {
        (Some(d), _) => format!("dropped ({})", number(d.p)),
        (None, Some(e)) if e.identifiable && e.p < 1.0 - LEVEL => "kept".into(),
        _ => "not shown".into(),
    };
    row.push(number(reduced.map_or(f64::NAN, |e| e.value)));
    row.push(reduced.map_or("-".into(), interval));
    row.push(reduced.filter(|e| e.identifiable).map_or("-".into(), |e| number(e.p)));
    row.push(term);
    row
}

fn interval(e: &ParameterEstimate) -> String {
    match e.identifiable {
        true => format!("[{} {}]", number(e.low), number(e.high)),
        false => "not identifiable".into(),
    }
}

fn rows_posterior(s: &Study, joint: usize) -> Vec<Vec<String>> {
    let mcmc = s.results.iter().find(|r| r.method == "mcmc");
    let rows = mcmc.and_then(|r| r.joints.iter().find(|j| j.joint == joint));
    let row = |e: &ParameterEstimate| {
        let q = e.posterior?;
        let nlse = s.estimate("nlse", joint, &e.name)?;
        Some(vec![
            joint.to_string(),
            e.name.clone(),
            number(q.mean),
            number(q.median),
            format!("[{} {}]", number(q.low), number(q.high)),
            format!("{:.4}", q.convergence.r_hat),
            format!("{:.0}", q.convergence.ess_bulk),
            format!("{:.0}", q.convergence.ess_tail),
            number(nlse.value),
            interval(nlse),
            format!("{} .. {}", e.bounds[0], e.bounds[1]),
            if q.converged { "" } else { "not converged" }.into(),
        ])
    };
    rows.map(|j| j.parameters.iter().filter_map(row).collect()).unwrap_or_default()
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map(|c| c.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Four significant digits.
fn number(x: f64) -> String {
    match x.abs() {
        _ if x.is_nan() => "-".into(),
        0.0 => "0".into(),
        a if !(1e-3..1e5).contains(&a) => format!("{x:.2e}"),
        a => {
            let digits = (3 - a.log10().floor() as i32).clamp(0, 6) as usize;
            format!("{x:.digits$}")
        }
    }
}
