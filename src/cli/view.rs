//! Opens a recording in the viewer, or says how to get it.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, bail};

use super::interrupt;

/// Names the viewer where it is not on PATH.
const VARIABLE: &str = "ARMTWIN_RERUN";
/// Without a display it ends at once.
const STARTS_WITHIN: Duration = Duration::from_millis(800);

/// Leaves the viewer running.
pub fn open(file: &Path) -> anyhow::Result<()> {
    if cfg!(not(feature = "viewer")) {
        bail!(
            "--view: this armtwin was built without the viewer; build it with its default features"
        );
    }
    let viewer = std::env::var(VARIABLE).unwrap_or_else(|_| "rerun".into());
    let mut start = Command::new(&viewer);
    start.arg(file).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut running = interrupt::starting(|| start.spawn()).with_context(|| {
        format!(
            "--view: cannot start {viewer:?}; get the viewer by `pip install \
                 rerun-sdk==0.36.3` or name it in {VARIABLE}, then: rerun {}",
            file.display()
        )
    })?;
    std::thread::sleep(STARTS_WITHIN);
    match running.try_wait()? {
        Some(status) if !status.success() => {
            bail!("--view: {viewer} ended at once ({status}); is there a display?")
        }
        _ => Ok(()),
    }
}
