//! Tangents of effects that were located.

use super::*;
use crate::effects::find;
use crate::identification::settle::cut;

const DT: f64 = 0.008;

fn angle() -> Vec<f64> {
    (0..500).map(|k| (1.3 * k as f64 * DT).sin()).collect()
}

/// a sin(N q) + b cos(N q)
fn waves(q: &[f64], order: f64) -> Vec<Vec<f64>> {
    let wave = |f: fn(f64) -> f64| q.iter().map(|q| f(order * q)).collect();
    vec![wave(f64::sin), wave(f64::cos)]
}

fn ripple(linear: Vec<f64>) -> Located {
    let effect = find("torque_ripple").unwrap();
    Located { effect, joint: 0, linear, nonlinear: vec![12.0], open: vec![0], starts: 40 }
}

/// d/dN (a sin(N q) + b cos(N q)) = q (a cos(N q) - b sin(N q)), and the tangent touches the torque.
#[test]
fn a_tangent_has_the_slopes_of_the_law() {
    let (q, located) = (angle(), ripple(vec![0.7, -0.2]));
    let Tangent { slopes, rest } = located.tangent(&Size::UR5, |n| waves(&q, n[0]));
    let names: Vec<&str> = slopes.iter().map(|s| s.parameter.name.as_str()).collect();
    assert_eq!(names, ["ripple_sine", "ripple_cosine", "ripple_order"]);
    assert_eq!(*slopes[2].of, ["ripple_sine", "ripple_cosine"]);
    assert!(slopes[0].of.is_empty() && slopes[1].of.is_empty());
    for (k, q) in q.iter().enumerate() {
        let (sin, cos) = (12.0 * q).sin_cos();
        assert!((slopes[0].series[k] - sin).abs() < 1e-9);
        let slope = q * (0.7 * cos + 0.2 * sin);
        assert!((slopes[2].series[k] - slope).abs() < 1e-5, "{k}");
        let touching = [0.7, -0.2, 12.0].iter().zip(&slopes);
        let touching: f64 = touching.map(|(x, s)| (x - s.centre) * s.series[k]).sum();
        assert!((rest[k] + touching - (0.7 * sin - 0.2 * cos)).abs() < 1e-9, "{k}");
    }
    assert!(slopes[2].parameter.lower == 4.0 && slopes[2].parameter.upper == 36.0);
}

/// A gap's reference follows the gap: the slope is that of the torque, not of the column.
#[test]
fn references_follow_what_they_refer_to() {
    let effect = find("backlash").unwrap();
    let (linear, nonlinear) = (vec![0.002], vec![2e4, 20.0, 0.005]);
    let located = Located { effect, joint: 1, linear, nonlinear, open: vec![], starts: 12 };
    // gap x (gap0 + 3) at gap0 = gap: gap^2 + 3 gap.
    let tangent = located.tangent(&Size::UR5, |n| vec![vec![n[2] + 3.0]]);
    assert!((tangent.slopes[0].series[0] - (2.0 * 0.002 + 3.0)).abs() < 1e-6);
    assert!((tangent.rest[0] + 0.002f64.powi(2)).abs() < 1e-8, "{:?}", tangent.rest);
}

#[test]
fn a_twin_takes_the_values_and_steps_are_not_longer_than_allowed() {
    let located = Located { joint: 2, ..ripple(vec![0.7, -0.2]) };
    let twin = with_located(&Twin::default(), std::slice::from_ref(&located));
    assert_eq!(twin.values["ripple_order"], vec![12.0; 6]);
    assert!(located.shows() && !ripple(vec![0.0, 0.0]).shows());
    assert_eq!(located.searched(), ["ripple_order"]);
    assert_eq!((cut(2.0, 9.0), cut(2.0, 0.1), cut(-2.0, -2.5)), (3.0, 2.0 / 1.5, -2.5));
}
