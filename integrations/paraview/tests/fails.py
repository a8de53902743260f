"""What goes wrong on one process is told by all, and none waits: mpirun -np 2 pvbatch fails.py PLUGIN FOLDER."""
import sys

sys.path.insert(0, sys.argv[0].rsplit("/", 1)[0])
from look import *  # noqa: F403

plugin, folder = sys.argv[1:3]
LoadPlugin(plugin, remote=False, ns=globals())
# Values of two components on the second process.
balls = OpenDataFile(f"{folder}/balls0.vti")
spoilt = ProgrammableFilter(Input=balls, CopyArrays=0)
spoilt.Script = """
from paraview.modules.vtkRemotingCore import vtkProcessModule
output.ShallowCopy(self.GetInputDataObject(0, 0))
values = inputs[0].PointData["density"]
if vtkProcessModule.GetProcessModule().GetPartitionId() == 1:
    import numpy
    values = numpy.stack([values, values], 1)
output.PointData.append(values, "density")
"""
view, display, opacity, at = open_view(spoilt)
Render(view)
print("first: came through")
# Fewer ghosts than the light needs; then enough of them, and it draws.
Delete(view)
balls = OpenDataFile(f"{folder}/balls0.vti")  # the first one has made its ghosts
view, display, opacity, at = open_view(balls, ghosts=1)
display.ChiaroLighting = "visibility"
Render(view)
print("second: came through")
display.ChiaroGhostLevels = 8
shot(view, f"{folder}/mended.png")
print("came through")
