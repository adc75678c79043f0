//! The twin beside the recording in rerun.
