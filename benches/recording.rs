//! Reading a 6000 x 43 recording (48 s of a six-joint arm at 125 Hz).
//! `benches/recording_pandas.py` times pandas on the same file.

use std::fmt::Write;
use std::hint::black_box;
use std::path::PathBuf;

use armtwin::recording;
use criterion::{Criterion, criterion_group, criterion_main};

const SIGNALS: [&str; 7] = [
    "target_q",
    "target_qd",
    "target_qdd",
    "actual_q",
    "actual_qd",
    "actual_current",
    "joint_temperatures",
];

/// Smooth signals with six significant digits, as logs have them.
fn generate() -> String {
    let mut text = String::from("timestamp");
    for signal in SIGNALS {
        (0..6).for_each(|j| write!(text, ",{signal}_{j}").unwrap());
    }
    for k in 0..6000 {
        let time = 0.008 * k as f64;
        write!(text, "\n{time:.3}").unwrap();
        (0..42)
            .for_each(|c| write!(text, ",{:.6}", (time * (1.0 + 0.1 * c as f64)).sin()).unwrap());
    }
    text + "\n"
}

fn read(criterion: &mut Criterion) {
    let text = generate();
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("recording_6000x43.csv");
    std::fs::write(&path, &text).unwrap();
    let read = recording::read(&path, None).unwrap();
    assert_eq!((read.time.len(), read.channels.len()), (6000, 42));
    let packed = path.with_extension("csv.gz");
    recording::write_csv(&read, &packed).unwrap();
    criterion.bench_function("read 6000 x 43 CSV", |b| {
        b.iter(|| recording::read(black_box(&path), None).unwrap());
    });
    criterion.bench_function("read 6000 x 43 CSV.gz", |b| {
        b.iter(|| recording::read(black_box(&packed), None).unwrap());
    });
}

criterion_group!(benches, read);
criterion_main!(benches);
