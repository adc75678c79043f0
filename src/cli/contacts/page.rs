//! Contacts as a table.

use crate::external_wrench::Contact;
use crate::report::table;

pub fn page(contacts: &[Contact]) -> String {
    if contacts.is_empty() {
        return "No contact is told from what the twin leaves anyway.\n".into();
    }
    let rows = contacts.iter().map(row);
    let header = ["time s", "link", "peak N", "at s", "force on the arm N", "N.s", "explains"];
    format!("{}\n", table(&header, 1, rows))
}

fn row(contact: &Contact) -> Vec<String> {
    let force: Vec<String> = contact.force_n.iter().map(|f| format!("{f:.0}")).collect();
    vec![
        format!("{:.1} .. {:.1}", contact.start_s, contact.end_s),
        format!("{} ({:.0} %)", contact.link, 100.0 * contact.link_probability),
        format!("{:.0} +- {:.0}", contact.peak_n, contact.peak_sd_n),
        format!("{:.2}", contact.peak_time_s),
        force.join(" "),
        format!("{:.0}", contact.impulse_ns),
        format!("{:.0} %", 100.0 * contact.explained.max(0.0)),
    ]
}
