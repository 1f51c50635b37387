"""A HyperQueue server with one worker, from its Python package.

    hyperqueue_server.py FOLDER CORES
"""

import signal
import sys
from pathlib import Path

from hyperqueue.cluster import LocalCluster, WorkerConfig

folder = Path(sys.argv[1])
folder.mkdir(parents=True)
with LocalCluster(str(folder), WorkerConfig(cores=int(sys.argv[2]))):
    (folder / "ready").touch()
    signal.sigwait({signal.SIGTERM, signal.SIGINT})
