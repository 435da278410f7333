//! Formats of files of fields.

/// The format of files of fields, such as the frames of a [`FrameSeries`](crate::output::FrameSeries).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// NPZ archives of NumPy. Needs the feature `npy`.
    ///
    /// Frames are `frame_000000.npz` and so on. They contain `time` \[s\], the cell centres `x1` and `x2` \[m\], the
    /// chosen fields as arrays of shape (n1, n2), `approach` \[m\], `force` \[N\], `tilt` \[rad\] and `contact_area`
    /// \[m²\], all in double precision and uncompressed, and the [`Metadata`](crate::output::Metadata) as the JSON
    /// text `metadata`. In Python, without pickle:
    ///
    /// ```python
    /// frame = numpy.load("run/frame_000012.npz")
    /// matplotlib.pyplot.pcolormesh(frame["x1"], frame["x2"], frame["pressure"].T)
    /// units = json.loads(str(frame["metadata"]))["units"]
    /// ```
    #[cfg(feature = "npy")]
    Npz,
    /// Files of VTK.
    ///
    /// Frames are images `frame_000000.vti` and so on, and `series.pvd` lists them with their times. Open this file
    /// in ParaView, even while the run continues. An image is a flat sheet of n1 × n2 cells in the plane of contact,
    /// with x1 along its x. The chosen fields are cell data in double precision, named with their units, such as
    /// `pressure [Pa]`. `TimeValue` \[s\], `approach [m]`, `force [N]`, `tilt [rad]`, `contact area [m2]` and the
    /// [`Metadata`](crate::output::Metadata) as the JSON text `metadata` are field data. The gap is +∞ where the
    /// initial gap is infinite: rescale the colours to the finite range.
    ///
    /// Two frames of the same time, such as before and after a jump of the load, are both written and listed; ParaView
    /// shows one of them.
    Vtk,
}

impl Format {
    pub(super) fn extension(self) -> &'static str {
        match self {
            #[cfg(feature = "npy")]
            Format::Npz => "npz",
            Format::Vtk => "vti",
        }
    }

    /// The file of a frame.
    pub(super) fn frame(self, number: usize) -> String {
        format!("frame_{number:06}.{}", self.extension())
    }

    /// Whether it is VTK: a collection lists the frames, and the index along x1 varies fastest.
    pub(super) fn is_vtk(self) -> bool {
        self.extension() == "vti"
    }
}
