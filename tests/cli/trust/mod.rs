//! What files of strangers may not do: nothing is lost, and no one is let in.

mod decoders;
mod document;
mod edges;
mod publish;
mod validated;
mod writing;
