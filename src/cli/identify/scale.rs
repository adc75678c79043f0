//! `identify --loaded`: the drives' torque constants by a load that is known.

use std::path::PathBuf;

use crate::identification::Gain;
use crate::report::{table, to_uncertainty};
use crate::workflow::{KnownLoad, Scaled};

#[derive(clap::Args)]
pub struct LoadArgs {
    /// Recording of the arm with a known load at the flange, which tells the torque constants [default: none]
    #[arg(long, value_name = "RECORDING", requires = "payload")]
    loaded: Option<PathBuf>,
    /// Mass of the load of --loaded, kg; needed with --loaded
    #[arg(long, value_name = "KG", value_parser = mass, requires = "loaded", allow_hyphen_values = true)]
    payload: Option<f64>,
    /// Centre of the load's mass in the flange's frame, m [default: it is fitted]
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
    /// The recording and the load in it, if torque constants are what is asked for.
    pub fn given(&self) -> Option<(&PathBuf, KnownLoad)> {
        let mass_kg = self.payload?;
        Some((self.loaded.as_ref()?, KnownLoad { mass_kg, centre_m: self.payload_centre }))
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
