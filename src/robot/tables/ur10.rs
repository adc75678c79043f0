//! UR10 (CB series), as published by its manufacturer.

use super::{RIGHT, TURN, Table, deg};

pub static TABLE: Table = Table {
    name: "ur10",
    source: "a, d, alpha, masses, centres of mass: manufacturer's page \"DH Parameters for \
             calculations of kinematics and dynamics\"; inertia tensors (given there in DH axes): \
             UniversalRobots/Universal_Robots_ROS2_Description, \
             config/ur10/physical_parameters.yaml; joint ranges and torques: its \
             config/ur10/joint_limits.yaml; the elbow's range is the mechanical one, not the half \
             kept there for planners",
    reach: 1.3,
    d: [0.1273, 0.0, 0.0, 0.163941, 0.1157, 0.0922],
    a: [0.0, -0.612, -0.5723, 0.0, 0.0, 0.0],
    alpha: [RIGHT, 0.0, 0.0, RIGHT, -RIGHT, 0.0],
    mass: [7.1, 12.7, 4.27, 2.0, 2.0, 0.365],
    com: [
        [0.021, 0.0, 0.027],
        [0.38, 0.0, 0.158],
        [0.24, 0.0, 0.068],
        [0.0, 0.007, 0.018],
        [0.0, 0.007, 0.018],
        [0.0, 0.0, -0.026],
    ],
    inertia: [
        [0.03408, 2e-05, 0.03529, -0.00425, 8e-05, 0.02156],
        [0.02814, 5e-05, 0.77068, -0.01561, 2e-05, 0.76943],
        [0.01014, 8e-05, 0.30928, 0.00916, 0.0, 0.30646],
        [0.00296, -1e-05, 0.00222, 0.0, -0.00024, 0.00258],
        [0.00296, -1e-05, 0.00222, 0.0, -0.00024, 0.00258],
        [0.0004, 0.0, 0.00041, 0.0, 0.0, 0.00034],
    ],
    range: [TURN, TURN, TURN, TURN, TURN, TURN],
    velocity: [deg(120.0), deg(120.0), deg(180.0), deg(180.0), deg(180.0), deg(180.0)],
    effort: [330.0, 330.0, 150.0, 56.0, 56.0, 56.0],
};
