"""The values of calls: what is read of them, and how objects were made, which is what they show, pickle and compare."""

import copy
import warnings

import numpy as np


def own(value):
    """A value as it is now: what the caller may change later is copied, an iterator read."""
    if type(value) is tuple:
        return tuple(own(each) for each in value)
    if type(value) is list or hasattr(value, "__next__"):
        return [own(each) for each in value]
    if type(value) is dict:
        return {name: own(each) for name, each in value.items()}
    is_fixed = isinstance(value, (str, bytes)) or callable(value) or type(value).__module__.startswith("viscocontact")
    if is_fixed or not hasattr(value, "__len__"):
        return value
    try:
        return copy.copy(value)
    except Exception:  # what is read from elsewhere, as by h5py, cannot be copied, but its numbers can
        return np.array(value)


def key(value, *others):
    """Something to compare and to hash by: numbers and arrays by value, other objects by themselves."""
    if others:
        return tuple(key(each) for each in (value, *others))
    if isinstance(value, dict):
        return tuple(sorted((name, key(each)) for name, each in value.items() if each is not None))
    if isinstance(value, (str, bytes, type)) or value is None or callable(value):
        return value
    try:
        array = np.ma.filled(np.ma.asarray(value, float), np.nan)
    except (TypeError, ValueError):
        return tuple(key(each) for each in value) if isinstance(value, (list, tuple)) else value
    return array.shape, array.tobytes()


def shown(kind, maker, arguments, keywords):
    """A call in one line; of arrays their shape alone."""

    def text(value):
        words = f"<array {list(value.shape)}>" if hasattr(value, "dtype") and value.shape else repr(value)
        return words if len(words) <= 60 else words[:59] + "…"

    values = [text(value) for value in arguments]
    values += [f"{name}={text(value)}" for name, value in (keywords or {}).items() if value is not None]
    if maker == "__add__":
        return " + ".join(values)
    return f"{kind.__name__}{'.' if maker else ''}{maker}({', '.join(values)})"


def numbers(name, value):
    """An array of real numbers in the order of rows; NaN where a mask is."""
    # NumPy takes an iterator, as of `zip`, for one value
    value = list(value) if hasattr(value, "__next__") else value
    array = np.asarray(value)
    try:
        array = array.astype("float64", casting="same_kind", copy=False, order="C")
    except TypeError:
        raise TypeError(f"{name}: an array of real numbers is needed, not of {array.dtype}") from None
    return np.where(np.ma.getmaskarray(value), np.nan, array) if np.ma.isMaskedArray(value) else array


def squared(cells, lengths, only_warns):
    """Refuses sides that make squares of the cells if they are exchanged, and only then."""
    (n1, n2), (l1, l2) = cells, lengths

    def is_square(a, b):
        return abs(a * n2 / (b * n1) - 1) < 1e-3

    if is_square(l1, l2) or not is_square(l2, l1):
        return
    text = (
        f"lengths = ({l1}, {l2}) are those of the other axes: the map has {n1} points along x1 and {n2} along x2; give "
        f"lengths=({l2}, {l1}), or the other orientation, \"array\" or \"picture\""
    )
    if not only_warns:
        raise ValueError(text)
    warnings.warn(text, UserWarning, stacklevel=2)
