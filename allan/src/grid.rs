//! The averaging times of the streaming estimators and how far apart their differences lie.
//!
//! Four averaging times an octave, `m` in {1, 2, 3} and {4, 5, 6, 7} * 2^k. The 17 shortest form
//! the *ground* and use every overlap. Above it, *level* `l` (from 1) takes the four averaging
//! times {24, 28, 32, 40} * 2^l, looks only at absolute indices that are multiples of `2^l`, and so
//! has 24 to 40 differences an averaging time. Against full overlap that costs at most 0.9 % of
//! the degrees of freedom for white, flicker and walk noise in records of at least 8 averaging
//! times (tests/overlap.rs); half of it is the last, incomplete stride. Differenced white noise
//! has nearly independent neighbours, so there the loss is the whole factor `2^l`; the degrees of
//! freedom that [`edf`](crate::edf::edf) gives for the stride account for it.

/// Averaging times of the ground, at full overlap.
pub(crate) const GROUND_LAGS: [u64; 17] =
    [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40];

/// Averaging times of a level in units of its stride.
pub(crate) const LEVEL_LAGS: [u64; 4] = [24, 28, 32, 40];
