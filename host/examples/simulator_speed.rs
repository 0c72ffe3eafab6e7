//! Samples a second that the simulator makes, term by term, on one core: `cargo xtask bench
//! simulator` runs it.

use std::time::Instant;

use inm_host::internals::model::published::{PublishedAxis, RATE_HZ};
use inm_host::internals::model::random::Generator;
use inm_host::internals::model::whole::Model;
use inm_host::internals::model::{Coefficient, Seed};
use inm_host::internals::simulate::source::Simulation;

/// Samples of one measurement, and in one block.
const SAMPLES: usize = 1 << 24;
const BLOCK: usize = 8192;

fn main() {
    let coefficients = PublishedAxis::X.coefficients();
    let term = |coefficient: Coefficient| {
        let value = *coefficients.get(coefficient);
        let seed = Seed { seed: 1, stream: 0 };
        coefficient.term(value).generator(RATE_HZ, seed)
    };
    for coefficient in Coefficient::ALL {
        report(coefficient.name(), &mut [term(coefficient)]);
    }
    report("all five", &mut Coefficient::ALL.map(term));

    let mut model = Model::published(Some(PublishedAxis::X));
    report_whole("simulation", &model);
    model.axes[0].chain = Some("ads1281:linear+400hz".parse().expect("a chain"));
    report_whole("through the chain", &model);
}

/// All that `inm simulate` does for one axis, but writing.
fn report_whole(name: &str, model: &Model) {
    let length = SAMPLES as u64;
    let mut simulation = Simulation::new(model, length, 1).expect("a model");
    let start = Instant::now();
    while !simulation.next_columns(BLOCK)[0].is_empty() {}
    let took_s = start.elapsed().as_secs_f64();
    println!(
        "{name:20} {:6.1} million samples/s",
        SAMPLES as f64 / took_s * 1e-6
    );
}

fn report(name: &str, generators: &mut [Box<dyn Generator>]) {
    let mut samples = vec![0.0; BLOCK];
    // The best of three: other programs only ever slow it down.
    let best = (0..3)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..SAMPLES / BLOCK {
                samples.fill(0.0);
                generators
                    .iter_mut()
                    .for_each(|one| one.add_to(&mut samples));
            }
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min);
    println!(
        "{name:20} {:6.1} million samples/s",
        SAMPLES as f64 / best * 1e-6
    );
}
