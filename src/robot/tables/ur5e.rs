//! UR5e, as published by its manufacturer.

use super::{RIGHT, TURN, Table, deg, diagonal};

pub static TABLE: Table = Table {
    name: "ur5e",
    source: "a, d, alpha, masses, centres of mass: manufacturer's page \"DH Parameters for \
             calculations of kinematics and dynamics\"; inertia tensors (cylinder approximation, \
             turned into DH axes): UniversalRobots/Universal_Robots_ROS2_Description, \
             config/ur5e/physical_parameters.yaml; joint ranges and torques: its \
             config/ur5e/joint_limits.yaml; the elbow's range is the mechanical one, not the half \
             kept there for planners",
    reach: 0.85,
    d: [0.1625, 0.0, 0.0, 0.1333, 0.0997, 0.0996],
    a: [0.0, -0.425, -0.3922, 0.0, 0.0, 0.0],
    alpha: [RIGHT, 0.0, 0.0, RIGHT, -RIGHT, 0.0],
    mass: [3.761, 8.058, 2.846, 1.37, 1.3, 0.365],
    com: [
        [0.0, -0.02561, 0.00193],
        [0.2125, 0.0, 0.11336],
        [0.15, 0.0, 0.0265],
        [0.0, -0.0018, 0.01634],
        [0.0, 0.0018, 0.01634],
        [0.0, 0.0, -0.001159],
    ],
    inertia: [
        diagonal(0.010267499999999999, 0.00666, 0.010267499999999999),
        diagonal(0.0151074, 0.13388583541666665, 0.13388583541666665),
        diagonal(0.004095, 0.03120936758333333, 0.03120936758333333),
        diagonal(0.0025599, 0.0021942, 0.0025599),
        diagonal(0.0025599, 0.0021942, 0.0025599),
        diagonal(9.890414008333333e-05, 9.890414008333333e-05, 0.0001321171875),
    ],
    range: [TURN, TURN, TURN, TURN, TURN, TURN],
    velocity: [deg(180.0), deg(180.0), deg(180.0), deg(180.0), deg(180.0), deg(180.0)],
    effort: [150.0, 150.0, 150.0, 28.0, 28.0, 28.0],
};
