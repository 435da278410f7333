//! Fields on other cells.

/// Carries fields to other cells.
pub(crate) trait Transfer {
    /// The cells they are carried to.
    fn cells(&self) -> [usize; 2];

    /// Whether they cover the whole grid, mirror images included.
    fn covers(&self) -> bool;

    /// A field that is zero wherever it was not computed.
    fn confined(&self, own: &[f64]) -> Vec<f64>;

    /// A field that is the convolution of `source` wherever it was not computed; zero without a source.
    fn induced(&mut self, own: &[f64], source: Option<&[f64]>) -> Vec<f64>;
}
