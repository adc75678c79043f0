//! Identification: errors, coverage, detection, for the arm and for the motor.

use super::seen::{Seen, in_order, seen};
use super::{Page, coverage, detection, distinct, errors, rounding};
use crate::figure::{Figure, Panel};
use crate::studies::sweep::table::Table;

/// One system's rows.
pub struct Part<'a> {
    pub rows: Vec<&'a Seen>,
    /// Rows that no sensor rounded, where the others are rounded.
    pub exact: Vec<&'a Seen>,
    /// Signal-to-noise ratios, rising, dB; infinite is no noise.
    pub snrs: Vec<f64>,
    pub methods: Vec<&'a str>,
}

impl<'a> Part<'a> {
    /// The method whose errors and tests stand in the tables.
    pub fn main(&self) -> &'a str {
        let nlse = self.methods.iter().find(|m| **m == "nlse");
        nlse.or(self.methods.first()).copied().unwrap_or_default()
    }

    pub fn of<'b>(&'b self, method: &'b str) -> impl Iterator<Item = &'a Seen> + 'b {
        self.rows.iter().copied().filter(move |r| r.method == method)
    }
}

pub fn page(cells: &Table) -> Page {
    let all = seen(cells);
    let mut page =
        Page { headline: String::new(), text: String::new(), picture: None, figures: Vec::new() };
    for system in in_order(all.iter().map(|r| r.system.as_str())) {
        let here = all.iter().filter(|r| r.system == system);
        let (mut rows, mut exact): (Vec<&Seen>, Vec<&Seen>) =
            here.partition(|r| r.quantisation > 0.0);
        if rows.is_empty() {
            std::mem::swap(&mut rows, &mut exact);
        }
        let part = Part {
            exact,
            snrs: distinct(rows.iter().map(|r| r.snr_db)),
            methods: in_order(rows.iter().map(|r| r.method.as_str())),
            rows,
        };
        let name = if system == "arm" { "The arm" } else { "The motor" };
        page.text += &format!("## {name}\n\n");
        if page.headline.is_empty() {
            page.headline = errors::headline(&part);
        }
        page.picture.get_or_insert_with(|| errors::overview(&part));
        let mut chapters =
            vec![errors::chapter(&part), coverage::chapter(&part), detection::chapter(&part)];
        chapters.extend(rounding::chapter(&part));
        page.text += &chapters.iter().map(|c| format!("* {}\n", c.says)).collect::<String>();
        for chapter in chapters {
            let file = format!("{}_{system}.svg", chapter.name);
            page.text += &format!("\n{}\n![{}]({file})\n", chapter.text, chapter.caption);
            let Chapter { caption, panels, columns, .. } = chapter;
            page.figures.push(Figure { file, caption, panels, columns });
        }
        page.text.push('\n');
    }
    page
}

/// What one aspect comes to.
pub struct Chapter {
    /// Name of the figure's file, before the system and the ending.
    pub name: &'static str,
    /// The conclusion, in words.
    pub says: String,
    /// Headline and tables.
    pub text: String,
    pub caption: String,
    /// Panels of the figure, and how many stand side by side.
    pub panels: Vec<Panel>,
    pub columns: usize,
}
