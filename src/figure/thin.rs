//! As many points as a plot can show.

/// Points in order of time. Where rows are further apart than `step` the line ends (NaN); `time` and
/// `step` have one unit.
pub fn over_time(time: &[f64], y: &[f64], step: f64) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = Vec::with_capacity(y.len());
    for (k, (&t, &y)) in time.iter().zip(y).enumerate() {
        if k > 0 && t - time[k - 1] > 1.5 * step {
            points.push((t, f64::NAN));
        }
        points.push((t, y));
    }
    points
}

/// Least and largest value of each of about `places` stretches of a line, in the order they come: peaks
/// stay, and so do the ends of a line.
pub fn thinned(points: &[(f64, f64)], places: usize) -> Vec<(f64, f64)> {
    let most = points.len().div_ceil(places.max(1)).max(1);
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for run in runs(points) {
        if !kept.is_empty() {
            kept.push((run[0].0, f64::NAN));
        }
        kept.extend(run.chunks(most).flat_map(extremes));
    }
    kept
}

/// One of every so many rows, so that `most` are left.
pub fn every(x: &[f64], y: &[f64], most: usize) -> Vec<(f64, f64)> {
    let stride = x.len().div_ceil(most.max(1)).max(1);
    x.iter().copied().zip(y.iter().copied()).step_by(stride).collect()
}

/// Stretches of points whose values are numbers.
pub fn runs(points: &[(f64, f64)]) -> impl Iterator<Item = &[(f64, f64)]> {
    points.split(|p| !p.1.is_finite()).filter(|run| !run.is_empty())
}

/// Points of the least and the largest value; all of them where there are no more than two.
fn extremes(stretch: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let by_value = |a: &usize, b: &usize| stretch[*a].1.total_cmp(&stretch[*b].1);
    let ends = [(0..stretch.len()).min_by(by_value), (0..stretch.len()).max_by(by_value)];
    match ends {
        [Some(a), Some(b)] if a != b => vec![stretch[a.min(b)], stretch[a.max(b)]],
        _ => stretch.first().copied().into_iter().collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_peaks_where_they_are() {
        let x: Vec<f64> = (0..10_000).map(f64::from).collect();
        let mut y: Vec<f64> = x.iter().map(|x| (0.001 * x).sin()).collect();
        (y[1234], y[8000]) = (-7.0, 9.0);
        let all = over_time(&x, &y, 1.0);
        let kept = thinned(&all, 100);
        assert!(kept.len() <= 200 && kept.windows(2).all(|w| w[0].0 < w[1].0), "{}", kept.len());
        assert!(kept.contains(&(1234.0, -7.0)) && kept.contains(&(8000.0, 9.0)));
        assert_eq!(thinned(&all[..50], 100), all[..50], "all of a few");
    }

    #[test]
    fn a_line_ends_where_rows_are_left_out_or_no_number_stands() {
        let y = [1.0, 1.0, 2.0, 3.0, f64::NAN, 4.0];
        let all = over_time(&[0.0, 0.1, 0.2, 1.0, 1.1, 1.2], &y, 0.1);
        let ends: Vec<bool> = thinned(&all, 100).iter().map(|p| p.1.is_nan()).collect();
        assert_eq!(ends, [false, false, false, true, false, true, false]);
    }

    #[test]
    fn scattered_points_are_few() {
        let x: Vec<f64> = (0..1000).map(f64::from).collect();
        assert_eq!(every(&x, &x, 100).len(), 100);
    }
}
