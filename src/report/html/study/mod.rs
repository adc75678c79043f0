//! A finished study: its summary with the plots in it.

mod panels;

use std::ops::Range;

use maud::{Markup, PreEscaped};
use pulldown_cmark::{CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd};

use super::frame::{self, Section};
use crate::figure::Figure;
use crate::studies::StudyError;
use crate::studies::sweep::Page;

/// The whole file: the headline and its picture, then the summary with plots for its figures.
///
/// # Errors
/// If a figure cannot be drawn for readers without scripts.
pub fn study_report(page: &Page) -> Result<String, StudyError> {
    let parser = Parser::new_ext(&page.text, Options::ENABLE_TABLES);
    let events: Vec<Event<'_>> = parser.flat_map(shown).collect();
    let events = with_plots(&events, &page.figures)?;
    let title = plain(&events, |e| matches!(e, Event::End(TagEnd::Heading(_))));
    let picture = page.picture.as_ref().map(|panel| {
        let panels = vec![panel.clone()];
        panels::figure(&Figure { panels, columns: 1, ..Figure::default() })
    });
    Ok(frame::Page {
        kind: &format!("armtwin {} study: {title}", env!("CARGO_PKG_VERSION")),
        answer: &page.headline,
        more: "",
        picture: picture.transpose()?.unwrap_or_default(),
        sections: chapters(&events).into_iter().map(|range| section(&events[range])).collect(),
    }
    .html())
}

/// Tables that scroll where a page is narrow, markup as the text it is.
fn shown(event: Event<'_>) -> Vec<Event<'_>> {
    match event {
        Event::Html(text) | Event::InlineHtml(text) => vec![Event::Text(text)],
        Event::Start(Tag::Table(_)) => vec![markup("<div class=\"wide named\">"), event],
        Event::End(TagEnd::Table) => vec![event, markup("</div>")],
        other => vec![other],
    }
}

fn markup<'a>(text: impl Into<CowStr<'a>>) -> Event<'a> {
    Event::Html(text.into())
}

/// A paragraph that is the picture of a figure becomes its plots.
fn with_plots<'a>(
    mut events: &[Event<'a>],
    figures: &[Figure],
) -> Result<Vec<Event<'a>>, StudyError> {
    let mut shown = Vec::new();
    while let [first, after @ ..] = events {
        let end = after.iter().position(|e| matches!(e, Event::End(TagEnd::Paragraph)));
        match (pictured(events, figures), end) {
            (Some(figure), Some(end)) => {
                shown.push(markup(panels::figure(figure)?.into_string()));
                events = &after[end + 1..];
            }
            _ => {
                shown.push(first.clone());
                events = after;
            }
        }
    }
    Ok(shown)
}

fn pictured<'f>(events: &[Event<'_>], figures: &'f [Figure]) -> Option<&'f Figure> {
    let [Event::Start(Tag::Paragraph), Event::Start(Tag::Image { dest_url, .. }), ..] = events
    else {
        return None;
    };
    figures.iter().find(|f| *f.file == **dest_url)
}

/// Text and code up to the first event that is the `end`.
fn plain(events: &[Event<'_>], end: impl Fn(&Event<'_>) -> bool) -> String {
    let text = |e: &Event<'_>| match e {
        Event::Text(text) | Event::Code(text) => Some(text.to_string()),
        Event::SoftBreak | Event::HardBreak => Some(" ".into()),
        _ => None,
    };
    events.iter().take_while(|e| !end(e)).filter_map(text).collect()
}

/// What stands before the first chapter, without the title, and the chapters.
fn chapters(events: &[Event<'_>]) -> Vec<Range<usize>> {
    let begins =
        |e: &Event<'_>| matches!(e, Event::Start(Tag::Heading { level: HeadingLevel::H2, .. }));
    let titled = |e: &Event<'_>| matches!(e, Event::End(TagEnd::Heading(HeadingLevel::H1)));
    let mut starts: Vec<usize> =
        events.iter().position(titled).map(|at| at + 1).into_iter().collect();
    starts.extend((0..events.len()).filter(|&i| begins(&events[i])));
    let ends = starts.iter().skip(1).copied().chain([events.len()]);
    starts.iter().copied().zip(ends).map(|(from, to)| from..to).collect()
}

fn section(events: &[Event<'_>]) -> Section {
    let headed =
        events.iter().position(|e| matches!(e, Event::End(TagEnd::Heading(HeadingLevel::H2))));
    let (title, body) = match events.first() {
        Some(Event::Start(Tag::Heading { level: HeadingLevel::H2, .. })) => {
            let end = headed.unwrap_or_default();
            (plain(&events[..end], |_| false), &events[end + 1..])
        }
        _ => ("Summary".into(), events),
    };
    let mut text = String::new();
    pulldown_cmark::html::push_html(&mut text, body.iter().cloned());
    let body: Markup = PreEscaped(text.trim().to_string());
    Section::new(title.to_lowercase().replace(' ', "-"), title, body)
}

#[cfg(test)]
mod tests {
    use super::study_report;
    use crate::figure::{Figure, Line, Panel, Scale};
    use crate::studies::sweep::Page;

    fn panel(title: &str) -> Panel {
        let points = vec![(10.0, 0.01), (20.0, 0.1), (f64::INFINITY, 1.0)];
        let band = vec![(10.0, 0.005, 0.02), (20.0, 0.05, 0.2), (f64::INFINITY, 0.5, 2.0)];
        Panel {
            title: title.into(),
            across: ("SNR, dB", Scale::Decibel),
            up: ("error, %", Scale::Log),
            lines: vec![Line { label: "a & b".into(), points, band, ..Line::default() }],
            nominal: vec![(10.0, 0.2), (20.0, 0.2)],
            ..Panel::default()
        }
    }

    #[test]
    fn chapters_tables_and_plots_are_in_one_file() {
        let text = "# A <b>study</b>\n\narmtwin, 2 cells.\n\n* **Found**: `all` of it.\n* More.\n\n\
                    ## The arm\n\n| a | b |\n| --- | ---: |\n| 1 | 2 |\n\n![errors](e.svg)\n\nEnd.\n";
        let panels = vec![panel("one"), panel("two")];
        let figure = Figure { file: "e.svg".into(), caption: "errors".into(), panels, columns: 2 };
        let headline = "Found & told.".into();
        let page = Page {
            headline,
            text: text.into(),
            picture: Some(panel("first")),
            figures: vec![figure],
        };
        let page = study_report(&page).unwrap();
        assert!(
            page.contains("<h1>Found &amp; told.</h1>") && page.contains("<code>all</code> of it")
        );
        assert!(page.contains("<section id=\"the-arm\">") && page.contains("<td>1</td>"));
        let own = page.split("* plotly.js (basic").next().unwrap();
        assert!(!own.contains("<b>") && !own.contains("e.svg") && own.contains("<p>End.</p>"));
        assert_eq!(own.matches("<div class=\"plot").count(), 3, "at the top, and two panels");
        assert_eq!(own.matches("<noscript><img src=\"data:image/svg+xml").count(), 2, "for both");
        let trace = "\"x\":[10.0,20.0,30.0],\"y\":[0.01,0.1,1.0]";
        assert_eq!(own.matches(trace).count(), 3, "no noise stands 10 dB on");
        let area = "[10.0,20.0,30.0,30.0,20.0,10.0],\"y\":[0.005,0.05,0.5,2.0,0.2,0.02]";
        assert_eq!(own.matches(area).count(), 3, "intervals");
        let ticks = "\"ticktext\":[\"10\",\"20\",\"none\"],\"tickvals\":[10.0,20.0,30.0]";
        assert_eq!(own.matches(ticks).count(), 3);
        assert_eq!(own.matches("\"type\":\"log\"").count(), 3);
    }
}
