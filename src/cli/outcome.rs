//! How a command ends, and the exit code that says so.

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Everything asked for is done.
    Done,
    /// Some inputs failed, and will fail again.
    Failed,
    /// Arguments that make no sense together.
    Usage,
    /// `check` found something.
    Findings,
    /// Some inputs failed, and may not fail again.
    Retry,
}

impl Outcome {
    /// The exit code.
    pub fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Failed => 1,
            Self::Usage => 2,
            Self::Findings => 3,
            Self::Retry => 4,
        }
    }

    /// The outcome of two parts: what fails for good outweighs what may be tried again.
    pub fn and(self, other: Self) -> Self {
        let weight = |o: Self| match o {
            Self::Done => 0,
            Self::Findings => 1,
            Self::Retry => 2,
            Self::Failed => 3,
            Self::Usage => 4,
        };
        if weight(other) > weight(self) { other } else { self }
    }
}
