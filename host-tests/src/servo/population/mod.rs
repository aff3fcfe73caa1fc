//! The position loop on a population of axes, drawn at random from a seed.
//!
//! | file | what |
//! |---|---|
//! | [`range`] | ranges of the whole population and of usual machines, streams of random numbers |
//! | [`family`] | the four families and their ranges |
//! | [`draw`] | one axis: what it is, and what its user knows of it |
//! | [`mod@bench`] | the axis in motion: dead time, wiring, sensor, jitter, end stops |
//! | [`sequence`] | steps, sines and rest on any positioner, and what they show |
//! | [`adaptive`] | the loop of the core: commissioning, then a positioner |
//! | [`practitioner`] | the fixed controller of a practitioner |
//! | [`search`] | its gains, searched on the axis itself |
//! | [`trial`] | one axis with all of these |
//! | [`mod@course`] | what an axis does after its commissioning, and how its loop came through it |
//! | [`changed`] | an axis whose mass changes in motion |
//! | [`handling`] | an axis that takes a load and puts it down, again and again |
//! | [`shown`] | one axis with its loop, sample by sample |
//! | [`summary`] | the figures of many axes |

pub mod adaptive;
pub mod bench;
pub mod changed;
pub mod course;
pub mod draw;
pub mod family;
pub mod handling;
pub mod practitioner;
pub mod range;
pub mod search;
pub mod sequence;
pub mod shown;
pub mod summary;
pub mod trial;
