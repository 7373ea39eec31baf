//! The report.

mod counts;
mod page;
