"""Runs the command given, then prints its exit code, CPU seconds and peak memory (bytes) as JSON on the file descriptor named first.

A process of its own, because on Linux a child starts with its parent's peak memory as its own: it must have a small parent.
"""

import json
import os
import subprocess
import sys


def main():
    report, command = int(sys.argv[1]), sys.argv[2:]
    child = subprocess.Popen(command)
    _, status, usage = os.wait4(child.pid, 0)
    figures = [os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024]
    os.write(report, json.dumps(figures).encode())


if __name__ == "__main__":
    main()
