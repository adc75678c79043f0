//! What a diagnosis of position servos says of positions.

use crate::diagnosis::{Diagnosis, words};
use crate::report::{paragraph, table};

/// Errors of the simulated position, joint by joint, and what each cause takes off.
pub fn page(d: &Diagnosis) -> String {
    let Some(position) = &d.position else { return String::new() };
    let mrad = |rad: f64| format!("{:.2}", 1e3 * rad);
    let joint = |j: &crate::diagnosis::JointPositionShrink| {
        let errors = [j.before_rad, j.after_rad, j.rounding_rad].map(mrad);
        std::iter::once(j.joint.to_string()).chain(errors).collect()
    };
    let head = ["joint", "before mrad", "after mrad", "rounding mrad"];
    let mut text = format!(
        "\nPosition: twin led along the command of the check recording, rms; {} -> {} mrad over all joints\n{}\n",
        mrad(position.before_rad),
        mrad(position.after_rad),
        table(&head, 1, position.joints.iter().map(joint))
    );
    let unseen = position.cross_validated;
    let [before, after] = [unseen.before_rad, unseen.after_rad].map(mrad);
    text += &format!(
        "mean size, both recordings, in stretches that were not fitted: {before} -> {after} mrad\n"
    );
    for cause in &position.causes {
        let (effect, place) = (&cause.effect, words::place(&cause.joints));
        let (before, after) = (words::error_without(cause.before_rad), mrad(cause.after_rad));
        text += &format!("{effect}, {place}: {before} -> {after} mrad beside the other causes\n");
    }
    if position.birge_ratio > 1.0 {
        let wider = format!(
            "Intervals are {:.1} times wider than noise alone asks for: what each recording says by itself differs by so \
             much more (Birge ratio).",
            position.birge_ratio
        );
        text += &(paragraph("", &wider) + "\n");
    }
    let offset = position.time_offset.as_ref();
    if let Some(line) = offset.and_then(|o| o.line("the check recording", "the fit recording")) {
        text += &(paragraph("", &line) + "\n");
    }
    let torque = "Values are those by which the simulated position follows both recordings best; of the \
                  positions above, those that follow the fit recording alone. Torque below is position times \
                  the servo's gain: what the recorded position shows that the twin does not give.";
    text + &paragraph("", torque) + "\n"
}
