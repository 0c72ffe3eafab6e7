//! The Allan deviation of a slice at octaves, with 95 % intervals.

fn main() {
    // White noise of standard deviation 1 and a slow drift under it (generator: Lehmer, NIST SP 1065).
    let mut state = 1_234_567_890_u64;
    let mut uniform = || {
        state = state * 16_807 % 2_147_483_647;
        state as f64 / 2_147_483_647.0
    };
    let samples: Vec<f64> = (0..20_000)
        .map(|i| 12.0_f64.sqrt() * (uniform() - 0.5) + 1e-5 * f64::from(i))
        .collect();

    println!("{:>6} {:>9}   95 % interval", "m", "deviation");
    for octave in inm_allan::octaves(&samples) {
        println!(
            "{:>6} {:>9.5}   {:.5} to {:.5}",
            octave.m, octave.deviation, octave.lo, octave.hi
        );
    }
}
