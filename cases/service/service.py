"""The service under load: started on some cores, asked over HTTP by many clients, measured by the system's figures."""

import http.client
import json
import os
import signal
import subprocess
import threading
import time
from contextlib import contextmanager
from pathlib import Path

# Seconds that a request, and the start of the service, may take.
LIMIT = 60
# Seconds for which a connection may be idle: the service hangs up after 20.
IDLE = 10


class Refused(Exception):
    """What is no good answer."""


class Client:
    """A client with a connection of its own, to this machine."""

    def __init__(self, port):
        self.port = port
        self.connection, self.used = None, 0.0

    def ask(self, method, path, body=None):
        """A good answer's body."""
        if time.monotonic() - self.used > IDLE:
            self.close()
        if self.connection is None:
            self.connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=LIMIT)
        try:
            kind = {"Content-Type": "application/json"} if body is not None else {}
            self.connection.request(method, path, body, kind)
            answer = self.connection.getresponse()
            text = answer.read()
        except (OSError, http.client.HTTPException) as error:
            self.close()
            raise Refused(f"{method} {path}: {error!r}") from error
        self.used = time.monotonic()
        if answer.status >= 300:
            raise Refused(f"{method} {path}: {answer.status} {text[:200].decode(errors='replace')}")
        return text

    def json(self, method, path, content=None):
        """An answer that is JSON."""
        return json.loads(self.ask(method, path, None if content is None else json.dumps(content)))

    def ended(self, job, until):
        """Follows a job by its events to its end: the job."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=LIMIT)
        try:
            connection.request("GET", f"/v1/jobs/{job}/events")
            answer, kind = connection.getresponse(), ""
            if answer.status != 200:
                raise Refused(f"events: {answer.status}")
            while line := answer.readline().decode():
                if line.startswith("event:"):
                    kind = line[6:].strip()
                elif line.startswith("data:") and kind == "end":
                    return json.loads(line[5:])
                if time.monotonic() > until:
                    raise Refused(f"job {job} takes too long")
        except (OSError, http.client.HTTPException) as error:
            raise Refused(f"events of {job}: {error!r}") from error
        finally:
            connection.close()
        raise Refused(f"events of {job}: no end came")

    def close(self):
        """Hangs up."""
        if self.connection is not None:
            self.connection.close()
            self.connection = None


class Service:
    """A service that is at work."""

    def __init__(self, process, port):
        self.process, self.port = process, port

    def processes(self):
        """The service and what it has started."""
        found = [self.process.pid]
        for pid in found:
            try:
                found += map(int, Path(f"/proc/{pid}/task/{pid}/children").read_text().split())
                for task in Path(f"/proc/{pid}/task").iterdir():
                    found += [int(child) for child in (task / "children").read_text().split() if int(child) not in found]
            except OSError:
                continue
        return found

    def processor(self):
        """Seconds of the processor that its processes have taken, with those that have ended."""
        ticks = 0
        for pid in self.processes():
            try:
                figures = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
            except OSError:
                continue
            ticks += sum(map(int, figures[11:15]))
        return ticks / os.sysconf("SC_CLK_TCK")

    def memory(self):
        """Memory in MB: what is the service's own, and that of all its processes, shared pages once."""
        own, all_of_it = 0.0, 0.0
        for pid in self.processes():
            try:
                lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
            except OSError:
                continue
            kilobytes = next((int(line.split()[1]) for line in lines if line.startswith("Pss:")), 0)
            all_of_it += kilobytes / 1024
            own += kilobytes / 1024 if pid == self.process.pid else 0
        return own, all_of_it


@contextmanager
def started(program, folder, cores, log):
    """A service on some cores, for as long as the block lasts."""
    words = [program, "serve", "--listen", "127.0.0.1:0", "--data", folder, "--jobs", len(cores), "--threads", len(cores)]
    with open(log, "wb") as sink:
        process = subprocess.Popen(
            list(map(str, words)), stdin=subprocess.DEVNULL, stdout=sink, stderr=sink, start_new_session=True,
            preexec_fn=lambda: os.sched_setaffinity(0, cores),
        )
    try:
        yield Service(process, _port(process, log))
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(LIMIT)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _port(process, log):
    """Where it listens, once it says so."""
    until = time.monotonic() + LIMIT
    while time.monotonic() < until and process.poll() is None:
        for line in Path(log).read_text(errors="replace").splitlines():
            if "listens at http://127.0.0.1:" in line:
                return int(line.split("127.0.0.1:")[1].split(";")[0])
        time.sleep(0.05)
    raise SystemExit(f"the service does not start ({log}):\n{Path(log).read_text(errors='replace')[-2000:]}")


def uploaded(port, files):
    """{name: id} of files that are sent."""
    client, ids = Client(port), {}
    for name, path in files.items():
        ids[name] = json.loads(client.ask("POST", f"/v1/files?name={name}", path.read_bytes()))["id"]
    client.close()
    return ids


class Clients:
    """Many clients that run jobs: each takes the next one when it has the results of its last."""

    def __init__(self, port, ids, jobs, digest, until):
        self.port, self.ids, self.jobs, self.digest, self.until = port, ids, jobs, digest, until
        self.results = [None] * len(jobs)
        self.errors = []
        # The job that was asked for last, for who asks for its state.
        self.last = None
        self._next, self._lock = iter(range(len(jobs))), threading.Lock()

    def run(self, count):
        """Runs all jobs by so many clients; seconds."""
        began = time.monotonic()
        threads = [threading.Thread(target=self._client, daemon=True) for _ in range(count)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(max(self.until - time.monotonic(), 0) + LIMIT)
            if thread.is_alive():
                self.errors.append("a client has not ended in time")
        return time.monotonic() - began

    def _client(self):
        client = Client(self.port)
        while time.monotonic() < self.until:
            with self._lock:
                number = next(self._next, None)
            if number is None:
                break
            try:
                self.results[number] = self._one(client, self.jobs[number])
            except (Refused, LookupError, ValueError) as error:
                self.errors.append(f"job {number}: {error}")
        client.close()

    def _one(self, client, job):
        """Digests of what a job writes."""
        files = {name: self.ids[name] for name in job.reads}
        asked = client.json("POST", "/v1/jobs", {"command": job.command, "arguments": list(job.words), "files": files})
        self.last = asked["id"]
        ended = client.ended(asked["id"], self.until)
        if ended["state"] != "done":
            raise Refused(f"{ended['state']}: {ended['reason']}")
        made = {one["name"]: one["id"] for one in client.json("GET", f"/v1/jobs/{ended['id']}/results")}
        found = []
        for name in job.writes:
            digest = self.digest(client.ask("GET", f"/v1/jobs/{ended['id']}/results/{name}"))
            if digest != made[name]:
                raise Refused(f"{name}: what came down is not what was made")
            found.append(digest)
        return found
