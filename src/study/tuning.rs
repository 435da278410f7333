//! The numbers by which a study proceeds, chosen on the scenes of `tests/validation/study_random.rs` and
//! `study_kernels.rs`; docs/maintainers/tuned_numbers.md says what comes of half and of twice each.

/// Parts are of the accuracy that is asked for.
pub(super) struct Tuning {
    /// Cells across the widest contact on the first mesh, and across a domain that is given.
    pub(super) across: f64,
    pub(super) across_given: f64,
    /// How many times as fine the next mesh is: after the first one, or where a mesh does not resolve the attraction,
    /// and at least and at most.
    pub(super) ratio: f64,
    pub(super) ratios: [f64; 2],
    /// Part of what is left to the mesh at which the next mesh aims.
    pub(super) aim: f64,
    /// Part for the error in time, and at which shorter steps aim; and the tolerance of steps to begin with.
    pub(super) in_time: f64,
    pub(super) aim_in_time: f64,
    pub(super) tolerance: f64,
    /// Ratio of the tolerances of two runs whose difference is the error in time of the first.
    pub(super) shorter: f64,
    /// Tolerances of adaptive steps, and the ratio of those of finer meshes, whose steps end where those of the first
    /// do.
    pub(super) tolerances: [f64; 2],
    pub(super) on_finer: f64,
    /// Part that is left to pressure fields in time, and the least error in time that is asked of them.
    pub(super) of_fields: f64,
    pub(super) least_of_fields: f64,
    /// Part for the residual of the solver, relative to the displacement, far below the errors of mesh and time; and
    /// for the series of a body that has none.
    pub(super) of_solver: f64,
    pub(super) of_series: f64,
    /// Most times that the steps are shortened, that a domain is grown, and meshes on which a quantity may not
    /// converge.
    pub(super) most_shortened: usize,
    pub(super) most_grown: usize,
    pub(super) most_unconverged: usize,
    /// A domain is made anew if the contact is narrower than the one it was found for by this factor.
    pub(super) narrower: f64,
}

pub(super) const TUNING: Tuning = Tuning {
    across: 16.0,
    across_given: 32.0,
    ratio: 1.5,
    ratios: [1.25, 2.0],
    aim: 0.7,
    in_time: 0.4,
    aim_in_time: 0.3,
    tolerance: 0.25,
    shorter: 8.0,
    tolerances: [1e-9, 0.1],
    on_finer: 2.0,
    of_fields: 0.3,
    least_of_fields: 1e-5,
    of_solver: 0.01,
    of_series: 0.1,
    most_shortened: 3,
    most_grown: 8,
    most_unconverged: 4,
    narrower: 0.75,
};
