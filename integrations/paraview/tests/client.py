"""A client of a server of several processes: client.py PLUGIN FOLDER PORT PROCESSES: folder/client-spao-N.png, as ranks.py by pvbatch."""
import sys

sys.path.insert(0, sys.argv[0].rsplit("/", 1)[0])
from look import *  # noqa: F403

plugin, folder, port, ranks = sys.argv[1:5]
Connect("127.0.0.1", int(port))
LoadPlugin(plugin, remote=True, ns=globals())
LoadPlugin(plugin, remote=False, ns=globals())
source = OpenDataFile([f"{folder}/balls{t}.vti" for t in range(3)])
view, display, opacity, at = open_view(source)
for exact in (0, 1):
    display.ChiaroExactCompositing = exact
    look_from(view, (13, 17, 9))
    Render(view)  # a camera that moves on
    look_from(view, (130, 170, 90))
    Render(view)
    shot(view, f"{folder}/client-{'exact-' if exact else ''}spao-{ranks}.png")
print("came through")
Disconnect()
