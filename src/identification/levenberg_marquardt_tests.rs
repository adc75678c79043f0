//! Against MINPACK and scipy on the classic problems (tests/golden/levenberg_marquardt.py).

use super::*;

const BARD_Y: [f64; 15] =
    [0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39];
const KOWALIK_Y: [f64; 11] =
    [0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246];
const KOWALIK_U: [f64; 11] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625];
const MEYER_Y: [f64; 16] = [
    34780.0, 28610.0, 23650.0, 19630.0, 16370.0, 13720.0, 11540.0, 9744.0, 8261.0, 7030.0, 6005.0,
    5147.0, 4427.0, 3820.0, 3307.0, 2872.0,
];

struct Classic {
    count: usize,
    f: fn(&[f64]) -> Vec<f64>,
}

impl Residuals for Classic {
    fn count(&self) -> usize {
        self.count
    }

    fn residuals(&self, x: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&(self.f)(x));
    }
}

fn classic(name: &str) -> Classic {
    match name {
        "rosenbrock" => Classic { count: 2, f: |x| vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]] },
        "powell_singular" => Classic { count: 4, f: powell_singular },
        "freudenstein_roth" => Classic { count: 2, f: freudenstein_roth },
        "bard" => Classic { count: 15, f: bard },
        "kowalik_osborne" => Classic { count: 11, f: kowalik_osborne },
        "meyer" => Classic { count: 16, f: meyer },
        "jennrich_sampson" => Classic { count: 10, f: jennrich_sampson },
        other => panic!("no problem {other}"),
    }
}

fn powell_singular(x: &[f64]) -> Vec<f64> {
    vec![
        x[0] + 10.0 * x[1],
        5f64.sqrt() * (x[2] - x[3]),
        (x[1] - 2.0 * x[2]).powi(2),
        10f64.sqrt() * (x[0] - x[3]).powi(2),
    ]
}

fn freudenstein_roth(x: &[f64]) -> Vec<f64> {
    let (a, b) = (x[0], x[1]);
    vec![-13.0 + a + ((5.0 - b) * b - 2.0) * b, -29.0 + a + ((b + 1.0) * b - 14.0) * b]
}

fn bard(x: &[f64]) -> Vec<f64> {
    let row = |(i, y): (usize, &f64)| {
        let u = (i + 1) as f64;
        let v = 16.0 - u;
        y - (x[0] + u / (v * x[1] + u.min(v) * x[2]))
    };
    BARD_Y.iter().enumerate().map(row).collect()
}

fn kowalik_osborne(x: &[f64]) -> Vec<f64> {
    let row = |(y, u): (&f64, &f64)| y - x[0] * (u * u + u * x[1]) / (u * u + u * x[2] + x[3]);
    KOWALIK_Y.iter().zip(&KOWALIK_U).map(row).collect()
}

fn meyer(x: &[f64]) -> Vec<f64> {
    let row = |(i, y): (usize, &f64)| x[0] * (x[1] / (50.0 + 5.0 * i as f64 + x[2])).exp() - y;
    MEYER_Y.iter().enumerate().map(row).collect()
}

fn jennrich_sampson(x: &[f64]) -> Vec<f64> {
    (1..=10).map(f64::from).map(|i| 2.0 + 2.0 * i - ((i * x[0]).exp() + (i * x[1]).exp())).collect()
}

#[derive(serde::Deserialize)]
struct Golden {
    problem: String,
    start: Vec<f64>,
    bounds: Option<(Vec<f64>, Vec<f64>)>,
    x: Vec<f64>,
    sum_of_squares: f64,
}

#[test]
fn reaches_the_same_minima_as_minpack_and_scipy() {
    let text = include_str!("../../tests/golden/levenberg_marquardt.json");
    let all: Vec<Golden> = serde_json::from_str(text).unwrap();
    assert!(all.len() > 10);
    for golden in all {
        let bounds = match golden.bounds {
            Some((lower, upper)) => Bounds::new(lower, upper).unwrap(),
            None => Bounds::unbounded(golden.start.len()),
        };
        let problem = classic(&golden.problem);
        let outcome = minimise(&problem, &golden.start, &bounds, &Settings::default());
        let excess = outcome.sum_of_squares - golden.sum_of_squares;
        let name = &golden.problem;
        assert!(outcome.stop.converged(), "{name}: {outcome:?}");
        assert!(excess <= 1e-9 * golden.sum_of_squares + 1e-20, "{name}: {outcome:?}");
        if name != "powell_singular" {
            for (x, g) in outcome.x.iter().zip(&golden.x) {
                assert!((x - g).abs() <= 1e-5 * g.abs() + 1e-7, "{name}: {:?}", outcome.x);
            }
        }
    }
}

#[test]
fn dependent_parameters_are_no_obstacle() {
    let sum = Classic { count: 2, f: |x| vec![x[0] + x[1] - 1.0, 2.0 * (x[0] + x[1]) - 4.0] };
    let outcome = minimise(&sum, &[5.0, 5.0], &Bounds::unbounded(2), &Settings::default());
    assert!(outcome.stop.converged());
    assert!((outcome.x[0] + outcome.x[1] - 1.8).abs() < 1e-6, "{outcome:?}");
}

#[test]
fn a_residual_that_is_not_finite_at_the_start_is_said_so() {
    let nan = Classic { count: 1, f: |_| vec![f64::NAN] };
    let outcome = minimise(&nan, &[0.0], &Bounds::unbounded(1), &Settings::default());
    assert_eq!(outcome.stop, Stop::NotFinite);
}
