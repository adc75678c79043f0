//! How far what two recordings say of the same values differs, beside what their own errors let expect.
//!
//! Errors of a fit know noise, not what the laws of a twin are inexact to: gears that are warmer, a motion that is slower. What each
//! recording says by itself shows that, and intervals of what both say together are as many times wider (Birge, *The calculation of
//! errors by the method of least squares*, Phys. Rev. 40, 1932; the scale factor of the Particle Data Group's tables).

use super::Estimate;

/// Root mean square of how far values of the one and of the other differ, in standard errors of that difference, at least 1: the Birge
/// ratio. What one of them does not tell, or has at the end of its range, does not count.
pub fn birge_ratio([one, other]: [&[Estimate]; 2]) -> f64 {
    let is_told = |e: &&Estimate| e.identifiable && !e.at_bound;
    let both = one.iter().zip(other).filter(|(a, b)| is_told(a) && is_told(b));
    let squares = both.map(|(a, b)| {
        let expected = a.standard_error.powi(2) + b.standard_error.powi(2);
        (a.value - b.value).powi(2) / expected
    });
    let squares: Vec<f64> = squares.filter(|z| z.is_finite()).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt().max(1.0)
}

/// Makes intervals this many times wider.
pub fn widen(estimates: &mut [Estimate], ratio: f64) {
    for e in estimates {
        e.standard_error *= ratio;
        e.low = e.value - ratio * (e.value - e.low);
        e.high = e.value + ratio * (e.high - e.value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(value: f64, standard_error: f64) -> Estimate {
        Estimate {
            effect: "coulomb",
            name: "coulomb",
            unit: "N.m",
            joint: Some(1),
            value,
            standard_error,
            low: value - 2.0 * standard_error,
            high: value + 2.0 * standard_error,
            p: 0.0,
            at_bound: false,
            identifiable: true,
            range: [0.0, 10.0],
        }
    }

    #[test]
    fn intervals_are_as_much_wider_as_values_differ_more_than_their_errors() {
        let one = [estimate(1.0, 0.3), estimate(5.0, 3.0)];
        let other = [estimate(3.0, 0.4), estimate(5.0, 4.0)];
        // 2 of .5, and none of 5.
        let ratio = birge_ratio([&one, &other]);
        assert!((ratio - 8f64.sqrt()).abs() < 1e-12, "{ratio}");
        let mut told = vec![estimate(2.0, 0.1)];
        widen(&mut told, ratio);
        assert!((told[0].high - 2.0 - 0.2 * ratio).abs() < 1e-12);
        assert!((2.0 - told[0].low - 0.2 * ratio).abs() < 1e-12);
    }

    #[test]
    fn values_that_agree_leave_intervals_as_they_are() {
        assert_eq!(birge_ratio([&[estimate(1.0, 0.3)], &[estimate(1.1, 0.3)]]), 1.0);
        assert_eq!(birge_ratio([&[], &[]]), 1.0);
    }

    #[test]
    fn what_one_of_them_does_not_tell_says_nothing() {
        let off = estimate(9.0, 0.1);
        let [untold, bound] = [
            Estimate { identifiable: false, ..off.clone() },
            Estimate { at_bound: true, ..off.clone() },
        ];
        for other in [untold, bound, Estimate { standard_error: f64::NAN, ..off }] {
            assert_eq!(birge_ratio([&[estimate(1.0, 0.1)], &[other]]), 1.0);
        }
    }
}
