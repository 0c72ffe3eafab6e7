//! Sums of products.

/// Sums that run side by side: as many as fill the vector units of today's processors twice over, since a single running
/// sum waits for each addition.
const LANES: usize = 8;

/// Sum of the products of two series, as far as both reach. The products are added in an order of its own, the same on
/// every machine.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let size = a.len().min(b.len());
    let (a, rest_a) = a[..size].as_chunks::<LANES>();
    let (b, rest_b) = b[..size].as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adds_all_products_of_any_length() {
        for size in [0_u32, 1, 7, 8, 9, 40, 1003] {
            // Whole numbers, so that the sum is exact in any order.
            let a: Vec<f64> = (0..size).map(f64::from).collect();
            let b: Vec<f64> = (0..size + 3).map(|i| f64::from(i % 5)).collect();
            let sum: u32 = (0..size).map(|i| i * (i % 5)).sum();
            assert_eq!(dot(&a, &b), f64::from(sum), "{size} values");
        }
    }
}
