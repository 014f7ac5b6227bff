#!/usr/bin/python3
"""Pictures of meshes and trajectories: OBJ, PLY, STL, and the VTKHDF files that `shapebench run` writes.

A trajectory has one camera, which sees all of its frames, so that pictures of two frames can be laid over each
other. Its bodies stand on nothing but the obstacles that it holds; a mesh by itself stands on a ground of its own.

Needs what `scripts/setup pictures` installs: Debian's python3-vtk9, python3-h5py, python3-matplotlib and,
for a machine without a display, xvfb, xauth and libgl1-mesa-dri. `scripts/run view SCENE --video FILE` makes films."""

from plots import fail, opened, write

import argparse  # after plots, which watches for interrupts
import dataclasses
import os
import shutil
import subprocess
import sys

SURFACE, EDGE, GROUND = (0.55, 0.72, 0.90), (0.12, 0.18, 0.25), (0.97, 0.97, 0.98)  # colours
STOP, SHADE = (0.90, 0.89, 0.87), (0.80, 0.80, 0.81)  # of obstacles, and of shadows on them
OBSTACLES = ("obstacles", "particles/obstacles", "nodes/obstacles")  # before schema 4 only the latter
PLANE, SPHERE, BOX, CAPSULE = range(4)  # kinds of obstacles
TRAJECTORIES = (".vtkhdf", ".h5", ".hdf5", ".hdf")


@dataclasses.dataclass
class Sequence:
    """What all pictures of a file share: its camera sees the box of all frames."""

    low: "numpy.ndarray"
    high: "numpy.ndarray"
    obstacles: list  # rows of numbers, as in results/README.md
    still: bool  # a mesh that is not of a simulation

    @property
    def centre(self):
        return (self.low + self.high) / 2

    @property
    def span(self):
        return float(sum((self.high - self.low) ** 2) ** 0.5) or 1.0


def parse():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", nargs="+", help="several files are shown side by side, with names")
    parser.add_argument("-o", "--output", default="render.png", help="PNG to write (%(default)s)")
    parser.add_argument("--overwrite", action="store_true", help="replace a file that is there")
    parser.add_argument("--view", choices=["front", "side", "back", "three-quarter"], default="three-quarter")
    parser.add_argument("--size", default="640x640", metavar="WxH", help="of each panel (%(default)s)")
    parser.add_argument("--frame", type=int, metavar="N", help="of a trajectory; negative: from the end (-1)")
    parser.add_argument("--columns", type=int, default=4, help="panels in a row, at most (%(default)s)")
    parser.add_argument("--cells", choices=["boxes", "wire"], help="draw the leaf cells of an octree, coloured by "
                        "size, of files recorded with --record nodes: as boxes, or as wires in the surface")
    parser.add_argument("--edges", action="store_true", help="show the triangles, where they are not too small for it")
    parser.add_argument("--colour", metavar="FIELD", help="colour by what shapebench run --fields has stored: "
                        "displacement, speed, strain, piece or level; one scale for all frames of all files")
    parser.add_argument("--no-names", action="store_true", help="leave the file names out")
    options = parser.parse_args()
    if options.colour and options.cells == "boxes":
        parser.error("--colour is of the surface, and --cells boxes leaves it out")
    options.frame = -1 if options.frame is None else options.frame
    return options


def with_display():
    """VTK draws through OpenGL, which wants an X server: lend it a virtual one, which ends when this process has."""
    if os.environ.get("DISPLAY"):
        return
    missing = [tool for tool in ("xvfb-run", "xauth") if not shutil.which(tool)]
    if missing:
        fail(f"no display and no {' and no '.join(missing)}: apt-get install xvfb xauth libgl1-mesa-dri "
             "python3-vtk9 (scripts/setup pictures)", 3)
    until, _ = os.pipe()
    lender = subprocess.Popen(["xvfb-run", "-a", "-s", "-screen 0 64x64x24", "sh", "-c",
                               'echo "$DISPLAY $XAUTHORITY"; read -r end'], stdin=until, stdout=subprocess.PIPE,
                              text=True, start_new_session=True)  # Ctrl-C is for us: we still need it then
    os.environ["DISPLAY"], _, os.environ["XAUTHORITY"] = lender.stdout.readline().rstrip("\n").partition(" ")
    if not os.environ["DISPLAY"]:
        fail("no display, and xvfb-run lends none", 3)


def polydata(points, faces):
    """A mesh of faces that have equally many corners."""
    import numpy
    import vtk
    from vtk.util import numpy_support

    cells = numpy.empty((len(faces), faces.shape[1] + 1), dtype=numpy.int64)
    cells[:, 0] = faces.shape[1]
    cells[:, 1:] = faces
    array = vtk.vtkCellArray()
    array.SetCells(len(faces), numpy_support.numpy_to_vtkIdTypeArray(cells.ravel(), deep=True))
    data = vtk.vtkPolyData()
    data.SetPoints(vtk.vtkPoints())
    data.GetPoints().SetData(numpy_support.numpy_to_vtk(numpy.ascontiguousarray(points), deep=True))
    data.SetPolys(array)
    return data


def read_sequence(path, mesh):
    """The box of `mesh`, or of all frames of a trajectory, whose points lie one frame after the other."""
    import numpy

    if mesh:
        bounds = numpy.array(mesh.GetBounds())
        return Sequence(bounds[::2], bounds[1::2], [], True)
    with opened(path) as file:
        points, rows = file["VTKHDF/Points"], 1 << 20
        if not len(points):
            raise ValueError("no points")
        low, high = numpy.full(3, numpy.inf), numpy.full(3, -numpy.inf)
        for first in range(0, len(points), rows):
            some = points[first : first + rows]
            low, high = numpy.minimum(low, some.min(0)), numpy.maximum(high, some.max(0))
        if not numpy.isfinite(high - low).all():
            raise ValueError("points that are not finite")
        obstacles = next((file[name][()] for name in OBSTACLES if name in file), numpy.empty((0, 9)))
        if obstacles.ndim != 2 or obstacles.shape[1] != 9 or not numpy.isfinite(obstacles).all() or \
                not numpy.isin(obstacles[:, 0], (PLANE, SPHERE, BOX, CAPSULE)).all():
            raise ValueError("obstacles that are none")
        if "Steps" in file["VTKHDF"] and not len(file["VTKHDF/Steps/Values"]):
            raise ValueError("no frames")
    return Sequence(low.astype(float), high.astype(float), list(obstacles), False)


def read_trajectory(path, frame, colours):
    """One frame of a VTKHDF file, UnstructuredGrid or PolyData, with or without steps, with values to colour by."""
    from vtk.util import numpy_support

    with opened(path) as file:
        root = file["VTKHDF"]
        kind = root.attrs["Type"].decode() if isinstance(root.attrs["Type"], bytes) else root.attrs["Type"]
        cells = root["Polygons"] if kind == "PolyData" else root
        first, count, part, corner = 0, len(root["Points"]), 0, 0
        if "Steps" in root:
            offsets = root["Steps/PointOffsets"][()].ravel()
            if not -len(offsets) <= frame < len(offsets):
                fail(f"{path}: has {len(offsets)} frames, no frame {frame}", 2)
            part = int(root["Steps/PartOffsets"][frame])
            first, count = int(offsets[frame]), int(root["NumberOfPoints"][part])
            corner = int(root["Steps/ConnectivityIdOffsets"][frame, 2 if kind == "PolyData" else 0])
        elif frame not in (0, -1):
            fail(f"{path}: has one frame, no frame {frame}", 2)
        corners = cells["Connectivity"][corner : corner + int(cells["NumberOfConnectivityIds"][part])]
        if len(corners) % 3 or ("Types" in cells and (cells["Types"][corner // 3 : corner // 3 + 1] != 5).any()):
            fail(f"{path}: its cells are not all triangles", 3)
        points, faces = root["Points"][first : first + count], corners.reshape(-1, 3)
        if points.shape[1] != 3 or len(points) != count or (faces < 0).any() or (faces >= count).any():
            raise ValueError("triangles of points that are not there")  # VTK would read beyond them
        data = polydata(points, faces)
        if colours:
            values = field_values(file, colours.name, first, count)
            if len(values) != count:
                raise ValueError(f"values of '{colours.name}' for other points")
            data.GetPointData().SetScalars(numpy_support.numpy_to_vtk(values, deep=True))
        return data


@dataclasses.dataclass
class Colours:
    """The scale of a field, from 0."""

    name: str
    high: float
    over: bool  # whether single values lie beyond it
    whole: bool  # numbers of something

    def map(self):
        """matplotlib's."""
        import matplotlib
        from matplotlib.colors import ListedColormap

        count = int(self.high) + 1
        if not self.whole:
            return matplotlib.colormaps["viridis"]
        if self.name == "piece":  # neighbours differ
            return ListedColormap([matplotlib.colormaps["tab20"](n % 20) for n in range(count)])
        return matplotlib.colormaps["viridis"].resampled(count)

    def range(self):
        return (-0.5, self.high + 0.5) if self.whole else (0, self.high)


def read_colours(paths, name):
    """One scale for all frames of all files: up to the value that a hundredth of the points exceed."""
    import numpy

    some, most = [], 0.0
    for path in paths:
        if not is_trajectory(path):
            fail(f"{path}: a mesh holds no fields to colour by", 3)
        with opened(path) as file:
            fields = file["VTKHDF"].get("PointData", {})
            if name not in fields:
                there = f"it has {', '.join(fields)}" if len(fields) else "it has none"
                fail(f"{path}: has no field '{name}' ({there}): write it with shapebench run --fields", 3)
            if not len(fields[name]):
                raise ValueError(f"no values of '{name}'")
            rows, skip = 1 << 20, 1 + len(fields[name]) // 10**7
            for first in range(0, len(fields[name]), rows):
                values = field_values(file, name, first, rows)
                some.append(values[::skip])
                most = max(most, values.max(initial=0))
    whole = name in ("piece", "level") and most < 10**5
    high = most if whole else float(numpy.percentile(numpy.concatenate(some), 99)) or most
    return Colours(name, high or float(not whole), most > high, whole)


def field_values(file, name, first, count):
    """Of so many points, as far as there are; of vectors how long they are."""
    import numpy

    values = file["VTKHDF/PointData"][name][first : first + count].astype(float)
    if values.ndim > 1:
        values = numpy.sqrt((values**2).sum(1))
    if not numpy.isfinite(values).all():
        raise ValueError(f"values of '{name}' that are not finite")
    return values


def is_trajectory(path):
    return os.path.splitext(path)[1].lower() in TRAJECTORIES


def read_mesh(path):
    import vtk

    vtk.vtkObject.GlobalWarningDisplayOff()
    if not os.path.isfile(path):
        fail(f"{path}: {'is a folder' if os.path.isdir(path) else 'no such file'}", 3)
    ending = os.path.splitext(path)[1].lower()
    readers = {".obj": vtk.vtkOBJReader, ".ply": vtk.vtkPLYReader, ".stl": vtk.vtkSTLReader}
    if ending not in readers:
        fail(f"{path}: reads .obj, .ply, .stl and .vtkhdf or .h5, not {ending or 'files without an ending'}", 3)
    reader = readers[ending]()
    reader.SetFileName(path)
    reader.Update()
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputConnection(reader.GetOutputPort())
    triangles.PassLinesOff()
    triangles.PassVertsOff()
    triangles.Update()
    if triangles.GetOutput().GetNumberOfPolys() == 0:
        fail(f"{path}: holds no faces", 3)
    return triangles.GetOutput()


def turns(rest, x, edge):
    """How each node's neighbours have turned about it."""
    import numpy

    moments = numpy.zeros((len(rest), 3, 3))
    for a, b in (edge.T, edge.T[::-1]):
        before, now = rest[b] - rest[a], x[b] - x[a]
        numpy.add.at(moments, a, now[:, :, None] * before[:, None, :] / (before**2).sum(1)[:, None, None])
    u, _, vt = numpy.linalg.svd(moments)
    u[:, :, 2] *= numpy.linalg.det(u @ vt)[:, None]
    return u @ vt


def read_cells(path, frame):
    """The leaf cells at a frame, moved and turned with their nodes; each of their faces has the level."""
    import numpy
    from vtk.util import numpy_support

    corner = numpy.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) - 0.5
    side = numpy.array([[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]])
    with opened(path) as file:
        if "nodes" not in file:
            fail(f"{path}: holds no octree: write it with shapebench run --engine octree --record nodes", 3)
        nodes, times = file["nodes"], file["VTKHDF/Steps/Values"][()].ravel()
        rest, edge, size = nodes["rest"][()], nodes["edge"][()], nodes["size"][()]
        record = numpy.abs(nodes["step"][()] * nodes.attrs["h"] - times[frame]).argmin()
        x = nodes["x"][record].reshape(-1, len(rest), 3)
        levels, cell = int(nodes.attrs["levels"]), nodes.attrs["cell"]
    level = levels - numpy.rint(numpy.log2(size / cell)).astype(int)
    print(f"{path}: " + ", ".join(f"{(level == n).sum()} leaves of level {n}" for n in range(levels + 1)))
    points = [at[:, None, :] + numpy.einsum("nab,nc,kb->nka", turns(rest, at, edge), size[:, None] * 0.97, corner)
              for at in x]
    count = len(rest) * len(x)
    faces = (8 * numpy.arange(count)[:, None, None] + side).reshape(-1, 4)
    data = polydata(numpy.concatenate(points).reshape(-1, 3), faces)
    data.GetCellData().SetScalars(numpy_support.numpy_to_vtk(numpy.repeat(numpy.tile(level, len(x)), 6), deep=True))
    return data, levels


def cells_actor(data, levels, wire):
    """Coarse cells blue, fine ones red."""
    import colorsys

    import vtk

    colours = vtk.vtkLookupTable()
    colours.SetNumberOfTableValues(levels + 1)
    for n in range(levels + 1):
        colours.SetTableValue(n, *colorsys.hsv_to_rgb(0.62 * (1 - n / max(1, levels)), 0.55, 0.95), 1)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetLookupTable(colours)
    mapper.SetScalarRange(-0.5, levels + 0.5)
    mapper.SetScalarModeToUseCellData()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetAmbient(0.3 if not wire else 1)
    look.SetDiffuse(0.8 if not wire else 0)
    if wire:
        look.SetRepresentationToWireframe()
        look.SetLineWidth(2)
    else:
        look.EdgeVisibilityOn()
        look.SetEdgeColor(*EDGE)
    return actor


def edge_colour(data, scale):
    """The darker the larger triangles are in the image, of so many pixels a unit of length; none for those under two
    pixels, which lines would cover."""
    import math

    import vtk

    mass = vtk.vtkMassProperties()
    mass.SetInputData(data)
    if not data.GetNumberOfPolys():
        return None
    pixels = scale * math.sqrt(2 * mass.GetSurfaceArea() / data.GetNumberOfPolys())
    share = min(1, pixels / 8)
    return pixels >= 2 and [share * dark + (1 - share) * own for dark, own in zip(EDGE, SURFACE)]


def colour_by(mapper, colours):
    import vtk

    shades = colours.map()
    table = vtk.vtkLookupTable()
    table.SetNumberOfTableValues(shades.N)
    for n in range(shades.N):
        table.SetTableValue(n, *shades(n))
    table.SetTableRange(*colours.range())
    mapper.SetLookupTable(table)
    mapper.UseLookupTableScalarRangeOn()
    mapper.SetInterpolateScalarsBeforeMapping(not colours.whole)
    mapper.ScalarVisibilityOn()


def surface_actor(data, edges, scale, colours):
    import vtk

    normals = vtk.vtkPolyDataNormals()
    normals.SetInputData(data)
    normals.SetFeatureAngle(50)
    normals.SplittingOn()
    normals.ConsistencyOff()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    mapper.ScalarVisibilityOff()
    if colours:
        colour_by(mapper, colours)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(*SURFACE)
    look.SetAmbient(0.16)
    look.SetDiffuse(0.85)
    look.SetSpecular(0.18)
    look.SetSpecularPower(25)
    colour = edges and edge_colour(data, scale)
    if colour:
        look.EdgeVisibilityOn()
        look.SetEdgeColor(*colour)
    return actor


def flat_actor(source, colour):
    """Something of one colour, but for contact shadows."""
    import vtk

    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(*colour)
    look.SetAmbient(1.0)
    look.SetDiffuse(0.0)
    return actor


def disc(centre, normal, radius):
    import vtk

    source = vtk.vtkRegularPolygonSource()
    source.SetNumberOfSides(96)
    source.SetRadius(radius)
    source.SetNormal(*normal)
    source.SetCenter(*centre)
    return source


def ball(centre, radius):
    import vtk

    source = vtk.vtkSphereSource()
    source.SetCenter(*centre)
    source.SetRadius(radius)
    source.SetPhiResolution(48)
    source.SetThetaResolution(96)
    return source


def solid(kind, a, b, radius):
    """A sphere, box or capsule."""
    import vtk

    if kind == SPHERE:
        return ball(a, radius)
    if kind == BOX:
        source = vtk.vtkCubeSource()
        source.SetBounds(a[0], b[0], a[1], b[1], a[2], b[2])
        return source
    line = vtk.vtkLineSource()
    line.SetPoint1(*a)
    line.SetPoint2(*b)
    tube = vtk.vtkTubeFilter()
    tube.SetInputConnection(line.GetOutputPort())
    tube.SetRadius(radius)
    tube.SetNumberOfSides(96)
    whole = vtk.vtkAppendPolyData()
    for part in [ball(a, radius), ball(b, radius)] + [tube] * bool((a != b).any()):
        whole.AddInputConnection(part.GetOutputPort())
    return whole


def obstacle_actor(kind, a, b, radius):
    actor = flat_actor(solid(kind, a, b, radius), STOP)
    actor.GetProperty().SetAmbient(0.35)
    actor.GetProperty().SetDiffuse(0.65)
    return actor


def shadow_actor(data, point, normal):
    """What the light from straight above leaves dark of a plane: shows how far above it a body is."""
    import vtk

    drop = vtk.vtkMatrix4x4()  # y becomes the plane's
    for axis in (0, 2):
        drop.SetElement(1, axis, -normal[axis] / normal[1])
    drop.SetElement(1, 1, 0)
    drop.SetElement(1, 3, float(point @ normal) / normal[1])
    transform = vtk.vtkTransform()
    transform.SetMatrix(drop)
    flat = vtk.vtkTransformPolyDataFilter()
    flat.SetInputData(data)
    flat.SetTransform(transform)
    return flat_actor(flat, SHADE)


def surroundings(renderer, sequence, data):
    """The obstacles, with the shadow of `data` on those that it can lie on; under a mesh by itself a ground, seen by
    the contact shadow that it takes. A plane is drawn about the bodies, and only for who looks at its free side."""
    import numpy

    centre, span = sequence.centre, sequence.span
    eye = numpy.array(renderer.GetActiveCamera().GetPosition())
    if sequence.still:
        under = (centre[0], sequence.low[1] - 0.002 * span, centre[2])
        renderer.AddActor(flat_actor(disc(under, (0, 1, 0), 4 * span), GROUND))
    for row in sequence.obstacles:
        kind, a, b, radius = row[0], row[1:4], row[4:7], row[7]
        if kind != PLANE:
            renderer.AddActor(obstacle_actor(kind, a, b, radius))
        elif (eye - a) @ b > 0:
            middle = centre - ((centre - a) @ b + 0.002 * span) * b
            renderer.AddActor(flat_actor(disc(middle, b, 1.5 * span), STOP))
            if b[1] > 0.5:
                renderer.AddActor(shadow_actor(data, a - 0.001 * span * b, b))


def light(renderer, centre, span, direction, strength):
    import vtk

    lamp = vtk.vtkLight()
    lamp.SetLightTypeToSceneLight()
    lamp.SetFocalPoint(*centre)
    lamp.SetPosition(*[c + 6 * span * d for c, d in zip(centre, direction)])
    lamp.SetIntensity(strength)
    renderer.AddLight(lamp)


def stage(renderer, sequence, view):
    """Camera and lights: key from the upper left of the camera, fill from its right."""
    import math

    centre, span = sequence.centre, sequence.span
    turn = {"front": 0.0, "side": 90.0, "back": 180.0, "three-quarter": 35.0}[view]
    a, rise = math.radians(turn), math.radians(12)

    def around(angle, up):
        return (math.sin(a + angle) * math.cos(up), math.sin(up), math.cos(a + angle) * math.cos(up))

    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*centre)
    camera.SetPosition(*[c + 5 * span * d for c, d in zip(centre, around(0, rise))])
    camera.SetViewUp(0, 1, 0)
    camera.SetClippingRange(0.5 * span, 12 * span)  # whatever size an obstacle is
    camera.SetViewAngle(2 * math.degrees(math.atan(0.53 / 5)))
    light(renderer, centre, span, around(-0.7, 0.85), 0.85)
    light(renderer, centre, span, around(0.9, 0.35), 0.32)
    light(renderer, centre, span, around(0, 0.1), 0.16)


def occlusion(renderer, span):
    """Darkens folds and contacts (screen-space ambient occlusion)."""
    import vtk

    pass_ = vtk.vtkSSAOPass()
    pass_.SetRadius(0.06 * span)
    pass_.SetBias(0.01 * span)
    pass_.SetKernelSize(64)
    pass_.BlurOn()
    pass_.SetDelegatePass(vtk.vtkRenderStepsPass())
    renderer.SetPass(pass_)


def fill(renderer, path, frame, shared, options, height):
    """What there is to see: the surface, an octree's cells, or both."""
    mesh, sequence, colours = shared
    surface = mesh or read_trajectory(path, frame, colours)
    if options.cells:
        cells, levels = read_cells(path, frame)
        renderer.AddActor(cells_actor(cells, levels, options.cells == "wire"))
    if options.cells != "boxes":
        actor = surface_actor(surface, options.edges, height / sequence.span, colours)
        renderer.AddActor(actor)
        if options.cells:
            actor.GetProperty().SetOpacity(0.35)
    stage(renderer, sequence, options.view)
    surroundings(renderer, sequence, cells if options.cells == "boxes" else surface)
    if options.cells != "wire":  # it cannot look through the surface
        occlusion(renderer, sequence.span)


def share(path, colours):
    """What all pictures of a file are made with."""
    mesh = None if is_trajectory(path) else read_mesh(path)
    return mesh, read_sequence(path, mesh), colours


def panel(path, frame, shared, options, size):
    """An image of one file, drawn at twice the size and averaged."""
    import numpy
    import vtk
    from vtk.util import numpy_support

    renderer = vtk.vtkRenderer()
    renderer.SetBackground(*GROUND)
    renderer.AutomaticLightCreationOff()
    fill(renderer, path, frame, shared, options, size[1])
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(2 * size[0], 2 * size[1])
    window.AddRenderer(renderer)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.SetInputBufferTypeToRGB()
    grab.ReadFrontBufferOff()
    grab.Update()
    flat = numpy_support.vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
    image = flat.reshape(2 * size[1], 2 * size[0], 3)[::-1].astype(numpy.float32)
    return image.reshape(size[1], 2, size[0], 2, 3).mean(axis=(1, 3)) / 255


def bar(colours, height):
    """An image of the scale."""
    import numpy
    from matplotlib import cm, colors, ticker
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    units = {"displacement": " (mesh units)", "speed": " (mesh units/s)"}
    figure = Figure(figsize=(1, height / 100), dpi=100, facecolor=GROUND)
    norm = colors.Normalize(*colours.range())
    axes = figure.add_axes((0.12, 0.12, 0.16, 0.76))
    extend = "max" if colours.over else "neither"
    drawn = figure.colorbar(cm.ScalarMappable(norm, colours.map()), cax=axes, extend=extend)
    drawn.set_label(colours.name + units.get(colours.name, ""), fontsize=9)
    axes.tick_params(labelsize=9)
    axes.yaxis.set_major_locator(ticker.MaxNLocator(6, integer=colours.whole))
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return numpy.asarray(canvas.buffer_rgba())[:, :, :3].astype(numpy.float32) / 255


def write_sheet(panels, names, columns, options):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    height, width = panels[0].shape[:2]
    columns = min(columns, len(panels))
    rows = -(-len(panels) // columns)
    label = 34 if names else 0
    figure = pyplot.figure(figsize=(columns * width / 100, rows * (height + label) / 100), dpi=100,
                           facecolor=GROUND)
    for i, image in enumerate(panels):
        row, column = divmod(i, columns)
        bottom = 1 - (row * (height + label) + height) / (rows * (height + label))
        axes = figure.add_axes((column / columns, bottom, 1 / columns, height / (rows * (height + label))))
        axes.imshow(image, aspect="auto", interpolation="nearest")
        axes.set_axis_off()
        if names:
            axes.set_title(names[i], y=-0.5 * label / height, va="center", fontsize=15, color="0.25", pad=0)
    write(figure, options.output, options.overwrite, format="png", dpi=100)


def draw(path, frame, shared, options, size):
    """The panel, with the scale of its colours beside it."""
    import numpy

    image = panel(path, frame, shared, options, size)
    return numpy.hstack((image, bar(shared[2], size[1]))) if shared[2] else image


def main():
    options = parse()
    try:
        size = tuple(int(part) for part in options.size.split("x"))
        assert len(size) == 2 and 16 <= min(size) and max(size) <= 4096
    except (ValueError, AssertionError):
        fail(f"--size {options.size}: wants WxH, each 16 to 4096", 2)
    with_display()
    try:
        import h5py, matplotlib, numpy, vtk  # noqa: F401
    except ImportError as error:
        fail(f"{error} (for {sys.executable}): apt-get install python3-vtk9 python3-h5py python3-matplotlib", 3)
    colours = options.colour and read_colours(options.file, options.colour)
    panels = [draw(path, options.frame, share(path, colours), options, size) for path in options.file]
    names = [os.path.splitext(os.path.basename(path))[0] for path in options.file]
    show = len(names) > 1 and not options.no_names
    write_sheet(panels, names if show else None, max(1, options.columns), options)


if __name__ == "__main__":
    main()
