//! How a command ends, and its exit code.

/// How a command ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outcome {
    /// Everything that was asked for is done.
    #[default]
    Done,
    /// Some inputs failed and will fail again.
    Failed,
    /// The arguments contradict each other or name something that cannot be used.
    Usage,
    /// `check` found something.
    Findings,
    /// Some inputs failed and may succeed at another try.
    Retry,
}

impl Outcome {
    /// Returns the exit code.
    pub fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Failed => 1,
            Self::Usage => 2,
            Self::Findings => 3,
            Self::Retry => 4,
        }
    }

    /// Combines the outcomes of two parts. A permanent failure outweighs one that may pass at another try.
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
