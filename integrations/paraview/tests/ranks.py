"""Pictures by any number of processes, mpirun -np N pvbatch ranks.py PLUGIN FOLDER: folder/NAME-N.png of each method, composited by
ParaView (NAME-N.json: where from, and of which blocks) and exactly (NAME-N.exr: the floats), and of the modes of one value a ray. Then
what must not wait for ever: a block off the screen, edits, hidden and shown, two views, moments. More than three processes draw visibility
and the average alone, and fewer moments. Prints "came through"."""
import json
import sys

sys.path.insert(0, sys.argv[0].rsplit("/", 1)[0])
from look import *  # noqa: F403
from paraview.modules.vtkRemotingCore import vtkProcessModule  # noqa: E402

plugin, folder = sys.argv[1:3]
ranks = vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions()
LoadPlugin(plugin, remote=False, ns=globals())
blocks = ProgrammableFilter(Input=OpenDataFile(f"{folder}/balls0.vti"))
blocks.Script = f"""
from paraview.modules.vtkRemotingCore import vtkProcessModule
rank = vtkProcessModule.GetProcessModule().GetPartitionId()
extent = self.GetInputDataObject(0, 0).GetExtent()
open(f"{folder}/extent-{ranks}-{{rank}}", "w").write(repr(list(extent)))
"""
UpdatePipeline(proxy=blocks)
Delete(blocks)
source = OpenDataFile([f"{folder}/balls{t}.vti" for t in range(3)])  # after that script, which brings names of its own
view, display, opacity, at = open_view(source)


def keep(name):
    is_exact = bool(display.ChiaroExactCompositing)
    display.ChiaroFrameFile = f"{folder}/{name}-{ranks}.exr" if is_exact else ""
    shot(view, f"{folder}/{name}-{ranks}.png")
    display.ChiaroFrameFile = ""
    if is_exact:
        return
    seen = {"position": list(view.CameraPosition), "focal": list(view.CameraFocalPoint), "up": list(view.CameraViewUp)}
    seen["angle"] = view.CameraViewAngle
    seen["extents"] = [json.load(open(f"{folder}/extent-{ranks}-{rank}", encoding="utf-8")) for rank in range(ranks)]
    with open(f"{folder}/{name}-{ranks}.json", "w", encoding="utf-8") as file:
        json.dump(seen, file)


is_short = ranks > 3
for method in ("visibility",) if is_short else ("spao", "visibility", "transport"):
    display.ChiaroLighting = method
    for exact in (0, 1):
        display.ChiaroExactCompositing = exact
        keep(("exact-" if exact else "") + method)
    display.ChiaroExactCompositing = 0
modes = (("Average", "mean"), ("Maximum", "mip"), ("Minimum", "minip"), ("Additive", "additive"))
for mode, name in modes[:1] if is_short else modes:
    display.ChiaroValueOfRays = mode
    keep(name)
display.ChiaroValueOfRays = "None"

# All blocks but one off the screen, composited either way; edits there.
display.ChiaroLighting = "visibility"
for exact in (0, 1):
    display.ChiaroExactCompositing = exact
    look_from(view, (20, 30, 60), aside=(0, 0, 60))
    Render(view)
    opacity.Points = [at(0), 0, 0.5, 0, at(0.5), 0, 0.5, 0, at(0.7), 0.5 - 0.1 * exact, 0.5, 0, at(1), 0.9, 0.5, 0]
    Render(view)
    Hide(source, view)
    Render(view)
    Show(source, view)
    look_from(view, (13, 17, 9), aside=(25, 20, 25))
    keep(f"near{exact}")
look_from(view, (130, 170, 90))

# The next moments, and back: nothing stale.
display.ChiaroExactCompositing = 1
opacity.Points = [at(0), 0, 0.5, 0, at(0.35), 0, 0.5, 0, at(0.6), 0.5, 0.5, 0, at(1), 0.9, 0.5, 0]
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
for t in (1,) if is_short else (0, 1, 2, 1):
    scene.AnimationTime = scene.TimeKeeper.TimestepValues[t]
    keep(f"moment{t}")

# Lights that follow the camera are where that is now.
lamp = AddLight(view=view)
lamp.Coords, lamp.Type, lamp.Intensity = "Camera", "Directional", 2
lamp.Position, lamp.FocalPoint = [1, 1, 1], [0, 0, 0]
Render(view)
look_from(view, (-150, 60, 90))
display.ChiaroLighting = "spao"
display.ChiaroFrameFile = f"{folder}/lamp-{ranks}.exr"
Render(view)
display.ChiaroFrameFile = ""
RemoveLight(lamp)
display.ChiaroLighting = "visibility"

# Two views of one source, each with its own look; the first shows what it did.
look_from(view, (130, 170, 90))
other, second, _, _ = open_view(source, (320, 240))
second.ChiaroLighting = "spao"
second.ChiaroExactCompositing = 1
look_from(other, (-150, 60, 45))
shot(other, f"{folder}/other-{ranks}.png")
keep("second")
scene.AnimationTime = scene.TimeKeeper.TimestepValues[2]
Render(view)
Render(other)
Hide(source, other)
Render(other)

# Other geometry beside it: exact compositing steps back, a mode of one value a ray is not drawn.
ball = Sphere(Center=[40, 33, 30], Radius=30)
Show(ball, view)
keep("beside")
Hide(ball, view)

# A film of all moments, and a volume of two cells, of which more processes have none.
if not is_short:
    display.ChiaroExactCompositing = 1
    SaveAnimation(f"{folder}/film-{ranks}.png", view, ImageResolution=list(view.ViewSize), FrameWindow=[0, 2])
Hide(source, view)
few = OpenDataFile(f"{folder}/few.vti")
view, display, opacity, at = open_view(few)
look_from(view, (3, 4, 2), aside=(-39, -32, -35))  # from its middle
for exact in (0, 1):
    display.ChiaroExactCompositing = exact
    display.ChiaroLighting = "visibility" if exact else "spao"
    Render(view)
    opacity.Points = [at(0), 0, 0.5, 0, at(0.3 + 0.1 * exact), 0, 0.5, 0, at(1), 0.9, 0.5, 0]
    keep(f"few{exact}")
print("came through")
