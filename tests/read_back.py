"""Reads a run that the test `a_run_for_other_readers` wrote, with numpy, with VTK itself and with csv, and compares
every number bit by bit with the bare numbers (*.raw) beside it; runs the programs of docs/guide/results.md there. Exits with 1 if
anything differs.

Usage: read_back.py FOLDER
"""

import contextlib
import csv
import json
import pathlib
import re
import sys
import xml.etree.ElementTree

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

UNITS = {"pressure": "Pa", "displacement": "m", "gap": "m", "traction": "Pa"}
checks, differences = 0, 0


def check(what, same):
    """Counts a comparison and tells of one that fails."""
    global checks, differences
    checks += 1
    if not same:
        differences += 1
        print(f"differs: {what}", file=sys.stderr)


def same_bits(found, expected):
    """Whether two arrays are equal in shape and in every bit."""
    found, expected = numpy.asarray(found), numpy.asarray(expected)
    return (
        found.dtype == numpy.float64
        and found.shape == expected.shape
        and numpy.ascontiguousarray(found).tobytes() == numpy.ascontiguousarray(expected).tobytes()
    )


def check_archive(folder, frame, raw, shape, scene):
    with numpy.load(folder / f"{frame}.npz", allow_pickle=False) as archive:
        names = {"time", "x1", "x2", "approach", "force", "tilt", "contact_area", "metadata", *UNITS}
        check(f"{frame}.npz: names", set(archive.files) == names)
        for name in names - {"metadata"}:
            expected = raw(name)
            if name in UNITS:
                expected = expected.reshape(shape)
            elif name not in ("x1", "x2", "tilt"):
                expected = expected.reshape(())
            check(f"{frame}.npz: {name}", same_bits(archive[name], expected))
        check(f"{frame}.npz: scene", json.loads(str(archive["metadata"])) == scene)
    gap = numpy.load(folder / f"{frame}.npy", allow_pickle=False)
    check(f"{frame}.npy", same_bits(gap, raw("gap").reshape(shape)))


def read(reader, path):
    """What VTK finds in a file, which it must know as one of its own and read without errors."""
    failures = []
    reader.AddObserver("ErrorEvent", lambda *event: failures.append(event))
    check(f"{path.name}: CanReadFile", reader.CanReadFile(str(path)))
    reader.SetFileName(str(path))
    reader.Update()
    check(f"{path.name}: read without errors", not failures)
    return reader.GetOutput()


def check_image(path, raw, shape, scene):
    frame = path.name
    reader = vtk.vtkXMLImageDataReader()
    image = read(reader, path)
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    check(f"{frame}: dimensions", image.GetDimensions() == (shape[0] + 1, shape[1] + 1, 1))
    check(f"{frame}: number of cells", image.GetNumberOfCells() == shape[0] * shape[1])
    cells, state = image.GetCellData(), image.GetFieldData()
    check(f"{frame}: arrays", cells.GetNumberOfArrays() == len(UNITS) and state.GetNumberOfArrays() == 6)
    for name, unit in UNITS.items():
        # x runs fastest in VTK, the last axis in numpy
        found = vtk_to_numpy(cells.GetArray(f"{name} [{unit}]")).reshape(shape[::-1]).T
        check(f"{frame}: {name}", same_bits(found, raw(name).reshape(shape)))
    numbers = {
        "TimeValue": "time",
        "approach [m]": "approach",
        "force [N]": "force",
        "tilt [rad]": "tilt",
        "contact area [m2]": "contact_area",
    }
    for name, other in numbers.items():
        check(f"{frame}: {name}", same_bits(vtk_to_numpy(state.GetArray(name)).ravel(), raw(other)))
    check(f"{frame}: time steps of the pipeline", times is None or tuple(times) == tuple(raw("time")))
    check(f"{frame}: scene", json.loads(state.GetAbstractArray("metadata").GetValue(0)) == scene)
    # cells lie where they belong: the one that VTK finds at a centre is the one of this centre
    x1, x2 = raw("x1"), raw("x2")
    for i in range(shape[0]):
        for j in range(shape[1]):
            cell = image.FindCell([x1[i], x2[j], 0.0], None, -1, 1e-12, vtk.reference(0), [0.0] * 3, [0.0] * 8)
            check(f"{frame}: cell at ({x1[i]}, {x2[j]})", cell == j * shape[0] + i)


def check_stress(path, raw, shape, scene):
    frame = path.name
    volume, depths = read(vtk.vtkXMLRectilinearGridReader(), path), raw("depths")
    size = (*shape, len(depths))
    check(f"{frame}: dimensions", volume.GetDimensions() == size)
    axes = [volume.GetXCoordinates(), volume.GetYCoordinates(), volume.GetZCoordinates()]
    for axis, name in zip(axes, ["x1", "x2", "depths"]):
        check(f"{frame}: {name}", same_bits(vtk_to_numpy(axis), raw(name)))
    points, state = volume.GetPointData(), volume.GetFieldData()
    check(f"{frame}: arrays", points.GetNumberOfArrays() == 3 and state.GetNumberOfArrays() == 2)
    for name, other in [("von Mises stress [Pa]", "von_mises"), ("Tresca stress [Pa]", "tresca")]:
        found = vtk_to_numpy(points.GetArray(name)).reshape(size[::-1])
        # planes of fields, in which x2 is fastest
        check(f"{frame}: {name}", same_bits(found.transpose(0, 2, 1), raw(other).reshape(size[2], *shape)))
    tensor = vtk_to_numpy(points.GetArray("stress [Pa]"))
    check(f"{frame}: components", tensor.shape == (size[0] * size[1] * size[2], 6))
    expected = raw("stress").reshape(size[2], *shape, 6).transpose(0, 2, 1, 3).reshape(-1, 6)
    # VTK: xx, yy, zz, xy, yz, xz
    check(f"{frame}: stress", same_bits(tensor, expected[:, [0, 1, 2, 3, 5, 4]]))
    # by VTK's own arithmetic, from the tensor at a point that VTK finds: the invariants
    middle = [raw("x1")[shape[0] // 2], raw("x2")[shape[1] // 2], depths[1]]
    row = volume.FindPoint(middle)
    check(f"{frame}: place of the middle", tuple(volume.GetPoint(row)) == tuple(middle))
    xx, yy, zz, xy, yz, xz = tensor[row]
    matrix = numpy.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    principal = numpy.linalg.eigvalsh(matrix)
    found = vtk_to_numpy(points.GetArray("Tresca stress [Pa]"))[row]
    check(f"{frame}: Tresca of the tensor", abs(found - (principal[2] - principal[0])) <= 1e-12 * abs(principal).max())
    check(f"{frame}: time", same_bits(vtk_to_numpy(state.GetArray("TimeValue")).ravel(), raw("time")))
    told = json.loads(state.GetAbstractArray("metadata").GetValue(0))
    check(f"{frame}: scene", all(told.get(key) == value for key, value in scene.items() if key != "notes"))


def check_history(folder, frames, raws, scene):
    with open(folder / "history.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    check("history.csv: scene", json.loads((folder / "history.csv.json").read_text(encoding="utf-8")) == scene)
    check("history.csv: rows", len(rows) == len(frames))
    columns = {"time [s]": "time", "force [N]": "force", "approach [m]": "approach", "contact area [m2]": "contact_area"}
    for row, raw in zip(rows, raws):
        for column, name in columns.items():
            check(f"history.csv: {column}", same_bits([float(row[column])], raw(name)))
        check("history.csv: max pressure", float(row["max pressure [Pa]"]) == raw("pressure").max())
        check("history.csv: own column", float(row["twice, force [N]"]) == 2.0 * float(row["force [N]"]))


def check_guide(folder, raws):
    """The programs of the guide, one after the other as a reader would run them, and what they leave in their names."""
    page = (pathlib.Path(__file__).parent.parent / "docs" / "guide" / "results.md").read_text(encoding="utf8")
    programs = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    check("guide: programs", len(programs) == 3)
    names = {}
    with contextlib.chdir(folder):
        for program in programs:
            exec(program, names)
    check("guide: pandas", same_bits(names["history"]["force [N]"], [raw("force")[0] for raw in raws]))
    check("guide: times", same_bits(names["times"], [raw("time")[0] for raw in raws]))
    check("guide: maximum pressures", same_bits(names["maximum"], [raw("pressure").max() for raw in raws]))
    check("guide: PyVista", names["image"].n_cells == raws[-1]("pressure").size)
    force = names["pressure"].sum() * names["cell"]
    check("guide: force", abs(force / raws[-1]("force")[0] - 1.0) < 1e-9)


def main():
    folder = pathlib.Path(sys.argv[1])
    *shape, count = map(int, (folder / "shape.txt").read_text().split())
    scene = json.loads((folder / "scene.json").read_text(encoding="utf-8"))
    frames = [f"frame_{k:06}" for k in range(count)]
    raws = [lambda name, frame=frame: numpy.fromfile(folder / f"{frame}.{name}.raw", dtype="<f8") for frame in frames]

    collection = xml.etree.ElementTree.parse(folder / "series.pvd").getroot().findall("Collection/DataSet")
    check("series.pvd: files", [entry.get("file") for entry in collection] == [f"{frame}.vti" for frame in frames])
    for frame, raw, entry in zip(frames, raws, collection):
        check(f"series.pvd: time of {frame}", same_bits([float(entry.get("timestep"))], raw("time")))
        check_archive(folder, frame, raw, shape, scene)
        check_image(folder / entry.get("file"), raw, shape, scene)
        check_stress(folder / f"{frame}.vtr", raw, shape, scene)
    check_history(folder, frames, raws, scene)
    check_guide(folder, raws)
    check("leftovers", not list(folder.glob("*.part")))

    print(f"{checks} comparisons with numpy {numpy.__version__} and VTK {vtk.vtkVersion.GetVTKVersion()}: {differences} differ")
    sys.exit(1 if differences or count == 0 else 0)


if __name__ == "__main__":
    main()
