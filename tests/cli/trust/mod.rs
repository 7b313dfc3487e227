//! Tests that untrusted files cannot destroy files or reach other ones.

mod decoders;
mod document;
mod edges;
mod publish;
mod validated;
mod writing;
