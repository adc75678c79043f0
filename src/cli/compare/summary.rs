//! The text panel of the rerun file.

use super::judge::{HEADER, LEGEND, Report, Row};

/// Markdown: the table, the twin's values, what was done to the recording.
pub fn markdown(report: &Report, notes: &[String]) -> String {
    let controller = &report.controller;
    let mut text = table(&HEADER.map(String::from), report.joints.iter().map(Row::cells));
    text += "\n";
    LEGEND.iter().for_each(|line| text += &format!("- {line}\n"));
    text += &format!("\n## Twin ({})\n\n{}", report.robot, values(report));
    text += &format!(
        "\n## Simulation\n\nThe twin follows `{}` under computed torque:\n\n- natural frequency {} \
         rad/s, damping ratio {}\n- friction feed-forward {}\n",
        report.followed,
        controller.bandwidth_rad_s,
        controller.damping_ratio,
        controller.friction_feedforward
    );
    text += &format!("\n## Recording\n\n- {}\n", report.recording);
    notes.iter().for_each(|note| text += &format!("- {note}\n"));
    text
}

/// One row per parameter, one column per joint.
fn values(report: &Report) -> String {
    let joints = report.joints.iter().map(|j| j.joint.to_string());
    let header: Vec<String> =
        ["parameter".into(), "from".into()].into_iter().chain(joints).collect();
    let rows = report.values.iter().map(|v| {
        let from = if v.fitted { "fitted" } else { "given" };
        let mut row = vec![format!("{} / {}", v.parameter, v.unit), from.into()];
        row.extend(v.values.iter().map(|x| format!("{x:.3}")));
        row.resize(header.len(), String::new());
        row
    });
    table(&header, rows)
}

fn table(header: &[String], rows: impl Iterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let rule = vec!["---".to_string(); header.len()];
    rows.fold(line(header) + &line(&rule), |text, row| text + &line(&row))
}
