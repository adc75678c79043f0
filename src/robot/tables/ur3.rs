//! UR3 (CB series), as published by its manufacturer.

use super::{RIGHT, TURN, Table, deg, diagonal};

pub static TABLE: Table = Table {
    name: "ur3",
    source: "a, d, alpha, masses, centres of mass: manufacturer's page \"DH Parameters for \
             calculations of kinematics and dynamics\"; inertia tensors (cylinder approximation, \
             turned into DH axes): UniversalRobots/Universal_Robots_ROS2_Description, \
             config/ur3/physical_parameters.yaml; joint ranges and torques: its \
             config/ur3/joint_limits.yaml; the elbow's range is the mechanical one, not the half \
             kept there for planners",
    reach: 0.5,
    d: [0.1519, 0.0, 0.0, 0.11235, 0.08535, 0.0819],
    a: [0.0, -0.24365, -0.21325, 0.0, 0.0, 0.0],
    alpha: [RIGHT, 0.0, 0.0, RIGHT, -RIGHT, 0.0],
    mass: [2.0, 3.42, 1.26, 0.8, 0.8, 0.35],
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
        diagonal(0.00354375, 0.0065468090625, 0.0065468090625),
        diagonal(0.0016106414999999998, 0.00225, 0.0016106414999999998),
        diagonal(0.0015721739999999998, 0.00225, 0.0015721739999999998),
        diagonal(0.00013626666666666665, 0.00013626666666666665, 0.0001792),
    ],
    range: [TURN, TURN, TURN, TURN, TURN, f64::INFINITY],
    velocity: [deg(180.0), deg(180.0), deg(180.0), deg(360.0), deg(360.0), deg(360.0)],
    effort: [56.0, 56.0, 28.0, 12.0, 12.0, 12.0],
};
