//! The report.

mod page;
