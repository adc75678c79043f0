//! Do printed probabilities mean what they say? Over all chapters, by tenths.

use super::chapter::Chapter;
use super::rows::mean;
use super::{Printed, Share};
use crate::text::markdown_table;

/// Causes a tenth needs before it is held against its frequency, and how far it may be off.
const FEWEST: usize = 30;
const TOLERANCE: f64 = 0.05;

/// Causes printed with a probability in one tenth.
#[derive(Debug, Clone, PartialEq)]
pub struct Tenth {
    /// Lower edge of the tenth.
    pub from: f64,
    pub mean: Option<f64>,
    pub true_ones: Share,
    /// With those that may be the arm's own.
    pub at_best: Share,
}

impl Tenth {
    /// `None` where there are too few to tell.
    pub fn is_off(&self) -> Option<bool> {
        let (printed, found) = (self.mean?, self.true_ones.value()?);
        (self.true_ones.of >= FEWEST).then_some((printed - found).abs() > TOLERANCE)
    }
}

/// Causes of which nobody knows whether they are true are left out.
pub fn tenths<'a>(causes: impl Iterator<Item = &'a Printed>) -> Vec<Tenth> {
    let known: Vec<(f64, bool, bool)> =
        causes.filter_map(|c| Some((c.probability, c.holds?, c.may_be_the_arms))).collect();
    let tenth = |p: f64| ((10.0 * p) as usize).min(9);
    (0..10)
        .map(|i| {
            let here: Vec<_> = known.iter().filter(|(p, ..)| tenth(*p) == i).collect();
            Tenth {
                from: i as f64 / 10.0,
                mean: mean(here.iter().map(|(p, ..)| *p)),
                true_ones: Share::count(here.iter().copied(), |(_, holds, _)| *holds),
                at_best: Share::count(here.iter().copied(), |(_, holds, may)| *holds || *may),
            }
        })
        .collect()
}

pub fn section(chapters: &[Chapter]) -> String {
    let causes = chapters.iter().flat_map(|c| &c.cases).flat_map(|j| &j.printed);
    let row = |t: &Tenth| {
        vec![
            format!("{:.1} to {:.1}", t.from, t.from + 0.1),
            t.true_ones.of.to_string(),
            t.mean.map_or("-".into(), |m| format!("{m:.2}")),
            t.true_ones.to_string(),
            t.at_best.to_string(),
            t.is_off().map_or("-", |off| if off { "**off**" } else { "no" }).to_string(),
        ]
    };
    let rows: Vec<_> = tenths(causes).iter().map(row).collect();
    let table = markdown_table(&["printed", "causes", "mean", "true", "at best", "off"], 1, &rows);
    format!(
        "## Probability and frequency\n\nEvery cause that is named in a chapter above, by the \
         probability printed beside it; causes of untouched recordings, of which nobody knows, are \
         left out. At best: with names that nobody grafted and another untouched pair of the same arm is \
         told, for the arm may have them. Off: a tenth of {FEWEST} causes and more whose mean and frequency are more than \
         {TOLERANCE} apart.\n\n{table}"
    )
}
