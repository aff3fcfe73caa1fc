//! Which parameters a model has.

/// Most inputs that the caller may give.
pub const INPUTS_MAX: usize = 2;

/// Any structure `(b_{m-1} s^{m-1} + .. + b0) / (s^m + a_{m-1} s^{m-1} + .. + a0)` for a
/// `trendid_any`.
///
/// The parameters stand in this order: a_i with i ascending, b_i of each input, the constant, the
/// initial state.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Structure {
    /// Order m, 1 to 4.
    pub order: u8,
    /// Number of inputs, 1 or 2.
    pub inputs: u8,
    /// Bit i: a_i exists; an integrator has no a_0.
    pub output_terms: u8,
    /// Bit i: b_i of this input exists.
    pub input_terms: [u8; INPUTS_MAX],
    /// Not 0: there is a constant input, for the offset of a valve.
    pub constant: u8,
    /// Not 0: the error of the first position is a parameter.
    pub initial_state: u8,
}
