//! The arm in rapier: a multibody in generalised coordinates, one revolute joint per body.
//!
//! Per step of length h, for the state (q_k, v_k) and the motor torque tau_k held over the step:
//!
//! ```text
//! (M + diag(armature)) (v_{k+1} - v_k)/h + c(q_k, v) + g(q_k)
//!     = tau_k - torque - damping (v_k + v_{k+1})/2 - friction,     |friction| <= dry
//! q_{k+1} = q_k + h v_{k+1}
//! ```
//!
//! Dry friction is a constraint of rapier's solver: whatever stops the joint, up to the level, so a
//! joint that should stick stands truly still. Half of the damping is implicit (rapier's
//! `damping`), half explicit: together the trapezoidal rule, which neither adds nor hides damping.
//! rapier gives every angular degree of freedom a default damping of 0.1, removed here. It takes
//! Coriolis, centrifugal and gyroscopic terms implicitly through an approximate linearisation,
//! which is why the order of convergence is one (docs/accuracy.md).

use nalgebra::{Matrix3, Unit, Vector3};
use rapier3d_f64::glamx::{DMat3, DQuat, DVec3};
use rapier3d_f64::prelude::{
    GenericJoint, GenericJointBuilder, JointAxesMask, MassProperties, Multibody, MultibodyIndex,
    PhysicsWorld, Pose, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients,
};

use crate::effects::{JointLoad, Mechanism};
use crate::robot::{Body, Placement};

/// Gauss-Seidel sweeps over the friction constraints of all joints in a step.
const FRICTION_SWEEPS: usize = 16;
/// Of the friction constraint: rapier's default (1e6 Hz) lets a sticking joint creep at small steps.
const FRICTION_STIFFNESS_HZ: f64 = 1e12;

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlantError {
    #[error("the step must be a positive number of seconds, not {0}")]
    Step(f64),
    #[error("the mechanism has {bodies} bodies but {armatures} rotor inertias")]
    Armature { bodies: usize, armatures: usize },
    #[error("body {0} has no mass: rapier needs a positive mass (merge it into its parent)")]
    Mass(String),
}

/// A mechanism in motion. Reusable through [`Plant::set_state`]; no state outside of it.
pub struct Plant {
    world: PhysicsWorld,
    arm: MultibodyIndex,
    base: RigidBodyHandle,
    links: Vec<Link>,
    step_s: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    v_mid: Vec<f64>,
}

struct Link {
    body: RigidBodyHandle,
    parent: RigidBodyHandle,
    /// Joint axis in the body's frame.
    axis: DVec3,
}

impl Plant {
    /// Stands at q = 0 to begin with; `step_s` in seconds.
    pub fn new(mechanism: &Mechanism, step_s: f64) -> Result<Self, PlantError> {
        check(mechanism, step_s)?;
        let mut world = still_world(step_s, mechanism.robot.gravity);
        let base = world.insert_body(RigidBodyBuilder::fixed());
        let mut links: Vec<Link> = Vec::with_capacity(mechanism.robot.dof());
        for body in &mechanism.robot.bodies {
            let parent = body.parent.map_or(base, |p| links[p].body);
            links.push(insert_link(&mut world, body, parent));
        }
        let Some(link) = links.first().and_then(|l| world.multibody_joints.rigid_body_link(l.body))
        else {
            return Err(PlantError::Mass("(the robot has no bodies)".into()));
        };
        let arm = link.multibody;
        let dof = links.len();
        let zeros = vec![0.0; dof];
        let (q, v, a, v_mid) = (zeros.clone(), zeros.clone(), zeros.clone(), zeros);
        let mut plant = Self { world, arm, base, links, step_s, q, v, a, v_mid };
        plant.settle(&mechanism.armature);
        Ok(plant)
    }

    /// Degrees of freedom.
    pub fn dof(&self) -> usize {
        self.links.len()
    }

    /// s
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Joint angles, rad (unwrapped).
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Joint velocities, rad/s.
    pub fn v(&self) -> &[f64] {
        &self.v
    }

    /// Acceleration in the last step, (v_{k+1} - v_k)/h, rad/s^2: with the position and torque
    /// from before that step and [`Plant::v_mid`] it satisfies the equation of motion.
    pub fn a(&self) -> &[f64] {
        &self.a
    }

    /// (v_k + v_{k+1})/2 of the last step, rad/s: the central difference of the position.
    pub fn v_mid(&self) -> &[f64] {
        &self.v_mid
    }

    /// Puts the arm at `q` (rad) moving at `v` (rad/s).
    pub fn set_state(&mut self, q: &[f64], v: &[f64]) {
        let move_by: Vec<f64> = q.iter().zip(&self.q).map(|(to, from)| to - from).collect();
        let PhysicsWorld { bodies, multibody_joints, .. } = &mut self.world;
        if let Some(arm) = multibody_joints.get_multibody_mut(self.arm) {
            arm.apply_displacements(&move_by);
            arm.generalized_velocity_mut().copy_from_slice(v);
            arm.forward_kinematics(bodies, false);
            arm.update_rigid_bodies(bodies, true);
        }
        self.read_state();
        self.a.fill(0.0);
        self.v_mid.copy_from_slice(v);
    }

    /// Advances by one step under motor torques `tau` (N.m) against `loads`, both per joint.
    pub fn step(&mut self, tau: &[f64], loads: &[JointLoad]) {
        self.apply_loads(loads);
        self.apply_torques(tau, loads);
        self.world.step();
        self.read_state();
    }

    fn apply_loads(&mut self, loads: &[JointLoad]) {
        if let Some(arm) = self.world.multibody_joints.get_multibody_mut(self.arm) {
            for (level, load) in arm.frictions_mut().iter_mut().zip(loads) {
                *level = load.dry.max(0.0);
            }
            for (damping, load) in arm.damping_mut().iter_mut().zip(loads) {
                *damping = 0.5 * load.damping;
            }
        }
    }

    /// rapier takes torques on bodies: the motor's acts on its body and back on the parent.
    fn apply_torques(&mut self, tau: &[f64], loads: &[JointLoad]) {
        let bodies = &mut self.world.bodies;
        for link in &self.links {
            bodies[link.body].reset_torques(false);
        }
        for (i, link) in self.links.iter().enumerate() {
            let net = tau[i] - loads[i].torque - 0.5 * loads[i].damping * self.v[i];
            let torque = (*bodies[link.body].rotation() * link.axis) * net;
            bodies[link.body].add_torque(torque, false);
            if link.parent != self.base {
                bodies[link.parent].add_torque(-torque, false);
            }
        }
    }

    fn read_state(&mut self) {
        if let Some(arm) = self.world.multibody_joints.get_multibody(self.arm) {
            for (i, v_next) in arm.generalized_velocity().iter().enumerate() {
                self.a[i] = (v_next - self.v[i]) / self.step_s;
                self.v_mid[i] = 0.5 * (v_next + self.v[i]);
                self.v[i] = *v_next;
            }
            for (q, link) in self.q.iter_mut().zip(arm.links().skip(1)) {
                *q = link.joint.coords()[3];
            }
        }
    }

    /// Makes rapier see masses and a fixed root before the first step, and sets what it defaults.
    fn settle(&mut self, armature: &[f64]) {
        let PhysicsWorld { bodies, colliders, multibody_joints, .. } = &mut self.world;
        for link in &self.links {
            bodies[link.body].recompute_mass_properties_from_colliders(colliders);
        }
        if let Some(arm) = multibody_joints.get_multibody_mut(self.arm) {
            arm.forward_kinematics(bodies, true);
            arm.update_rigid_bodies(bodies, true);
            arm.damping_mut().fill(0.0);
            arm.armature_mut().copy_from_slice(armature);
            debug_assert!(assembled_in_order(arm));
        }
    }
}

/// Generalised coordinates in the order of the bodies, as the rest of this file assumes.
fn assembled_in_order(arm: &Multibody) -> bool {
    arm.links().skip(1).enumerate().all(|(i, link)| link.assembly_id() == i)
}

fn check(mechanism: &Mechanism, step_s: f64) -> Result<(), PlantError> {
    if !(step_s > 0.0 && step_s.is_finite()) {
        return Err(PlantError::Step(step_s));
    }
    let (bodies, armatures) = (mechanism.robot.dof(), mechanism.armature.len());
    if bodies != armatures {
        return Err(PlantError::Armature { bodies, armatures });
    }
    match mechanism.robot.bodies.iter().find(|b| b.inertia.mass <= 0.0) {
        Some(body) => Err(PlantError::Mass(body.name.clone())),
        None => Ok(()),
    }
}

/// An empty world that integrates with exactly one step of `step_s` per call.
fn still_world(step_s: f64, gravity: Vector3<f64>) -> PhysicsWorld {
    let mut world = PhysicsWorld { gravity: vector(&gravity), ..PhysicsWorld::default() };
    let settings = &mut world.integration_parameters;
    settings.dt = step_s;
    settings.num_solver_iterations = 1; // rapier's word for substeps
    settings.num_internal_pgs_iterations = FRICTION_SWEEPS;
    settings.num_internal_stabilization_iterations = 0;
    settings.max_ccd_substeps = 0;
    settings.normalized_max_linear_velocity = f64::MAX;
    world
}

fn insert_link(world: &mut PhysicsWorld, body: &Body, parent: RigidBodyHandle) -> Link {
    let inertia = &body.inertia;
    let mass = MassProperties::with_inertia_matrix(
        vector(&inertia.com),
        inertia.mass,
        matrix(&inertia.about_com),
    );
    let rigid = RigidBodyBuilder::dynamic().additional_mass_properties(mass).can_sleep(false);
    let handle = world.insert_body(rigid);
    world.multibody_joints.insert(parent, handle, revolute(body), true);
    Link { body: handle, parent, axis: vector(&body.joint.axis) }
}

/// rapier's revolute joints turn about the X axis of both joint frames.
fn revolute(body: &Body) -> GenericJoint {
    let turn = x_onto(&body.joint.axis);
    let Placement { rotation, translation } = &body.joint.placement;
    let placement = DQuat::from_mat3(&matrix(rotation));
    GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
        .local_frame1(Pose::from_parts(vector(translation), placement * turn))
        .local_frame2(Pose::from_parts(DVec3::ZERO, turn))
        .softness(SpringCoefficients::new(FRICTION_STIFFNESS_HZ, 1.0))
        .build()
}

fn x_onto(axis: &Unit<Vector3<f64>>) -> DQuat {
    DQuat::from_rotation_arc(DVec3::X, vector(axis).normalize())
}

fn vector(v: &Vector3<f64>) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

fn matrix(m: &Matrix3<f64>) -> DMat3 {
    DMat3::from_cols_slice(m.as_slice())
}
