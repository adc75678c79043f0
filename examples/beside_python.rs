//! The engine's own times beside which `python/bench/bench.py` stands: torque along 100 000 samples, and
//! an identification of the recording that it wrote.
//!
//! `cargo run --release --example beside_python -- RECORDING.csv`

use std::time::Instant;

use armtwin::effects::Motion;
use armtwin::identification::Method;
use armtwin::robot::{Workspace, inverse_dynamics};
use armtwin::series::JointSeries;
use armtwin::workflow::Identify;
use armtwin::{Twin, recording};

const SAMPLES: usize = 100_000;

/// Median wall-clock, ms.
fn median_ms(repeats: usize, mut call: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..repeats)
        .map(|_| {
            let clock = Instant::now();
            call();
            1e3 * clock.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[repeats / 2]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut twin = Twin::default();
    twin.drive.rotor_inertia = vec![1.1, 1.1, 1.1, 0.14, 0.14, 0.14];
    let wave = |rate: f64, j: usize| (0..SAMPLES).map(move |k| (rate * k as f64 + j as f64).sin());
    let series = |rate: f64| {
        JointSeries::from_joints(
            &(0..6).map(|j| wave(rate, j).collect()).collect::<Vec<Vec<f64>>>(),
        )
    };
    let [q, qd, qdd] = [0.7, 1.3, 2.9].map(series);
    let whole = median_ms(21, || {
        std::hint::black_box(twin.torque(&Motion::new(&twin.robot, 0.008, &q, &qd, &qdd)));
    });
    println!("Twin::torque, ({SAMPLES}, 6)            {whole:9.2} ms");
    let mut ws = Workspace::new(&twin.robot);
    let mut state = [[0.0; 6]; 4];
    let looped = median_ms(21, || {
        for k in 0..SAMPLES {
            let [a, b, c, tau] = &mut state;
            q.sample_into(k, a);
            qd.sample_into(k, b);
            qdd.sample_into(k, c);
            inverse_dynamics(&twin.robot, &mut ws, a, b, c, tau);
            tau.iter_mut()
                .zip(&*c)
                .zip(&twin.drive.rotor_inertia)
                .for_each(|((t, a), i)| *t += i * a);
            std::hint::black_box(tau);
        }
    });
    println!("inverse_dynamics, one thread          {looped:9.2} ms");
    if let Some(path) = std::env::args().nth(1) {
        let fit = recording::read(path.as_ref(), None)?;
        let how = Identify::default().methods([Method::Nlse]);
        how.run(&twin, &fit, None, &())?;
        let own = median_ms(41, || {
            std::hint::black_box(how.run(&twin, &fit, None, &()).is_ok());
        });
        println!("Identify::run, 6 x {} samples        {own:9.2} ms", fit.time.len());
    }
    Ok(())
}
