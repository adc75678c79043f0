//! One simulation of the DC motor's shipped identification recording (100 s, 100000 samples).

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};

use armtwin::motor::experiment::Clean;
use armtwin::motor::scenario::{SHIPPED, Scenario};
use armtwin::motor::sensitivity::{Sensitivities, simulate_with_sensitivities};
use armtwin::motor::simulate::{Accuracy, simulate_each};

fn motor(c: &mut Criterion) {
    let scenario = Scenario::parse(SHIPPED[0]).expect("a shipped scenario");
    let clean = Clean::of(&scenario.truth, &scenario.identification).expect("the true motor");
    let record = clean.for_identification(1);
    let problem = scenario.problem(&record);
    let x = scenario.truth.to_array();
    c.bench_function("motor: simulate 100 s, 1 kHz", |b| {
        b.iter(|| {
            let mut last = 0.0;
            let done =
                simulate_each(&scenario.truth, &clean.input, Accuracy::SEARCH, |_, w| last = w);
            black_box((done, last))
        });
    });
    c.bench_function("motor: cost of one particle", |b| b.iter(|| black_box(problem.cost(&x))));
    c.bench_function("motor: cost of one particle, as a swarm asks for it", |b| {
        b.iter(|| black_box(problem.cost_below(f64::INFINITY, &x)));
    });
    let mut space = Sensitivities::default();
    c.bench_function("motor: with sensitivities", |b| {
        b.iter(|| {
            simulate_with_sensitivities(
                &scenario.truth,
                &clean.input,
                Accuracy::SEARCH,
                black_box(&mut space),
            )
        });
    });
}

criterion_group!(benches, motor);
criterion_main!(benches);
