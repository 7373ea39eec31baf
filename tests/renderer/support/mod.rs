//! What tests of several rooms share.

pub(crate) mod all_features;
pub(crate) mod compress;
pub(crate) mod damage;
pub(crate) mod exercise;
pub(crate) mod flight;
pub(crate) mod program;
pub(crate) mod property;
pub(crate) mod run;
pub(crate) mod sample_sets;
pub(crate) mod scene;
#[cfg(target_os = "linux")]
pub(crate) mod slurm;
pub(crate) mod specular;
