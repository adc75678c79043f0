//! An arm with one value a little otherwise, beside it as it is.

use super::made::Made;
use crate::servo::arm::Arm;

/// Both arms, with those effects only that are not the same in both.
#[derive(Clone)]
pub struct Moved {
    own: Arm,
    other: Arm,
    /// By how much the value is another.
    by: f64,
    /// How much more the encoders show, rad per unit of the value.
    pub shown: Vec<f64>,
    /// kg.m2 per unit of it.
    rotor: Vec<f64>,
    has_bodies: bool,
    has_servos: bool,
    /// Do its servos pull otherwise, for they or what encoders show are others?
    pulls: bool,
    is_asked: bool,
    torque: [Vec<f64>; 2],
}

impl Moved {
    pub fn new(own: &Arm, other: &Arm, by: f64) -> Self {
        let per_unit = |own: &[f64], other: &[f64]| -> Vec<f64> {
            own.iter().zip(other).map(|(own, other)| (other - own) / by).collect()
        };
        let (a, b) = (&own.mechanism, &other.mechanism);
        let shown = per_unit(&a.encoder_zero, &b.encoder_zero);
        let (lacks, has) = (own.beyond(other), other.beyond(own));
        let has_servos = own.servo != other.servo;
        let pulls = has_servos || shown.iter().any(|s| *s != 0.0);
        Self {
            by,
            shown,
            rotor: per_unit(&a.armature, &b.armature),
            has_bodies: a.robot != b.robot,
            has_servos,
            pulls,
            is_asked: pulls || lacks.acts() || has.acts(),
            torque: [(); 2].map(|()| vec![0.0; a.armature.len()]),
            own: lacks,
            other: has,
        }
    }

    /// Are its bodies others?
    pub fn has_bodies(&self) -> bool {
        self.has_bodies
    }

    /// How what bodies take along a step changes, N.m per unit of the value, where `own` is what those of the
    /// arm as it is take: `put` at every joint.
    pub fn by_bodies(&mut self, made: &mut Made, own: &[f64], mut put: impl FnMut(usize, f64)) {
        let [_, torque] = &mut self.torque;
        made.taken_by(self.other.robot(), torque);
        let both = torque.iter().zip(own).enumerate();
        both.for_each(|(j, (other, own))| put(j, (other - own) / self.by));
    }

    /// How all else that is taken or asked along a step changes; `arm`, as it is, has heard what it was told, and `hear`
    /// tells other servos.
    pub fn by_rest(
        &mut self,
        made: &mut Made,
        arm: &Arm,
        hear: impl Fn(&mut Arm),
        mut put: impl FnMut(usize, f64),
    ) {
        for (j, (rotor, acceleration)) in self.rotor.iter().zip(&made.acceleration).enumerate() {
            put(j, rotor * acceleration);
        }
        if !self.is_asked {
            return;
        }
        let [own, other] = &mut self.torque;
        if self.pulls {
            self.own.hear_as(arm);
            match self.has_servos {
                true => hear(&mut self.other),
                false => self.other.hear_as(arm),
            }
            made.asked_of(&mut self.own, own);
            made.asked_of(&mut self.other, other);
        } else {
            made.asked_of_effects(&mut self.own, own);
            made.asked_of_effects(&mut self.other, other);
        }
        let both = other.iter().zip(&*own).enumerate();
        both.for_each(|(j, (other, own))| put(j, (other - own) / self.by));
    }
}
