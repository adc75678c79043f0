//! Figures over many cases, and the goals they are held against.

use super::rows::{
    Figure, Goal, brier, catalogue, count, coverage, mean_set_size, median, of, of_oracle, outside,
    plain, strong,
};
use super::{Judged, Kind, Share, on_recordings};

/// The figures of the project's goals.
pub fn goals(all: &[Judged]) -> Vec<Goal> {
    match on_recordings::are(all) {
        true => on_recordings::goals(all),
        false => of_simulated(all),
    }
}

/// The few figures that say most.
pub fn figures(all: &[Judged]) -> Vec<Figure> {
    if on_recordings::are(all) {
        return on_recordings::figures(all);
    }
    let (plain, clean, outside) = (plain(all), of(all, Kind::Clean), outside(all));
    let diagnosed = all.iter().filter(|j| j.verdict.is_some()).count();
    vec![
        Figure::share("top-1, set", count(&plain, |j| j.top1_set)),
        Figure::share("top-1 exactly", count(&plain, |j| j.top1)),
        Figure::share("wrong name", count(&catalogue(all), |j| j.wrong)),
        Figure::share("false alarms", count(&clean, |j| !j.causes.is_empty())),
        Figure::share("unknown or a stand-in", count(&outside, |j| j.abstained || j.stands_in())),
        Figure { name: "Brier score", value: brier(all), cases: diagnosed },
    ]
}

fn of_simulated(all: &[Judged]) -> Vec<Goal> {
    let (plain, clean) = (plain(all), of(all, Kind::Clean));
    let (catalogue, outside) = (catalogue(all), outside(all));
    let pairs: Vec<&Judged> = of(all, Kind::Pair).into_iter().filter(|j| strong(j)).collect();
    let at_least = |figure, share: Share, least: f64, goal| Goal {
        figure,
        found: share.to_string(),
        goal,
        met: share.value().map(|v| v >= least),
    };
    let at_most = |figure, share: Share, most: f64, goal| Goal {
        figure,
        found: share.to_string(),
        goal,
        met: share.value().map(|v| v <= most),
    };
    let number = |figure, value: Option<f64>, range: std::ops::RangeInclusive<f64>, goal| Goal {
        figure,
        found: value.map_or("-".into(), |v| format!("{v:.3}")),
        goal,
        met: value.map(|v| range.contains(&v)),
    };
    let covered = coverage(all);
    let ratios = of_oracle(plain.iter().copied().filter(|j| j.top1_set));
    vec![
        at_least("top-1 within the set", count(&plain, |j| j.top1_set), 0.96, "at least .96"),
        number(
            "mean size of the set",
            mean_set_size(plain.iter().copied()),
            0.0..=1.13,
            "at most 1.13",
        ),
        at_least("top-1 exactly", count(&plain, |j| j.top1), 0.93, "at least .93"),
        at_least("joint", count(&plain, |j| j.joint), 0.97, "at least .97"),
        at_most(
            "false alarms, clean",
            count(&clean, |j| !j.causes.is_empty()),
            0.02,
            "at most .02",
        ),
        at_most("wrong name, catalogue cases", count(&catalogue, |j| j.wrong), 0.02, "at most .02"),
        Goal {
            figure: "unknown, withheld and foreign",
            found: count(&outside, |j| j.abstained).to_string(),
            goal: "no goal",
            met: None,
        },
        at_least(
            "unknown or a stand-in, of these",
            count(&outside, |j| j.abstained || j.stands_in()),
            0.95,
            "at least .95",
        ),
        number("Brier score, all cases", brier(all), 0.0..=0.06, "at most .06"),
        Goal {
            figure: "90 % intervals that cover",
            found: covered.to_string(),
            goal: ".85 to .95",
            met: covered.value().map(|v| (0.85..=0.95).contains(&v)),
        },
        number(
            "realised shrink over oracle's, median",
            median(ratios.iter().copied()),
            0.95..=f64::INFINITY,
            "at least .95",
        ),
        at_least(
            "pairs, both named within sets",
            count(&pairs, |j| j.all_set),
            0.75,
            "at least .75",
        ),
    ]
}
