//! Numbers with as many digits as they are worth.

/// Beyond so many decimals a number is written with its power of ten.
const MOST_DECIMALS: i32 = 7;

/// A value and its interval, to two digits of half the interval's width; to four digits of the
/// value where there is no interval.
pub fn to_uncertainty(value: f64, low: f64, high: f64) -> [String; 3] {
    let half = 0.5 * (high - low);
    let decimals = match half > 0.0 && half.is_finite() {
        true => 1 - half.log10().floor() as i32,
        false if value != 0.0 && value.is_finite() => 3 - value.abs().log10().floor() as i32,
        false => 1,
    };
    [value, low, high].map(|x| with_decimals(x, decimals))
}

fn with_decimals(x: f64, decimals: i32) -> String {
    if !x.is_finite() {
        return "-".into();
    }
    if decimals <= MOST_DECIMALS {
        return format!("{x:.*}", decimals.max(0) as usize);
    }
    let digits = if x == 0.0 { 0 } else { decimals + x.abs().log10().floor() as i32 };
    format!("{x:.*e}", digits.clamp(0, 9) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_the_interval() {
        assert_eq!(to_uncertainty(2.80512, 2.7213, 2.8891), ["2.805", "2.721", "2.889"]);
        assert_eq!(to_uncertainty(812.25, 700.0, 950.0), ["812", "700", "950"]);
        assert_eq!(to_uncertainty(0.0, -0.0125, 0.0125), ["0.000", "-0.013", "0.013"]);
    }

    #[test]
    fn without_an_interval_four_digits_stand() {
        assert_eq!(to_uncertainty(6.18034, f64::NAN, f64::NAN), ["6.180", "-", "-"]);
        assert_eq!(to_uncertainty(1.25e-9, 1e-9, 1.5e-9)[0], "1.25e-9");
        assert_eq!(to_uncertainty(0.0, 0.0, 0.0)[0], "0.0");
    }
}
