//! UR3e, as published by its manufacturer.

use super::{RIGHT, TURN, Table, deg, diagonal};

pub static TABLE: Table = Table {
    name: "ur3e",
    source: "a, d, alpha, masses, centres of mass: manufacturer's page \"DH Parameters for \
             calculations of kinematics and dynamics\"; inertia tensors (cylinder approximation, \
             turned into DH axes): UniversalRobots/Universal_Robots_ROS2_Description, \
             config/ur3e/physical_parameters.yaml; joint ranges and torques: its \
             config/ur3e/joint_limits.yaml; the elbow's range is the mechanical one, not the half \
             kept there for planners",
    reach: 0.5,
    d: [0.15185, 0.0, 0.0, 0.13105, 0.08535, 0.0921],
    a: [0.0, -0.24355, -0.2132, 0.0, 0.0, 0.0],
    alpha: [RIGHT, 0.0, 0.0, RIGHT, -RIGHT, 0.0],
    mass: [1.98, 3.4445, 1.437, 0.871, 0.805, 0.261],
    com: [
        [0.0, -0.02, 0.0],
        [0.13, 0.0, 0.1157],
        [0.05, 0.0, 0.0238],
        [0.0, 0.0, 0.01],
        [0.0, 0.0, 0.01],
        [0.0, 0.0, -0.02],
    ],
    inertia: [
        diagonal(0.008093166666666665, 0.005625, 0.008093166666666665),
        diagonal(0.00961875, 0.021728491912499998, 0.021728491912499998),
        diagonal(0.00354375, 0.006544570199999999, 0.006544570199999999),
        diagonal(0.0020849999999999996, 0.00225, 0.0020849999999999996),
        diagonal(0.0020849999999999996, 0.00225, 0.0020849999999999996),
        diagonal(0.00013626666666666665, 0.00013626666666666665, 0.0001792),
    ],
    range: [TURN, TURN, TURN, TURN, TURN, f64::INFINITY],
    velocity: [deg(180.0), deg(180.0), deg(180.0), deg(360.0), deg(360.0), deg(360.0)],
    effort: [54.0, 54.0, 28.0, 9.0, 9.0, 9.0],
};
