//! A model file: refused, or written as it was read, and data can be made of it.

use inm_host::{Model, simulate};

/// Samples that are made of each: less than a block, as the promise is of the file and not of speed.
const SAMPLES: u64 = 32;

/// Reads `bytes` as a model, or as the models of a diagnosis.
pub fn keeps(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let model = match Model::from_json(text) {
        Ok(model) => model,
        Err(problem) => return assert!(!problem.is_empty()),
    };
    let written = serde_json::to_string(&model).expect("what was read can be written");
    let again = Model::from_json(&written).expect("what was written can be read");
    assert!(again == model, "{written}");
    if let Ok(mut record) = simulate(&model, SAMPLES, 1, None) {
        for column in record.next_columns(SAMPLES as usize) {
            assert_eq!(column.len() as u64, SAMPLES);
        }
    }
}
