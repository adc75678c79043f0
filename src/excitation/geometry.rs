//! Distances of line segments: from each other and from a box.

use nalgebra::Vector3;

/// A straight segment from one end to the other, m.
pub type Segment = [Vector3<f64>; 2];

/// A box parallel to the axes of the base, m.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Cuboid {
    pub lower: [f64; 3],
    pub upper: [f64; 3],
}

/// Shorter segments are points, m2.
const POINT_M2: f64 = 1e-18;

/// Distance of the closest points of two segments, m (Ericson, *Real-Time Collision Detection*, 2005,
/// section 5.1.9, in its symbols).
pub fn segment_segment([p1, q1]: &Segment, [p2, q2]: &Segment) -> f64 {
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, f) = (d1.dot(&d1), d2.dot(&d2), d2.dot(&r));
    let c = d1.dot(&r);
    let (s, t) = if a <= POINT_M2 && e <= POINT_M2 {
        (0.0, 0.0)
    } else if a <= POINT_M2 {
        (0.0, (f / e).clamp(0.0, 1.0))
    } else if e <= POINT_M2 {
        ((-c / a).clamp(0.0, 1.0), 0.0)
    } else {
        let b = d1.dot(&d2);
        let denominator = a * e - b * b;
        let parallel = denominator <= 1e-12 * a * e;
        let s = if parallel { 0.0 } else { ((b * f - c * e) / denominator).clamp(0.0, 1.0) };
        match (b * s + f) / e {
            t if t < 0.0 => ((-c / a).clamp(0.0, 1.0), 0.0),
            t if t > 1.0 => (((b - c) / a).clamp(0.0, 1.0), 1.0),
            t => (s, t),
        }
    };
    (p1 + d1 * s - p2 - d2 * t).norm()
}

/// Distance of a segment from a box, m; zero where they meet.
///
/// Half the square of the distance of p + t d is convex in t and quadratic between the places where
/// the segment crosses a face's plane: its minimum is where its slope, linear in between, vanishes.
pub fn segment_box([p, q]: &Segment, cuboid: &Cuboid) -> f64 {
    let d = q - p;
    let outside = |t: f64| Vector3::from_fn(|i, _| cuboid.beyond(i, p[i] + t * d[i]));
    let slope = |t: f64| outside(t).dot(&d);
    let crossings =
        (0..3).flat_map(|i| [cuboid.lower[i], cuboid.upper[i]].map(|x| (x - p[i]) / d[i]));
    let mut places: Vec<f64> = crossings.filter(|t| *t > 0.0 && *t < 1.0).collect();
    places.extend([0.0, 1.0]);
    places.sort_by(f64::total_cmp);
    let after = places.iter().position(|&t| slope(t) >= 0.0);
    let best = match after {
        None => 1.0,
        Some(0) => 0.0,
        Some(i) => {
            let (t0, t1) = (places[i - 1], places[i]);
            let (s0, s1) = (slope(t0), slope(t1));
            t0 + (t1 - t0) * s0 / (s0 - s1)
        }
    };
    outside(best).norm()
}

impl Cuboid {
    /// How far a coordinate lies outside along one axis, m, signed.
    fn beyond(&self, axis: usize, x: f64) -> f64 {
        x - x.clamp(self.lower[axis], self.upper[axis])
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn segment(a: [f64; 3], b: [f64; 3]) -> Segment {
        [a.into(), b.into()]
    }

    #[test]
    fn closed_forms() {
        let x = segment([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let cases = [
            // Crossing at a right angle, 0.3 apart.
            (segment([0.5, -1.0, 0.3], [0.5, 1.0, 0.3]), 0.3),
            // Parallel beside, and parallel further on.
            (segment([0.2, 0.4, 0.0], [0.9, 0.4, 0.0]), 0.4),
            (segment([4.0, 4.0, 0.0], [5.0, 4.0, 0.0]), 5.0),
            // End against end, point, meeting.
            (segment([1.0, 0.3, 0.4], [2.0, 3.0, 4.0]), 0.5),
            (segment([-3.0, 0.0, 4.0], [-3.0, 0.0, 4.0]), 5.0),
            (segment([0.5, -1.0, 0.0], [0.5, 1.0, 0.0]), 0.0),
        ];
        for (other, expected) in cases {
            assert!((segment_segment(&x, &other) - expected).abs() < 1e-12, "{other:?}");
            assert!((segment_segment(&other, &x) - expected).abs() < 1e-12, "{other:?}");
        }
        let cuboid = Cuboid { lower: [0.0; 3], upper: [1.0, 2.0, 3.0] };
        let cases = [
            // Above a face, beside an edge, off a corner, through, inside.
            (segment([0.5, -9.0, 3.2], [0.5, 9.0, 3.2]), 0.2),
            (segment([1.3, 2.4, -9.0], [1.3, 2.4, 9.0]), 0.5),
            (segment([2.0, 4.0, 5.0], [5.0, 4.0, 5.0]), 3.0),
            (segment([-5.0, 1.0, 1.0], [5.0, 1.1, 1.2]), 0.0),
            (segment([0.2, 0.2, 0.2], [0.3, 0.3, 0.3]), 0.0),
            // Off a corner along a diagonal: the closest point lies between planes.
            (segment([2.0, -1.0, 1.0], [0.0, -1.0 - 2.0, 1.0]), 2_f64.sqrt()),
        ];
        for (segment, expected) in cases {
            let found = segment_box(&segment, &cuboid);
            assert!((found - expected).abs() < 1e-12, "{segment:?}: {found}");
        }
    }

    /// Compares with the smallest of many distances between points along both.
    #[test]
    fn no_pair_of_points_is_closer() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut point = || Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        for _ in 0..200 {
            let (a, b) = ([point(), point()], [point(), point()]);
            let along = |s: &Segment, i: usize| s[0] + (s[1] - s[0]) * (i as f64 / 100.0);
            let (u, v) = (point(), point());
            let cuboid = Cuboid { lower: u.inf(&v).into(), upper: u.sup(&v).into() };
            let (mut closest, mut to_box) = (f64::MAX, f64::MAX);
            for i in 0..=100 {
                let x = along(&a, i);
                let outside = Vector3::from_fn(|k, _| cuboid.beyond(k, x[k]));
                to_box = to_box.min(outside.norm());
                for k in 0..=100 {
                    closest = closest.min((x - along(&b, k)).norm());
                }
            }
            let (found, boxed) = (segment_segment(&a, &b), segment_box(&a, &cuboid));
            assert!(found <= closest + 1e-12 && closest < found + 0.04, "{found} {closest}");
            assert!(boxed <= to_box + 1e-12 && to_box < boxed + 0.02, "{boxed} {to_box}");
        }
    }
}
