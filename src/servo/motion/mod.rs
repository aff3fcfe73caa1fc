//! Where the axis shall be: setpoints, profiles, and the filter that follows a measured motion.

pub(crate) mod profile;
pub(crate) mod reference;
pub(crate) mod tracking_filter;
