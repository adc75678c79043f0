//! Numbers as people read them: with as many digits as they are worth, and never a minus before zero.

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
        return unsigned_zero(format!("{x:.*}", decimals.max(0) as usize));
    }
    let digits = if x == 0.0 { 0 } else { decimals + x.abs().log10().floor() as i32 };
    format!("{x:.*e}", digits.clamp(0, 9) as usize)
}

/// Three significant digits.
pub fn significant(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".into() } else { "-".into() };
    }
    let after = (2.0 - x.abs().log10().floor()).max(0.0) as usize;
    if after > 6 { format!("{x:.0e}") } else { unsigned_zero(format!("{x:.after$}")) }
}

/// Two significant digits, and more of a whole number that has more.
pub fn rough(x: f64) -> String {
    let decimals = if x == 0.0 { 0.0 } else { 1.0 - x.abs().log10().floor() };
    with_decimals(x, decimals as i32)
}

/// Three significant digits without trailing zeros.
pub fn digits(x: f64) -> String {
    let text = significant(x);
    if text.contains('e') {
        return text;
    }
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}

/// A probability of chance: beyond one in ten thousand nobody compares.
pub fn chance(p: f64) -> String {
    match p {
        p if !p.is_finite() => "-".into(),
        p if p < 1e-4 => "<0.0001".into(),
        p => format!("{p:.4}"),
    }
}

/// An angle with its unit: mrad, or rad where there is one and more of it.
pub fn angle(rad: f64) -> String {
    if rad.abs() < 1.0 {
        format!("{} mrad", digits(1e3 * rad))
    } else {
        format!("{} rad", digits(rad))
    }
}

/// What is nothing but zeros has no sign.
fn unsigned_zero(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_string(),
        _ => text,
    }
}

/// A text in which no zero has a sign; its words are parted by single blanks.
pub fn unsigned_zeros(text: &str) -> String {
    let word = |word: &str| {
        let (open, rest) = word.split_at(word.len() - word.trim_start_matches('(').len());
        let zero = rest.trim_end_matches([')', ',']);
        let is_zero = zero.len() > 1 && !unsigned_zero(zero.into()).starts_with('-');
        let rest = if is_zero { rest.trim_start_matches('-') } else { rest };
        format!("{open}{rest}")
    };
    text.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// `2026-11-23` of unix time, s (Hinnant, "chrono-compatible low-level date algorithms", days to civil).
pub fn day(unix_s: f64) -> String {
    let z = (unix_s / 86400.0).floor() as i64 + 719_468;
    let era = z.div_euclid(146_097);
    let doe = z.rem_euclid(146_097);
    let yoe = (doe - doe / 1460 + doe / 36_524 - doe / 146_096) / 365;
    let doy = doe - (365 * yoe + yoe / 4 - yoe / 100);
    let mp = (5 * doy + 2) / 153;
    let d = doy - (153 * mp + 2) / 5 + 1;
    let m = if mp < 10 { mp + 3 } else { mp - 9 };
    let y = yoe + era * 400 + i64::from(m <= 2);
    format!("{y:04}-{m:02}-{d:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_in_a_text_have_no_sign() {
        for (text, said) in [
            ("-0.000 0.016 -0.002 (0.000 -0.000 -0.00)", "0.000 0.016 -0.002 (0.000 0.000 0.00)"),
            ("1  -0", "1  0"),
            ("- -a -0.0a -1.0 +-0.0", "- -a -0.0a -1.0 +-0.0"),
            ("", ""),
        ] {
            assert_eq!(unsigned_zeros(text), said);
        }
    }

    #[test]
    fn days_are_those_of_the_calendar() {
        for (unix, date) in
            [(0.0, "1970-01-01"), (951_827_696.0, "2000-02-29"), (1_795_392_000.0, "2026-11-23")]
        {
            assert_eq!(day(unix), date);
        }
    }

    #[test]
    fn rough_numbers_have_two_digits() {
        for (x, said) in [(0.324, "0.32"), (4.06, "4.1"), (41.3, "41"), (140.2, "140"), (0.0, "0")]
        {
            assert_eq!(rough(x), said);
        }
    }

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

    #[test]
    fn digits_are_few() {
        assert_eq!(
            [1234.0, 12.34, 0.5, 0.0012, 100.0].map(digits),
            ["1234", "12.3", "0.5", "0.0012", "100"]
        );
    }

    #[test]
    fn chances_and_angles_have_a_size_one_can_imagine() {
        assert_eq!(
            [0.0, 1e-300, 0.00021, 0.5].map(chance),
            ["<0.0001", "<0.0001", "0.0002", "0.5000"]
        );
        assert_eq!([0.00123, 11.963].map(angle), ["1.23 mrad", "12 rad"]);
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(to_uncertainty(-0.0001, -0.5, 0.5)[0], "0.00");
        assert_eq!(digits(-0.0), "0");
    }
}
