//! The tables and the figure of the paper again.

pub mod fig1;
pub mod table1;
mod table1_picture;
mod table1_text;
pub mod table2;
mod table2_text;
