//! From torque per unit of each parameter at every sample to columns at the kept ones.

use std::sync::Arc;

use super::located::{Slope, Tangent};
use super::problem::{Column, Parameter};
use crate::kernels::axpy;

/// Torque at every sample, joint after joint where it reaches further than one: per unit of a
/// parameter that is searched for, or what is there anyway.
pub struct Regressor {
    pub parameter: Option<Parameter>,
    pub series: Vec<f64>,
    slope_of: Arc<[&'static str]>,
    centre: f64,
}

impl Regressor {
    pub fn linear(parameter: Parameter, series: Vec<f64>) -> Self {
        Self { parameter: Some(parameter), series, slope_of: Arc::default(), centre: 0.0 }
    }

    pub fn of_tangent(Tangent { slopes, rest }: Tangent) -> Vec<Self> {
        let slope = |Slope { parameter, series, centre, of }: Slope| Self {
            parameter: Some(parameter),
            series,
            slope_of: of,
            centre,
        };
        let rest = Self { parameter: None, series: rest, slope_of: Arc::default(), centre: 0.0 };
        slopes.into_iter().map(slope).chain([rest]).collect()
    }

    /// What of it falls on one joint.
    pub fn at(&self, joint: usize, samples: usize) -> Self {
        let series = self.series[joint * samples..(joint + 1) * samples].to_vec();
        let (parameter, slope_of) = (self.parameter.clone(), self.slope_of.clone());
        Self { parameter, series, slope_of, centre: self.centre }
    }
}

/// The columns of parameters; what is there anyway is taken off `y`, and slopes added to it where
/// they were worked out.
pub fn columns_of(
    regressors: Vec<Regressor>,
    mut reduced: impl Iterator<Item = Vec<f64>>,
    y: &mut [f64],
) -> Vec<Column> {
    let mut columns = Vec::new();
    for Regressor { parameter, slope_of, centre, .. } in regressors {
        let values = reduced.next().unwrap_or_default();
        let Some(parameter) = parameter else {
            axpy(-1.0, &values, y);
            continue;
        };
        axpy(centre, &values, y);
        columns.push(Column { parameter, values, slope_of, centre });
    }
    columns
}
