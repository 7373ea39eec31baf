//! Files: pictures and moving pictures, and the names and numbers by which frames are asked for.
//!
//! [`pattern`] reads a name such as `dir/name_####.png`, [`output`] says which files it stands for, [`mod@file`] writes one
//! whole or not at all: [`png`] or [`exr`], the latter with a [`channel`] for each layer. It goes to its [`destination`] by
//! way of a [`part`]; a [`ledger`] sees to it that each file is written once and none that is read. A [`clip`] joins its pictures when
//! the last of them is done: as [`apng`], as [`gif`], or by [`ffmpeg`]; a
//! [`lock`] keeps other runs out, or a [`claim`] shares frames with them. The [`manifest`] knows which files are whole. [`range`] reads a list of frames, [`rate`] a frame
//! rate as a fraction. [`sky_file`] reads the picture of a sky.

pub mod apng;
pub mod channel;
pub mod claim;
pub mod clip;
pub mod destination;
pub mod exr;
pub mod ffmpeg;
pub mod file;
pub mod gif;
pub mod ledger;
pub mod lock;
pub mod manifest;
pub mod output;
pub mod part;
pub mod pattern;
pub mod png;
pub mod png_read;
pub mod range;
pub mod rate;
pub mod sky_file;
