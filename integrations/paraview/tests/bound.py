"""What 8 bits may cost where ParaView composites: bound.py FOLDER RANKS NAME... compares folder/NAME-RANKS.png with NAME-1.png. Of each
pixel the ranks on its ray are counted, from where ranks.py says that the blocks and the camera are; it may be (ranks + 1)/255 off, and those
of so many ranks .35 ranks/255 in the mean. Exits with 1 where one is more."""
import json
import sys

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

folder, ranks, *names = sys.argv[1:]


def picture(name):
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[:, :, :3].astype(int)  # row 0 below


def rays(seen, width, height):
    """The eye, and a direction for each pixel."""
    eye, at, up = (numpy.array(seen[key], float) for key in ("position", "focal", "up"))
    ahead = (at - eye) / numpy.linalg.norm(at - eye)
    right = numpy.cross(ahead, up)
    right /= numpy.linalg.norm(right)
    tangent = numpy.tan(numpy.radians(seen["angle"]) / 2)
    x = ((numpy.arange(width) + 0.5) * 2 - width) / height * tangent
    y = ((numpy.arange(height) + 0.5) * 2 / height - 1) * tangent
    return eye, ahead + x[None, :, None] * right + y[:, None, None] * numpy.cross(right, ahead)


def met_by(extent, eye, ways):
    """Whether rays pass through a block."""
    near, far = numpy.zeros(ways.shape[:2]), numpy.full(ways.shape[:2], numpy.inf)
    for axis in range(3):
        way = numpy.where(numpy.abs(ways[:, :, axis]) < 1e-12, 1e-12, ways[:, :, axis])
        one, other = ((extent[2 * axis + side] - eye[axis]) / way for side in (0, 1))
        near, far = numpy.maximum(near, numpy.minimum(one, other)), numpy.minimum(far, numpy.maximum(one, other))
    return near < far


failed = False
for name in names:
    one, many = picture(f"{folder}/{name}-1.png"), picture(f"{folder}/{name}-{ranks}.png")
    off = numpy.abs(one - many).max(2)
    with open(f"{folder}/{name}-{ranks}.json", encoding="utf-8") as file:
        seen = json.load(file)
    eye, ways = rays(seen, off.shape[1], off.shape[0])
    on_ray = sum(met_by(extent, eye, ways).astype(int) for extent in seen["extents"])
    covered = (one != one[0, 0]).any(2)
    told = []
    for count in numpy.unique(on_ray):
        those = off[on_ray == count]
        matter = off[covered & (on_ray == count)]
        mean = matter.mean() if matter.size else 0
        wrong = those.max() > count + 1 or (matter.size > 100 and mean > 0.35 * count)
        failed = failed or wrong
        told.append(f"{count}: max {those.max()} mean {mean:.3f} of {matter.size}{' TOO MUCH' if wrong else ''}")
    assert on_ray.max() > 1, "no ray passes through two blocks"
    print(f"        {name} by ranks on the ray: {'; '.join(told)}")
sys.exit(int(failed))
