//! Pages as text: what a reader's browser is given.

use maud::html;
use sha2::{Digest, Sha256};

use super::bars::{Bars, Row};
use super::frame::{LIBRARY, Page, Section};
use super::plot::{AFTER, BEFORE, Look, plot};
use super::scale::rounded;
use crate::figure::{Colour, Drawn, Line, Panel, Shaded};

/// The digest of `plotly/plotly-basic.min.js` as npm has it (`plotly/README.md`).
const LIBRARY_SHA256: &str = "99784e3abfb07b142a15e521a439e6d9addceadb3f79553fd24c72774f0649ba";

fn page(body: maud::Markup) -> String {
    let sections = vec![Section::new("one", "One", body), Section::new("two", "Two", html! {})];
    let answer = "a < b <script>alert(1)</script>";
    Page { kind: "armtwin test", answer, more: "", picture: html! {}, sections }.html()
}

fn panel(name: &str) -> Panel {
    let points = vec![(0.0, 0.0), (1.0, f64::NAN), (2.0, 1.23456789)];
    let line = Line {
        label: name.into(),
        colour: Colour::After,
        drawn: Drawn::Joined,
        points,
        ..Line::default()
    };
    Panel {
        title: "t".into(),
        lines: vec![line],
        shaded: vec![Shaded { name: "slow".into(), from: 0.5, to: 1.5 }],
        ..Panel::default()
    }
}

#[test]
fn a_page_without_plots_is_small_and_safe() {
    let text = page(html! { p { "body" } });
    assert!(text.len() < 20_000 && !text.contains("Plotly"), "{}", text.len());
    assert!(text.contains("a &lt; b &lt;script&gt;"), "text is not markup");
    assert!(text.contains("id=\"one\"") && !text.contains("id=\"two\""), "empty sections go");
}

#[test]
fn a_page_with_plots_brings_the_library_once_and_fetches_nothing() {
    let two = ["</script><b>", "more"].map(|name| plot(&panel(name), Look::default()));
    let text = page(html! { @for one in two { (one) } });
    assert_eq!(text.matches("* plotly.js (basic").count(), 1);
    assert!(text.len() < 1_250_000, "only what draws lines and points: {}", text.len());
    for fetch in [" src=\"", "<link", "@import", "href=\"http"] {
        let own = text.split("* plotly.js (basic").next().unwrap();
        assert!(!own.contains(fetch), "{fetch}");
    }
    assert!(text.contains("<\\/script><b>"), "a name does not end the data");
    assert!(text.contains("[0.0,null,1.235]"), "gaps stay, digits go");
}

#[test]
fn the_library_is_what_npm_has() {
    let digest = Sha256::digest(LIBRARY.as_bytes());
    let hex: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(hex, LIBRARY_SHA256);
    assert!(!LIBRARY.contains("</script"), "it would end the element it stands in");
}

#[test]
fn equal_bars_are_both_there_and_lengths_are_in_proportion() {
    let row = Row { label: "joint 1".into(), values: vec![Some(2.0), Some(2.0), Some(1.0), None] };
    let names = vec![("before", BEFORE), ("after", AFTER), ("noise", "--floor"), ("none", "--ink")];
    let text = Bars { about: "a", names, rows: vec![row], caption: "c" }.markup().into_string();
    assert_eq!(text.matches("--share: 1.0000").count(), 2, "{text}");
    assert_eq!(text.matches("--share: 0.5000").count(), 1, "{text}");
    assert_eq!(text.matches("class=\"bar\"").count(), 3, "what is not known has no bar");
}

#[test]
fn digits_are_cut_without_tails() {
    let cases = [(1.23456, 1.235), (-0.000123456, -0.0001235), (98765.4, 98770.0), (0.0, 0.0)];
    for (x, expected) in cases {
        assert_eq!(rounded(x), expected);
        assert!(rounded(x).to_string().len() <= 10, "{}", rounded(x));
    }
    assert!(rounded(f64::NAN).is_nan());
}
