//! Links, base parameters and what torque they leave, for people.

use crate::report::{table, to_uncertainty};
use crate::workflow::{BaseRow, Left, Link, LinkValue, Summary};

pub fn print(body: &Summary) {
    println!(
        "\nRigid body: {} base parameters, of which this recording tells {}; condition number {:.0}",
        body.rank, body.told, body.condition
    );
    println!("{}", table(&BASE, 1, body.base.iter().map(base_cells)));
    for (joint, with) in body.beside_rotors.iter().enumerate().filter(|(_, with)| !with.is_empty())
    {
        println!("rotor inertia of joint {} is told with {with} only", joint + 1);
    }
    not_told(body).iter().for_each(|line| println!("not told: {line}"));
    println!(
        "\nLinks: the most probable ones that bodies can have; these data call for links {:.1} % from \
         the model's",
        100.0 * body.spread
    );
    println!("{}", table(&LINKS, 1, body.links.iter().map(link_cells)));
    body.notes.iter().for_each(|note| println!("note: {note}"));
    println!("\nTorque left, N.m (root mean square)");
    let joints = body.torque.first().map_or(0, |t| t.given_nm.len());
    let mut header = vec!["recording".to_string(), "rigid body".to_string()];
    header.extend((1..=joints).map(|j| format!("joint {j}")));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    println!("{}", table(&header, 2, body.torque.iter().flat_map(torque_cells)));
}

/// Which base parameters these data do not tell, one line per reason.
fn not_told(body: &Summary) -> Vec<String> {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for e in body.base.iter().map(|b| &b.estimate) {
        let Some(why) = e.why_not.as_deref() else { continue };
        match reasons.iter_mut().find(|(reason, _)| *reason == why) {
            Some((_, names)) => names.push(&e.name),
            None => reasons.push((why, vec![&e.name])),
        }
    }
    reasons.iter().map(|(why, names)| format!("{}: {why}", names.join(", "))).collect()
}

const BASE: [&str; 7] = ["parameter", "unit", "value", "99 % low", "high", "model", "stands for"];
const LINKS: [&str; 6] = ["link", "mass kg", "99 % low", "high", "model", "centre m (model)"];

fn base_cells(row: &BaseRow) -> Vec<String> {
    let e = &row.estimate;
    let [value, low, high] = to_uncertainty(e.value, e.low, e.high);
    let [low, high] = if e.identifiable { [low, high] } else { ["-".into(), "-".into()] };
    vec![
        e.name.clone(),
        e.unit.clone(),
        value,
        low,
        high,
        format!("{:.4}", row.model),
        row.group.clone(),
    ]
}

fn link_cells(link: &Link) -> Vec<String> {
    let LinkValue { value, low, high, model } = link.mass_kg;
    let [value, low, high] = to_uncertainty(value, low, high);
    let point = |p: &[f64; 3]| format!("{:.3} {:.3} {:.3}", p[0], p[1], p[2]);
    let centre = format!("{} ({})", point(&link.centre_m), point(&link.centre_model_m));
    vec![link.link.clone(), value, low, high, format!("{model:.3}"), centre]
}

fn torque_cells(left: &Left) -> Vec<Vec<String>> {
    let row = |name: &str, what: &str, values: &[f64]| {
        let mut cells = vec![name.to_string(), what.to_string()];
        cells.extend(values.iter().map(|v| format!("{v:.3}")));
        cells
    };
    let path = std::path::Path::new(&left.recording);
    let file = path.file_name().map_or(left.recording.clone(), |f| f.to_string_lossy().into());
    vec![
        row(&file, "as given", &left.given_nm),
        row("", "least squares, bounded", &left.least_squares_nm),
        row("", "possible links", &left.links_nm),
    ]
}
