//! What all reports share: head, answer, sections one after the other, plots that work offline.

use maud::{DOCTYPE, Markup, PreEscaped, html};

pub use crate::report::Fact;

/// Everything a report is made from.
pub struct Page<'a> {
    /// What made it: `armtwin diagnose`.
    pub kind: &'a str,
    /// In two lines at most, where the page is wide.
    pub answer: &'a str,
    /// What else belongs to the answer; may be empty.
    pub more: &'a str,
    /// The first picture.
    pub picture: Markup,
    pub sections: Vec<Section>,
}

pub struct Section {
    /// What a link ends in.
    pub id: String,
    pub title: String,
    pub body: Markup,
}

impl Section {
    pub fn new(id: impl Into<String>, title: impl Into<String>, body: Markup) -> Self {
        Self { id: id.into(), title: title.into(), body }
    }
}

/// Nothing is fetched from anywhere, whatever a script may try.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; \
                      img-src data: blob:";

impl Page<'_> {
    /// The whole file.
    pub fn html(&self) -> String {
        let sections: Vec<&Section> =
            self.sections.iter().filter(|s| !s.body.0.is_empty()).collect();
        let mut shown = sections.iter().map(|s| &s.body).chain([&self.picture]);
        let plots = shown.any(|markup| markup.0.contains("class=\"plot"));
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(POLICY);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    meta name="generator" content=(concat!("armtwin ", env!("CARGO_PKG_VERSION")));
                    title { (self.kind) }
                    style { (PreEscaped(include_str!("style.css"))) }
                    noscript { style { ".framed { display: none; }" } }
                }
                body {
                    header id="answer" {
                        p.kind { (self.kind) }
                        h1 { (self.answer) }
                        @if !self.more.is_empty() { p.more { (self.more) } }
                        (self.picture)
                        nav { @for s in &sections { a href={ "#" (s.id) } { (s.title) } } }
                    }
                    main { @for s in &sections { (section(s)) } }
                    @if plots { (scripts()) }
                }
            }
        }
        .into_string()
    }
}

fn section(s: &Section) -> Markup {
    html! { section id=(s.id) { h2 { (s.title) } (s.body) } }
}

/// Lines and points, without maps, surfaces and formulae.
pub const LIBRARY: &str = include_str!("plotly/plotly-basic.min.js");

/// The plotting library, once, and what draws with it.
fn scripts() -> Markup {
    html! {
        noscript {
            p.note { "The plots need JavaScript; every number is in the text and the tables." }
        }
        script { (PreEscaped(LIBRARY)) }
        script { (PreEscaped(include_str!("plots.js"))) }
    }
}

/// What is said of what.
pub fn facts(facts: &[Fact]) -> Markup {
    html! { dl { @for (what, text) in facts { dt { (what) } dd { (text) } } } }
}
