//! A scenario of `armtwin simulate`.

use crate::excitation::Design;

pub fn text(design: &Design) -> String {
    // Numbers, strings and lists under fixed keys: nothing TOML cannot hold.
    let body = toml::to_string(&design.scenario).unwrap_or_default();
    format!(
        "# Designed by armtwin excite, seed {}: the motion, and the twin it was designed for. What the\n\
         # twin leaves to be fitted has typical values.\n{body}",
        design.report.seed
    )
}
