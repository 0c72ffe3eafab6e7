//! Where an effect shows in the pictures of a record.

/// A place in frequency, averaging time or time at which an effect shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mark {
    /// A line or a peak.
    Line {
        /// Frequency of the mark, hertz.
        f_hz: f64,
        /// Which multiple of the effect's own frequency it is.
        multiple: u32,
    },
    /// The corner of a spectrum, hertz.
    Corner(f64),
    /// A band that the effect fills, from and to, hertz.
    Band(f64, f64),
    /// The averaging time at which it adds most to the Allan variance, seconds.
    AveragingTime(f64),
    /// A moment, seconds since the start of the record.
    Moment(f64),
    /// A stretch of time, from and to, seconds since the start of the record.
    Stretch(f64, f64),
}
