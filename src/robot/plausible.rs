//! What a link of a machine can weigh and how it can be spread. Three grades: possible; impossible but
//! like what people publish, which is read and noted; absurd, which is refused.
//!
//! The principal moments of a rigid body are positive, and none is larger than the other two together
//! (the triangle inequality). A decimal point that is misplaced in one moment breaks that by a factor
//! of up to ten, and so do shells and rods that were entered by hand; beyond that a tensor is no
//! slip. A moment of zero is one that was not given, and breaks nothing.

use nalgebra::Vector3;

use super::Inertia;

/// kg. No part of any machine that has joints is heavier: a thousand tonnes.
pub const HEAVIEST_KG: f64 = 1e6;
/// kg.m2, of the heaviest at ten metres.
pub const MOST_KG_M2: f64 = 1e8;
/// m, of an offset between frames or to a centre of mass.
pub const FARTHEST_M: f64 = 1e4;
/// m, radius of gyration of a link; more is noted, as millimetres taken for metres give it.
pub const WIDEST_M: f64 = 10.0;

/// Shares of the largest principal moment. Others that far below zero are a small slip, ...
const SLIGHT: f64 = 0.05;
/// ... that far rounding, ...
pub const ROUNDING: f64 = 1e-9;
/// ... and numbers printed with two digits break the triangle inequality by that much.
const PRINTED: f64 = 0.01;
/// How many times a decimal point in the wrong place breaks the triangle inequality.
pub const TENFOLD: f64 = 10.0;

/// How principal moments (sorted, kg.m2) stand to those of a rigid body.
#[derive(Debug, PartialEq)]
pub enum Moments {
    Possible,
    /// The least is below zero, as far as a slip goes.
    SlightlyNegative,
    /// The largest is more than the others together, as far as a slip goes.
    Unequal,
    /// The largest is so many times the others together.
    Absurd(f64),
    Indefinite,
    /// Larger than those of any machine.
    Huge,
}

/// Judges principal moments of inertia, `least <= middle <= most`, kg.m2.
pub fn moments([least, middle, most]: [f64; 3]) -> Moments {
    let largest = most.abs().max(least.abs());
    let others = least + middle;
    match () {
        () if largest > MOST_KG_M2 => Moments::Huge,
        () if least < -SLIGHT * largest => Moments::Indefinite,
        () if least < -ROUNDING * largest => Moments::SlightlyNegative,
        () if most > TENFOLD * others && least > ROUNDING * most => Moments::Absurd(most / others),
        () if others < most * (1.0 - PRINTED) => Moments::Unequal,
        () => Moments::Possible,
    }
}

/// Can anything that moves have this mass?
///
/// # Errors
/// Says why not.
pub fn mass(kg: f64) -> Result<(), String> {
    match kg {
        _ if !kg.is_finite() || kg > HEAVIEST_KG => {
            Err(format!("mass is {kg:e} kg, and no link weighs more than {HEAVIEST_KG:e} kg"))
        }
        _ if kg < 0.0 => Err(format!("mass is {kg} kg; give a positive mass")),
        _ => Ok(()),
    }
}

/// Can an offset be so long?
///
/// # Errors
/// Says why not.
pub fn offset(metres: &Vector3<f64>) -> Result<(), String> {
    let length = metres.norm();
    match length <= FARTHEST_M {
        true => Ok(()),
        false => {
            Err(format!("is {length:.1e} m away, and no link is longer than {FARTHEST_M:e} m"))
        }
    }
}

/// Can a body of an arm be like this, with all that was joined to its link? Of its moments only their size
/// counts: links were judged one by one.
///
/// # Errors
/// Says why not.
pub fn body(inertia: &Inertia) -> Result<(), String> {
    mass(inertia.mass)?;
    offset(&inertia.com).map_err(|e| format!("centre of mass {e}"))?;
    let largest = inertia.about_com.amax();
    match largest <= MOST_KG_M2 {
        true => Ok(()),
        false => Err(format!("moment of inertia is {largest:.1e} kg.m2, that of no machine")),
    }
}

pub fn absurd(times: f64, eigenvalues: &str) -> String {
    format!(
        "inertia tensor {eigenvalues} breaks the triangle inequality {times:.0}-fold: its largest \
         moment can be the sum of the other two at most, and {TENFOLD} times that is read"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_published_is_told_from_what_is_absurd() {
        for (sorted, expected) in [
            ([0.01, 0.02, 0.03], Moments::Possible),
            ([0.0, 0.0, 0.0], Moments::Possible),
            // A rod and a flat thing of which moments are not given.
            ([0.0, 0.05, 0.05], Moments::Possible),
            ([0.0, 0.0, 0.5], Moments::Unequal),
            // KUKA, as published: links of 2 kg and 0.01 kg.m2, one moment a decimal point off.
            ([0.01, 0.01, 0.1], Moments::Unequal),
            ([0.01, 0.01, 0.2], Moments::Unequal),
            ([0.01, 0.01, 1.28], Moments::Absurd(64.0)),
            ([-0.001, 0.05, 0.05], Moments::SlightlyNegative),
            ([-0.01, 0.05, 0.05], Moments::Indefinite),
            ([1e8, 1e8, 1.5e8], Moments::Huge),
        ] {
            assert_eq!(moments(sorted), expected, "{sorted:?}");
        }
    }

    #[test]
    fn masses_and_offsets_have_a_range() {
        assert!(mass(0.0).is_ok() && mass(4_000.0).is_ok());
        assert!(mass(1e300).unwrap_err().contains("1e300 kg"));
        assert!(mass(f64::NAN).is_err() && mass(-1.0).is_err());
        assert!(offset(&Vector3::new(0.0, 3.0, 0.0)).is_ok());
        assert!(offset(&Vector3::new(1e9, 0.0, 0.0)).unwrap_err().contains("1.0e9 m away"));
    }
}
