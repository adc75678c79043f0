//! A study's figures as plots, and as drawings where no script runs.

use base64::{Engine, engine::general_purpose::STANDARD};
use maud::{Markup, html};

use super::super::plot::{Look, NOMINAL, key, plot, variable};
use crate::figure::{Colour, Figure};
use crate::studies::StudyError;

/// # Errors
/// If the drawing for readers without scripts fails.
pub fn figure(figure: &Figure) -> Result<Markup, StudyError> {
    let names = figure.labels();
    let coloured = names.iter().enumerate().map(|(k, name)| (*name, variable(Colour::ByName, k)));
    let mut colours: Vec<(&str, &str)> = coloured.collect();
    if figure.panels.iter().any(|p| !p.nominal.is_empty()) {
        colours.push(("what should be (dashed)", NOMINAL));
    }
    let drawing = format!("data:image/svg+xml;base64,{}", STANDARD.encode(figure.svg()?));
    let look = Look { names: &names, whole: figure.panels.len() == 1, group: None };
    Ok(html! {
        figure {
            (key(&colours))
            div.grid { @for panel in &figure.panels { (plot(panel, look)) } }
            noscript { img src=(drawing) alt=(figure.caption); }
            @if !figure.caption.is_empty() { figcaption { (figure.caption) } }
        }
    })
}
