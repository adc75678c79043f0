//! Criteria as they are, and with each of them moved by a third.

use serde::Serialize;
use serde_json::{Number, Value};

use crate::diagnosis::Criteria;

/// What a criterion is multiplied by.
const DIRECTIONS: [(&str, f64); 2] = [("down", 2.0 / 3.0), ("up", 4.0 / 3.0)];

/// Criteria that all cases are answered by.
#[derive(Debug, Clone, PartialEq)]
pub struct Variant {
    /// Name of its folder of answers: `base`, `least_nats-down`.
    pub name: String,
    /// The criterion that is moved; `None`: all as they are.
    pub moved: Option<Moved>,
    pub criteria: Criteria,
}

/// A criterion and its values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Moved {
    pub criterion: String,
    pub from: f64,
    pub to: f64,
}

/// `base` first. Fields are found by serialising, so that one added later is moved as well.
///
/// # Errors
/// If a criterion does not take the moved value.
pub fn variants(base: &Criteria) -> serde_json::Result<Vec<Variant>> {
    let mut all = vec![Variant { name: "base".into(), moved: None, criteria: *base }];
    let Value::Object(fields) = serde_json::to_value(base)? else { return Ok(all) };
    for (criterion, value) in &fields {
        let Value::Number(from) = value else { continue };
        for (direction, factor) in DIRECTIONS {
            let to = scaled(from, factor);
            let mut other = fields.clone();
            other.insert(criterion.clone(), Value::Number(to.clone()));
            all.push(Variant {
                name: format!("{criterion}-{direction}"),
                moved: Some(Moved {
                    criterion: criterion.clone(),
                    from: from.as_f64().unwrap_or(f64::NAN),
                    to: to.as_f64().unwrap_or(f64::NAN),
                }),
                criteria: serde_json::from_value(Value::Object(other))?,
            });
        }
    }
    Ok(all)
}

/// Counts move by one at least; other numbers have three digits, so that a page shows what was used
/// and JSON gives back what was written.
fn scaled(from: &Number, factor: f64) -> Number {
    if let Some(count) = from.as_u64() {
        let to = (count as f64 * factor).round() as u64;
        return match to == count {
            true if factor < 1.0 => count.saturating_sub(1).into(),
            true => (count + 1).into(),
            false => to.into(),
        };
    }
    let exact = from.as_f64().unwrap_or(f64::NAN) * factor;
    let rounded = format!("{exact:.2e}").parse().unwrap_or(exact);
    Number::from_f64(rounded).unwrap_or_else(|| from.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_criterion_is_moved_both_ways_and_no_other_with_it() {
        let base = Criteria::default();
        let fields = |c: &Criteria| serde_json::to_value(c).unwrap().as_object().unwrap().clone();
        let all = variants(&base).unwrap();
        assert_eq!((all[0].name.as_str(), all[0].criteria), ("base", base));
        assert_eq!(all.len(), 1 + 2 * fields(&base).len(), "a criterion that is no number");
        assert!(fields(&base).len() <= 12, "more criteria than anybody keeps in mind");
        for variant in &all[1..] {
            let moved = variant.moved.as_ref().unwrap();
            let now = fields(&variant.criteria);
            let differs: Vec<_> = fields(&base).into_iter().filter(|(k, v)| now[k] != *v).collect();
            assert_eq!(differs.len(), 1, "{variant:?}");
            assert_eq!(differs[0].0, moved.criterion);
            assert_eq!(now[&moved.criterion].as_f64(), Some(moved.to));
            let factor = if variant.name.ends_with("-up") { 4.0 / 3.0 } else { 2.0 / 3.0 };
            // Counts are rounded.
            assert!((moved.to / moved.from / factor - 1.0).abs() < 0.06, "{variant:?}");
        }
    }

    /// Answers are told by their criteria from those to other ones.
    #[test]
    fn criteria_come_back_from_json_as_they_were() {
        for variant in variants(&Criteria::default()).unwrap() {
            let text = serde_json::to_string_pretty(&variant.criteria).unwrap();
            assert_eq!(serde_json::from_str::<Criteria>(&text).unwrap(), variant.criteria);
        }
    }

    #[test]
    fn counts_stay_counts_and_move() {
        let to = |count: u64| DIRECTIONS.map(|(_, factor)| scaled(&count.into(), factor).as_u64());
        assert_eq!(to(10), [Some(7), Some(13)]);
        assert_eq!(to(1), [Some(0), Some(2)]);
    }
}
