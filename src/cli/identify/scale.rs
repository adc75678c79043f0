//! `identify --loaded`: the drives' torque constants by a load that is known.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use super::{Args, inertia};
use crate::cli::twin::Arm;
use crate::identification::{Gain, Load, Terms, TorqueScale, torque_scale};
use crate::recording::Recording;
use crate::report::{table, to_uncertainty};
use crate::signals::{Conditioning, Samples};
use crate::twin::Twin;

#[derive(clap::Args)]
pub struct LoadArgs {
    /// Recording of the arm with a known load at the flange: tells the drives' torque constants
    #[arg(long, value_name = "RECORDING", requires = "payload")]
    loaded: Option<PathBuf>,
    /// Mass of that load, kg
    #[arg(long, value_name = "KG", value_parser = mass, requires = "loaded", allow_hyphen_values = true)]
    payload: Option<f64>,
    /// Centre of its mass in the flange's frame, m [default: found along]
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_parser = centre,
        requires = "loaded",
        allow_hyphen_values = true
    )]
    payload_centre: Option<[f64; 3]>,
}

impl LoadArgs {
    /// Whether torque constants are what is asked for.
    pub fn is_given(&self) -> bool {
        self.loaded.is_some()
    }
}

/// `2.805` or `2.805kg`
fn mass(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches("kg").trim().parse::<f64>();
    let positive = number.ok().filter(|m| *m > 0.0 && m.is_finite());
    positive.ok_or("give the mass of the load in kg, for example 2.805kg".into())
}

fn centre(text: &str) -> Result<[f64; 3], String> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|n| n.trim().parse().ok().filter(|n: &f64| n.is_finite())).collect();
    let three = numbers.and_then(|n| <[f64; 3]>::try_from(n).ok());
    three.ok_or("give X,Y,Z in m, for example 0,0,0.05".into())
}

/// What was found, and what became of the twin.
pub struct Scaled {
    pub scale: TorqueScale,
    pub twin: Twin,
    pub loaded: Recording,
    pub note: Option<String>,
}

impl Args {
    /// The twin with torque constants of its own arm, where a loaded run tells them.
    pub fn scaled(
        &self,
        arm: &Arm,
        terms: &Terms,
        fit: &(Recording, Samples),
        how: &Conditioning,
    ) -> anyhow::Result<Option<Scaled>> {
        let LoadArgs { loaded: Some(path), payload: Some(mass_kg), payload_centre } = &self.load
        else {
            return Ok(None);
        };
        super::refuse_same_file(&self.recordings[0], path)?;
        self.refuse_unknown_loads(path)?;
        let loaded = self.read(path, arm, how)?;
        let twin = &arm.twin;
        super::refuse_same_samples(&fit.0, &loaded.0)?;
        let load = Load { mass_kg: *mass_kg, centre_m: *payload_centre };
        let scale = torque_scale(twin, terms, [&fit.1, &loaded.1], load)
            .with_context(|| format!("--loaded {}", path.display()))?;
        let (twin, note) = corrected(twin, &scale, &fit.0);
        Ok(Some(Scaled { scale, twin, loaded: loaded.0, note }))
    }

    fn refuse_unknown_loads(&self, path: &Path) -> anyhow::Result<()> {
        let unknown = ["payload", "link_inertia", "torque_constant"];
        let asked = self.with.iter().chain(&self.terms);
        match asked.into_iter().find(|name| unknown.contains(&name.as_str())) {
            Some(name) => bail!(
                "--loaded {}: the load is known there and links and torque constants are found \
                 along; leave `{name}` out (`--with {}` is welcome)",
                path.display(),
                inertia::NAME
            ),
            None => Ok(()),
        }
    }
}

/// The drive with what is told; the twin's own constants elsewhere.
fn corrected(twin: &Twin, scale: &TorqueScale, fit: &Recording) -> (Twin, Option<String>) {
    if fit.channel("joint_torque_0").is_some() {
        let note = "the recording holds joint torque, not current: the gains are its sensors', and \
                    the twin's drive stays as it is";
        return (twin.clone(), Some(note.into()));
    }
    let mut new = twin.clone();
    let told = scale.joints.iter().zip(&mut new.drive.torque_constant);
    told.filter(|(gain, _)| gain.identifiable).for_each(|(gain, k)| *k *= gain.value);
    (new, None)
}

pub fn print(scaled: &Scaled) {
    let Scaled { scale, note, .. } = scaled;
    let [x, y, z] = scale.centre_m;
    let found = if scale.load.centre_m.is_some() { "given" } else { "found" };
    println!(
        "\nTorque constants, by a load of {} kg with its centre at {x:.3} {y:.3} {z:.3} m ({found}), \
         beside links within {:.1} % of the model's",
        scale.load.mass_kg,
        100.0 * scale.spread
    );
    println!("{}", table(&HEADER, 1, scale.joints.iter().map(cells)));
    match note {
        Some(note) => println!("note: {note}"),
        None => println!("What follows is in torque by these constants, where they are told."),
    }
}

/// Joint by joint, in words.
pub fn lines(scaled: &Scaled) -> Vec<String> {
    let told = scaled.scale.joints.iter().filter(|gain| gain.identifiable);
    let line = |gain: &Gain| {
        let [value, low, high] = to_uncertainty(gain.value, gain.low, gain.high);
        format!(
            "joint {}: {value} times the twin's torque per ampere ({low} to {high}), {:.3} N.m/A",
            gain.joint, gain.torque_per_ampere
        )
    };
    told.map(line).collect()
}

const HEADER: [&str; 6] = ["joint", "times the twin's", "99 % low", "high", "N.m/A", ""];

fn cells(gain: &Gain) -> Vec<String> {
    let [value, low, high] = to_uncertainty(gain.value, gain.low, gain.high);
    let remark = if gain.identifiable { "" } else { "not told by these runs" };
    let constant = format!("{:.3}", gain.torque_per_ampere);
    vec![gain.joint.to_string(), value, low, high, constant, remark.into()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_is_read_with_and_without_its_unit() {
        assert_eq!(
            (mass("2.805kg"), mass(" 2.805 kg"), mass("3")),
            (Ok(2.805), Ok(2.805), Ok(3.0))
        );
        assert!(mass("0").is_err() && mass("-1kg").is_err() && mass("two").is_err());
        assert_eq!(centre("0, 0,0.05"), Ok([0.0, 0.0, 0.05]));
        assert!(centre("0,0").is_err() && centre("0,0,nan").is_err());
    }
}
