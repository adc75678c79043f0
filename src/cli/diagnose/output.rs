//! Files of a diagnosis.

use std::path::Path;

use anyhow::Context;

use crate::cli::save;
use crate::workflow::Diagnosed;

/// What was written into `out`, and how to look at it.
pub fn written(out: &Path) -> String {
    let at = |file: &str| out.join(file).display().to_string();
    let rrd = match cfg!(feature = "viewer") {
        true => format!("rerun {}", at("twin.rrd")),
        false => "twin.rrd is not written: this armtwin was built without the viewer".into(),
    };
    format!(
        "{}: what is above, for programs\n{}: with pictures, for any browser\n{}: the mended \
         twin\n{rrd}",
        at("diagnosis.json"),
        at("report.html"),
        at("twin.toml")
    )
}

/// What [`write`] makes.
pub const FILES: [&str; 4] = ["diagnosis.json", "report.html", "twin.rrd", "twin.toml"];

/// Into the folder `out`, which is made if need be.
pub fn write(done: &Diagnosed, out: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(out).with_context(|| format!("cannot make {}", out.display()))?;
    save::document(&out.join("diagnosis.json"), &done.document())?;
    save::text(&out.join("report.html"), &done.html())?;
    #[cfg(feature = "viewer")]
    crate::viewer::write_rrd(&done.scene(), &out.join("twin.rrd"))?;
    Ok(done.mended.save(&out.join("twin.toml"))?)
}
