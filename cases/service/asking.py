"""Asks a service for the state of a job, again and again, and prints how long each answer took (seconds, JSON). A process of its own, so that no
other thread of Python is in its way. Usage: asking.py PORT RATE MOST: so many a second, at most so many; the job is the last line of the
standard input, whose end ends it."""

import json
import os
import select
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from service import Client, Refused  # noqa: E402


def main():
    port, rate, most = int(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
    client, took, errors, job, text = Client(port), [], [], None, b""
    due = time.monotonic()
    while len(took) + len(errors) < most:
        due += 1 / rate
        wait = max(due - time.monotonic(), 0)
        if select.select([sys.stdin], [], [], wait)[0]:
            read = os.read(sys.stdin.fileno(), 4096)
            if not read:
                break
            text += read
            whole = text.split(b"\n")[:-1]
            job = whole[-1].decode() if whole else job
            time.sleep(max(due - time.monotonic(), 0))
        if job is None:
            continue
        # Late by another one's work: that is no reason to ask twice as often.
        due = max(due, time.monotonic() - 1 / rate)
        began = time.perf_counter()
        try:
            client.json("GET", f"/v1/jobs/{job}")
            took.append(time.perf_counter() - began)
        except Refused as error:
            errors.append(str(error))
    print(json.dumps({"seconds": took, "errors": errors}))


if __name__ == "__main__":
    main()
