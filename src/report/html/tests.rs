//! Pages as text: what a reader's browser is given.

use maud::html;

use super::frame::{Page, Section};
use super::plot::{AFTER, Band, Curve, Drawn, Plot, rounded, thinned, with_gaps};

fn page(body: maud::Markup) -> String {
    let sections = vec![Section::new("one", "One", body), Section::new("two", "Two", html! {})];
    let answer = "a < b <script>alert(1)</script>";
    Page { kind: "armtwin test", answer, picture: html! {}, sections }.html()
}

fn plot(name: &str) -> Plot<'_> {
    let y = vec![0.0, f64::NAN, 1.23456789];
    Plot {
        title: "t".into(),
        across: "x",
        up: "y",
        curves: vec![Curve {
            name,
            colour: AFTER,
            x: vec![0.0, 1.0, 2.0],
            y,
            drawn: Drawn::Joined,
        }],
        bands: vec![Band { name: "slow".into(), from: 0.5, to: 1.5 }],
        ..Plot::default()
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
    let text = page(html! { (plot("</script><b>").markup()) (plot("more").markup()) });
    assert_eq!(text.matches("* plotly.js v").count(), 1);
    assert!(text.len() < 5_500_000, "the library for formulae is left out");
    for fetch in [" src=\"", "<link", "@import", "href=\"http"] {
        let own = text.split("* plotly.js v").next().unwrap();
        assert!(!own.contains(fetch), "{fetch}");
    }
    assert!(text.contains("<\\/script><b>"), "a name does not end the data");
    assert!(text.contains("[0.0,null,1.235]"), "gaps stay, digits go");
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

#[test]
fn thinning_keeps_peaks_where_they_are() {
    let x: Vec<f64> = (0..10_000).map(f64::from).collect();
    let mut y: Vec<f64> = x.iter().map(|x| (0.001 * x).sin()).collect();
    (y[1234], y[8000]) = (-7.0, 9.0);
    let [kept, values] = thinned(&x, &y, 100);
    assert!(kept.len() <= 200 && kept.windows(2).all(|w| w[0] < w[1]), "{}", kept.len());
    for (at, value) in [(1234.0, -7.0), (8000.0, 9.0)] {
        let place = kept.iter().position(|k| *k == at).expect("a peak");
        assert_eq!(values[place], value);
    }
    assert_eq!(thinned(&x[..50], &y[..50], 100), [x[..50].to_vec(), y[..50].to_vec()]);
}

#[test]
fn lines_end_where_rows_are_left_out() {
    let [x, y] = with_gaps(&[0.0, 0.1, 0.2, 1.0, 1.1], &[1.0; 5], 0.1, 100);
    assert_eq!((x.len(), y.iter().position(|y| y.is_nan())), (6, Some(3)));
}
