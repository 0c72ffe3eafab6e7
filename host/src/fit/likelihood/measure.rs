//! What a fit costs at full size; run by hand:
//! `cargo test --release -p inm-host --lib likelihood::measure -- --ignored --nocapture`

use std::time::Instant;

use super::components::unit_expectations;
use super::{Data, maximise, terms};
use crate::fit::design::Design;
use crate::model::published::{DURATION_S, PublishedAxis, RATE_HZ};
use crate::model::whole::Model;
use crate::simulate::source::Simulation;
use crate::spectrum::{Cascade, Estimate, Settings};

#[test]
#[ignore = "a measurement"]
fn speed() {
    let length = (DURATION_S * RATE_HZ) as u64;
    let mut simulation = Simulation::new(&Model::published(Some(PublishedAxis::X)), length, 1)
        .expect("a sound model");
    let mut cascade = Cascade::default();
    loop {
        let samples = simulation.next_columns(8192).remove(0);
        if samples.is_empty() {
            break;
        }
        cascade
            .push_values(cascade.next_index(), &samples)
            .expect("in order");
    }
    for _ in 0..3 {
        let start = Instant::now();
        let estimate = Estimate::new(&cascade, RATE_HZ, &Settings::default());
        let bins = start.elapsed();
        let design = Design::new(RATE_HZ, None);
        let start = Instant::now();
        let data = Data::new(&estimate, 1.0).expect("bins");
        let components = unit_expectations(&estimate, &design);
        let prepared = start.elapsed();
        let start = Instant::now();
        maximise(&data, &components).expect("a fit");
        let maximum = start.elapsed();
        let start = Instant::now();
        terms::fit(&cascade, &estimate, 1.0, &design).expect("a fit");
        println!(
            "estimate of {} bins {bins:.1?}; data and components {prepared:.1?}; maximum \
             {maximum:.1?}; five terms with intervals, tests and planning {:.1?}",
            data.len(),
            start.elapsed()
        );
    }
}
