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
//! joint that should stick stands truly still; where every joint slides for sure, one sweep of the
//! solver is exact (`sliding`). Half of the damping is implicit (rapier's
//! `damping`), half explicit: together the trapezoidal rule, which neither adds nor hides damping.
//! rapier gives every angular degree of freedom a default damping of 0.1, removed here. It takes
//! Coriolis, centrifugal and gyroscopic terms implicitly through an approximate linearisation,
//! which is why the order of convergence is one (docs/accuracy.md).
//!
//! Where the transmission gives way, the motor is a body of its own (next to massless, with the
//! armature) that carries the link on a second, coaxial joint; the elastic torque between them is
//! explicit, which takes no energy and needs a step of 0.1 ms or less, its damping implicit.

use nalgebra::{Matrix3, Unit, Vector3};
use rapier3d_f64::glamx::{DMat3, DQuat, DVec3};
use rapier3d_f64::prelude::{
    GenericJoint, GenericJointBuilder, JointAxesMask, MassProperties, Multibody, MultibodyIndex,
    PhysicsWorld, Pose, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients,
};

use crate::effects::{JointLoad, Mechanism, Transmission};
use crate::robot::{Body, Inertia, Placement, Robot, Workspace, gravity_torque};
use crate::simulation::sliding::Sliding;

/// Gauss-Seidel sweeps over the friction constraints of all joints in a step in which one may stick.
const FRICTION_SWEEPS: usize = 16;
/// Frequency of the friction constraint: rapier's default (1e6 Hz) lets sticking joints creep at small steps.
const FRICTION_STIFFNESS_HZ: f64 = 1e12;

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlantError {
    #[error("the step must be a positive number of seconds, not {0}")]
    Step(f64),
    #[error("the mechanism has {bodies} bodies but {armatures} rotor inertias")]
    Armature { bodies: usize, armatures: usize },
    #[error("body {0} has no mass: rapier needs a positive mass (merge it into its parent)")]
    Mass(String),
    #[error(
        "joint {0} has an elastic or slack transmission: it needs a rotor_inertia and a stiffness \
         above 0"
    )]
    Transmission(usize),
}

/// A mechanism in motion. Reusable through [`Plant::set_state`]; no state outside of it.
pub struct Plant {
    world: PhysicsWorld,
    arm: MultibodyIndex,
    base: RigidBodyHandle,
    robot: Robot,
    /// One per degree of freedom, in rapier's order.
    links: Vec<Link>,
    joints: Vec<Jointed>,
    step_s: f64,
    /// Generalised coordinates and velocities, one per degree of freedom.
    coordinates: Vec<f64>,
    velocities: Vec<f64>,
    motor: Side,
    v_mid: Vec<f64>,
    link: Side,
    /// Torque on each degree of freedom in this step, without dry friction, N.m.
    torque: Vec<f64>,
    sliding: Sliding,
    /// Sweeps in a step in which every joint slides; tests have others.
    pub(super) sliding_sweeps: usize,
}

/// Motion of one side of the transmissions, per joint.
struct Side {
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
}

/// Indices of a joint's degrees of freedom.
struct Jointed {
    motor: usize,
    /// Wind-up of the link relative to the motor, where the transmission gives way.
    wound: Option<Wound>,
}

struct Wound {
    dof: usize,
    transmission: Transmission,
    /// State of the hysteresis, -1 to 1.
    z: f64,
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
        let mut links: Vec<Link> = Vec::new();
        let mut joints: Vec<Jointed> = Vec::new();
        for (body, transmission) in mechanism.robot.bodies.iter().zip(&mechanism.transmission) {
            let carrier = |p: usize| links[joints[p].link()].body;
            let mut parent = body.parent.map_or(base, carrier);
            let motor = links.len();
            let mut body = body.clone();
            if transmission.is_some() {
                links.push(insert_link(&mut world, &rotor_of(&body), parent));
                parent = links[motor].body;
                body.joint.placement = Placement::identity();
            }
            let wound = transmission.map(|t| Wound { dof: links.len(), transmission: t, z: 0.0 });
            links.push(insert_link(&mut world, &body, parent));
            joints.push(Jointed { motor, wound });
        }
        let Some(link) = links.first().and_then(|l| world.multibody_joints.rigid_body_link(l.body))
        else {
            return Err(PlantError::Mass("(the robot has no bodies)".into()));
        };
        let arm = link.multibody;
        let (dof, zeros) = (joints.len(), vec![0.0; links.len()]);
        let mut plant = Self {
            world,
            arm,
            base,
            robot: mechanism.robot.clone(),
            links,
            joints,
            step_s,
            coordinates: zeros.clone(),
            velocities: zeros.clone(),
            torque: zeros,
            sliding: Sliding::new(mechanism),
            sliding_sweeps: 1,
            motor: Side::still(dof),
            v_mid: vec![0.0; dof],
            link: Side::still(dof),
        };
        plant.settle(&mechanism.armature);
        Ok(plant)
    }

    /// Joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// s
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Joint angles on the motor's side, rad (unwrapped).
    pub fn q(&self) -> &[f64] {
        &self.motor.q
    }

    /// Joint velocities on the motor's side, rad/s.
    pub fn v(&self) -> &[f64] {
        &self.motor.v
    }

    /// Angle, velocity and acceleration (as [`Plant::a`]) of the links: those of the motors where
    /// the transmission is rigid.
    pub fn link_motion(&self) -> [&[f64]; 3] {
        [&self.link.q, &self.link.v, &self.link.a]
    }

    /// Acceleration in the last step, (v_{k+1} - v_k)/h, rad/s^2: with the position and torque
    /// from before that step and [`Plant::v_mid`] it satisfies the equation of motion.
    pub fn a(&self) -> &[f64] {
        &self.motor.a
    }

    /// (v_k + v_{k+1})/2 of the last step, rad/s: the central difference of the position.
    pub fn v_mid(&self) -> &[f64] {
        &self.v_mid
    }

    /// Puts the motors at `q` (rad) moving at `v` (rad/s); transmissions are wound up by gravity.
    pub fn set_state(&mut self, q: &[f64], v: &[f64]) {
        let (coordinates, velocities) = self.generalised(q, v);
        let from = self.coordinates.iter();
        let move_by: Vec<f64> = coordinates.iter().zip(from).map(|(to, from)| to - from).collect();
        let PhysicsWorld { bodies, multibody_joints, .. } = &mut self.world;
        if let Some(arm) = multibody_joints.get_multibody_mut(self.arm) {
            arm.apply_displacements(&move_by);
            arm.generalized_velocity_mut().copy_from_slice(&velocities);
            arm.forward_kinematics(bodies, false);
            arm.update_rigid_bodies(bodies, true);
        }
        self.read_state();
        self.sliding.forget();
        self.motor.a.fill(0.0);
        self.link.a.fill(0.0);
        self.v_mid.copy_from_slice(v);
    }

    /// Coordinates and velocities of all degrees of freedom.
    fn generalised(&mut self, q: &[f64], v: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut carried = vec![0.0; q.len()];
        gravity_torque(&self.robot, &mut Workspace::new(&self.robot), q, &mut carried);
        let mut coordinates = vec![0.0; self.links.len()];
        let mut velocities = coordinates.clone();
        for (j, joint) in self.joints.iter_mut().enumerate() {
            coordinates[joint.motor] = q[j];
            velocities[joint.motor] = v[j];
            if let Some(wound) = &mut joint.wound {
                coordinates[wound.dof] = -wound.transmission.wind_up(carried[j]);
                wound.z = 0.0;
            }
        }
        (coordinates, velocities)
    }

    /// Advances by one step under motor torques `tau` (N.m) against `loads`, both per joint.
    pub fn step(&mut self, tau: &[f64], loads: &[JointLoad]) {
        self.apply_loads(loads);
        self.apply_torques(tau, loads);
        let motion = [&self.motor.v[..], &self.motor.a];
        let slides = self.sliding.everywhere(motion, &self.torque, loads, self.step_s);
        self.world.integration_parameters.num_internal_pgs_iterations =
            if slides { self.sliding_sweeps } else { FRICTION_SWEEPS };
        self.world.step();
        self.read_state();
    }

    fn apply_loads(&mut self, loads: &[JointLoad]) {
        if let Some(arm) = self.world.multibody_joints.get_multibody_mut(self.arm) {
            for (joint, load) in self.joints.iter().zip(loads) {
                arm.frictions_mut()[joint.motor] = load.dry.max(0.0);
                arm.damping_mut()[joint.motor] = 0.5 * load.damping;
                if let Some(wound) = &joint.wound {
                    let wind_up = -self.coordinates[wound.dof];
                    arm.damping_mut()[wound.dof] = wound.transmission.damping_at(wind_up);
                }
            }
        }
    }

    /// rapier takes torques on bodies: the motor's acts on its body and back on the parent.
    fn apply_torques(&mut self, tau: &[f64], loads: &[JointLoad]) {
        for (j, joint) in self.joints.iter_mut().enumerate() {
            self.torque[joint.motor] =
                tau[j] - loads[j].torque - 0.5 * loads[j].damping * self.motor.v[j];
            if let Some(wound) = &mut joint.wound {
                self.torque[wound.dof] =
                    wound.torque(&self.coordinates, &self.velocities, self.step_s);
            }
        }
        let bodies = &mut self.world.bodies;
        for (link, torque) in self.links.iter().zip(&self.torque) {
            let body = &mut bodies[link.body];
            let torque = (*body.rotation() * link.axis) * *torque;
            body.reset_torques(false);
            body.add_torque(torque, false);
            if link.parent != self.base {
                bodies[link.parent].add_torque(-torque, false);
            }
        }
    }

    fn read_state(&mut self) {
        if let Some(arm) = self.world.multibody_joints.get_multibody(self.arm) {
            for (v, v_next) in self.velocities.iter_mut().zip(arm.generalized_velocity().iter()) {
                *v = *v_next;
            }
            for (q, link) in self.coordinates.iter_mut().zip(arm.links().skip(1)) {
                *q = link.joint.coords()[3];
            }
        }
        for (j, joint) in self.joints.iter().enumerate() {
            let (q, v) = (self.coordinates[joint.motor], self.velocities[joint.motor]);
            self.v_mid[j] = 0.5 * (v + self.motor.v[j]);
            self.motor.advance(j, q, v, self.step_s);
            let wound = joint.wound.as_ref();
            let (dq, dv) =
                wound.map_or((0.0, 0.0), |w| (self.coordinates[w.dof], self.velocities[w.dof]));
            self.link.advance(j, q + dq, v + dv, self.step_s);
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
            for (joint, armature) in self.joints.iter().zip(armature) {
                arm.armature_mut()[joint.motor] = *armature;
            }
            debug_assert!(assembled_in_order(arm));
        }
    }
}

impl Side {
    fn still(dof: usize) -> Self {
        Self { q: vec![0.0; dof], v: vec![0.0; dof], a: vec![0.0; dof] }
    }

    fn advance(&mut self, j: usize, q: f64, v: f64, step_s: f64) {
        self.a[j] = (v - self.v[j]) / step_s;
        (self.q[j], self.v[j]) = (q, v);
    }
}

impl Jointed {
    /// The degree of freedom whose body is the link.
    fn link(&self) -> usize {
        self.wound.as_ref().map_or(self.motor, |w| w.dof)
    }
}

impl Wound {
    /// Torque on the link from the motor, N.m; moves the hysteresis on by a step.
    fn torque(&mut self, coordinates: &[f64], velocities: &[f64], step_s: f64) -> f64 {
        let (wind_up, rate) = (-coordinates[self.dof], -velocities[self.dof]);
        let t = &self.transmission;
        self.z = t.bent(self.z, rate * step_s);
        t.torque(wind_up) + t.hysteresis * self.z
    }
}

/// The motor: turns about the link's axis, next to massless beside its armature.
fn rotor_of(link: &Body) -> Body {
    let about_com = Matrix3::identity() * 1e-6;
    let inertia = Inertia { mass: 1e-4, com: Vector3::zeros(), about_com };
    Body { inertia, ..link.clone() }
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
    let weak = |(t, &armature): (&Option<Transmission>, &f64)| {
        t.is_some_and(|t| t.stiffness <= 0.0 || armature <= 0.0)
    };
    let mut drives = mechanism.transmission.iter().zip(&mechanism.armature);
    if let Some(joint) = drives.position(weak) {
        return Err(PlantError::Transmission(joint + 1));
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
