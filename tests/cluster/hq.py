"""The part of the program `hq` that droptower uses, by HyperQueue's Python package, which holds the server and the worker
but not that program: options as in `hq submit --help`, answers as with `--output-mode=json`.
"""

import argparse
import datetime
import json
import os

from hyperqueue.ffi.client import ClientConnection
from hyperqueue.ffi.protocol import JobDescription, ResourceRequest, TaskDescription
from hyperqueue.output import StdioDef


class Counted(Exception):
    """Ends the wait for a job after its first count."""


def seconds(text):
    return datetime.timedelta(seconds=float(text.removesuffix("s")))


def parsed():
    parser = argparse.ArgumentParser(prog="hq")
    parser.add_argument("--output-mode", choices=["json"], required=True)
    commands = parser.add_subparsers(dest="command", required=True)
    submit = commands.add_parser("submit")
    submit.add_argument("--name", required=True)
    submit.add_argument("--array", required=True)
    submit.add_argument("--cpus", type=int, required=True)
    submit.add_argument("--time-limit", type=seconds, required=True)
    submit.add_argument("--time-request", type=seconds, required=True)
    submit.add_argument("--crash-limit", type=int, required=True)
    submit.add_argument("--cwd", required=True)
    submit.add_argument("--stdout", required=True)
    submit.add_argument("--stderr", required=True)
    submit.add_argument("program", nargs="+")
    info = commands.add_parser("job").add_subparsers(dest="action", required=True).add_parser("info")
    info.add_argument("id", type=int)
    return parser.parse_args()


def submit(client, options):
    first, last = map(int, options.array.split("-"))

    def task(number):
        log = StdioDef.from_path(options.stdout.replace("%{TASK_ID}", str(number)))
        return TaskDescription(
            id=number, args=options.program, cwd=options.cwd, stdout=log, stderr=log, stdin=None,
            env={"HQ_TASK_ID": str(number)}, dependencies=[], task_dir=False, priority=0,
            resource_request=[ResourceRequest(cpus=options.cpus)], crash_limit=options.crash_limit,
        )

    job = JobDescription(name=options.name, tasks=[task(number) for number in range(first, last + 1)], max_fails=None)
    return {"id": client.submit_job(job)}


def info(client, number):
    counts = {}

    def count(jobs):
        counts.update(jobs[number])
        raise Counted

    try:
        client.wait_for_jobs([number], count)
    except Counted:
        pass
    left = counts["total"] - counts["finished"] - counts["failed"]
    # The package does not tell tasks that wait from those that run.
    stats = {"running": left, "finished": counts["finished"], "failed": counts["failed"], "canceled": 0, "waiting": 0}
    return [{"info": {"id": number, "task_count": counts["total"], "task_stats": stats}}]


options = parsed()
client = ClientConnection(os.environ["HQ_SERVER_DIR"])
answer = submit(client, options) if options.command == "submit" else info(client, options.id)
print(json.dumps(answer))
