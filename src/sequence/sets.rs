//! Which hemisphere samples the settings ask for, those of receivers on movers included, and words on them.

use crate::error::{Error, Result};
use crate::formfactor::hemicube;
use crate::formfactor::hemisphere::{MOST_SAMPLES, ORIGINS, Set};
use crate::formfactor::near::PairRule;
use crate::settings::{HemisphereSampling, Pairs, Settings};

/// Receivers on movers trace all their samples in every frame, so they take this share of the samples: one in … The hybrid finish
/// gathers what is seen of them pixel by pixel; interpolated alone, an eighth instead of a sixteenth would lower the whole
/// image's error by a quarter in a box with a large block. It would cost a twentieth of the frame's light.
const MOVING_SHARE: usize = 16;

/// The most sides between all pairs of which formulas are taken: two million pairs, and as many times sixteen rays.
const MOST_PAIRED: usize = 2048;

/// The sets of resting receivers and of those on movers.
///
/// # Errors
/// [`Error::Usage`] where a sample's number would not fit into its 16 bits, or a hemicube cannot be halved.
pub fn chosen(settings: &Settings) -> Result<[Set; 2]> {
    let samples = settings.solve.hemisphere_samples() as usize;
    if !(ORIGINS..=MOST_SAMPLES).contains(&samples) {
        return Err(Error::Usage {
            flag: "--samples".into(),
            expected: format!("{ORIGINS} to {MOST_SAMPLES} of them"),
            got: samples.to_string(),
            way_out: "take e.g. 256".into(),
        });
    }
    let set = match (
        settings.solve.form_factors,
        settings.solve.hemicube_resolution,
    ) {
        // Pairs know nothing of the sky and of covered receivers: there samples speak.
        (
            HemisphereSampling::Cosine | HemisphereSampling::Contour | HemisphereSampling::Disks,
            _,
        ) => Set::Cosine(samples),
        (HemisphereSampling::Plane, _) => Set::Plane(samples),
        (HemisphereSampling::Hemicube, None) => Set::Hemicube(hemicube::nearest(samples)),
        (HemisphereSampling::Hemicube, Some(resolution)) => Set::Hemicube(resolved(resolution)?),
    };
    Ok([set, set.thinned(MOVING_SHARE)])
}

/// Which pairs of elements exchange light by a formula, if any do.
pub fn pair_rule(settings: &Settings) -> Option<PairRule> {
    match (settings.solve.form_factors, settings.solve.pairs) {
        (HemisphereSampling::Contour, _) => Some(PairRule::Contour),
        (HemisphereSampling::Disks, _) => Some(PairRule::Disks),
        (_, Pairs::Near) => Some(PairRule::Near),
        _ => None,
    }
}

/// Whether all pairs of elements exchange light by a formula.
pub fn takes_all_pairs(settings: &Settings) -> bool {
    pair_rule(settings).is_some_and(PairRule::takes_all)
}

/// Refuses more sides than formulas between all pairs of them can be taken for.
///
/// # Errors
/// [`Error::Usage`] with the number of sides.
pub fn pairs_fit(settings: &Settings, sides: usize) -> Result<()> {
    if !takes_all_pairs(settings) || sides <= MOST_PAIRED {
        return Ok(());
    }
    Err(Error::Usage {
        flag: "--form-factors".into(),
        expected: format!(
            "contour and disks for at most {MOST_PAIRED} sides of elements, each pair of which they look at"
        ),
        got: format!("{sides} sides"),
        way_out: "add --elements 500, or a larger --element-size, or leave the flag out".into(),
    })
}

/// Samples of a resting receiver; those that are asked for where no set can have them.
pub fn samples(settings: &Settings) -> u64 {
    let asked = settings.solve.hemisphere_samples() as usize;
    chosen(settings).map_or(asked, |[set, _]| set.samples()) as u64
}

/// A resolution that a hemicube can have.
///
/// # Errors
/// [`Error::Usage`], with the nearest that would do.
pub fn resolved(resolution: u32) -> Result<usize> {
    let given = resolution as usize;
    let (least, most) = (hemicube::LEAST, hemicube::MOST);
    if (least..=most).contains(&given) && given.is_multiple_of(2) {
        return Ok(given);
    }
    let nearest = given.clamp(least, most).next_multiple_of(2);
    Err(Error::Usage {
        flag: "--hemicube-resolution".into(),
        expected: format!("an even number of pixels from {least} to {most}"),
        got: format!("'{resolution}'"),
        way_out: format!("the nearest is --hemicube-resolution {nearest}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn movers_take_a_sixteenth() {
        let mut settings = Settings::new("x.glb");
        let sets = |settings: &Settings| chosen(settings).expect("sets").map(Set::samples);
        assert_eq!(sets(&settings), [256, 16]);
        settings.solve.form_factors = HemisphereSampling::Plane;
        assert_eq!(sets(&settings), [256, 16]);
        // The nearest to 256 of 3R², and to 300/16.
        settings.solve.form_factors = HemisphereSampling::Hemicube;
        assert_eq!(sets(&settings), [300, 48]);
        settings.solve.hemicube_resolution = Some(32);
        assert_eq!(sets(&settings), [3072, 192]);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let mut settings = Settings::new("x.glb");
        for samples in [0, 15, 65_537, u32::MAX] {
            settings.solve.samples = Some(samples);
            assert!(chosen(&settings).is_err(), "{samples}");
        }
        for (resolution, nearest) in [(0, 4), (3, 4), (9, 10), (147, 146), (u32::MAX, 146)] {
            let told = resolved(resolution).expect_err("refused").to_string();
            let way_out = format!("the nearest is --hemicube-resolution {nearest}");
            assert!(told.ends_with(&way_out), "{told}");
        }
        assert_eq!(resolved(146).ok(), Some(146));
    }
}
