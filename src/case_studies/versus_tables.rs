//! PSO against NLSE as tables of the page.

use super::boxes::Boxed;
use super::versus::{Duel, Record, Tally, answer, tally};
use crate::text::markdown_table;

/// By law and recording.
pub fn versus(duels: &[(String, Vec<Duel>)]) -> String {
    let mut text = String::from(
        "### Does PSO beat NLSE?\n\nSame data, same bounds, same cost (Eq. 5). PSO: the paper's \
         settings, one run per seed, timed on the interpolated cost; \"direct\" is what its \
         evaluations would take summed over all samples. NLSE: separable least squares, which \
         needs no start, and plain Levenberg-Marquardt from as many random starts in the bounds. \
         Reached: within 0.01 % of the lowest cost anyone found. The bounds are the \
         catalogue's (see \"prior\" below), far wider than the values of a small arm.\n\n",
    );
    let header = [
        "joint",
        "lowest cost N.m",
        "separable",
        "evaluations",
        "ms",
        "PSO",
        "median above %",
        "worst %",
        "evaluations",
        "ms",
        "direct ms",
        "plain LM",
        "median above %",
        "worst %",
        "evaluations",
        "ms",
    ];
    for (what, duels) in duels {
        let rows: Vec<_> = duels.iter().map(row_versus).collect();
        text +=
            &format!("{what}\n\n{}\n**{}**\n\n", markdown_table(&header, 1, &rows), answer(duels));
    }
    text
}

/// By law, where bounds are tight around the truth.
pub fn tight(boxed: &[(String, Vec<Boxed>)]) -> String {
    let header = [
        "law",
        "bounds",
        "separable",
        "PSO",
        "worst above %",
        "plain LM",
        "worst above %",
        "first",
    ];
    let rows = boxed.iter().flat_map(|(law, all)| all.iter().map(|b| row_tight(law, b)));
    format!(
        "Bounds tight around the truth, synthetic recording, all six joints, the same seeds: does \
         the ranking change? What does not exist may be as large as the Coulomb level times the \
         width less 1.\n\n{}\n",
        markdown_table(&header, 2, &rows.collect::<Vec<_>>())
    )
}

fn row_versus(d: &Duel) -> Vec<String> {
    let counts = |r: &Record| vec![format!("{}/{}", r.reached, r.runs)];
    let above = |r: &Record| vec![percent(r.median), percent(r.worst)];
    let price = |r: &Record| vec![format!("{:.0}", r.evaluations), format!("{:.2}", r.ms)];
    let direct = d.swarm.evaluations * d.direct_ms;
    [
        vec![d.joint.to_string(), format!("{:.6}", d.lowest)],
        counts(&d.separable),
        price(&d.separable),
        counts(&d.swarm),
        above(&d.swarm),
        price(&d.swarm),
        vec![format!("{direct:.0}")],
        counts(&d.descent),
        above(&d.descent),
        price(&d.descent),
    ]
    .concat()
}

fn row_tight(law: &str, b: &Boxed) -> Vec<String> {
    let separable = tally(&b.duels, |d| &d.separable);
    let swarm = tally(&b.duels, |d| &d.swarm);
    let descent = tally(&b.duels, |d| &d.descent);
    let shares = [("separable", separable), ("PSO", swarm), ("plain LM", descent)];
    let best = shares.iter().map(|s| s.1.share()).fold(0.0, f64::max);
    let first: Vec<&str> = shares.iter().filter(|s| s.1.share() == best).map(|s| s.0).collect();
    let reached = |t: &Tally| format!("{}/{}", t.reached, t.runs);
    vec![
        law.into(),
        format!("truth x {0} (or / {0})", b.width),
        reached(&separable),
        reached(&swarm),
        percent(swarm.worst),
        reached(&descent),
        percent(descent.worst),
        first.join(", "),
    ]
}

fn percent(share: f64) -> String {
    format!("{:.3}", 100.0 * share)
}
