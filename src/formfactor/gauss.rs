//! Gauss and Legendre's points of the unit interval, plain and crowded towards its ends.
//!
//! Press, Teukolsky, Vetterling, Flannery 2007, "Numerical Recipes", 3rd edition, section 4.6: Newton's iteration on the
//! Legendre polynomial. The crowding is x = u⁴(35 − 84u + 70u² − 20u³), whose first three derivatives vanish at both
//! ends (Korobov 1963; Sidi 1993, "A new variable transformation for numerical integration", ISNM 112:359–373).

use std::f64::consts::PI;
use std::sync::OnceLock;

/// Points of a piece: with 16 the factor of touching squares is right to 1e-12 before anything is halved.
pub const NODES: usize = 16;

/// Points in 0..1 with their weights, which sum to 1: exact for polynomials up to degree 2·[`NODES`] − 1.
pub fn points() -> [(f64, f64); NODES] {
    let n = NODES as f64;
    std::array::from_fn(|i| {
        // Start from the asymptotic position of the root, and let Newton find it.
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut now, mut last) = (1.0, 0.0);
            for k in 1..=NODES {
                let k = k as f64;
                (now, last) = (((2.0 * k - 1.0) * x * now - (k - 1.0) * last) / k, now);
            }
            slope = n * (x * now - last) / (x * x - 1.0);
            x -= now / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

/// The same for integrands with a logarithm or a kink at either end.
pub fn crowded() -> &'static [(f64, f64); NODES] {
    static TABLE: OnceLock<[(f64, f64); NODES]> = OnceLock::new();
    TABLE.get_or_init(|| {
        points().map(|(u, weight)| {
            let x = u.powi(4) * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u)));
            (x, weight * 140.0 * (u * (1.0 - u)).powi(3))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_exact() {
        // ∫ x^k dx over 0..1 is 1/(k+1).
        for k in [0, 1, 2, 7, 30, 31] {
            let got: f64 = points().iter().map(|(x, w)| w * x.powi(k)).sum();
            assert!((got - 1.0 / f64::from(k + 1)).abs() < 1e-15, "x^{k}: {got}");
        }
    }

    #[test]
    fn a_logarithm_at_the_end_is_taken() {
        // ∫ x ln x dx = −1/4 and ∫ ln x dx = −1 over 0..1.
        let sum = |f: &dyn Fn(f64) -> f64| crowded().iter().map(|(x, w)| w * f(*x)).sum::<f64>();
        assert!((sum(&|x| x * x.ln()) + 0.25).abs() < 1e-11);
        assert!((sum(&f64::ln) + 1.0).abs() < 1e-7, "{}", sum(&f64::ln));
    }
}
