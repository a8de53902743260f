"""Around the calls: importing, other threads, Ctrl-C, fork, and what is left behind."""

import os
import resource
import signal
import subprocess
import sys
import threading
import time

import chiaro
import numpy as np
import pytest

LONG = {"lighting": "reference", "reference_rays": 65536, "size": (640, 480)}


def test_importing_starts_no_thread_and_opens_no_file(python):
    said = python("import os, numpy; before = len(os.listdir('/proc/self/task')); fds = os.listdir('/proc/self/fd')\n"
                  "import chiaro; print(len(os.listdir('/proc/self/task')) - before, len(os.listdir('/proc/self/fd')) - len(fds))")
    assert said.split() == ["0", "0"]


def test_ctrl_c_ends_a_render(python, blob):
    """Its time is measured by the child itself, as processor time, which a busy machine does not change."""
    script = f"""
import os, signal, threading, time, numpy as np, chiaro
signal.signal(signal.SIGINT, signal.default_int_handler)  # which a shell has its background do without
v = chiaro.sample("shells", 48)
chiaro.render(v, size=(16, 12))
threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    chiaro.render(v, **{LONG!r})
except KeyboardInterrupt:
    print("interrupted")
print(chiaro.render(v, size=(16, 12)))
"""
    assert python(script).splitlines() == ["interrupted", "<chiaro.Image 16 × 12>"]


def test_exceptions_and_two_sessions_in_threads(blob, small):
    results, errors = {}, []

    def work(k):
        s = chiaro.Session(blob, **{**small, "threads": 2})
        results[k] = [np.asarray(s.image(azimuth=20 * i)).copy() for i in range(6)]
        try:
            chiaro.render(blob, step=0)
        except ValueError as error:
            errors.append(str(error))

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    [t.start() for t in threads], [t.join() for t in threads]
    assert len(results) == 4 and errors == ["step=0: must be 0.001 to 100 voxels"] * 4
    for k in range(1, 4):
        for a, b in zip(results[0], results[k]):
            np.testing.assert_array_equal(a, b)


def test_one_session_takes_one_call_after_the_other(blob, small):
    s = chiaro.Session(blob, **small)
    scenes = [s.scene.with_(azimuth=30 * i) for i in range(8)]
    expected = [np.asarray(chiaro.render(scene, threads=1)).copy() for scene in scenes]
    s.image()
    found = [None] * 8

    def work(i):
        found[i] = np.asarray(s._session.render(scenes[i]._native, None, None))

    threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
    [t.start() for t in threads], [t.join() for t in threads]
    for a, b in zip(expected, found):
        np.testing.assert_array_equal(a, b)


def test_other_threads_run_meanwhile(small, blob):
    ticks = []
    done = threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(1)
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    before = len(ticks)
    chiaro.render(blob, **{**small, "lighting": "reference", "reference_rays": 256})
    during = len(ticks) - before
    done.set(), thread.join()
    assert during > 3


def test_a_fork_is_told_in_a_sentence(python):
    script = """
import os, sys, chiaro
chiaro.render("sample:ball:16", size=(8, 6))
child = os.fork()
if child == 0:
    try:
        chiaro.render("sample:ball:16", size=(8, 6))
    except chiaro.Error as error:
        print(error)
        sys.stdout.flush()
        os._exit(7)
    os._exit(0)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
chiaro.render("sample:ball:16", size=(8, 6))
"""
    sentence, code = python(script).splitlines()
    assert "forked" in sentence and "spawn" in sentence and code == "7"


def test_a_child_forked_before_the_first_call_works(python):
    script = """
import multiprocessing, chiaro, numpy as np
def work(azimuth):
    return np.asarray(chiaro.render("sample:ball:16", size=(8, 6), azimuth=azimuth)).sum()
with multiprocessing.get_context("fork").Pool(2) as pool:
    print(len(set(pool.map(work, [0, 90, 180]))) > 0)
"""
    assert python(script).strip() == "True"


def counts():
    with open("/proc/self/statm") as file:
        resident = int(file.read().split()[1]) * resource.getpagesize()
    return resident, len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd"))


def test_200_sessions_leave_nothing(python, tmp_path):
    script = """
import os, resource, sys, gc, numpy as np, chiaro
def counts():
    resident = int(open("/proc/self/statm").read().split()[1]) * resource.getpagesize()
    return resident, len(os.listdir("/proc/self/task")), len(os.listdir("/proc/self/fd"))
a = np.random.default_rng(1).integers(0, 1000, (40, 40, 40)).astype("u2")
def one(k):
    s = chiaro.Session(a, size=(64, 48), threads=2)
    s.image().depth
    s.image(azimuth=k)
    try: s.image(step=0)
    except ValueError: pass
    chiaro.render(a, size=(64, 48), threads=2).linear
for k in range(40): one(k)
gc.collect(); before = counts()
for k in range(200): one(k)
gc.collect(); after = counts()
print(after[0] / before[0], after[1] - before[1], after[2] - before[2])
"""
    growth, threads, files = map(float, python(script).split())
    assert growth <= 1.05 and threads <= 0 and files == 0


def test_peak_memory_of_a_render(python):
    """Beside the array 1.4 times as much, and its light (16 bits a voxel), where no spline takes a copy; and buffers whose size is none of the volume's."""
    script = """
import numpy as np, chiaro
def peak():
    return next(int(line.split()[1]) * 1024 for line in open("/proc/self/status") if line.startswith("VmHWM"))
n = 256
z, y, x = np.ogrid[:n, :n, :n]
a = ((x * 3 + y * 5 + z * 7) % 4096).astype("u2")
a[:] = a
chiaro.render("sample:ball:16", size=(64, 48))
open("/proc/self/clear_refs", "w").write("5")
before = peak()
chiaro.render(a, size=(64, 48), interpolation="linear")
print((peak() - before - 2.4 * a.nbytes) / 1e6)
"""
    assert float(python(script)) <= 32


def test_the_tool_comes_along(tool, python):
    assert chiaro.__version__ in tool("--version")
    done = subprocess.run([sys.executable, "-m", "chiaro", "render", "--stepp", "1"], capture_output=True, text=True)
    assert done.returncode == 2 and "did you mean '--step'" in done.stderr


def test_nothing_is_loaded_under_a_public_name(python):
    """Of our own folder only names with a hash of their bytes, and nothing under the GPL."""
    said = python("import chiaro, os; chiaro.render('sample:ball:16', size=(8, 6))\n"
                  "print('\\n'.join(sorted({l.split()[-1] for l in open('/proc/self/maps') if '/chiaro/' in l and '.so' in l})))")
    names = [os.path.basename(path) for path in said.split()]
    assert any(name.startswith("libchiaro-python") for name in names) and any(name.startswith("libtbb-") for name in names)
    import re

    for name in names:
        assert re.search(r"-[0-9a-f]{8}\.so|^libchiaro-python|^_chiaro\.", name), name
        assert "jbig" not in name and "stdc++" not in name
