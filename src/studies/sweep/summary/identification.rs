//! Identification: errors, coverage, detection, for the arm and for the motor.

use super::chapter::{Chapter, Part};
use super::seen::{Seen, in_order, seen};
use super::{Page, coverage, detection, distinct, errors, rounding};
use crate::figure::Figure;
use crate::studies::sweep::table::Table;

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
