//! What a converter really produced, for proof against what the far end received.

/// How many of the latest words are kept.
pub(crate) const KEPT: usize = 32;

/// Count and digest of the words that a converter produced.
///
/// The digest is FNV-1a over whole words: `d = (d ^ word) * 100000001B3h`, from CBF29CE484222325h.
///
/// ```
/// use inm_emulator::Sent;
/// let mut received = Sent::default();
/// received.push(0x1234_5678);
/// assert_eq!(received.words(), 1);
/// assert_ne!(received.digest(), Sent::default().digest());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sent {
    words: u64,
    digest: u64,
}

impl Sent {
    /// Takes one more word into the account.
    pub const fn push(&mut self, word: u32) {
        self.digest = (self.digest ^ word as u64).wrapping_mul(0x0000_0100_0000_01B3);
        self.words += 1;
    }

    /// Words so far.
    pub const fn words(self) -> u64 {
        self.words
    }

    /// Digest of all words so far, in their order.
    pub const fn digest(self) -> u64 {
        self.digest
    }
}

impl Default for Sent {
    fn default() -> Self {
        Self {
            words: 0,
            digest: 0xCBF2_9CE4_8422_2325,
        }
    }
}

/// The account of one converter and its latest words.
#[derive(Debug, Clone)]
pub(crate) struct Ledger {
    pub(crate) sent: Sent,
    latest: [u32; KEPT],
}

impl Ledger {
    pub(crate) fn new() -> Self {
        Self {
            sent: Sent::default(),
            latest: [0; KEPT],
        }
    }

    pub(crate) fn push(&mut self, word: u32) {
        self.latest[(self.sent.words % KEPT as u64) as usize] = word;
        self.sent.push(word);
    }

    /// Word number `index`, counted from zero, if it is among the latest.
    pub(crate) fn word(&self, index: u64) -> Option<u32> {
        let age = self.sent.words.checked_sub(index)?;
        (1..=KEPT as u64)
            .contains(&age)
            .then(|| self.latest[(index % KEPT as u64) as usize])
    }
}
