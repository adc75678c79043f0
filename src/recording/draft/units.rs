//! Units, by sizes, by names, and by what velocities and positions say of each other.

use super::Block;
use super::source::Columns;
use super::words::words;
use crate::recording::inspection::{plausible_step, step};

const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// rad: two turns; no servo arm goes further, and in degrees most do.
const FURTHEST: f64 = 12.6;
/// A and N.m beyond which a column is in thousandths.
const STRONGEST_A: f64 = 100.0;
const STRONGEST_NM: f64 = 5000.0;

/// Unit of the time column.
pub struct Clock {
    pub scale: f64,
    pub why: &'static str,
}

pub fn clock(columns: &Columns, time: usize) -> Clock {
    let step = step(&columns.values[time]);
    let units = [
        (1.0, "s, as its steps are those of a recording"),
        (1e-3, "ms, as its steps are those of a recording then"),
        (1e-6, "us, as its steps are those of a recording then"),
        (1e-9, "ns, as its steps are those of a recording then"),
    ];
    let fits = |scale: f64| plausible_step(step * scale);
    let found = units.into_iter().find(|(scale, _)| fits(*scale)).unwrap_or(units[0]);
    Clock { scale: found.0, why: found.1 }
}

/// Sets the scale of every block, and says why.
pub fn guess(blocks: &mut [Block], columns: &Columns, time: usize, time_scale: f64) {
    let position = blocks.iter().find(|b| b.stem == "actual_q").cloned();
    for block in blocks.iter_mut() {
        let largest = largest(block, columns);
        let degrees = named(block, columns, &["deg", "degree", "degrees", "dps"]);
        let (scale, why) = match block.stem {
            "actual_q" | "target_q" if degrees || largest > FURTHEST => {
                (DEGREE, format!("degrees: up to {largest:.0}"))
            }
            "actual_q" | "target_q" => (1.0, format!("rad: up to {largest:.2}")),
            "actual_qd" | "target_qd" | "actual_qdd" | "target_qdd" => (1.0, String::new()),
            "actual_current" | "target_current" if largest > STRONGEST_A => {
                (1e-3, format!("mA: up to {largest:.0}"))
            }
            "actual_current" | "target_current" => (1.0, format!("A: up to {largest:.2}")),
            "joint_torque" | "target_moment" if largest > STRONGEST_NM => {
                (1e-3, format!("N.mm: up to {largest:.0}"))
            }
            "joint_torque" | "target_moment" => (1.0, format!("N.m: up to {largest:.1}")),
            _ => (1.0, format!("up to {largest:.1}")),
        };
        block.scale = scale;
        if !why.is_empty() {
            block.why = format!("{}; {why}", block.why);
        }
    }
    let Some(position) = position else { return };
    let in_degrees = blocks.iter().any(|b| b.stem == "actual_q" && b.scale != 1.0);
    let radian = if in_degrees { DEGREE } else { 1.0 };
    for block in blocks.iter_mut().filter(|b| b.stem.ends_with("_qd")) {
        let Some(slope) = slope(&position, block, columns, time, time_scale) else { continue };
        // Velocity over differentiated position, in units of the file, is 1 where both have one unit.
        let scale = radian / nearest(slope);
        block.scale = scale;
        let unit = if (scale / DEGREE - 1.0).abs() < 0.1 { "degrees/s" } else { "rad/s" };
        block.why = format!("{}; {unit}: {slope:.3} times what actual_q changes by", block.why);
    }
    for block in blocks.iter_mut().filter(|b| b.stem.ends_with("_qdd") && in_degrees) {
        block.scale = DEGREE;
        block.why = format!("{}; degrees/s2, as positions are in degrees", block.why);
    }
}

/// The factor between units that is nearest to a slope.
fn nearest(slope: f64) -> f64 {
    let units = [1.0, 1.0 / DEGREE, DEGREE, 1000.0, 1e-3];
    let far = |unit: f64| (slope / unit).ln().abs();
    units.into_iter().min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(1.0)
}

fn largest(block: &Block, columns: &Columns) -> f64 {
    let all = block.columns.iter().flat_map(|c| &columns.values[*c]);
    all.fold(0.0, |most: f64, v| most.max(v.abs()))
}

fn named(block: &Block, columns: &Columns, units: &[&str]) -> bool {
    let name = block.columns.first().and_then(|c| columns.name(*c)).unwrap_or_default();
    words(name).iter().any(|w| units.contains(&w.as_str()))
}

/// Median over joints of the velocity's size over that of the differentiated position.
fn slope(
    position: &Block,
    velocity: &Block,
    columns: &Columns,
    time: usize,
    time_scale: f64,
) -> Option<f64> {
    let t = &columns.values[time];
    let each = position.columns.iter().zip(&velocity.columns).filter_map(|(q, v)| {
        let (q, v) = (&columns.values[*q], &columns.values[*v]);
        let hops = 1.max((0.1 / (step(t) * time_scale)).round() as usize);
        let (mut travelled, mut summed) = (0.0, 0.0);
        for k in (0..t.len().saturating_sub(hops)).step_by(hops) {
            let seconds = (t[k + hops] - t[k]) * time_scale;
            travelled += (q[k + hops] - q[k]).abs();
            summed += v[k + hops / 2].abs() * seconds;
        }
        (travelled > 0.0 && summed > 0.0).then(|| summed / travelled)
    });
    let mut each: Vec<f64> = each.collect();
    each.sort_unstable_by(f64::total_cmp);
    each.get(each.len() / 2).copied()
}
