//! The viewer: a page that shows an asset, its bakes and a supersampled picture side by side, served to a browser on
//! this machine.
//!
//! The page is made by `npm/make-viewer.js`, and a binary that was built with it passes it as [`PageFile`]s. The server
//! is the twin of `plugins/three/server.js`: a change of one belongs in the other, too. An HTTP crate would bring more
//! code than the server needs: it answers GET and HEAD, and closes each connection after one answer.

mod choose;
mod error;
mod events;
mod request;
mod response;
mod server;
mod site;
#[cfg(test)]
mod tests;
mod variant;

pub use choose::{Chosen, choose};
pub use error::ViewerError;
pub use events::{Events, reports_outputs};
pub use server::Server;
pub use site::{PageFile, Site};
pub use variant::Variant;
