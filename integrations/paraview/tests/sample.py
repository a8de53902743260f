"""Writes a volume to look at: sample.py FILE.vti [MOMENT]. Three balls and ripples, 81 x 66 x 72 floats; they move with time."""
import sys

from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonCore import vtkFloatArray
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter
from math import sin, sqrt

nx, ny, nz = 81, 66, 72
t = int(sys.argv[2]) if len(sys.argv) > 2 else 0
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
            near = max(1.5 - sqrt((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / r for a, b, c, r in balls)
            values.SetValue(i, 200 * min(max(near, 0), 1) + 10 * sin(x / 3) * sin(y / 4))
            i += 1
image.GetPointData().SetScalars(values)
writer = vtkXMLImageDataWriter()
writer.SetFileName(sys.argv[1])
writer.SetInputData(image)
writer.SetDataModeToBinary()  # Debian's VTK cannot read appended data by its newest expat
writer.Write()
