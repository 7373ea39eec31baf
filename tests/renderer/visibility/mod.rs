//! The back-buffer and the swept volume: no sample is lost, and no sample is traced in vain.

mod bodies;
mod exact;
mod known_savings;
mod specular;
mod swept;
