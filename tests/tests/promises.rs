//! What every reader promises of any bytes, held with the seeds of the fuzz targets and with damaged
//! copies of them. `cargo xtask fuzz` looks on without end.

use std::fs;
use std::path::{Path, PathBuf};

use inm_tests::promise;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Damaged copies of each seed: a second's worth for all readers together.
const COPIES: u64 = 300;

/// Values that readers stumble over, beside any at random.
const NASTY: [u8; 8] = [0, 1, 0x7f, 0x80, 0xff, b'-', b'9', b'\n'];

fn seeds(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    let folder = fs::read_dir(corpus.join(target)).expect("every target has seeds");
    let mut seeds: Vec<_> = folder
        .map(|entry| {
            let path = entry.expect("an entry").path();
            let bytes = fs::read(&path).expect("a file");
            (path, bytes)
        })
        .collect();
    seeds.sort();
    assert!(!seeds.is_empty(), "{target} has no seed");
    seeds
}

/// Changes, cuts out and doubles some of the bytes.
fn damage(bytes: &mut Vec<u8>, random: &mut Pcg64) {
    for _ in 0..random.random_range(1..6) {
        if bytes.is_empty() {
            return;
        }
        let at = random.random_range(0..bytes.len());
        let end = (at + random.random_range(1..9)).min(bytes.len());
        match random.random_range(0..5) {
            0 => bytes[at] ^= 1 << random.random_range(0..8),
            1 => bytes[at] = NASTY[random.random_range(0..NASTY.len())],
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            _ => {
                let again = bytes[at..end].to_vec();
                bytes.splice(at..at, again);
            }
        }
    }
}

fn holds(target: &str) {
    let keeps = promise::of(target);
    for (path, seed) in seeds(target) {
        keeps(&seed);
        for copy in 0..COPIES {
            let mut bytes = seed.clone();
            damage(&mut bytes, &mut Pcg64::seed_from_u64(copy));
            let tried = std::panic::catch_unwind(|| keeps(&bytes));
            assert!(tried.is_ok(), "{}, copy {copy}: {bytes:?}", path.display());
        }
    }
}

/// A test for each reader, so that one that breaks names it.
macro_rules! readers {
    ($($reader:ident)*) => {
        $(#[test]
        fn $reader() {
            holds(stringify!($reader));
        })*

        #[test]
        fn every_reader_is_tried() {
            let names = promise::ALL.map(|(name, _)| name);
            assert_eq!(names, [$(stringify!($reader)),*]);
        }
    };
}

readers!(capture elf frames header model npy text);

/// Found by `cargo xtask fuzz npy`: the samples between two stamps were more than could be counted.
#[test]
fn stamps_that_jump_further_than_numbers_go_do_not_run_over() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus/npy");
    let seed = fs::read(corpus.join("stamps-jump")).expect("the seed");
    promise::of("npy")(&seed);
}

/// Found by `cargo xtask fuzz npy`: the rate of a record was no number.
#[test]
fn stamps_without_a_rate_are_refused() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus/npy");
    let seed = fs::read(corpus.join("no-rate")).expect("the seed");
    promise::of("npy")(&seed);
}
