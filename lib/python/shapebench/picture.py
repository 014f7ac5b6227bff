"""Pictures of surfaces, for notebooks: by PyVista where it is installed, else by matplotlib."""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np
from numpy.typing import NDArray


def draw(vertices: NDArray[np.float64], triangles: NDArray[np.int32], ax: Any = None) -> Any:
    """Draws triangles with y up; returns PyVista's plotter, or matplotlib's axes: `ax`, where they are given (of the
    projection "3d"), else new ones."""
    if ax is None:
        with contextlib.suppress(ImportError):
            import pyvista

            plotter = pyvista.Plotter()
            plotter.add_mesh(pyvista.make_tri_mesh(vertices, triangles), color="lightblue", smooth_shading=True)
            plotter.camera_position = "xy"
            return plotter
        import matplotlib.pyplot as plt

        ax = plt.figure().add_subplot(projection="3d")
    x, y, z = vertices.T
    ax.plot_trisurf(x, -z, y, triangles=triangles, color="lightblue")  # matplotlib's third axis is up
    ax.set_box_aspect(np.ptp(np.column_stack((x, -z, y)), axis=0), zoom=1.4)
    ax.set_axis_off()
    return ax
