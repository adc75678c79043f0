//! The figures of cases on somebody's own recordings, held against their goals.

use super::super::rows::{Figure, Goal};
use super::super::{Judged, Share};
use super::found::explained;
use super::{agreement, found};
use crate::trials::Kind;

/// Strength, share that is to be named, and both in words.
const NAMED: [(f64, f64, &str, &str); 4] = [
    (0.5, 0.70, "grafts named, strength .5", "at least .70"),
    (1.0, 0.85, "grafts named, strength 1", "at least .85"),
    (2.0, 0.95, "grafts named, strength 2", "at least .95"),
    (4.0, 0.98, "grafts named, strength 4", "at least .98"),
];

/// The few figures that say most.
pub fn figures(all: &[Judged]) -> Vec<Figure> {
    let asked = found::asked(all);
    let of = |kind: Kind| all.iter().filter(move |j| j.kind == kind);
    let strays = |j: &Judged| !j.strays.is_empty();
    let foreign = || of(Kind::GraftedForeign);
    vec![
        Figure::share("named", Share::count(asked, found::named)),
        Figure::share("strays", Share::count(of(Kind::Grafted), strays)),
        Figure::share("foreign, another name", Share::count(foreign(), strays)),
        Figure::share("foreign called explained", Share::count(foreign(), explained)),
    ]
}

pub fn goals(all: &[Judged]) -> Vec<Goal> {
    let (levels, asked) = (found::levels(all), found::asked(all));
    let of = |kind: Kind| all.iter().filter(move |j| j.kind == kind);
    let mut goals: Vec<Goal> = NAMED
        .iter()
        .map(|(strength, least, figure, goal)| {
            let cases = found::at_level(&asked, *strength, &levels);
            let share = Share::count(cases, found::named);
            Goal { figure, found: share.to_string(), goal, met: share.value().map(|v| v >= *least) }
        })
        .collect();
    let at_most = |figure, share: Share, most: f64, goal| {
        let met = share.value().map(|v| v <= most);
        Goal { figure, found: share.to_string(), goal, met }
    };
    let strays = |j: &Judged| !j.strays.is_empty();
    let made_up =
        |j: &Judged| j.printed.iter().any(|p| p.holds == Some(false) && !p.may_be_the_arms);
    // No goal is set for these: they say what strays are.
    let told_to_none = |kind| {
        let found = Share::count(of(kind), made_up).to_string();
        Goal { figure: "of these, told to no untouched pair", found, goal: "no goal", met: None }
    };
    let foreign = || of(Kind::GraftedForeign);
    let other_names = Share::count(foreign(), strays);
    let pairs = agreement(all);
    goals.extend([
        at_most("strays, grafts", Share::count(of(Kind::Grafted), strays), 0.05, "at most .05"),
        told_to_none(Kind::Grafted),
        at_most("foreign grafts called explained", Share::count(foreign(), explained), 0.0, "0"),
        at_most("foreign grafts, another name", other_names, 0.10, "at most .10"),
        told_to_none(Kind::GraftedForeign),
        at_most("untouched, unexplained in spite of > 30 %", pairs.unexplained, 0.0, "0"),
    ]);
    goals.push(Goal {
        figure: "untouched pairs, same leading cause",
        found: pairs.same.to_string(),
        goal: "at least .90",
        met: pairs.same.value().map(|v| v >= 0.90),
    });
    goals
}
