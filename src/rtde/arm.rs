//! All that a simulated arm gives to clients: one row with a number for every quantity of RTDE.

use std::collections::HashMap;

use super::fields::OUTPUTS;
use super::{Type, Version, type_of};

/// Versions of software that clients know: of older controllers, and of the e-series.
pub const CONTROLLER: [Version; 2] = [Version([3, 15, 8, 106339]), Version([5, 11, 6, 1010327])];

/// Which quantities there are, where they stand in a row, and what they are where nothing moves them.
#[derive(Debug, Clone, PartialEq)]
pub struct Offer {
    /// Rows per second at most.
    pub rate_hz: f64,
    places: HashMap<String, (Type, usize)>,
    /// A row of an arm that is switched on and stands.
    pub still: Vec<f64>,
}

/// What does not change while the simulated arm works: modes as the guide numbers them, and what a
/// controller that is well shows of itself.
const STILL: &[(&str, f64)] = &[
    ("robot_mode", 7.0),
    ("joint_mode", 253.0),
    ("safety_mode", 1.0),
    ("safety_status", 1.0),
    ("safety_status_bits", 1.0),
    // Powered, a program runs.
    ("robot_status_bits", 3.0),
    ("runtime_state", 2.0),
    ("speed_scaling", 1.0),
    ("target_speed_fraction", 1.0),
    ("actual_main_voltage", 48.0),
    ("actual_robot_voltage", 48.0),
    ("actual_joint_voltage", 48.0),
    ("tool_mode", 253.0),
];

impl Offer {
    /// Everything but registers that are numbered, which come last.
    pub fn new(rate_hz: f64) -> Self {
        let mut names: Vec<String> = OUTPUTS.iter().map(|(name, _)| name.to_string()).collect();
        for side in ["output", "input"] {
            for (kind, range) in [("int", 0..48), ("double", 0..48), ("bit", 64..128)] {
                names.extend(range.map(|n| format!("{side}_{kind}_register_{n}")));
            }
        }
        let mut offer = Self { rate_hz, places: HashMap::new(), still: Vec::new() };
        for name in names {
            if let Some(t) = type_of(&name) {
                let value = STILL.iter().find(|(n, _)| *n == name).map_or(0.0, |(_, v)| *v);
                let at = offer.still.len();
                offer.still.extend(std::iter::repeat_n(value, t.width()));
                offer.places.insert(name, (t, at));
            }
        }
        offer
    }

    /// Type of a quantity and where it begins in a row.
    pub fn find(&self, name: &str) -> Option<(Type, usize)> {
        self.places.get(name).copied()
    }

    /// Where column `actual_q_3` or a scalar stands in a row.
    pub fn column(&self, name: &str) -> Option<usize> {
        let one = |name: &str| self.find(name).filter(|(t, _)| t.width() == 1).map(|(_, at)| at);
        let (stem, index) = name.rsplit_once('_').unwrap_or((name, ""));
        let (many, index) = (self.find(stem), index.parse::<usize>().ok());
        one(name).or_else(|| match (many, index) {
            (Some((t, at)), Some(i)) if i < t.width() => Some(at + i),
            _ => None,
        })
    }
}
