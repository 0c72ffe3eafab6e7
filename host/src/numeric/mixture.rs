//! Weighted sums of parts, such as the expectations of a model's components.

/// Adds the parts to `totals`, each times its weight, in their order; one of weight zero is not looked
/// at. Parts and weights, totals and values of a part go in pairs as far as both reach.
pub fn add_mixture(totals: &mut [f64], parts: &[Vec<f64>], weights: &[f64]) {
    for (part, &weight) in parts.iter().zip(weights) {
        if weight == 0.0 {
            continue;
        }
        for (total, one) in totals.iter_mut().zip(part) {
            *total += weight * one;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adds_each_part_by_its_weight() {
        let mut totals = [1.0, 2.0];
        let nowhere = vec![f64::INFINITY; 2];
        let parts = [vec![1.0, 0.0], nowhere, vec![0.0, 1.0]];
        add_mixture(&mut totals, &parts, &[3.0, 0.0, 0.5]);
        assert_eq!(totals, [4.0, 2.5]);
    }
}
