//! What the paper prints in Tables V and VI, and where the print cannot be right.

/// A row of Table V.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Printed {
    /// From 1 at the base.
    pub joint: usize,
    /// As [`crate::identification`] names it.
    pub parameter: &'static str,
    pub symbol: &'static str,
    pub pso: f64,
    pub nlse: f64,
    /// LBCI and UBCI, as printed.
    pub interval: [f64; 2],
    pub p: f64,
    pub misprint: Option<&'static str>,
}

/// A row of Table VI: PSO, NLSE.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct PrintedFit {
    pub joint: usize,
    pub r2_percent: [f64; 2],
    /// (N.m)^2; the paper's unit, N.m, is a misprint.
    pub mse_nm2: [f64; 2],
}

const fn row(
    joint: usize,
    names: (&'static str, &'static str),
    [pso, nlse]: [f64; 2],
    interval: [f64; 2],
    p: f64,
    misprint: Option<&'static str>,
) -> Printed {
    Printed { joint, parameter: names.0, symbol: names.1, pso, nlse, interval, p, misprint }
}

const C: (&str, &str) = ("coulomb", "tau_c");
const S: (&str, &str) = ("static", "tau_s");
const V1: (&str, &str) = ("viscous", "tau_v1");
const V2: (&str, &str) = ("viscous_quadratic", "tau_v2");
const V3: (&str, &str) = ("viscous_cubic", "tau_v3");
const W: (&str, &str) = ("stribeck_velocity", "qd_s");

/// N.m, N.m.s/rad and so on; qd_s in rad/s.
pub const TABLE_V: [Printed; 36] = [
    row(1, C, [0.91, -14.1], [0.88, 0.93], 1.7e-9, None),
    row(1, S, [0.64, 8.3], [0.6, 0.67], 2.2e-5, None),
    row(1, V1, [0.9, 4.49], [0.88, 0.92], 1.6e-4, None),
    row(1, V2, [1.6e-8, -0.41], [-9.8e-6, 9.8e-6], 1.0, None),
    row(1, V3, [2.4e-8, -0.79], [-1.19e-5, 1.2e-5], 1.0, None),
    row(1, W, [0.045, 3.77], [0.029, 0.062], 9.4e-3, None),
    row(2, C, [0.95, 1.6], [0.93, 0.96], 0.0, None),
    row(2, S, [0.5, 9.08], [0.46, 0.53], 0.0, None),
    row(2, V1, [0.4, -4.008], [0.37, 0.44], 1.6e-4, None),
    row(2, V2, [1.7e-6, -6.42], [-9.9e-5, 1.02e-4], 1.0, None),
    row(2, V3, [1.8e-6, -0.56], [-1e-4, 1.05e-4], 1.0, None),
    row(2, W, [0.039, 48.9], [0.024, 0.055], 9.3e-3, None),
    row(
        3,
        C,
        [0.59, 1.02],
        [0.55, 0.63],
        9.1e45,
        Some("a probability cannot be 9.1e45; 9.1e-45 is meant"),
    ),
    row(
        3,
        S,
        [0.54, 5.94],
        [0.5, 0.5],
        3.6e-38,
        Some("the interval [0.5 0.5] misses its own estimate"),
    ),
    row(3, V1, [0.89, 0.15], [0.87, 0.91], 1.6e-4, None),
    row(3, V2, [1.12e-8, -8.7], [-8.17e-6, 8.2e-6], 1.0, None),
    row(3, V3, [3.24e-14, 6.81], [-1.39e-8, 1.39e-8], 1.0, None),
    row(3, W, [0.04, 8.42], [0.03, 0.06], 9.3e-3, None),
    row(4, C, [0.2, 38.53], [0.17, 0.24], 0.0, None),
    row(4, S, [0.23, 2.69], [0.19, 0.26], 0.0, None),
    row(4, V1, [0.16, -79.85], [0.14, 0.19], 1.6e-4, None),
    row(4, V2, [2.9e-13, -20.9], [-4.2e-8, 4.2e-8], 1.0, None),
    row(
        4,
        V3,
        [2.8e12, -0.35],
        [-1.3e-7, 1.3e-7],
        1.0,
        Some("2.8e12 lies outside its own interval; 2.8e-12 is meant"),
    ),
    row(4, W, [0.025, 4.8], [0.013, 0.037], 9.6e-3, None),
    row(5, C, [0.17, -8.51], [0.14, 0.2], 6.2e-14, None),
    row(5, S, [0.2, 0.25], [0.17, 0.24], 0.0, None),
    row(5, V1, [0.17, 3.089], [0.14, 0.20], 1.6e-4, None),
    row(5, V2, [7.3e-4, -0.024], [-1.3e-3, 2.8e-3], 0.99, None),
    row(5, V3, [1.1e-12, 1.5e-3], [-8.1e-8, 8.1e-8], 0.98, None),
    row(5, W, [0.04, 1.5e-3], [0.03, 0.062], 4e-4, None),
    row(6, C, [0.2, 5.58], [0.17, 0.24], 0.0, None),
    row(6, S, [0.29, 0.23], [0.26, 0.33], 0.0, None),
    row(6, V1, [0.12, 6.29], [0.097, 0.148], 1.63e-4, None),
    row(6, V2, [3e-3, 0.31], [-1.2e-3, 7.3e-3], 0.99, None),
    row(6, V3, [2.22e-14, 0.37], [-1.15e-8, 1.15e-8], 0.99, None),
    row(6, W, [0.033, 4.18], [0.019, 0.047], 2.3e-3, None),
];

pub const TABLE_VI: [PrintedFit; 6] = [
    PrintedFit { joint: 1, r2_percent: [97.55, 90.27], mse_nm2: [3.13, 19.98] },
    PrintedFit { joint: 2, r2_percent: [97.47, 90.49], mse_nm2: [5.43, 12.6] },
    PrintedFit { joint: 3, r2_percent: [96.81, 88.99], mse_nm2: [2.19, 13.32] },
    PrintedFit { joint: 4, r2_percent: [87.28, 85.56], mse_nm2: [0.64, 0.72] },
    PrintedFit { joint: 5, r2_percent: [93.53, 87.97], mse_nm2: [0.38, 0.68] },
    PrintedFit { joint: 6, r2_percent: [88.25, 83.91], mse_nm2: [0.57, 0.75] },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_outside_its_own_interval_is_marked_as_a_misprint() {
        for r in TABLE_V {
            let inside = r.interval[0] <= r.pso && r.pso <= r.interval[1];
            assert!((inside && r.p <= 1.0) || r.misprint.is_some(), "{r:?}");
        }
    }

    /// The paper averages joints 1 to 3 and 4 to 6.
    #[test]
    fn the_printed_averages_follow_from_the_rows() {
        let mean =
            |rows: &[PrintedFit], f: fn(&PrintedFit) -> f64| rows.iter().map(f).sum::<f64>() / 3.0;
        assert!((mean(&TABLE_VI[..3], |r| r.r2_percent[0]) - 97.27).abs() < 0.01);
        assert!((mean(&TABLE_VI[3..], |r| r.mse_nm2[1]) - 0.71).abs() < 0.01);
    }
}
