//! Standard output and standard error. Their readers influence neither what is baked nor the exit code.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};

use crate::text::printable;

/// Messages for the user. Messages that cannot be written are dropped and change no outcome.
///
/// Each `write!` or `writeln!` is one message on one line, also with hostile names from files: see [`printable`].
pub struct Messages<'w>(pub &'w mut dyn Write);

impl Write for Messages<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let _ = self.0.write_all(bytes);
        Ok(bytes.len())
    }

    fn write_fmt(&mut self, message: Arguments<'_>) -> io::Result<()> {
        let text = message.to_string();
        let line = match text.strip_suffix('\n') {
            Some(line) => format!("{}\n", printable(line)),
            None => printable(&text).into_owned(),
        };
        // One write for each line keeps lines of processes that share a log apart.
        self.write_all(line.as_bytes())
    }

    fn flush(&mut self) -> io::Result<()> {
        let _ = self.0.flush();
        Ok(())
    }
}

/// Results. If their reader closes the pipe (`roughcast ... | head`), nothing more is printed and the work goes on. The
/// work also goes on after any other failure, which [`Results::finish`] returns.
pub struct Results<'w> {
    out: &'w mut dyn Write,
    failed: Option<io::Error>,
}

impl<'w> Results<'w> {
    /// Returns results that are printed to `out`.
    pub fn new(out: &'w mut dyn Write) -> Self {
        Self { out, failed: None }
    }

    /// Ends printing.
    ///
    /// # Errors
    /// Why results could not be printed, unless their reader closed the pipe.
    pub fn finish(mut self) -> io::Result<()> {
        self.flush()?;
        match self.failed {
            Some(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
            _ => Ok(()),
        }
    }

    /// Prints unless printing has failed before.
    fn attempt(&mut self, print: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
        if self.failed.is_none() {
            self.failed = print(self.out).err();
        }
    }
}

impl Write for Results<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.attempt(|out| out.write_all(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.attempt(|out| out.flush());
        Ok(())
    }
}
