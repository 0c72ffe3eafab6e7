use super::*;
use crate::diagnosis::detect::shock::scan::Scan;

#[test]
fn explore() {
    let Ok(list) = std::env::var("REC") else { return };
    for path in list.split(',') {
        let text = std::fs::read_to_string(path).expect("file");
        let values: Vec<f64> = text.split_whitespace().map(|v| v.parse().expect("number")).collect();
        let trial = Trial::new(values.clone());
        let proposals = trial.ask(&DETECTOR);
        println!("{path}:");
        if std::env::var("SCAN").is_ok() {
            let filled = trial.axis.filled.clone();
            let mut scan = Scan::new(&values, &filled).expect("long");
            let found = scan.stretches(trial::LEVEL, RATE_HZ);
            println!("  threshold {:.2}", scan.threshold());
            for one in found.iter().take(20) { println!("  stretch {:?} z {:.1} f {:.3} w {}", one.samples, one.z, one.frequency, one.window); }
            println!("  {} stretches", found.len());
        }
        for one in proposals {
            if let crate::diagnosis::detect::look::Proposal::Explain(one) = one {
                println!("  {:?} {:?} p {:.1e}", one.effect.kind, one.effect.values.iter().map(|v| v.map(|v| (v.value * 1000.0).round() / 1000.0)).collect::<Vec<_>>(), one.p_value);
            }
        }
    }
}
