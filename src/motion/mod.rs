//! Excitation and validation trajectories within the limits of the arm.
