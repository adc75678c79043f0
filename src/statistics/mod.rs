//! Covariances, tests and intervals; no I/O, no randomness of its own.
