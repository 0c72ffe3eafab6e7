use inm_host::fit::design::Design;
use inm_host::fit::likelihood::{Data, components, maximise, terms};
use inm_host::model::published::{PublishedAxis, RATE_HZ};
use inm_host::model::{Coefficient, PerCoefficient};
use inm_host::signal::Unit;
use inm_host::simulate::source::{SimulatedAxis, Simulation};
use inm_host::spectrum::{Cascade, Estimate, Settings};
use std::time::Instant;

fn main() {
    let axis = PublishedAxis::X;
    let mut simulation = Simulation::new(
        &[SimulatedAxis { name: "X".into(), unit: Unit::MetrePerSecondSquared, coefficients: axis.coefficients() }],
        RATE_HZ, 10_800_000, 1);
    let mut cascade = Cascade::default();
    let mut at = 0;
    let t = Instant::now();
    loop {
        let columns = simulation.next_columns(8192);
        if columns[0].is_empty() { break; }
        cascade.push_values(at, &columns[0]).unwrap();
        at += columns[0].len() as u64;
    }
    println!("simulate {:?}", t.elapsed());
    let t = Instant::now();
    let estimate = Estimate::new(&cascade, RATE_HZ, &Settings::default());
    println!("estimate {:?}: {} bins, {} nodes", t.elapsed(), estimate.bins.len(), estimate.operator.nodes_hz().len());
    let t = Instant::now();
    let design = Design::new(RATE_HZ, None);
    println!("design {:?}", t.elapsed());
    let t = Instant::now();
    let data = Data::new(&estimate, 1.0).unwrap();
    println!("data {:?}", t.elapsed());
    let t = Instant::now();
    let parts = components::unit_expectations(&estimate, &design);
    println!("components {:?}", t.elapsed());
    let t = Instant::now();
    let fit = maximise(&data, &parts).unwrap();
    println!("maximise {:?}", t.elapsed());
    let t = Instant::now();
    let five = terms::fit(&cascade, &estimate, 1.0, &design).unwrap();
    println!("terms {:?}", t.elapsed());
    let truth: PerCoefficient<f64> = axis.coefficients();
    for one in Coefficient::ALL { println!("{one:?} {:?} {:?}", truth.get(one), five.coefficients.get(one)); }
    println!("{:?}", five.tied);
    println!("{}", inm_host::fit::likelihood::information::correlation(&fit.covariance));
    for b in 0..data.len() { println!("{} {:e} {:.3} {:.3} {:.3} {:?}", b, data.f_hz[b], estimate.bins[b].edf, data.dof[b], data.psd[b]/fit.expected[b], estimate.bins[b].origin); }
}
