//! A recording against the words that the converters made.

use std::path::Path;

use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::source::{Block, Chunk, Source, Values};
use inm_protocol::AXES;

/// Words that have to agree for the beginning to be found: noise moves some seventeen bits of one.
const AGREE: usize = 4;

/// The samples of a block.
fn codes(block: &Block) -> Vec<[u32; AXES]> {
    let code = |axis: usize, place: usize| match &block.columns[axis].values {
        Values::Codes(codes) => codes[place].cast_unsigned(),
        Values::Floats(_) => panic!("codes stay codes"),
    };
    (0..block.len())
        .map(|place| [0, 1, 2].map(|axis| code(axis, place)))
        .collect()
}

/// Checks that the capture holds every word from the first that it has to its end, and prints how many.
#[track_caller]
pub fn compare(capture: &Path, words: &[[u32; AXES]]) {
    let mut source = CaptureSource::open(capture).expect("a capture");
    let mut sent = None;
    let mut samples = 0;
    while let Some(chunk) = source.next_chunk().expect("samples") {
        let block = match chunk {
            Chunk::Samples(block) => block,
            Chunk::Gap(gap) => panic!("samples are missing: {gap:?}"),
            Chunk::News(news) => {
                println!("{news}");
                continue;
            }
        };
        let codes = codes(&block);
        // Readings are dropped until the filters have settled.
        let rest: &mut &[_] = sent.get_or_insert_with(|| {
            let begins = words
                .windows(AGREE)
                .position(|words| words == &codes[..AGREE]);
            &words[begins.expect("the first samples were sent")..]
        });
        assert_eq!(block.first, samples, "a jump of the index");
        let (these, others) = rest.split_at(codes.len());
        assert_eq!(codes, these, "from sample {samples}");
        *rest = others;
        samples += codes.len() as u64;
    }
    println!("samples an axis: {samples} recorded, each the converters' word, none missing");
    println!("{:?}", source.proof().expect("of a board"));
}
