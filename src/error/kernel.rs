use crate::rounded::rounded;

/// Errors of an influence kernel.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KernelError {
    /// The [`InfluenceKernel`](crate::InfluenceKernel) was made for another grid than the contact's.
    #[error("the kernel was made for {} × {} cells of {} m × {} m, the contact has {} × {} of {} m × {} m: make \
        it for the grid of the contact",
        .kernel.0[0], .kernel.0[1], rounded(.kernel.1[0], 5), rounded(.kernel.1[1], 5),
        .contact.0[0], .contact.0[1], rounded(.contact.1[0], 5), rounded(.contact.1[1], 5))]
    WrongGrid {
        /// Cells of the kernel's grid along x1 and x2, and the sides of a cell \[m\].
        kernel: ([usize; 2], [f64; 2]),
        /// Cells of the contact's grid along x1 and x2, and the sides of a cell \[m\].
        contact: ([usize; 2], [f64; 2]),
    },

    /// No two cells of the grid are so far apart as the offset of an influence coefficient.
    #[error("offset ({}, {}) in cells is not allowed: it must be in (-{}, {}) along x1 and (-{}, {}) along x2, \
        the grid having {} × {} cells",
        .offset[0], .offset[1], .cells[0], .cells[0], .cells[1], .cells[1], .cells[0], .cells[1])]
    OffsetOutsideGrid {
        /// The offset along x1 and x2, in cells.
        offset: [isize; 2],
        /// Cells of the grid along x1 and x2.
        cells: [usize; 2],
    },

    /// An influence coefficient, or the compliance of a wave, is not one that a body can have.
    #[error("the influence {of} [{}, {}] is {value:?}: it must be {allowed}", .at[0], .at[1])]
    InvalidInfluence {
        /// `coefficient` or `wave`.
        of: &'static str,
        /// Distance in cells, or wave numbers per period.
        at: [isize; 2],
        /// The value \[m\].
        value: f64,
        /// What it must be.
        allowed: &'static str,
    },

    /// The material of a contact on a [`Layer`](crate::Layer) is not the material of the layer. Kernel and material
    /// must have the same Poisson's ratio at all times; a layer on a creeping body, or against one, is not modelled.
    #[error(
        "the layer was made for a Poisson's ratio of {layer} at all times, and {what}: give both one ratio (a \
        layer takes its thickness first, then the ratio), and no body that deforms against it"
    )]
    LayerMaterial {
        /// Poisson's ratio of the layer.
        layer: f64,
        /// What the material is instead.
        what: String,
    },

    /// The datum of a line contact on a [`Layer`](crate::Layer), or of one periodic along one axis: a rigid base has
    /// none, a half-space needs one.
    #[error("the datum of a load along a line on a layer is {}: it must be {allowed}", metres(*datum))]
    LayerDatum {
        /// The datum given \[m\].
        datum: Option<f64>,
        /// What it must be.
        allowed: &'static str,
    },

    /// The operator of these influence coefficients is not positive definite: no contact on such a body is stable.
    /// Check the sign of the coefficients, and that near cells influence each other more than distant ones.
    #[error(
        "the influence coefficients are not positive definite: the minimum eigenvalue found is {} m, the maximum \
        {} m; check their signs, and that near cells influence each other more than distant ones",
        rounded(*.minimum, 3), rounded(*.maximum, 3)
    )]
    NotPositiveDefinite {
        /// Estimate of the minimum eigenvalue \[m\].
        minimum: f64,
        /// Estimate of the maximum one \[m\].
        maximum: f64,
    },

    /// The stress below the surface can be computed for half-spaces, half-spaces periodic along both axes, and line
    /// contacts. It cannot be computed for a body given by the influence on its surface, nor for a body periodic
    /// along one axis with more than one cell along it.
    #[error("the stress below the surface is not known of this body ({body}): it must be {allowed}")]
    NoStress {
        /// The kernel, as its `Display` prints it.
        body: String,
        /// The bodies of which it is known.
        allowed: &'static str,
    },
}

fn metres(datum: Option<f64>) -> String {
    datum.map_or_else(|| "absent".to_owned(), |datum| format!("{} m", rounded(datum, 5)))
}
