//! A record read to its end, in a form that tests can compare.

use inm_host::internals::source::{Chunk, Gap, Source, SourceError, Values};
use inm_protocol::AXES;

/// Everything that a source had to say.
#[derive(Debug, Default)]
pub struct Record {
    /// Index, codes X Y Z, and for each axis whether the word may be used.
    pub samples: Vec<(u64, [u32; AXES], [bool; AXES])>,
    /// Gaps in all axes.
    pub gaps: Vec<Gap>,
    /// News, in words.
    pub news: Vec<String>,
    /// What ended the source early.
    pub error: Option<SourceError>,
}

impl Record {
    /// Reads `source` to its end, or to its error.
    ///
    /// # Panics
    /// If the source does not yield three columns of codes.
    pub fn read(source: &mut dyn Source) -> Self {
        let mut record = Self::default();
        loop {
            match source.next_chunk() {
                Ok(Some(Chunk::Samples(block))) => {
                    for i in 0..block.len() {
                        let axes = [0, 1, 2].map(|axis| &block.columns[axis]);
                        let codes = axes.map(|column| match &column.values {
                            Values::Codes(codes) => codes[i] as u32,
                            Values::Floats(_) => panic!("codes stay codes"),
                        });
                        let good =
                            axes.map(|column| !column.invalid.iter().any(|bad| bad.contains(&i)));
                        record.samples.push((block.first + i as u64, codes, good));
                    }
                }
                Ok(Some(Chunk::Gap(gap))) => record.gaps.push(gap),
                Ok(Some(Chunk::News(news))) => record.news.push(news),
                Ok(None) => return record,
                Err(error) => {
                    record.error = Some(error);
                    return record;
                }
            }
        }
    }

    /// The codes alone.
    pub fn codes(&self) -> Vec<[u32; AXES]> {
        self.samples.iter().map(|&(_, codes, _)| codes).collect()
    }

    /// Whether any news contain this text.
    pub fn tells(&self, text: &str) -> bool {
        self.news.iter().any(|news| news.contains(text))
    }

    /// Checks that every sample is the word that the converters made at its place: the index of
    /// a sample and the place of its word in `produced` differ by one constant.
    ///
    /// # Panics
    /// Naming the first sample that is not.
    pub fn assert_follows(&self, produced: &[[u32; AXES]]) {
        let (first, codes, _) = self.samples[0];
        let start = produced
            .windows(4)
            .position(|w| w[0] == codes && w[1] == self.samples[1].1)
            .expect("the first samples are among the words produced") as u64;
        for (index, codes, _) in &self.samples {
            let made = produced[(index - first + start) as usize];
            assert_eq!(*codes, made, "sample {index} is not the converters' word");
        }
    }
}
