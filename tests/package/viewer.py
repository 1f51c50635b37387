"""`droptower view` finds the viewer that is installed beside it."""

import subprocess
import sys
import time
from pathlib import Path

installed, run = map(Path, sys.argv[1:])
view = subprocess.Popen(
    [installed / "bin/droptower", "view", run], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
)
time.sleep(3)
view.terminate()
printed = view.communicate()[0]
if "is not installed" in printed or view.returncode == 2:
    sys.exit(f"the viewer was not found: {printed}")
