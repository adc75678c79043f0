//! Tables.

use maud::{Markup, html};

use crate::numbers::unsigned_zeros;

/// The first `left` columns are text, the rest numbers.
pub fn table(header: &[&str], left: usize, rows: impl IntoIterator<Item = Vec<String>>) -> Markup {
    let class = |i: usize| (i < left).then_some("text");
    // Only these may be broken where a page is narrow: a number is not.
    let of_cell = |i: usize, cell: &str| class(i).or(cell.contains(' ').then_some("words"));
    html! {
        div.wide {
            table {
                thead {
                    tr { @for (i, h) in header.iter().enumerate() { th class=[class(i)] { (h) } } }
                }
                tbody {
                    @for row in rows {
                        tr {
                            @for (i, cell) in row.iter().enumerate() {
                                td class=[of_cell(i, cell)] { (unsigned_zeros(cell)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Two columns, a name and a text.
pub fn explained(header: [&str; 2], rows: impl IntoIterator<Item = [String; 2]>) -> Markup {
    html! {
        table {
            thead { tr { @for h in header { th.text { (h) } } } }
            tbody {
                @for [name, text] in rows { tr { td.prose { (name) } td.prose { (text) } } }
            }
        }
    }
}
