//! The page: docs/external-wrench.md.

use super::{Found, Measured};
use crate::cli::contacts::sensor::Push;
use crate::external_wrench::Contact;
use crate::report::markdown_table;

/// A contact this near to what is known of one is that one, s.
const NEAR_S: f64 = 0.3;

pub fn page(measured: &Measured) -> String {
    format!(
        "# Forces from outside, beside what is known of them\n\n\
         Made by `armtwin contacts --validate ../shared/recordings -o docs/external-wrench.md`, \
         armtwin {version}.\n\n\
         {METHOD}\n\n\
         ## A force sensor at the flange of a UR5 at rest\n\n\
         {SENSED}\n\n{pushes}\n{sensed}\n\n\
         ## Contacts on moving arms\n\n\
         {KNOWN}\n\n{named}\n\
         ## Recordings that nothing touched\n\n\
         {untouched}",
        version = env!("CARGO_PKG_VERSION"),
        pushes = pushes(measured),
        sensed = sensed(measured),
        named = measured.named.iter().map(named).collect::<String>(),
        untouched = untouched(&measured.untouched),
    )
}

const METHOD: &str = "What a twin leaves of the recorded torque is held against forces of any shape \
at points along all links (tau = -J^T F), beside what the twin leaves when nothing touches. Friction \
of a joint at rest holds any torque between its limits: a standing arm shows a push only as far as it \
exceeds that, and the uncertainty of a peak says so. The twin's open values are fitted to another \
recording. The criteria were set with these recordings in view, so that rates on another arm may be \
worse.";

const SENSED: &str = "`Movement_No10_Standstill_ForceSensor_All`: pushes by hand in all directions. \
*Sensor*: size of the force less its mean over the first second, where it is above 5 N. Estimates \
are peaks +- their standard deviation, and how much later they are than the sensor's; *any*: every \
link may be touched; *flange*: with `--at-flange`; *controller's scale*: the same with the torque \
per ampere that the arm's own controller uses at rest, which is 22 % less than the paper's at joints \
1 to 3.";

const KNOWN: &str = "Nobody wrote down when. *Known* are intervals in which a model fitted to the \
undisturbed path errs most, as estimated before this method existed; they are not all contacts that \
are there (the UR10e repeats its path every 8.5 s: held against the median of the repeats, its torque \
also stands out at 6.0, 36.0 and 44.0 s). On the UR10e link 2 was touched. Times in s from the start.";

fn size(contact: &Contact) -> String {
    format!("{:.0} +- {:.0}", contact.peak_n, contact.peak_sd_n)
}

fn overlaps(contact: &Contact, [start, end]: [f64; 2]) -> bool {
    contact.start_s <= end + NEAR_S && contact.end_s >= start - NEAR_S
}

/// The strongest contact at the time of a push.
fn of_push<'a>(contacts: &'a [Contact], push: &Push) -> Option<&'a Contact> {
    let there = contacts.iter().filter(|c| overlaps(c, [push.start_s, push.end_s]));
    there.max_by(|a, b| a.peak_n.total_cmp(&b.peak_n))
}

fn pushes(measured: &Measured) -> String {
    let header = ["time s", "sensor N", "any N", "s", "flange N", "s", "controller's scale N", "s"];
    let row = |push: &Push| {
        let mut row = vec![
            format!("{:.1} .. {:.1}", push.start_s, push.end_s),
            format!("{:.1}", push.peak_n),
        ];
        for contacts in &measured.sensed {
            match of_push(contacts, push) {
                Some(c) => {
                    let late = c.peak_time_s - push.peak_time_s;
                    row.extend([size(c), format!("{late:+.2}")]);
                }
                None => row.extend(["-".to_string(), "-".to_string()]),
            }
        }
        row
    };
    let rows: Vec<Vec<String>> = measured.pushes.iter().map(row).collect();
    markdown_table(&header, 1, &rows)
}

fn sensed(measured: &Measured) -> String {
    let names = ["any", "flange", "controller's scale"];
    let one = |(name, contacts): (&str, &Vec<Contact>)| {
        let pairs: Vec<(&Push, &Contact)> =
            measured.pushes.iter().filter_map(|p| Some((p, of_push(contacts, p)?))).collect();
        let count = pairs.len().max(1) as f64;
        let off = |(p, c): &(&Push, &Contact)| c.peak_n - p.peak_n;
        let mean = |value: &dyn Fn(&(&Push, &Contact)) -> f64| {
            pairs.iter().map(value).sum::<f64>() / count
        };
        let inside = pairs.iter().filter(|p| off(p).abs() <= 2.0 * p.1.peak_sd_n).count();
        let stray = contacts
            .iter()
            .filter(|c| !measured.pushes.iter().any(|p| overlaps(c, [p.start_s, p.end_s])));
        format!(
            "*{name}*: {} of {} pushes found, {} contacts elsewhere; peaks {:+.1} N off on average, \
             {:.1} N RMS, {inside} of {} within two standard deviations; {:.2} s off on average.",
            pairs.len(),
            measured.pushes.len(),
            stray.count(),
            mean(&off),
            mean(&|p| off(p).powi(2)).sqrt(),
            pairs.len(),
            mean(&|(p, c)| (c.peak_time_s - p.peak_time_s).abs()),
        )
    };
    names.into_iter().zip(&measured.sensed).map(one).collect::<Vec<_>>().join("\n")
}

fn named(found: &Found) -> String {
    let header = ["known", "found", "link", "peak N", "force on the arm N", "explains"];
    let mut rows: Vec<(f64, Vec<String>)> = Vec::new();
    for contact in &found.contacts {
        let known: Vec<String> = found
            .known
            .iter()
            .filter(|k| overlaps(contact, **k))
            .map(|k| format!("{:.1} .. {:.1}", k[0], k[1]))
            .collect();
        let known = if known.is_empty() { "-".into() } else { known.join(", ") };
        rows.push((contact.start_s, [vec![known], row(contact)].concat()));
    }
    for known in found.known.iter().filter(|k| !found.contacts.iter().any(|c| overlaps(c, **k))) {
        let text = format!("{:.1} .. {:.1}", known[0], known[1]);
        let dashes = vec!["-".to_string(); header.len() - 1];
        rows.push((known[0], [vec![text], dashes].concat()));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rows: Vec<Vec<String>> = rows.into_iter().map(|(_, row)| row).collect();
    format!(
        "`{}`, fitted to `{}`:\n\n{}\n",
        found.recording,
        found.fit,
        markdown_table(&header, 2, &rows)
    )
}

fn row(contact: &Contact) -> Vec<String> {
    let force: Vec<String> = contact.force_n.iter().map(|f| format!("{f:.0}")).collect();
    vec![
        format!("{:.1} .. {:.1}", contact.start_s, contact.end_s),
        format!("{} ({:.0} %)", contact.link, 100.0 * contact.link_probability),
        size(contact),
        force.join(" "),
        format!("{:.0} %", 100.0 * contact.explained),
    ]
}

fn untouched(all: &[Found]) -> String {
    let false_ones = |found: &&Found| !found.contacts.is_empty();
    let count: usize = all.iter().map(|f| f.contacts.len()).sum();
    let minutes: f64 = all.iter().map(|f| f.seconds).sum::<f64>() / 60.0;
    let row = |found: &Found| {
        let times = |c: &Contact| format!("{:.1} .. {:.1} ({} N)", c.start_s, c.end_s, size(c));
        let times: Vec<String> = found.contacts.iter().map(times).collect();
        vec![format!("`{}`", found.recording), format!("`{}`", found.fit), times.join(", ")]
    };
    let rows: Vec<Vec<String>> = all.iter().filter(false_ones).map(row).collect();
    let table = markdown_table(&["recording", "fitted to", "contacts"], 3, &rows);
    format!(
        "{} pairs of recordings (the UR5's undisturbed ones; every unloaded one of the UR10e against \
         every other), {minutes:.1} minutes searched: {count} contacts, {:.2} per minute.\n\n{}",
        all.len(),
        count as f64 / minutes,
        if rows.is_empty() { String::new() } else { table },
    )
}
