//! What strangers' files may not do.

mod decoders;
