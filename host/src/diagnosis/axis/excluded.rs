//! Bands of an axis that no steady law speaks for.

use std::ops::Range;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;

/// A band that no steady law speaks for: neither fits nor tests look at it.
#[derive(Debug, Clone, PartialEq)]
pub struct Excluded {
    /// The band, hertz.
    pub band_hz: Range<f64>,
    /// What there is to say of it.
    pub remark: Remark,
}

impl Excluded {
    /// Extends it by another band.
    fn join(&mut self, band_hz: &Range<f64>) {
        let all = union(&self.band_hz, band_hz);
        if let Place::Band { ends_hz, .. } = &mut self.remark.place
            && *ends_hz == [self.band_hz.start, self.band_hz.end]
        {
            *ends_hz = [all.start, all.end];
        }
        self.band_hz = all;
    }
}

/// The band that two bands span.
fn union(one: &Range<f64>, other: &Range<f64>) -> Range<f64> {
    one.start.min(other.start)..one.end.max(other.end)
}

impl AxisState {
    /// Bands that are excluded, with what there is to say of each.
    pub fn excluded(&self) -> &[Excluded] {
        &self.excluded
    }

    /// Bands that neither fits nor tests look at, hertz: those, the bands of tones that have a name, and what is absorbed.
    pub fn excluded_hz(&self) -> Vec<Range<f64>> {
        let bands = self.excluded.iter().map(|one| one.band_hz.clone());
        bands
            .chain(self.tones_hz())
            .chain(self.absorbed_hz())
            .collect()
    }

    /// The band, hertz, whose noise was taken out with a course, or drowned in that of what is followed: what is left there says nothing.
    pub fn absorbed_hz(&self) -> Option<Range<f64>> {
        let explanations = self.explanations().iter();
        let absorbed = explanations.filter_map(Explanation::absorbs_hz);
        let end_hz = absorbed.fold(0.0, f64::max);
        (end_hz > 0.0).then_some(0.0..end_hz)
    }

    /// Bands of tones that have a name, hertz.
    pub fn tones_hz(&self) -> Vec<Range<f64>> {
        let named = self.explanations().iter().flat_map(Explanation::bands_hz);
        named.cloned().collect()
    }

    /// The same with as much again on either side: what is seen there is left of them.
    pub fn tones_with_skirts_hz(&self) -> impl Iterator<Item = Range<f64>> {
        self.tones_hz().into_iter().map(|band| {
            let width_hz = band.end - band.start;
            band.start - width_hz..band.end + width_hz
        })
    }

    /// Excludes a band, joined with one beside it.
    pub fn exclude(&mut self, new: Excluded) {
        match self.beside(&new.band_hz) {
            Some(place) => self.excluded[place].join(&new.band_hz),
            None => self.excluded.push(new),
        }
    }

    /// Excludes a line, by itself whatever stands beside it.
    pub fn exclude_line(&mut self, new: Excluded) {
        self.excluded.push(new);
    }

    /// Lets all excluded bands count again.
    pub fn readmit_all(&mut self) {
        self.excluded.clear();
    }

    /// The bands that would be excluded with a new one, hertz.
    pub fn excluded_with(&self, new_hz: &Range<f64>) -> Vec<Range<f64>> {
        let bands = self.excluded.iter().map(|one| one.band_hz.clone());
        let mut bands_hz: Vec<Range<f64>> = bands.collect();
        match self.beside(new_hz) {
            Some(place) => bands_hz[place] = union(&bands_hz[place], new_hz),
            None => bands_hz.push(new_hz.clone()),
        }
        bands_hz
    }

    /// Number of the first excluded band that a new one lies beside, by no more than its own width.
    fn beside(&self, new_hz: &Range<f64>) -> Option<usize> {
        let width_hz = new_hz.end - new_hz.start;
        let mut bands = self.excluded.iter().map(|one| &one.band_hz);
        bands.position(|one| one.start < new_hz.end + width_hz && new_hz.start - width_hz < one.end)
    }
}
