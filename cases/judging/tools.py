"""Runs the program and other commands, each with a limit of its own, and keeps what they said."""

import os
import resource
import signal
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path


class Failed(Exception):
    """A step that did not end well; the message has the command and what it said."""


@dataclass
class Tools:
    """The program, the seconds that one command may take, and threads (0: all cores)."""

    program: Path
    limit: float
    threads: int = 0
    log: list = field(default_factory=list)

    def run(self, *words, codes=(0,)):
        """Runs the program; returns what it printed and its CPU seconds."""
        return self.command(self.program, *words, codes=codes)

    def command(self, *words, codes=(0,)):
        """Runs a command; raises Failed with what it said where its exit code is none of `codes`."""
        text = [str(word) for word in words]
        self.log.append(" ".join(text))
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        # A session of its own, so that the mesher that it may have started ends with it.
        with subprocess.Popen(text, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace", start_new_session=True) as child:
            try:
                out, err = child.communicate(timeout=self.limit)
            except subprocess.TimeoutExpired:
                os.killpg(child.pid, signal.SIGKILL)
                raise Failed(f"{' '.join(text)}\n    did not end within {self.limit:g} s") from None
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.log.append(f"# {time.monotonic() - began:.1f} s\n{out}{err}")
        if child.returncode not in codes:
            said = "\n    ".join((err or out).strip().splitlines()[-4:])
            raise Failed(f"{' '.join(text)}\n    ended with {child.returncode}: {said}")
        return out, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def threads_words(self):
        """The option of threads, if any."""
        return ["--threads", self.threads] if self.threads else []


def ended(failed, count, what, began, out):
    """Prints what is wrong, {name: lines}, with `count` of `what` (a plural) done since `began`, time.monotonic(); returns the exit code."""
    for name, lines in failed.items():
        for line in lines:
            print(f"FAILED  {name}: {line}")
    print(f"{count - len(failed)} of {count} {what} ok in {time.monotonic() - began:.0f} s; meshes and logs: {out}")
    return 1 if failed else 0
