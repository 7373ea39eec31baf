//! A page of plots that belong to no run: charts, and the same in text.

use super::chart::Chart;
use super::unwritten;
use crate::error::Result;
use askama::Template;

/// Charts with a heading, and a text below.
#[derive(Template)]
#[template(path = "plots.html", config = "src/report/page/askama.toml")]
pub struct Plots {
    style: &'static str,
    /// The heading.
    pub name: String,
    /// What is plotted, in a sentence.
    pub about: String,
    /// The charts.
    pub charts: Vec<Chart>,
    /// The same in text.
    pub text: String,
}

impl Plots {
    /// The page of these charts.
    ///
    /// # Errors
    /// [`Error::Write`](crate::error::Error::Write) where the template fails.
    pub fn page(name: &str, about: String, charts: Vec<Chart>, text: String) -> Result<String> {
        let plots = Plots {
            style: include_str!("page.css"),
            name: name.into(),
            about,
            charts,
            text,
        };
        plots.render().map_err(unwritten)
    }
}
