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

/// One in so many origins is traced first, spread over all. The others are traced only if these disagree, since the edge of
/// a shadow crosses the element there.
const FIRST: usize = 4;

impl PointMask {
    /// Traces from the origins in `may`; `visible` tells whether nothing stands in the way.
    pub fn trace(may: u16, mut visible: impl FnMut(usize) -> bool) -> PointMask {
        let mut mask = PointMask(0);
        let mut trace = |o: usize, mask: &mut PointMask| {
            mask.0 |= (1 << ORIGINS | visible(o) as u32) << o;
        };
        for o in each_origin(may).filter(|o| o % FIRST == 0) {
            trace(o, &mut mask);
        }
        let agree = mask.visible() == 0 || mask.visible() == mask.traced();
        if mask.traced().count_ones() > 1 && agree {
            return mask;
        }
        for o in each_origin(may).filter(|o| o % FIRST != 0) {
            trace(o, &mut mask);
        }
        mask
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
/// traced ones.
pub fn irradiance(
    lights: &[PunctualLight],
    sampler: &ReceiverSampler,
    invalid: u16,
    masks: &[PointMask],
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
        let visible = sampling::visible_share(samples.map(|o| (share[o], mask.sees(o))));
        irradiance += light.power * (mean * visible);
    }
    irradiance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_where_the_first_origins_disagree_the_others_are_traced() {
        let lit = PointMask::trace(u16::MAX, |_| true);
        assert_eq!((lit.visible(), lit.traced()), (0x1111, 0x1111));
        let edge = PointMask::trace(u16::MAX, |o| o < 8);
        assert_eq!((edge.visible(), edge.traced()), (0x00ff, 0xffff));
        assert_eq!(edge.differences(lit), 14);
        assert_eq!(PointMask::trace(0, |_| true), PointMask::default());
    }
}
