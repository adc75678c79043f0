//! The pushes that a force sensor shows.

use std::io::Read;
use std::path::Path;

use anyhow::Context;

/// N; what is less is no push.
const LEAST_N: f64 = 5.0;
/// Pushes nearer to each other are one, s.
const NEAR_S: f64 = 0.2;
/// At the start nothing touches, s: the sensor's zero.
const ZERO_S: f64 = 1.0;

/// A stretch of more than 5 N.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Push {
    pub start_s: f64,
    pub end_s: f64,
    pub peak_n: f64,
    pub peak_time_s: f64,
}

/// From a log of time (s) and force (N, three columns), comma-separated and packed with gzip.
pub fn pushes(log: &Path) -> anyhow::Result<Vec<Push>> {
    let mut text = String::new();
    let file = std::fs::File::open(log).with_context(|| log.display().to_string())?;
    flate2::read::GzDecoder::new(file).read_to_string(&mut text)?;
    // The last line may be cut.
    let lines: Vec<&str> = text.lines().collect();
    let row = |line: &&str| -> Option<[f64; 4]> {
        let numbers: Vec<f64> = line.split(',').map_while(|n| n.trim().parse().ok()).collect();
        numbers.get(..4)?.try_into().ok()
    };
    let rows: Vec<[f64; 4]> =
        lines.split_last().map_or(&[][..], |l| l.1).iter().filter_map(row).collect();
    Ok(stretches(&rows))
}

fn stretches(rows: &[[f64; 4]]) -> Vec<Push> {
    let quiet: Vec<_> = rows.iter().take_while(|r| r[0] < ZERO_S).collect();
    let mean = |i: usize| quiet.iter().map(|r| r[i]).sum::<f64>() / quiet.len().max(1) as f64;
    let zero = [mean(1), mean(2), mean(3)];
    let mut all: Vec<Push> = Vec::new();
    for row in rows {
        let force = (0..3).map(|i| (row[i + 1] - zero[i]).powi(2)).sum::<f64>().sqrt();
        if force < LEAST_N {
            continue;
        }
        let new = Push { start_s: row[0], end_s: row[0], peak_n: force, peak_time_s: row[0] };
        match all.last_mut() {
            Some(last) if row[0] - last.end_s < NEAR_S => {
                last.end_s = row[0];
                if force > last.peak_n {
                    (last.peak_n, last.peak_time_s) = (force, row[0]);
                }
            }
            _ => all.push(new),
        }
    }
    all
}
