//! How far estimates are off, and which parameter goes first.

use super::identification::{Chapter, Part};
use super::seen::{Seen, in_order};
use super::{decibel, down_to, listed, over_snr, percent, quantile};
use crate::studies::StudyError;
use crate::studies::sweep::chart::{Line, Panel, Scale, draw};

/// An estimate is of use within it.
const USEFUL: f64 = 0.2;
/// So many of ten estimates must be.
const MOST: f64 = 0.9;

pub fn chapter(part: &Part<'_>) -> Result<Chapter, StudyError> {
    let exists = part.rows.iter().filter(|r| r.truth != 0.0 && !r.absent);
    let labels = in_order(exists.map(|r| r.label.as_str()));
    let main = part.main();
    let row = |label: &&str| {
        let cell = |db: &f64| {
            let errors = errors(part.of(main), label, *db);
            format!("{} ({})", percent(quantile(&errors, 0.5)), percent(quantile(&errors, MOST)))
        };
        std::iter::once(label.to_string()).chain(part.snrs.iter().map(cell)).collect()
    };
    let rows: Vec<Vec<String>> = labels.iter().map(row).collect();
    let panels: Vec<Panel> = labels.iter().map(|label| panel(part, label)).collect();
    Ok(Chapter {
        name: "error",
        says: order(part, &labels),
        text: format!(
            "### Errors\n\n|estimate - truth| / |truth| by {main}: median over seeds and joints, and \
             in brackets what {:.0} % of the estimates keep to.\n\n{}",
            100.0 * MOST,
            over_snr("parameter", &part.snrs, &rows)
        ),
        caption: "Relative error over SNR: median, and the band between 10 % and 90 %".into(),
        svg: draw(&panels, 3)?,
    })
}

fn errors<'a>(rows: impl Iterator<Item = &'a Seen>, label: &str, db: f64) -> Vec<f64> {
    let here = rows.filter(|r| r.label == label && r.snr_db == db);
    here.filter_map(Seen::error).filter(|e| e.is_finite()).collect()
}

/// Which parameter is of no more use first as noise grows.
fn order(part: &Part<'_>, labels: &[&str]) -> String {
    let useful =
        |label: &str, db: f64| quantile(&errors(part.of(part.main()), label, db), MOST) <= USEFUL;
    let limit = |label: &&str| (down_to(&part.snrs, |db| useful(label, db)), label.to_string());
    let mut limits: Vec<(Option<f64>, String)> = labels.iter().map(limit).collect();
    // What is never of use goes first.
    let key = |l: &(Option<f64>, String)| (l.0.is_none(), l.0.unwrap_or(0.0));
    limits.sort_by(|a, b| key(b).0.cmp(&key(a).0).then(key(b).1.total_cmp(&key(a).1)));
    let lowest = part.snrs.first().copied();
    let (hold, go): (Vec<_>, Vec<_>) = limits.into_iter().partition(|l| l.0 == lowest);
    let held: Vec<String> = hold.into_iter().map(|l| l.1).collect();
    let named = |(limit, label): &(Option<f64>, String)| match limit {
        Some(db) if db.is_infinite() => format!("{label} (only without noise)"),
        Some(db) => format!("{label} (down to {})", decibel(*db)),
        None => format!("{label} (at no SNR)"),
    };
    let lost: Vec<String> = go.iter().map(named).collect();
    let floor = decibel(lowest.unwrap_or(f64::INFINITY));
    let within = format!(
        "nine of ten estimates are within {:.0} % of the truth by {}",
        100.0 * USEFUL,
        part.main()
    );
    match (go.first(), held.is_empty()) {
        (None, _) => format!("**No parameter is lost down to {floor}**: {within}."),
        (Some(first), all_go) => {
            let rest = match all_go {
                true => String::new(),
                false => format!("; down to {floor} hold {}", listed(&held)),
            };
            format!(
                "**{} goes first** as noise grows; where {within}, in this order: {}{rest}.",
                first.1,
                lost.join(", ")
            )
        }
    }
}

fn panel(part: &Part<'_>, label: &str) -> Panel {
    let line = |method: &&str| {
        let at = |db: &f64| (*db, errors(part.of(method), label, *db));
        let all: Vec<(f64, Vec<f64>)> =
            part.snrs.iter().map(at).filter(|(_, e)| !e.is_empty()).collect();
        Line {
            label: method.to_string(),
            points: all.iter().map(|(db, e)| (*db, 100.0 * quantile(e, 0.5))).collect(),
            band: all
                .iter()
                .map(|(db, e)| (*db, 100.0 * quantile(e, 0.1), 100.0 * quantile(e, 0.9)))
                .collect(),
        }
    };
    Panel {
        title: label.into(),
        across: ("SNR, dB", Scale::Decibel),
        up: ("error, %", Scale::Log),
        lines: part.methods.iter().map(line).collect(),
        nominal: Vec::new(),
    }
}
