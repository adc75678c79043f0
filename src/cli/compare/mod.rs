//! `armtwin compare`: the twin beside a recording, as numbers and as a rerun file.

#[cfg(feature = "viewer")]
mod build;
pub(super) mod fit;
#[cfg(feature = "viewer")]
mod judge;
#[cfg(feature = "viewer")]
mod summary;

use std::path::PathBuf;

use super::conditioning::ConditioningArgs;
use super::outputs::Output;
use super::recordings::WorkArgs;
use super::stream::StreamArgs;
use super::twin::ArmArgs;
#[cfg(feature = "viewer")]
use super::{save, view};

/// Show the twin beside a recording: the arm twice in 3D, torques, angles, residuals
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin compare Movement_No6 -o movement6.rrd
  armtwin compare check.csv --twin scenarios/twins/ur5.toml -o check.rrd
  rerun check.rrd
  armtwin compare check.csv --serve              # then, at any time: rerun rerun+http://127.0.0.1:9876/proxy

What the twin gives no values for is fitted on the recording; without --twin that is the paper's
friction law, rotor inertia and current offset of a UR5. The twin is then driven along the recorded
command (or the recorded position, where no command is recorded) by a computed-torque controller in
the simulation. Look at the file with the viewer: pip install rerun-sdk==0.36.3")]
#[cfg_attr(not(feature = "viewer"), allow(dead_code))]
pub struct Args {
    /// File, or folder with one log per signal
    recording: PathBuf,
    #[command(flatten)]
    arm: ArmArgs,
    #[command(flatten)]
    work: WorkArgs,
    /// File to write
    #[arg(short, long, value_name = "FILE.rrd", default_value = "compare.rrd")]
    out: Output,
    /// Write the table, the twin's values and all settings as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
    /// Open the file in the viewer
    #[arg(long)]
    view: bool,
    #[command(flatten)]
    live: StreamArgs,
    #[command(flatten)]
    conditioning: ConditioningArgs,
}

#[cfg(not(feature = "viewer"))]
pub fn run(_: &Args) -> anyhow::Result<()> {
    anyhow::bail!(
        "this armtwin was built without the viewer; build it with its default features \
         (cargo build --release) to get `compare`"
    )
}

#[cfg(feature = "viewer")]
pub fn run(args: &Args) -> anyhow::Result<()> {
    use anyhow::Context;

    use super::progress::Progress;
    use super::stream::Deliveries;
    use crate::signals::Conditioning;
    use crate::viewer::write_rrd;

    let arm = args.arm.load()?;
    let recording = args.work.read(
        &args.recording,
        &arm,
        args.conditioning.floor_hz(),
        &Progress::default(),
    )?;
    let twin = &arm.twin;
    let terms = fit::terms(twin, args.arm.twin.is_some())?;
    let how = args.conditioning.options().over(Conditioning::default());
    let link = args.live.open()?;
    let compared = build::compare(&recording, twin, terms.as_ref(), &how, link.as_ref())
        .with_context(|| args.recording.display().to_string())?;
    println!("{}", arm.line());
    println!("armtwin {}  compare", env!("CARGO_PKG_VERSION"));
    compared.notes.iter().for_each(|note| println!("  {note}"));
    println!("\n{}", compared.report.table());
    if let Some(path) = &args.json {
        save::document(path, &compared.report)?;
    }
    write_rrd(&compared.scene, &args.out)?;
    println!("\n{}: open it with the viewer, `rerun {}`", args.out.display(), args.out.display());
    if args.view {
        view::open(&args.out)?;
    }
    let mut sent = Deliveries::default();
    compared.sent.into_iter().for_each(|one| sent.push(one));
    sent.end(link)
}
