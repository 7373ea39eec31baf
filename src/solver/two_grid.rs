//! Two-grid correction: the further bounces of a residual, solved between a few hundred groups of rows.
//!
//! Brakhage 1960, "Über die numerische Behandlung von Integralgleichungen nach der Quadraturformelmethode", Numerische
//! Mathematik 2:183–196; Atkinson 1976, "A survey of numerical methods for the solution of Fredholm integral equations of
//! the second kind", SIAM: unshot radiosity r reflects on and on, and since reflecting smooths, means over groups tell its
//! further bounces well. They only improve the start of a sweep: their error is in the next residual.

use super::rows::Rows;
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use std::collections::HashMap;

/// Groups that large scenes are divided into, about: their matrix is then as small as one row in a hundred of all.
const GROUPS: usize = 192;

/// A group's factors are added up again once one in so many of its samples has changed.
const STALE: usize = 16;

/// Rounds between the groups, at most; more show up in the next residual.
const ROUNDS: usize = 64;

/// Rounds end when none changes any group by more than this share of the largest.
const SETTLED: f32 = 1e-3;

/// The groups and the factors between them.
#[derive(Clone, Debug, Default)]
pub(super) struct TwoGrid {
    /// The group of each row, and one more for misses.
    of: Vec<u16>,
    members: Vec<Vec<u32>>,
    /// Mean factors, groups × (groups + 1).
    factors: Vec<f32>,
    /// Samples that changed in each group since its factors were added up.
    changed: Vec<u32>,
}

impl TwoGrid {
    /// Divides rows; those with one key lie in one plane or surface. Factors are not known yet.
    pub(super) fn of(keys: &[u64]) -> TwoGrid {
        let size = keys.len().div_ceil(GROUPS).max(1);
        let mut counts: HashMap<u64, usize> = HashMap::new();
        keys.iter()
            .for_each(|key| *counts.entry(*key).or_default() += 1);
        let mut open: HashMap<u64, usize> = HashMap::new();
        let mut members: Vec<Vec<u32>> = Vec::new();
        for (row, key) in keys.iter().enumerate() {
            // Small surfaces that follow one another share a group.
            let key = if 4 * counts[key] < size {
                u64::MAX
            } else {
                *key
            };
            let group = match open.get(&key) {
                Some(group) if members[*group].len() < size => *group,
                _ => {
                    members.push(Vec::new());
                    open.insert(key, members.len() - 1);
                    members.len() - 1
                }
            };
            members[group].push(row as u32);
        }
        let mut of = vec![members.len() as u16; keys.len() + 1];
        for (group, rows) in members.iter().enumerate() {
            rows.iter().for_each(|row| of[*row as usize] = group as u16);
        }
        TwoGrid {
            of,
            factors: vec![0.0; members.len() * (members.len() + 1)],
            changed: vec![u32::MAX; members.len()],
            members,
        }
    }

    /// Takes note of samples that changed.
    pub(super) fn note(&mut self, rows: &Rows, changed: &[(u32, u32)]) {
        for (sample, _) in changed {
            if let Some(group) = self.of.get(*sample as usize / rows.stride()) {
                let count = &mut self.changed[*group as usize];
                *count = count.saturating_add(1);
            }
        }
    }

    /// Adds up the factors of groups of which too much has changed.
    fn refresh(&mut self, rows: &Rows, area: &[f32]) {
        let width = self.members.len() + 1;
        let of = &self.of;
        let groups = (
            self.factors.par_chunks_mut(width),
            &mut self.changed,
            &self.members,
        );
        groups
            .into_par_iter()
            .for_each(|(factors, changed, members)| {
                let samples: usize = members.iter().map(|i| rows.row(*i as usize).len()).sum();
                if (*changed as usize) * STALE <= samples {
                    return;
                }
                *changed = 0;
                factors.fill(0.0);
                let all: f32 = members.iter().map(|i| area[*i as usize]).sum();
                for &i in members {
                    let weight =
                        area[i as usize] / all.max(f32::MIN_POSITIVE) * rows.share[i as usize];
                    for id in rows.row(i as usize).iter() {
                        factors[of[(id as usize).min(of.len() - 1)] as usize] += weight;
                    }
                }
            });
    }

    /// The irradiance that each row will have received once `unshot` has reflected on and on, about.
    pub(super) fn correction(
        &mut self,
        rows: &Rows,
        area: &[f32],
        reflectance: &[Vec3],
        unshot: &[Vec3],
    ) -> Vec<Vec3> {
        self.refresh(rows, area);
        let arrives = self.solve(&self.means(area, unshot), &self.means(area, reflectance));
        let rows = self.of[..self.of.len() - 1].iter();
        rows.map(|group| arrives[*group as usize].into()).collect()
    }

    /// Mean value of each group, weighted by area.
    fn means(&self, area: &[f32], values: &[Vec3]) -> Vec<Vec3A> {
        let mean = |members: &Vec<u32>| {
            let members = || members.iter().map(|i| *i as usize);
            let all: f32 = members().map(|i| area[i]).sum();
            let sum: Vec3 = members().map(|i| values[i] * area[i]).sum();
            (sum / all.max(f32::MIN_POSITIVE)).into()
        };
        self.members.iter().map(mean).collect()
    }

    /// Irradiance of each group once what all have to give has reflected on and on, by Gauss and Seidel's iteration.
    fn solve(&self, given: &[Vec3A], reflectance: &[Vec3A]) -> Vec<Vec3A> {
        let (groups, width) = (given.len(), self.members.len() + 1);
        let mut light = given.to_vec();
        let mut arrives = vec![Vec3A::ZERO; groups];
        for _ in 0..ROUNDS {
            let (mut step, mut most) = (0.0f32, 0.0f32);
            for group in 0..groups {
                let row = &self.factors[group * width..group * width + groups];
                arrives[group] = gathered(row, &light);
                let new = given[group] + reflectance[group] * arrives[group];
                step = step.max((new - light[group]).abs().max_element());
                most = most.max(new.abs().max_element());
                light[group] = new;
            }
            if step <= SETTLED * most {
                break;
            }
        }
        arrives
    }
}

/// Σ factor × light, in four strands.
fn gathered(factors: &[f32], light: &[Vec3A]) -> Vec3A {
    let mut strands = [Vec3A::ZERO; 4];
    for (factors, light) in factors.chunks(4).zip(light.chunks(4)) {
        for ((strand, factor), light) in strands.iter_mut().zip(factors).zip(light) {
            *strand += *light * *factor;
        }
    }
    (strands[0] + strands[1]) + (strands[2] + strands[3])
}
