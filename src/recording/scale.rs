//! Factors between the units of a file and SI.

use serde::Deserialize;

/// One for all columns, or one each.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "a number or a list with one number per column")]
pub enum Scale {
    All(f64),
    Each(Vec<f64>),
}

impl Default for Scale {
    fn default() -> Self {
        Scale::All(1.0)
    }
}

impl Scale {
    /// `count` factors; says what is wrong with them.
    pub fn expand(&self, count: usize) -> Result<Vec<f64>, String> {
        let scales = match self {
            Scale::All(scale) => vec![*scale; count],
            Scale::Each(scales) if scales.len() == count => scales.clone(),
            Scale::Each(s) => return Err(format!("{} scales for {count} columns", s.len())),
        };
        match scales.iter().find(|s| !is_factor(**s)) {
            Some(scale) => Err(format!(
                "scale {scale} must be a number other than zero, between 1e-15 and 1e15 in size"
            )),
            None => Ok(scales),
        }
    }
}

/// Between units; what it multiplies stays a number.
pub fn is_factor(scale: f64) -> bool {
    (1e-15..=1e15).contains(&scale.abs())
}
