//! Where a preparation comes from: it is made, or it is in the cache.

use super::cache::{CacheFile, Keeping, KeptPreparation};
use super::effort::Effort;
use super::observer::Event;
use crate::archive::check;
use crate::error::Result;
use crate::mesh::{RadiosityMesh, Sizes};
use crate::scene::Animation;
use crate::settings::Settings;

/// Where the mesh and the static hits come from.
pub(super) enum MeshSource<'a> {
    /// They are made, and then kept in the cache, if there is one.
    Cut {
        /// How long edges may be.
        sizes: &'a Sizes,
        /// Seconds that it took to find out.
        pilot_seconds: f64,
        /// What was warned of on the way.
        warnings: Vec<String>,
        /// The file in the cache.
        cache: Option<&'a CacheFile>,
    },
    /// They are in the cache.
    Kept(Box<KeptPreparation>),
}

impl MeshSource<'_> {
    /// The mesh, with what is known of it before light is looked for.
    pub(super) fn mesh(
        &mut self,
        settings: &Settings,
        animation: &Animation,
        watch: &(dyn Fn(Event) + Sync),
    ) -> Result<(RadiosityMesh, Keeping)> {
        match self {
            MeshSource::Cut {
                sizes,
                pilot_seconds,
                warnings,
                ..
            } => {
                watch(Event::Stage {
                    name: "cut patches",
                    total: 0,
                });
                Effort::of(settings, animation, sizes).judge(settings, watch)?;
                let patches = RadiosityMesh::cut_by(animation, sizes)?;
                let keeping = Keeping {
                    counts: [patches.elements.len(), patches.sides.len()].map(|count| count as u64),
                    pilot_seconds: *pilot_seconds,
                    warnings: std::mem::take(warnings),
                    ..Keeping::default()
                };
                Ok((patches, keeping))
            }
            MeshSource::Kept(kept) => {
                let keeping = kept.begin()?;
                let patches = kept.read(|from| RadiosityMesh::restore(animation, from))?;
                let [elements, sides] = keeping.counts;
                let all = patches.elements.len() as u64;
                let fits = (patches.sides.len() as u64..=2 * all).contains(&sides);
                kept.read(|_| check(elements == all && fits, "another number of elements"))?;
                Effort::counted(settings, animation, keeping.counts).judge(settings, watch)?;
                Ok((patches, keeping))
            }
        }
    }
}
