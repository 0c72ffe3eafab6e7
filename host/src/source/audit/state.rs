//! What is proven of a stream, and where the comparison stands, with their words.

use std::fmt;

/// What is proven of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Proof {
    /// Where the comparison stands.
    pub state: State,
    /// Times that a loss on the link broke the comparison.
    pub breaks: u32,
    /// Times that the board's bins did not agree with ours.
    pub disagreements: u32,
    /// Conversions of the whole record that are proven, those included of which board and host
    /// agree that they are missing.
    pub proven: u64,
}

/// Where the comparison stands. Indices count the samples of the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum State {
    /// Nothing has been compared.
    #[default]
    Unheard,
    /// Both sides begin with this sample.
    Waiting {
        /// First sample that will be compared.
        epoch: u64,
    },
    /// The bins agree.
    Proven {
        /// First sample in them.
        epoch: u64,
        /// The sample after the last one in them.
        index: u64,
    },
    /// The link lost a batch.
    Lost {
        /// The first sample that did not arrive.
        index: u64,
    },
    /// Nothing was lost, and yet the bins differ: a fault in the chain or in the programs.
    Disagrees {
        /// The sample at which it was noticed.
        index: u64,
    },
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Unheard => write!(f, "not compared with the board's own bins"),
            Self::Waiting { epoch } => write!(
                f,
                "the comparison with the board's own bins begins at sample {epoch}"
            ),
            Self::Proven { epoch: 0, index } => {
                write!(f, "proven to sample {index} (the board's own bins agree)")
            }
            Self::Proven { epoch, index } => write!(
                f,
                "proven from sample {epoch} to {index} (the board's own bins agree)"
            ),
            Self::Lost { index } => write!(
                f,
                "not proven since sample {index}, where the link lost samples"
            ),
            Self::Disagrees { index } => write!(
                f,
                "THE BOARD'S OWN BINS DISAGREE at sample {index}: a fault in the chain that no \
                 check sum saw"
            ),
        }
    }
}

impl fmt::Display for Proof {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.state.fmt(f)?;
        if self.breaks > 0 || self.disagreements > 0 {
            write!(f, "; {} samples proven in all", self.proven)?;
        }
        if self.breaks > 0 {
            write!(f, ", {} times broken by the link", self.breaks)?;
        }
        if self.disagreements > 0 {
            write!(f, ", {} DISAGREEMENTS", self.disagreements)?;
        }
        Ok(())
    }
}
