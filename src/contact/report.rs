//! What one step did.

/// The outcome and the cost of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StepReport {
    /// Time at the end of the step \[s\].
    pub time: f64,
    /// Length of the step \[s\]; 0 for a jump of the load.
    pub dt: f64,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Convolutions with the influence kernel: padded transforms forth and back.
    pub convolutions: usize,
    /// Applications of the preconditioner, each on an unpadded grid of a quarter of the size.
    pub preconditioner_applications: usize,
    /// Residual reached, in the measure of [`Settings::tolerance`](crate::contact::Settings::tolerance).
    pub residual: f64,
    /// Cells in contact.
    pub contact_cells: usize,
    /// Rigid-body approach ω \[m\].
    pub approach: f64,
    /// Normal force \[N\].
    pub force: f64,
}

impl StepReport {
    /// The transforms of the step in units of one convolution, a preconditioner counting a quarter.
    pub fn convolution_equivalents(&self) -> f64 {
        self.convolutions as f64 + 0.25 * self.preconditioner_applications as f64
    }
}
