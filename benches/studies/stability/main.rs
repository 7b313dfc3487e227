//! Prints the tables of docs/stability.md as markdown and draws its pictures.
//!
//! `cargo run --release -p studies --bin stability [FOLDER]` writes pictures to FOLDER, `docs/pictures` by default. It
//! reads `../shared/data/maps`, else `fixtures/maps`, for the one table of real maps.

use std::error::Error;
use std::path::PathBuf;

mod depth;
mod filtering;
mod grooves;
mod moments;
mod picture;
mod rank;
mod signs;
mod sizes;
mod steep;
mod synthetic;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(|| PathBuf::from("docs/pictures"), PathBuf::from);
    moments::print();
    grooves::print(&folder)?;
    steep::print();
    rank::print();
    filtering::print()?;
    signs::print(&folder)?;
    depth::print_normals()?;
    depth::print_heights()?;
    sizes::print();
    depth::print_not_finite();
    Ok(())
}

/// Prints a heading and the head of a table.
fn head(title: &str, columns: &[&str]) {
    println!("\n### {title}\n");
    println!("| {} |", columns.join(" | "));
    println!("|{}", "---|".repeat(columns.len()));
}

/// Prints a row of a table.
fn row(cells: &[String]) {
    println!("| {} |", cells.join(" | "));
}
