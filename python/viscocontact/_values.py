"""The values of calls: how objects were made, which is what they show, pickle and compare."""

import copy

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
