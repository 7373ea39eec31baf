//! Results that were found several times, independently: their mean, and how far it and one of them are off.

/// Samples are drawn so often, independently: the mean's error is known from how they differ.
///
/// Owen 1997, "Scrambled net variance for integrals of smooth functions", Annals of Statistics 25(4):1541–1562: scrambled
/// samples are stratified, so that a binomial would say many times too much, and a wrong factor pass.
pub const REPEATS: u32 = 16;

/// How many standard errors, found from [`REPEATS`] results, their mean may be off: Student's t of 15 degrees of freedom,
/// which one in ten thousand right results exceeds.
pub const STUDENT: f64 = 5.24;

/// How many times the change by halving a quadrature it may be off. An error that falls as n^−p leaves 1/(2^p − 1) times
/// what the last halving changed: a third for p = 2; once for p = 1, as for disks where patches touch at an edge, since
/// there the first row of them is wrong however small. Before that is reached (p is 0.66, 0.83, 0.91, 0.95 for n = 16 to
/// 128 between squares at 30°) it is up to half as much again.
pub const HALVINGS: f64 = 1.5;

/// The mean of independent values, and its standard error, which is 0 for a single one.
pub fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0).max(1.0) / n).sqrt())
}

/// The standard deviation of one of several independent values.
pub fn deviation(values: &[f64]) -> f64 {
    mean(values).1 * (values.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_and_its_error_by_hand() {
        // 1, 2, 3, 6: squares 4 + 1 + 0 + 9 = 14 around 3, over 3 · 4.
        let (got, error) = mean(&[1.0, 2.0, 3.0, 6.0]);
        assert!(got == 3.0 && (error - (14.0f64 / 12.0).sqrt()).abs() < 1e-15);
        assert!((deviation(&[1.0, 2.0, 3.0, 6.0]) - (14.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(mean(&[7.0]), (7.0, 0.0));
    }
}
