"""What a user writes, for mypy --strict against the stubs; never run."""

from pathlib import Path

import chiaro
import numpy as np

volume = chiaro.read("scan.nii.gz")
image = chiaro.render(volume, lighting="transport", probe="studio", view="left", size=(640, 480), clip_plane=[(0, 0, 1, 10)])
image.save(Path("a.png"))
depth = image.depth + np.float32(1)
session = chiaro.Session(volume, azimuth=10, device="cpu")
session.camera.azimuth += 10
session.transfer = "ct-bone"
session.step = 0.25
scene: chiaro.Scene = session.scene.with_(up=None, mode="iso", iso=[100, (200, "red")])
for frame in chiaro.turntable(scene, 12, threads=2):
    print(frame.width, frame.stats["samples"])
chiaro.save_video("a.mp4", chiaro.turntable(scene, 12), fps=25)
field = chiaro.illuminate(volume, lighting="spao", spao_levels=5)
print(field.array.mean(), chiaro.compare(image, image).rmse, volume.affine @ np.ones(4))
function = chiaro.TransferFunction([(0, "black", 0), (255, "white", 0.5)]).scaled(0.5)
chiaro.render("sample:ball", transfer=function, background="white", no_skip_empty=True, sh_bands=2)
