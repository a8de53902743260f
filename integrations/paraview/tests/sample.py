"""Writes a volume to look at: sample.py FILE.vti [MOMENT|few]. Three balls and ripples, 81 x 66 x 72 floats; they move with time. few: two
cells of them."""
import sys

from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonCore import vtkFloatArray
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter
from math import sin, sqrt

is_few = sys.argv[2:] == ["few"]
nx, ny, nz = (3, 2, 2) if is_few else (81, 66, 72)
t = int(sys.argv[2]) if len(sys.argv) > 2 and not is_few else 0
balls = ((40 + 4 * t, 33, 30, 20), (25, 25, 52 - 6 * t, 10), (58, 44, 48, 12))
image = vtkImageData()
image.SetDimensions(nx, ny, nz)
values = vtkFloatArray()
values.SetName("density")
values.SetNumberOfTuples(nx * ny * nz)
i = 0
for z in range(nz):
    for y in range(ny):
        for x in range(nx):
            if is_few:
                values.SetValue(i, 30 + 35 * x + 60 * y + 40 * z)
                i += 1
                continue
            near = max(1.5 - sqrt((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / r for a, b, c, r in balls)
            values.SetValue(i, 200 * min(max(near, 0), 1) + 10 * sin(x / 3) * sin(y / 4))
            i += 1
image.GetPointData().SetScalars(values)
writer = vtkXMLImageDataWriter()
writer.SetFileName(sys.argv[1])
writer.SetInputData(image)
writer.SetDataModeToBinary()  # Debian's VTK cannot read appended data by its newest expat
writer.Write()
