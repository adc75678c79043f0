//! UR5 (CB series): the paper's Tables I and II and Eq. 18, with the manufacturer's alpha_4.

use super::{RIGHT, TURN, Table, deg, diagonal};

pub static TABLE: Table = Table {
    name: "ur5",
    source: "a, d, masses, centres of mass: the paper's Tables I and II; alpha_4 = +pi/2 after the \
             manufacturer (printed -pi/2, see ur5-as-printed); d_4 = 0.109915 as the paper prints \
             it (the manufacturer says 0.10915: 0.8 mm along the axes of joints 2 to 4, without \
             effect on gravity torque); inertia tensors: the paper's Eq. 18, about the centres of \
             mass in DH axes; joint ranges, speeds and torques: the manufacturer's UR5 data",
    reach: 0.85,
    d: [0.089159, 0.0, 0.0, 0.109915, 0.09465, 0.0823],
    a: [0.0, -0.425, -0.39225, 0.0, 0.0, 0.0],
    alpha: [RIGHT, 0.0, 0.0, RIGHT, -RIGHT, 0.0],
    mass: [3.7, 8.393, 2.33, 1.219, 1.219, 0.1879],
    com: [
        [0.0, -0.02561, 0.00193],
        [0.2125, 0.0, 0.11336],
        [0.15, 0.0, 0.0265],
        [0.0, -0.0018, 0.01634],
        [0.0, 0.0018, 0.01634],
        [0.0, 0.0, -0.001159],
    ],
    inertia: [
        diagonal(0.0085, 0.0064, 0.0085),
        diagonal(0.0085, 0.212, 0.212),
        diagonal(0.0017, 0.0473, 0.0473),
        diagonal(0.0018, 0.0014, 0.0018),
        diagonal(0.0018, 0.0014, 0.0018),
        diagonal(0.00008, 0.00008, 0.00013),
    ],
    range: [TURN; 6],
    velocity: [deg(180.0); 6],
    effort: [150.0, 150.0, 150.0, 28.0, 28.0, 28.0],
};
