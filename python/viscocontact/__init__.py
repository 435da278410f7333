"""Contact of viscoelastic bodies: pressure, contact area and approach over time, for any shape and load history.

Lengths are in m, forces in N, moduli and pressures in Pa, times in s. Fields are arrays of the shape of their grid, x1 along the first
axis. Pressure is positive in compression, displacement positive into the bodies, and the gap positive when open.

>>> import viscocontact as vc
>>> grid = vc.Grid(64, 4e-3)
>>> contact = vc.ViscoelasticContact(grid, vc.Shape.sphere(10e-3), vc.Material(vc.Rheology.maxwell(1e6, 1.0)))
>>> for report in contact.follow(vc.Load.force(1.0), until=2.0):
...     area = contact.contact_area
>>> contact.pressure.shape
(64, 64)

Errors are ValueError, TypeError, OSError, MemoryError, NotImplementedError (a combination that is not covered), `ConvergenceError`, `Cancelled` and
RuntimeError (an object that is computing meanwhile), with the value, the range allowed and the remedy. An exception of a function that you
wrote comes out as itself.
"""

from viscocontact import _adapters, _native
from viscocontact._native import *  # noqa: F403

_adapters.attach()

__all__ = [name for name in dir(_native) if not name.startswith("_")]
__version__ = _native.__version__
