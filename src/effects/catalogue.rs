//! The one list: command line, docs, scenario keys and tests follow from it.

use super::Effect;
use crate::robot::DrivePart;

/// Every effect armtwin knows, in the order of the docs. A twin adds up their torques in this order
/// (what scales the drive's torque after what makes it, what turns gravity after what has mass, what jumps
/// after what is smooth), and
/// sensors show them in this order.
pub static CATALOGUE: &[&dyn Effect] = &[
    &super::coulomb::Coulomb,
    &super::viscous::Viscous,
    &super::viscous_quadratic::ViscousQuadratic,
    &super::viscous_cubic::ViscousCubic,
    &super::stribeck::Stribeck,
    &super::coulomb_asymmetry::CoulombAsymmetry,
    &super::load_friction::LoadFriction,
    &super::temperature_friction::TemperatureFriction,
    &super::presliding::Presliding,
    &super::lugre::Lugre,
    &super::maxwell_slip::MaxwellSlip,
    &super::joint_flexibility::JointFlexibility,
    &super::backlash::Backlash,
    &super::torque_ripple::TorqueRipple,
    &super::cable_spring::CableSpring,
    &super::joint_coupling::JointCoupling,
    &super::rotor_inertia::RotorInertia,
    &super::link_inertia::LinkInertia,
    &super::payload::Payload,
    &super::external_contact::ExternalContact,
    &super::base_tilt::BaseTilt,
    &super::encoder_offset::EncoderOffset,
    &super::torque_constant::TorqueConstant,
    &super::current_offset::CurrentOffset,
    &super::servo_gain::ServoGain,
    &super::servo_damping::ServoDamping,
    &super::servo_friction::ServoFriction,
    &super::servo_max_torque::ServoMaxTorque,
    &super::servo_dead_band::ServoDeadBand,
    &super::servo_delay::ServoDelay,
    &super::servo_offset::ServoOffset,
    &super::torque_saturation::TorqueSaturation,
    &super::controller_mismatch::ControllerMismatch,
    &super::velocity_lag::VelocityLag,
    &super::time_delay::TimeDelay,
    &super::quantisation::Quantisation,
];

/// Effects that stand for a part of the drive, with that part and the name of their parameter.
pub fn of_drive() -> impl Iterator<Item = (&'static dyn Effect, DrivePart, &'static str)> {
    let part = |e: &&'static dyn Effect| Some((*e, e.stands_for()?, e.about().parameters[0].name));
    CATALOGUE.iter().filter_map(part)
}

/// By the name in its `about`.
pub fn find(name: &str) -> Option<&'static dyn Effect> {
    CATALOGUE.iter().copied().find(|e| e.about().name == name)
}

/// Where an effect stands in the catalogue.
pub fn order(effect: &dyn Effect) -> usize {
    let same = |e: &&dyn Effect| e.about().name == effect.about().name;
    CATALOGUE.iter().position(same).unwrap_or(CATALOGUE.len())
}

/// All names, in the order of the docs, for messages: `coulomb, viscous, ...`.
pub fn names() -> String {
    let names: Vec<_> = CATALOGUE.iter().map(|e| e.about().name).collect();
    names.join(", ")
}
