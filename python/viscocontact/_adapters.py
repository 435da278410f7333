"""Results in pandas, xarray and matplotlib, and maps of SurfaceTopography: each is imported where it is asked for."""

import importlib

import numpy as np

native = importlib.import_module("viscocontact._native")

UNITS = {
    "time": "s", "dt": "s", "force": "N", "approach": "m", "contact_area": "m²", "pressure": "Pa", "gap": "m", "displacement": "m",
    "traction": "Pa", "heights": "m", "level": "m²", "stiffness": "m", "area": "m²", "velocity1": "m/s", "velocity2": "m/s",
    "temperature": "K", "lateral_force1": "N", "lateral_force2": "N", "mean_gap": "m", "dissipation": "W", "depth": "m",
}
FIELDS = ("pressure", "gap", "displacement", "traction")
# metres in a unit of SurfaceTopography
METRES = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "nm": 1e-9, "pm": 1e-12, "Å": 1e-10, "km": 1e3}


def _label(name):
    unit = UNITS.get(name)
    return f"{name.replace('_', ' ')} [{unit}]" if unit else name.replace("_", " ")


def _axes(ax):
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.subplots(layout="constrained")[1]
    return ax


def _columns(self):
    """The columns of a table, by name."""
    if isinstance(self, native.SlidingTable):
        return self.columns()
    if isinstance(self, native.Fit):
        names = ("name", "value", "deviation", "scale", "limit")
        rows = {name: [getattr(estimate, name) for estimate in self.estimates] for name in names}
        return rows | {"low": [each.interval[0] for each in self.estimates], "high": [each.interval[1] for each in self.estimates]}
    if isinstance(self, native.Recording):
        given = {name: self.column(name) for name in ("time", "force", "deflection", "drive", "depth")}
        return {name: values for name, values in given.items() if values is not None}
    if isinstance(self, native.Curve):
        return {"time": self.experiment.times, "drive": self.experiment.drive, "force": self.force}
    return self.table()


def to_dataframe(self):
    """The table as a `pandas.DataFrame`, a column for each name; of a run it goes on to its end."""
    import pandas

    return pandas.DataFrame(_columns(self))


def to_xarray(self):
    """The fields as an `xarray.Dataset` over the centres of the cells x1 and x2 [m], with units; of a map its heights."""
    import xarray

    is_map = isinstance(self, native.HeightMap)
    names = ("heights",) if is_map else FIELDS
    grid = self.grid if hasattr(self, "grid") else self.fields.grid
    places = [values.ravel() for values in grid.coordinates()]
    if is_map:
        places = [values + center for values, center in zip(places, self.center)]
    axes = {name: (name, values, {"units": "m"}) for name, values in zip(("x1", "x2"), places)}
    fields = {name: (("x1", "x2"), getattr(self, name), {"units": UNITS[name]}) for name in names}
    return xarray.Dataset(fields, axes)


def _plot_field(self, ax, name):
    grid = self.grid if hasattr(self, "grid") else self.fields.grid
    (x1, x2), values = (side.ravel() for side in grid.coordinates()), np.asarray(getattr(self, name))
    image = ax.pcolormesh(x1 * 1e3, x2 * 1e3, np.where(np.isfinite(values), values, np.nan).T, shading="nearest")
    ax.set(xlabel="x1 [mm]", ylabel="x2 [mm]", aspect="equal")
    ax.figure.colorbar(image, ax=ax, label=_label(name))


def plot(self, what=None, *, ax=None, **style):
    """Draws by matplotlib, on the axes `ax` or new ones, which it returns.

    Of fields and maps `what` is drawn as a map: "pressure" by default, "gap", "displacement", "traction" or "heights". Of tables it is
    the column over the first one (of a sweep "friction" over the speed), of curves the force over time; `style` goes to `Axes.plot`.
    """
    if hasattr(self, "pressure") or isinstance(self, native.HeightMap):
        names = ("heights",) if isinstance(self, native.HeightMap) else FIELDS
        if (what or names[0]) not in names:
            raise ValueError(f"what = {what!r} is not a field: it must be one of {', '.join(names)}")
        ax = _axes(ax)
        _plot_field(self, ax, what or names[0])
        return ax
    ax = _axes(ax)
    columns = _columns(self)
    if isinstance(self, native.SlidingTable):
        columns = {"speed": np.hypot(columns["velocity1"], columns["velocity2"])} | columns
        ax.set_xscale("log")
    x, *others = columns
    default = {"SlidingTable": "friction", "Recording": "force", "Curve": "force"}.get(type(self).__name__, others[0])
    if (what or default) not in columns:
        raise ValueError(f"what = {what!r} is not a column: it must be one of {', '.join(others)}")
    ax.plot(columns[x], columns[what or default], **style)
    ax.set(xlabel="speed [m/s]" if x == "speed" else _label(x), ylabel=_label(what or default))
    return ax


def _plot_fit(self, curve=0, *, ax=None, **style):
    """Draws the measured and the fitted force of a curve over time by matplotlib, on the axes `ax` or new ones, which it returns."""
    ax, (fitted, residual), time = _axes(ax), self.force(curve), self.samples(curve)["time"]
    ax.plot(time, fitted + residual, ".", label="measured")
    ax.plot(time, fitted, label="fitted", **style)
    ax.set(xlabel="time [s]", ylabel="force [N]")
    ax.legend()
    return ax


def from_topography(topography):
    """The map of a topography of SurfaceTopography: its heights, sides and periodicity, in m by the unit that it has.

    Raises ValueError if it has no unit that is a length: `topography.scale` or `HeightMap(heights, lengths)` in m then.
    """
    unit = getattr(topography, "unit", None)
    if unit not in METRES:
        raise ValueError(f"unit = {unit!r} of the topography is not known: it must be one of {', '.join(METRES)}")
    metres, heights = METRES[unit], np.ma.filled(np.ma.asarray(topography.heights(), float), np.nan)
    lengths = [side * metres for side in topography.physical_sizes]
    return native.HeightMap(heights * metres, lengths, bool(getattr(topography, "is_periodic", False)))


ROW = ("time", "dt", "force", "approach", "convolution_equivalents", "residual", "contact_cells", "time_error", "iterations", "fallback_iterations", "warnings")


def as_dict(self):
    """The numbers by name, with "tilt1" and "tilt2": a row of a `pandas.DataFrame`. Areas are those of the contact: `Run.table` has them."""
    return {name: getattr(self, name) for name in ROW} | {"tilt1": self.tilt[0], "tilt2": self.tilt[1]}


def history_to_dataframe(self):
    """The rows written so far as a `pandas.DataFrame`, the same numbers bit by bit."""
    import pandas

    # later ones read every digit by default
    exact = {"float_precision": "round_trip"} if int(pandas.__version__.split(".")[0]) < 3 else {}
    return pandas.read_csv(self.path, **exact)


def attach():
    """Gives the classes their methods."""
    tables = (native.Run, native.SlidingTable, native.ElasticStates, native.Recording, native.Curve)
    fields = (native.ViscoelasticContact, native.ElasticContact, native.SteadySliding, native.Fields, native.HeightMap)
    for kind in (*tables, native.Fit):
        kind.to_dataframe = to_dataframe
    for kind in fields:
        kind.to_xarray = to_xarray
    for kind in (*tables, *fields):
        kind.plot = plot
    native.Fit.plot = _plot_fit
    native.StepReport.as_dict = as_dict
    native.CsvHistory.to_dataframe = history_to_dataframe
    native.HeightMap.from_topography = staticmethod(from_topography)
