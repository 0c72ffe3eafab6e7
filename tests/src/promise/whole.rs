//! What holds of every source that opens, read to its end.

use inm_host::internals::source::{Block, Chunk, Source};

/// Reads `source` to its end or to its error, and holds each chunk to what [`Source`] says of it. No
/// more than `most` samples an axis can come of the bytes behind it.
pub fn read(source: &mut dyn Source, most: usize) {
    let axes = source.signal().axes.len();
    assert!(axes > 0);
    let rate_hz = source.signal().rate_hz;
    assert!(
        rate_hz.is_finite() && rate_hz > 0.0,
        "{rate_hz} samples a second"
    );
    for axis in &source.signal().axes {
        assert!(axis.scale.is_finite() && axis.zero.is_finite(), "{axis:?}");
    }
    let (mut end, mut samples) = (0, 0);
    loop {
        match source.next_chunk() {
            Ok(Some(Chunk::Samples(block))) => {
                check(&block, axes);
                assert!(block.first >= end, "sample {} after {end}", block.first);
                samples += block.len();
                assert!(samples <= most, "{samples} samples of {most} at most");
                end = block.end();
            }
            Ok(Some(Chunk::Gap(gap))) => {
                assert!(gap.from >= end, "a gap from {} after {end}", gap.from);
                assert!(gap.to.is_none_or(|to| to > gap.from), "{gap:?}");
                assert!(!gap.cause.is_empty());
                end = gap.to.unwrap_or(gap.from);
            }
            Ok(Some(Chunk::News(news))) => assert!(!news.is_empty()),
            Ok(None) => break,
            Err(error) => {
                assert!(!error.to_string().is_empty());
                break;
            }
        }
    }
    let _ = source.clocks();
    let _ = source.proof();
}

fn check(block: &Block, axes: usize) {
    assert_eq!(block.columns.len(), axes);
    for column in &block.columns {
        assert_eq!(column.values.len(), block.len());
        let mut free = 0;
        for run in &column.invalid {
            assert!(
                run.start >= free && run.start < run.end,
                "{:?}",
                column.invalid
            );
            free = run.end;
        }
        assert!(free <= block.len(), "{:?}", column.invalid);
    }
}
