"""HTTP to a service: requests and their answers, uploads that are taken up again, downloads, events. Of the standard library alone."""

from __future__ import annotations

import hashlib
import http.client
import json
import math
import os
import ssl
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, BinaryIO
from urllib.parse import quote, urlencode, urlsplit

from .errors import InputError, ServerError

#: A file that is larger goes up in pieces of so many bytes, each of which can be sent again.
PIECE = 32 << 20
#: So many bytes are read and written at once.
BUFFER = 1 << 18
#: How often what broke off is tried again, and how many seconds are waited before; each time as many more.
TRIES, PAUSE = 6, 1.0
#: Seconds that a connection may take, that an answer may take, and that may pass between two events: the service says something every 15.
CONNECTION, ANSWER, SILENCE = 20.0, 600.0, 60.0

#: What wrong input is answered with.
_WRONG = (400, 413, 415, 422)


class Broken(ServerError):
    """The connection broke off, or was not to be had. It may be tried again."""


class Transport:
    """A service at an address, with the token of who asks. Threads may share it."""

    def __init__(self, url: str, token: str | None) -> None:
        parts = urlsplit(url if "//" in url else f"//{url}", "http")
        try:
            port = parts.port
        except ValueError:
            port = -1
        if parts.scheme not in ("http", "https") or not parts.hostname or port == -1 or parts.username or parts.query:
            raise InputError(f"{url}: give the address of a service, such as http://127.0.0.1:7878")
        self.url = f"{parts.scheme}://{parts.netloc}{parts.path.rstrip('/')}"
        self._base = parts.path.rstrip("/")
        self._host, self._port = parts.hostname, port
        self._tls = ssl.create_default_context() if parts.scheme == "https" else None
        self._token = token
        self._kept = threading.local()
        #: The SHA-256 of what jobs have made, as far as it was looked at: it is there, though it was not uploaded.
        self.made: set[str] = set()
        # Uploads that broke off, by the SHA-256 of their contents.
        self._begun: dict[str, str] = {}

    def _connected(self) -> http.client.HTTPConnection:
        connection: http.client.HTTPConnection
        if self._tls is not None:
            connection = http.client.HTTPSConnection(self._host, self._port, timeout=CONNECTION, context=self._tls)
        else:
            connection = http.client.HTTPConnection(self._host, self._port, timeout=CONNECTION)
        try:
            connection.connect()
        except OSError as error:
            raise Broken(f"{self.url}: {error}; is a `geo-adapt serve` at work there?") from error
        return connection

    def _sent(
        self,
        connection: http.client.HTTPConnection,
        method: str,
        path: str,
        body: bytes | BinaryIO | None,
        headers: Mapping[str, str],
        patience: float,
    ) -> http.client.HTTPResponse:
        """The beginning of an answer, whatever it is."""
        all_headers = {"Accept": "application/json, */*", **headers}
        if self._token:
            all_headers["Authorization"] = f"Bearer {self._token}"
        connection.sock.settimeout(patience)
        try:
            connection.request(method, self._base + path, body=body, headers=all_headers)
        except (BrokenPipeError, ConnectionResetError):
            # Whoever refuses an upload answers and hangs up.
            pass
        return connection.getresponse()

    def _broke(self, error: Exception) -> Broken:
        return Broken(f"{self.url}: the connection broke off: {str(error) or type(error).__name__}")

    def _refusal(self, response: http.client.HTTPResponse) -> Exception:
        """What an answer that is no good one tells."""
        try:
            told = json.loads(response.read(1 << 20))["detail"]
        except (ValueError, LookupError, TypeError, OSError, http.client.HTTPException):
            told = f"{response.status} {response.reason}: this is no service of geo-adapt"
        if response.status in _WRONG:
            return InputError(told)
        return ServerError(f"{self.url}: {told}", response.status)

    @contextmanager
    def opened(
        self,
        method: str,
        path: str,
        body: bytes | BinaryIO | None = None,
        headers: Mapping[str, str] | None = None,
        patience: float = ANSWER,
    ) -> Iterator[http.client.HTTPResponse]:
        """A good answer, over a connection of its own. Who asks too often waits."""
        begin = 0 if body is None or isinstance(body, bytes) else body.tell()
        for attempt in range(TRIES + 1):
            connection = self._connected()
            try:
                try:
                    response = self._sent(connection, method, path, body, headers or {}, patience)
                    wait = response.getheader("Retry-After") if response.status == 429 else None
                    if response.status >= 400 and (wait is None or attempt == TRIES):
                        raise self._refusal(response)
                except (OSError, http.client.HTTPException) as error:
                    raise self._broke(error) from error
                if wait is None:
                    yield response
                    return
            finally:
                connection.close()
            if body is not None and not isinstance(body, bytes):
                body.seek(begin)
            time.sleep(float(wait) if wait.isdigit() else PAUSE)

    def ask(
        self,
        method: str,
        path: str,
        body: bytes | BinaryIO | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> tuple[http.client.HTTPResponse, bytes]:
        """A good answer with its body. What only asks goes over a connection that is kept; what changes something is never sent twice."""
        if method not in ("GET", "HEAD"):
            with self.opened(method, path, body, headers) as response:
                return response, self._read(response)
        for attempt in range(TRIES):
            response, text = self._asked(method, path, headers or {}, may_wait=True)
            if response.status < 400:
                return response, text
            wait = response.getheader("Retry-After") or ""
            time.sleep(float(wait) if wait.isdigit() else PAUSE)
        return self._asked(method, path, headers or {}, may_wait=False)

    def _asked(
        self, method: str, path: str, headers: Mapping[str, str], may_wait: bool
    ) -> tuple[http.client.HTTPResponse, bytes]:
        """A good answer; or one that says to ask again later."""
        kept: http.client.HTTPConnection | None = getattr(self._kept, "connection", None)
        while True:
            self._kept.connection = None
            connection = kept or self._connected()
            try:
                response = self._sent(connection, method, path, None, headers, ANSWER)
                is_late = response.status == 429 and response.getheader("Retry-After") is not None
                if response.status >= 400 and not (is_late and may_wait):
                    raise self._refusal(response)
                text = response.read()
            except (OSError, http.client.HTTPException) as error:
                connection.close()
                if kept is None:
                    raise self._broke(error) from error
                # It was idle for too long.
                kept = None
                continue
            except BaseException:
                connection.close()
                raise
            if not response.will_close:
                self._kept.connection = connection
            return response, text

    def _read(self, response: http.client.HTTPResponse) -> bytes:
        try:
            return response.read()
        except (OSError, http.client.HTTPException) as error:
            raise self._broke(error) from error

    def json(self, method: str, path: str, content: object = None, **query: object) -> Any:
        """An answer that is JSON."""
        given = {name: value for name, value in query.items() if value is not None}
        whole = f"{path}?{urlencode(given)}" if given else path
        body = None if content is None else json.dumps(content, allow_nan=False).encode()
        _, text = self.ask(method, whole, body, {"Content-Type": "application/json"} if body is not None else None)
        return self._decoded(text)

    def _decoded(self, text: bytes) -> Any:
        try:
            return json.loads(text) if text else None
        except ValueError:
            raise ServerError(f"{self.url}: answers with what is no JSON: this is no service of geo-adapt") from None

    # Uploads.

    def has(self, digest: str) -> bool:
        """Whether contents were uploaded."""
        try:
            self.ask("GET", f"/v1/files/{digest}")
        except ServerError as error:
            if error.status != 404:
                raise
            return False
        return True

    def upload(self, file: BinaryIO, name: str) -> dict[str, Any]:
        """Sends a file from its beginning: what the service says of it. A large one goes in pieces (tus 1.0.0), and goes on where it broke off."""
        length = file.seek(0, os.SEEK_END)
        file.seek(0)
        if length > PIECE:
            found: dict[str, Any] = self._in_pieces(file, name, length)
            return found
        kind = {"Content-Type": "application/octet-stream", "Content-Length": str(length)}
        _, text = self.ask("POST", f"/v1/files?name={quote(name, safe='')}", file, kind)
        found = self._decoded(text)
        return found

    def _in_pieces(self, file: BinaryIO, name: str, length: int) -> dict[str, Any]:
        digest = digest_of(file)
        place, offset = self._begun.get(digest), None
        if place is not None:
            offset = self._offset(place)
        if place is None or offset is None:
            begin = {"Upload-Length": str(length), "Tus-Resumable": "1.0.0"}
            response, _ = self.ask("POST", f"/v1/uploads?name={quote(name, safe='')}", b"", begin)
            place, offset = response.getheader("Location") or "", 0
            self._begun[digest] = place
        broken = 0
        while True:
            file.seek(offset)
            piece = file.read(PIECE)
            kind = {"Content-Type": "application/offset+octet-stream", "Upload-Offset": str(offset), "Tus-Resumable": "1.0.0"}
            try:
                response, text = self.ask("PATCH", place, piece, kind)
            except ServerError as error:
                # 409: another part of it is there than was thought.
                may_go_on = error.status is None or error.status == 409 or error.status >= 500
                broken += 1
                if not may_go_on or broken > TRIES:
                    raise
                time.sleep(PAUSE * broken)
                there = self._offset(place)
                offset = offset if there is None else there
                continue
            offset, broken = offset + len(piece), 0
            if response.status == 200:
                del self._begun[digest]
                found: dict[str, Any] = self._decoded(text)
                return found

    def _offset(self, place: str) -> int | None:
        """How much of an upload is there; None where that is not to be known."""
        try:
            response, _ = self.ask("HEAD", place, None, {"Tus-Resumable": "1.0.0"})
        except ServerError:
            return None
        found = response.getheader("Upload-Offset") or ""
        return int(found) if found.isdigit() else None

    # Downloads.

    def download(self, path: str, digest: str, to: BinaryIO) -> None:
        """Writes contents, and checks them. What broke off goes on where it was."""
        known, there, broken = hashlib.sha256(), 0, 0
        while True:
            more = {"Range": f"bytes={there}-", "If-Range": f'"{digest}"'} if there else {}
            try:
                with self.opened("GET", path, None, more) as response:
                    if there and response.status != 206:
                        raise ServerError(f"{self.url}: does not go on with a download; try it again")
                    while chunk := self._chunk(response):
                        to.write(chunk)
                        known.update(chunk)
                        there, broken = there + len(chunk), 0
                break
            except Broken:
                broken += 1
                if broken > TRIES:
                    raise
                time.sleep(PAUSE * broken)
        if known.hexdigest() != digest:
            raise ServerError(f"{self.url}: what came is not what was sent; download it again")

    def _chunk(self, response: http.client.HTTPResponse) -> bytes:
        try:
            chunk = response.read(BUFFER)
        except (OSError, http.client.HTTPException) as error:
            raise self._broke(error) from error
        # With a length that is known, http.client takes an early end for the end.
        if not chunk and response.length:
            raise Broken(f"{self.url}: the connection broke off")
        return chunk

    # Events.

    def events(self, job: str, until: float = math.inf) -> Iterator[tuple[str, dict[str, Any]]]:
        """What becomes of a job, as (kind, job), until the kind "end": server-sent events, taken up again where they broke off. Until a time of
        `time.monotonic` at most; the kind is "late" then, and the job empty."""
        broken = 0
        while True:
            left = until - time.monotonic()
            if left <= 0:
                yield "late", {}
                return
            try:
                with self.opened("GET", f"/v1/jobs/{job}/events", None, None, min(SILENCE, max(left, 0.1))) as response:
                    for kind, told in self._events(response, until):
                        broken = 0
                        yield kind, told
                        if kind in ("end", "late"):
                            return
                broken += 1
            except ServerError as error:
                if error.status is not None and error.status != 429 and error.status < 500:
                    raise
                broken += 0 if time.monotonic() >= until else 1
                if broken > TRIES:
                    raise
            time.sleep(min(PAUSE * min(broken, TRIES), max(until - time.monotonic(), 0.0)))

    def _events(self, response: http.client.HTTPResponse, until: float) -> Iterator[tuple[str, dict[str, Any]]]:
        kind = ""
        while True:
            try:
                line = response.readline()
            except (OSError, http.client.HTTPException, ValueError) as error:
                raise self._broke(error) from error
            if not line:
                return
            text = line.decode(errors="replace").rstrip("\r\n")
            if text.startswith("event:"):
                kind = text[6:].strip()
            elif text.startswith("data:"):
                yield kind, self._decoded(text[5:].strip().encode())
            if time.monotonic() >= until:
                yield "late", {}
                return


def digest_of(file: BinaryIO) -> str:
    """The SHA-256 of a file from its beginning, in hexadecimal digits."""
    known = hashlib.sha256()
    file.seek(0)
    while chunk := file.read(BUFFER):
        known.update(chunk)
    return known.hexdigest()
