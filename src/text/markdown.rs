//! Tables for a page.

/// A Markdown table whose first `left` columns are text and the rest numbers.
pub fn markdown_table(header: &[&str], left: usize, rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let header: Vec<String> = header.iter().map(ToString::to_string).collect();
    let rule = |n: usize| if n < left { "---" } else { "---:" }.to_string();
    let rule: Vec<String> = (0..header.len()).map(rule).collect();
    let rows: String = rows.iter().map(|r| line(r)).collect();
    format!("{}{}{rows}", line(&header), line(&rule))
}
