//! UR5 exactly as the paper's Table I prints it: alpha_4 = -pi/2 mirrors the wrist.

use super::{RIGHT, Table, ur5};

pub static TABLE: Table = Table {
    name: "ur5-as-printed",
    source: "the paper's Tables I and II and Eq. 18 without correction: alpha_4 = -pi/2 mirrors \
             the wrist, no such arm is built; for comparison with the paper only",
    alpha: [RIGHT, 0.0, 0.0, -RIGHT, -RIGHT, 0.0],
    ..ur5::TABLE
};
