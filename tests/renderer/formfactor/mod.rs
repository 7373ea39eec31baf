//! Form factors through the whole renderer: sample sets, and closed forms of near pairs.

mod near_pairs;
mod sample_sets;
