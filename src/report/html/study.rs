//! A finished study: its summary with the plots in it.

use std::ops::Range;

use base64::{Engine, engine::general_purpose::STANDARD};
use maud::{Markup, PreEscaped, html};
use pulldown_cmark::{CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd};

use super::frame::{Page, Section};

/// The page of a `summary` (Markdown: a title, findings as a list, chapters with tables and pictures).
/// `figures` are file names and SVG texts; the first is the page's picture.
pub fn study_report(summary: &str, figures: &[(String, String)]) -> String {
    let parser = Parser::new_ext(summary, Options::ENABLE_TABLES);
    let events: Vec<Event<'_>> = parser.flat_map(|event| shown(event, figures)).collect();
    let title = plain(&events, |e| matches!(e, Event::End(TagEnd::Heading(_))));
    let first = events.iter().position(|e| matches!(e, Event::Start(Tag::Item)));
    let answer = first.map(|at| plain(&events[at..], |e| matches!(e, Event::End(TagEnd::Item))));
    let picture = figures.first().map(|(name, svg)| html! { img src=(data(svg)) alt=(name); });
    Page {
        kind: &format!("armtwin {} study: {title}", env!("CARGO_PKG_VERSION")),
        answer: answer.as_deref().unwrap_or(&title),
        picture: picture.unwrap_or_default(),
        sections: chapters(&events).into_iter().map(|range| section(&events[range])).collect(),
    }
    .html()
}

/// Pictures brought along, tables that scroll where a page is narrow, markup as the text it is.
fn shown<'a>(event: Event<'a>, figures: &[(String, String)]) -> Vec<Event<'a>> {
    let markup = |text: &'static str| Event::Html(CowStr::Borrowed(text));
    match event {
        Event::Start(Tag::Image { link_type, dest_url, title, id }) => {
            let file = figures.iter().find(|(name, _)| **name == *dest_url);
            let dest_url = file.map_or(dest_url, |(_, svg)| data(svg).into());
            vec![Event::Start(Tag::Image { link_type, dest_url, title, id })]
        }
        Event::Html(text) | Event::InlineHtml(text) => vec![Event::Text(text)],
        Event::Start(Tag::Table(_)) => vec![markup("<div class=\"wide\">"), event],
        Event::End(TagEnd::Table) => vec![event, markup("</div>")],
        other => vec![other],
    }
}

fn data(svg: &str) -> String {
    format!("data:image/svg+xml;base64,{}", STANDARD.encode(svg))
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

    #[test]
    fn chapters_tables_and_pictures_are_in_one_file() {
        let summary = "# A <b>study</b>\n\narmtwin, 2 cells.\n\n* **Found**: `all` of it.\n* More.\n\n\
                       ## The arm\n\n| a | b |\n| --- | ---: |\n| 1 | 2 |\n\n![errors](e.svg)\n";
        let page = study_report(summary, &[("e.svg".into(), "<svg></svg>".into())]);
        assert!(page.contains("<h1>Found: all of it.</h1>"), "{page}");
        assert!(page.contains("<section id=\"the-arm\">") && page.contains("<td>1</td>"));
        let picture = "src=\"data:image/svg+xml;base64,PHN2Zz48L3N2Zz4=\"";
        assert_eq!(page.matches(picture).count(), 2, "at the top and in its place: {page}");
        assert!(!page.contains("<b>") && !page.contains("e.svg)"));
    }
}
