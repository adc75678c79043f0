//! Conditioning and inference of one joint's signals: `cargo bench --bench signals`.

use std::hint::black_box;

use armtwin::signals::LowPass;
use armtwin::statistics::infer;
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::DMatrix;

/// 6000 samples of sixteen columns: what one joint's regression filters.
fn low_pass(c: &mut Criterion) {
    let filter = LowPass::new(8.0, 125.0, 4).expect("below Nyquist");
    let column: Vec<f64> = (0..6000).map(|k| (0.01 * f64::from(k)).sin()).collect();
    let columns = vec![column.clone(); 16];
    c.bench_function("zero-phase low-pass, 6000 samples", |b| {
        b.iter(|| filter.apply(black_box(&mut column.clone())))
    });
    c.bench_function("zero-phase low-pass, 16 columns of 6000", |b| {
        b.iter(|| filter.apply_many(black_box(&mut columns.clone())))
    });
}

/// Intervals of six parameters by three conventions from 1000 decimated rows.
fn inference(c: &mut Criterion) {
    let n = 1000;
    let jacobian = DMatrix::from_fn(n, 6, |i, k| (0.02 * (i * (k + 1)) as f64).sin());
    let residual: Vec<f64> = (0..n).map(|i| ((i * i) as f64).cos()).collect();
    let slots: Vec<usize> = (0..n).collect();
    let zero = [0.0; 6];
    c.bench_function("infer, 1000 rows, 6 parameters", |b| {
        b.iter(|| infer(&zero, &zero, black_box(&jacobian), &residual, &slots, None, 0.99))
    });
}

criterion_group!(benches, low_pass, inference);
criterion_main!(benches);
