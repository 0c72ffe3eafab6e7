//! The estimators by their definition, strided and with gaps, in 256-bit integers; and codes to
//! try them on.

use inm_allan::Statistic;

pub const ALL: [Statistic; 3] = [Statistic::Allan, Statistic::Modified, Statistic::Hadamard];

/// A record: runs of codes, each with the absolute index of its first sample.
pub type Runs = Vec<(u64, Vec<i32>)>;

/// Every averaging time of the grid up to `longest`, with its stride.
pub fn grid(longest: u64) -> Vec<(u64, u64)> {
    let octaves = (0..).flat_map(|k| [4, 5, 6, 7].map(|quarter| quarter << k));
    let all = [1, 2, 3].into_iter().chain(octaves);
    all.map(|m: u64| {
        let mut stride = 1;
        while m > 40 * stride {
            stride *= 2;
        }
        (m, stride)
    })
    .take_while(|&(m, _)| m <= longest)
    .collect()
}

/// Sum of squared differences that end at multiples of `stride`, and how many they are, straight
/// from sums over the samples. 128 bits hold it for the records of these tests.
pub fn direct(statistic: Statistic, runs: &Runs, m: u64, stride: u64) -> (u128, u64) {
    let (mut total, mut terms) = (0_u128, 0);
    for (start, codes) in runs {
        let mut single = vec![0_i128];
        let mut double = vec![0_i128];
        for &code in codes {
            double.push(double.last().unwrap() + single.last().unwrap());
            single.push(single.last().unwrap() + i128::from(code));
        }
        let at = |sums: &[i128], end: usize, lags: u64| sums[end - (lags * m) as usize];
        let span = statistic.span(m) as usize;
        for end in (span..=codes.len()).filter(|&end| (start + end as u64).is_multiple_of(stride)) {
            let second = |s: &[i128]| at(s, end, 0) - 2 * at(s, end, 1) + at(s, end, 2);
            let third =
                |s: &[i128]| at(s, end, 0) - 3 * at(s, end, 1) + 3 * at(s, end, 2) - at(s, end, 3);
            let difference = match statistic {
                Statistic::Allan => second(&single),
                Statistic::Modified => third(&double),
                Statistic::Hadamard => third(&single),
            };
            total = total
                .checked_add(difference.unsigned_abs().checked_pow(2).unwrap())
                .unwrap();
            terms += 1;
        }
    }
    (total, terms)
}

/// The factor between the mean square of differences and the variance.
pub fn normalisation(statistic: Statistic, m: u64) -> f64 {
    let m = m as f64;
    match statistic {
        Statistic::Allan => 2.0 * m * m,
        Statistic::Modified => 2.0 * (m * m) * (m * m),
        Statistic::Hadamard => 6.0 * m * m,
    }
}

/// Codes that strain the arithmetic, by kind.
pub fn adversarial(kind: u8, len: usize, seed: u64) -> Vec<i32> {
    let mut state = seed.wrapping_mul(2).wrapping_add(1);
    let mut random = || {
        // xorshift64* (Vigna 2016).
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 32) as i32
    };
    let period = 1 + (seed % 97) as usize;
    (0..len)
        .map(|i| match kind % 7 {
            0 => [i32::MIN, i32::MAX][i / period % 2],
            1 => i32::MIN,
            2 => i32::MAX,
            3 => (i as i32).wrapping_mul(12_345_678),
            4 => random(),
            5 => random() >> 20,
            _ => 1_000_000_000 + (random() >> 28),
        })
        .collect()
}
