//! How large an arm is: ranges and typical values grow with it, by their units.

use std::sync::LazyLock;

use super::Parameter;
use crate::robot::{Robot, tables};

/// An arm beside the UR5, for which the catalogue's ranges are written: times its largest rated torque, its
/// mass and its reach. Angles and times are the same on all arms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    torque: f64,
    mass: f64,
    reach: f64,
}

/// N.m, kg, m
type Sizes = [f64; 3];

/// Where an arm's rated torques are not known: times what holds its links stretched out. A UR5 is rated for
/// 2.5 times that.
const RATED: f64 = 2.5;
const GRAVITY: f64 = 9.81;

static UR5: LazyLock<Sizes> = LazyLock::new(|| sizes(&tables::ur5::TABLE.robot()));

impl Size {
    pub const UR5: Self = Self { torque: 1.0, mass: 1.0, reach: 1.0 };

    pub fn of(robot: &Robot) -> Self {
        let own = sizes(robot);
        let over = |i: usize| {
            let ratio: f64 = own[i] / UR5[i];
            if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 }
        };
        Self { torque: over(0), mass: over(1), reach: over(2) }
    }

    /// The same where it carries more than itself: masses as its drives hold at its reach, if that is more than it weighs.
    pub fn laden(self) -> Self {
        Self { mass: self.mass.max(self.torque / self.reach), ..self }
    }

    /// How many times as large a quantity in this unit is: one in `N.m/rad` grows with the torque, one in
    /// `kg.m2` with mass and reach squared, one in `rad/s` not at all.
    pub fn factor(&self, unit: &str) -> f64 {
        let product = |units: &str| {
            let each = units.trim_matches(['(', ')']).split('.').map(|part| self.of_unit(part));
            each.product::<f64>()
        };
        match unit.split_once('/') {
            Some((above, below)) => product(above) / product(below),
            None => product(unit),
        }
    }

    fn of_unit(&self, part: &str) -> f64 {
        let name = part.trim_end_matches(|c: char| c.is_ascii_digit());
        let power = part[name.len()..].parse().unwrap_or(1);
        let once = match name {
            "N" => self.torque / self.reach,
            "kg" => self.mass,
            "m" => self.reach,
            _ => 1.0,
        };
        once.powi(power)
    }
}

impl Parameter {
    /// This parameter on an arm of this size.
    pub fn on(&self, size: &Size) -> Self {
        let times = size.factor(self.unit);
        // What is no number stays none, and zero zero.
        let null = if self.null == 0.0 { 0.0 } else { self.null * times };
        let [min, max, typical] = [self.min, self.max, self.typical].map(|x| x * times);
        Self { min, max, typical, null, ..*self }
    }
}

fn sizes(robot: &Robot) -> Sizes {
    let mass: f64 = robot.bodies.iter().map(|b| b.inertia.mass).sum();
    let lengths = robot.bodies.iter().map(|b| b.joint.placement.translation.norm());
    // The first joint stands on the base.
    let reach = lengths.skip(1).sum::<f64>() + robot.flange.translation.norm();
    let rated = robot.bodies.iter().map(|b| b.joint.limits.effort).filter(|e| e.is_finite());
    let (largest, held) = (rated.fold(0.0, f64::max), GRAVITY * stretched(robot));
    // Some files say 1 for want of a better number; an arm holds itself.
    let torque = if largest > 0.0 { largest.max(held) } else { RATED * held };
    [torque, mass, reach]
}

/// Mass times distance of all links, kg.m, where the arm is stretched out from its second joint on.
fn stretched(robot: &Robot) -> f64 {
    let mut out = 0.0;
    let mut sum = 0.0;
    for (i, body) in robot.bodies.iter().enumerate().skip(1) {
        out += if i > 1 { body.joint.placement.translation.norm() } else { 0.0 };
        sum += body.inertia.mass * (out + body.inertia.com.norm());
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::CATALOGUE;
    use crate::robot::builtin;

    #[test]
    fn the_catalogue_is_written_for_a_ur5() {
        let size = Size::of(&builtin("ur5").unwrap());
        assert_eq!(size, Size::UR5);
        for p in CATALOGUE.iter().flat_map(|e| e.about().parameters) {
            let there = p.on(&size);
            assert_eq!((there.min, there.max, there.typical), (p.min, p.max, p.typical));
        }
    }

    /// A UR10e is rated for 330 N.m where a UR5 is for 150.
    #[test]
    fn quantities_grow_by_their_units() {
        let size = Size { torque: 2.2, mass: 1.8, reach: 1.4 };
        let close = |unit: &str, factor: f64| {
            assert!((size.factor(unit) - factor).abs() < 1e-12, "{unit}: {}", size.factor(unit));
        };
        close("N.m", 2.2);
        close("N.m.s2/rad2", 2.2);
        close("rad/(N.m)", 1.0 / 2.2);
        close("N", 2.2 / 1.4);
        close("kg.m", 1.8 * 1.4);
        close("kg.m2", 1.8 * 1.4 * 1.4);
        for same in ["rad", "rad/s", "s", "-", "1/turn"] {
            close(same, 1.0);
        }
        let larger = Size::of(&builtin("ur10e").unwrap());
        assert!((larger.torque - 2.2).abs() < 1e-12, "{larger:?}");
        let smaller = Size::of(&builtin("ur3e").unwrap());
        assert!(smaller.torque < 0.5 && smaller.mass < 0.7 && smaller.reach < 0.7, "{smaller:?}");
    }

    /// An arm without rated torques has the sizes of one with them, within a factor.
    #[test]
    fn weight_stands_for_rated_torque() {
        for name in ["ur5", "ur10e", "ur3e"] {
            let mut robot = builtin(name).unwrap();
            let rated = Size::of(&robot).torque;
            robot.bodies.iter_mut().for_each(|b| b.joint.limits.effort = f64::INFINITY);
            let by_weight = Size::of(&robot).torque;
            assert!((0.5..2.0).contains(&(by_weight / rated)), "{name}: {by_weight} {rated}");
        }
    }
}
