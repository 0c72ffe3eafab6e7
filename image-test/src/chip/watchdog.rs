//! IWDG: the watchdog on the internal low-speed oscillator (RM0090, section 21).

/// The oscillator, hertz (21.3, and the data sheet's typical value).
const LSI_HZ: u64 = 32_000;

/// Keys of KR (21.4.1).
const UNLOCK: u32 = 0x5555;
const RELOAD: u32 = 0xaaaa;
const START: u32 = 0xcccc;

/// The watchdog.
pub struct Watchdog {
    unlocked: bool,
    prescaler: u32,
    reload: u32,
    bites_ps: Option<u64>,
}

impl Watchdog {
    pub(super) fn new() -> Self {
        Self {
            unlocked: false,
            prescaler: 0,
            // 21.4.3.
            reload: 0xfff,
            bites_ps: None,
        }
    }

    /// From a feed to the bite, picoseconds.
    #[must_use]
    pub fn patience_ps(&self) -> u64 {
        // 4 to 256 (21.4.2).
        let divider = 4u64 << self.prescaler.min(6);
        (u64::from(self.reload) + 1) * divider * 1_000_000_000_000 / LSI_HZ
    }

    /// When it bites; `None` while it has not been started.
    #[must_use]
    pub fn bites_ps(&self) -> Option<u64> {
        self.bites_ps
    }

    pub(super) fn read(&self, offset: u32) -> u32 {
        match offset {
            4 => self.prescaler,
            8 => self.reload,
            _ => 0,
        }
    }

    pub(super) fn write(&mut self, offset: u32, value: u32, now_ps: u64) {
        match (offset, value) {
            (0, START) => self.bites_ps = Some(now_ps + self.patience_ps()),
            (0, RELOAD) => {
                self.unlocked = false;
                if self.bites_ps.is_some() {
                    self.bites_ps = Some(now_ps + self.patience_ps());
                }
            }
            (0, key) => self.unlocked = key == UNLOCK,
            (4, value) if self.unlocked => self.prescaler = value & 7,
            (8, value) if self.unlocked => self.reload = value & 0xfff,
            _ => {}
        }
    }
}
