//! Visibility of a light without a surface from the origins of a receiver.

use super::hemisphere_hits::each_origin;
use crate::emission::punctual::PunctualLight;
use crate::emission::sampling;
use crate::formfactor::hemisphere::{ORIGINS, ReceiverSampler};
use glam::Vec3;

/// One bit for each origin that sees a light, and one for each that was traced.
///
/// ```text
///  bit   31 ········ 16 15 ········· 0
///        └── traced ──┘ └── visible ─┘     `visible` is part of `traced`; bit o and bit 16 + o are origin o
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PointMask(u32);

impl PointMask {
    /// Traces from the origins in `may`; `visible` tells whether nothing stands in the way.
    ///
    /// All of them are traced: a rule that leaves most out where the first few agree takes narrow sunlight for none. Rooms lit
    /// by the sun through a window were up to 2 % too dark or too bright by that.
    pub fn trace(may: u16, visible: impl Fn(usize) -> bool) -> PointMask {
        let seen = each_origin(may).filter(|origin| visible(*origin));
        let seen = seen.fold(0u32, |seen, origin| seen | 1 << origin);
        PointMask(u32::from(may) << ORIGINS | seen)
    }

    /// The origins that see the light.
    #[inline]
    pub fn visible(self) -> u16 {
        self.0 as u16
    }

    /// The origins that were traced.
    #[inline]
    pub fn traced(self) -> u16 {
        (self.0 >> ORIGINS) as u16
    }

    /// Whether an origin sees the light.
    #[inline]
    pub fn sees(self, origin: usize) -> bool {
        self.0 >> origin & 1 == 1
    }

    /// Number of origins in which two masks differ.
    pub fn differences(self, other: PointMask) -> u64 {
        let differ = self.0 ^ other.0;
        (differ as u16 | (differ >> ORIGINS) as u16)
            .count_ones()
            .into()
    }

    /// The origins that are traced now and have another result than in an older mask, or had none.
    pub(crate) fn news(self, old: PointMask) -> u16 {
        self.traced() & (!old.traced() | self.visible() ^ old.visible())
    }

    /// Number of origins in which masks differ from others, one by one.
    pub fn all_differences(masks: &[PointMask], others: &[PointMask]) -> u64 {
        let pairs = masks.iter().zip(others);
        pairs.map(|(a, b)| a.differences(*b)).sum()
    }
}

/// Irradiance from lights of known visibility, W/m².
///
/// Of each light it is the mean over the valid origins, as if nothing stood in between, times the visible share of the
/// traced ones. `tint` tells what clear surfaces let through of a light to an origin.
pub fn irradiance(
    lights: &[PunctualLight],
    sampler: &ReceiverSampler,
    invalid: u16,
    masks: &[PointMask],
    tint: impl Fn(&PunctualLight, usize) -> Vec3,
) -> Vec3 {
    let mut irradiance = Vec3::ZERO;
    let valid = invalid.count_zeros().max(1) as f32;
    for (light, mask) in lights.iter().zip(masks) {
        if mask.visible() == 0 {
            continue;
        }
        let share: [f32; ORIGINS] =
            std::array::from_fn(|o| light.share(sampler.point(o), sampler.stand.normal));
        let mean = each_origin(!invalid).map(|o| share[o]).sum::<f32>() / valid;
        let samples = each_origin(mask.traced());
        let arrives = |o| mask.sees(o).then(|| tint(light, o));
        let visible = sampling::visible_share(samples.map(|o| (share[o], arrives(o))));
        irradiance += light.power * (visible * mean);
    }
    irradiance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_origin_that_may_see_a_light_is_traced() {
        let edge = PointMask::trace(u16::MAX, |o| o < 8);
        assert_eq!((edge.visible(), edge.traced()), (0x00ff, 0xffff));
        let narrow = PointMask::trace(0x7fff, |o| o == 5);
        assert_eq!((narrow.visible(), narrow.traced()), (0x0020, 0x7fff));
        // Seven that see no more, and one that is not traced.
        assert_eq!(edge.differences(narrow), 8);
        assert_eq!(PointMask::trace(0, |_| true), PointMask::default());
    }
}
