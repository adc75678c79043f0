//! Minimum of a function of one variable inside a bracket.
//!
//! Brent, *Algorithms for Minimization without Derivatives*, 1973, chapter 5: parabolas through
//! the three best points, golden sections where a parabola does not help.

const GOLDEN: f64 = 0.381_966_011_250_105;

/// A point and the value there.
#[derive(Clone, Copy)]
struct Point {
    x: f64,
    f: f64,
}

/// `(x, f(x))` of a local minimum in `[low, high]`, to `tolerance` in x.
pub fn minimise(mut f: impl FnMut(f64) -> f64, low: f64, high: f64, tolerance: f64) -> (f64, f64) {
    let (mut a, mut b) = (low, high);
    let x = a + GOLDEN * (b - a);
    let mut best = Point { x, f: f(x) };
    let (mut second, mut third) = (best, best);
    let (mut step, mut step_before_last) = (0.0f64, 0.0f64);
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        let small = 1e-15 * best.x.abs() + tolerance / 3.0;
        if (best.x - middle).abs() <= 2.0 * small - 0.5 * (b - a) {
            break;
        }
        let parabola = parabola_step(best, second, third);
        let helps = parabola.abs() < 0.5 * step_before_last.abs()
            && best.x + parabola > a + 2.0 * small
            && best.x + parabola < b - 2.0 * small;
        step_before_last =
            if helps { step } else { (if best.x < middle { b } else { a }) - best.x };
        step = if helps { parabola } else { GOLDEN * step_before_last };
        let x = best.x + if step.abs() >= small { step } else { small.copysign(step) };
        let new = Point { x, f: f(x) };
        if new.f <= best.f {
            *(if new.x < best.x { &mut b } else { &mut a }) = best.x;
            (third, second, best) = (second, best, new);
        } else {
            *(if new.x < best.x { &mut a } else { &mut b }) = new.x;
            if new.f <= second.f || second.x == best.x {
                (third, second) = (second, new);
            } else if new.f <= third.f || third.x == best.x || third.x == second.x {
                third = new;
            }
        }
    }
    (best.x, best.f)
}

/// From the best point to the vertex of the parabola through all three; infinite if there is none.
fn parabola_step(best: Point, second: Point, third: Point) -> f64 {
    let r = (best.x - second.x) * (best.f - third.f);
    let q = (best.x - third.x) * (best.f - second.f);
    let numerator = (best.x - third.x) * q - (best.x - second.x) * r;
    let denominator = 2.0 * (q - r);
    if denominator == 0.0 { f64::INFINITY } else { -numerator / denominator }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_minimum_of_a_smooth_function_in_a_dozen_evaluations() {
        let mut calls = 0;
        let f = |x: f64| {
            calls += 1;
            x - (x + 1.0).ln() * 2.0
        };
        let (x, value) = minimise(f, 0.0, 5.0, 1e-9);
        assert!((x - 1.0).abs() < 1e-7, "{x}");
        assert!((value - (1.0 - 2.0 * 2f64.ln())).abs() < 1e-14);
        assert!(calls < 25, "{calls} evaluations");
    }

    #[test]
    fn a_minimum_at_the_edge_is_approached() {
        let (x, _) = minimise(|x| x, 2.0, 3.0, 1e-9);
        assert!((x - 2.0).abs() < 1e-7);
    }

    #[test]
    fn a_kink_is_found_by_golden_sections() {
        let (x, _) = minimise(|x: f64| (x - 0.3).abs(), 0.0, 1.0, 1e-10);
        assert!((x - 0.3).abs() < 1e-9);
    }
}
