"""What VTK reads in a VTKHDF file, and whether the file is as the format says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest


@dataclass(frozen=True)
class Step:
    """One step as VTK has it."""

    time: float
    points: np.ndarray
    triangles: np.ndarray
    point_data: dict[str, np.ndarray]
    cell_data: dict[str, np.ndarray]


def read(path) -> list[Step]:
    """All steps, read out of order, as somebody does who looks at them."""
    hdf = pytest.importorskip("vtkmodules.vtkIOHDF", reason="VTK is not installed")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    reader = hdf.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    count = reader.GetNumberOfSteps()
    found = {}
    for number in [*range(0, count, 2), *reversed(range(1, count, 2))]:
        reader.SetStep(number)
        reader.Update()
        surface = reader.GetOutputDataObject(0)
        assert surface.GetNumberOfVerts() == surface.GetNumberOfLines() == 0
        assert surface.GetNumberOfStrips() == 0
        polygons = surface.GetPolys()
        corners = vtk_to_numpy(polygons.GetConnectivityArray()).copy()
        ends = vtk_to_numpy(polygons.GetOffsetsArray())
        assert np.array_equal(ends, np.arange(0, len(corners) + 1, 3))
        values = []
        for kind in (surface.GetPointData(), surface.GetCellData()):
            arrays = [kind.GetArray(k) for k in range(kind.GetNumberOfArrays())]
            values.append({a.GetName(): vtk_to_numpy(a).copy() for a in arrays})
        points = vtk_to_numpy(surface.GetPoints().GetData()).copy()
        found[number] = Step(reader.GetTimeValue(), points, corners.reshape(-1, 3), *values)
    return [found[number] for number in range(count)]


def check_layout(path) -> None:
    """Compare sizes and offsets with the format's rules for PolyData over time, without VTK.

    https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format
    """
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "r") as file:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        assert root.attrs["Version"].tolist() == [2, 0]
        kind = root.attrs.get_id("Type")
        assert kind.dtype.kind == "S" and root.attrs["Type"] == b"PolyData"
        count = int(steps.attrs["NSteps"])
        sizes = {"point": root["NumberOfPoints"][:]}
        kinds = ("Vertices", "Lines", "Polygons", "Strips")
        cells = np.array([root[f"{name}/NumberOfCells"][:] for name in kinds])
        ids = np.array([root[f"{name}/NumberOfConnectivityIds"][:] for name in kinds])
        sizes["cell"] = cells.sum(axis=0)
        for name in ("Values", "NumberOfParts", "PartOffsets", "PointOffsets"):
            assert steps[name].shape == (count,)
        for name in ("CellOffsets", "ConnectivityIdOffsets"):
            assert steps[name].shape == (count, 4)
        for name in kinds:
            # VTK before 9.7 shows no surface otherwise.
            assert root[f"{name}/Offsets"].dtype == root[f"{name}/Connectivity"].dtype
        assert (np.diff(steps["Values"][:]) > 0).all()
        parts, first = steps["NumberOfParts"][:], steps["PartOffsets"][:]
        assert (parts == 1).all() and (first + parts <= len(sizes["point"])).all()
        here = sizes["point"][first]
        assert root["Points"].shape[1:] == (3,)
        assert (steps["PointOffsets"][:] + here <= len(root["Points"])).all()
        for number, name in enumerate(kinds):
            begin = steps["ConnectivityIdOffsets"][:, number]
            assert (begin + ids[number][first] <= len(root[f"{name}/Connectivity"])).all()
            begin = steps["CellOffsets"][:, number] + first
            assert (begin + cells[number][first] + 1 <= len(root[f"{name}/Offsets"])).all()
        for kind in ("Point", "Cell"):
            for name, values in root[f"{kind}Data"].items():
                begin = steps[f"{kind}DataOffsets/{name}"][:]
                assert begin.shape == (count,)
                assert (begin + sizes[kind.lower()][first] <= len(values)).all()
