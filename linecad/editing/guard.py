"""Who may talk to the page's server: this machine, this page, with the token that the command printed.

Any web page that a browser shows may send requests to 127.0.0.1, and any program of this machine may open the port. So
each request must name the server by its numbers (Host: a foreign name may be bound to 127.0.0.1 by its owner), must not
come from a page of another origin, and, for everything but the page itself, must carry the token in a header of ours,
which no foreign page can send without a preflight that is refused. No cookies: they do not know ports.
"""

import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

Message = MutableMapping[str, Any]
Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

HOST = "127.0.0.1"
TOKEN_BYTES = 32
TOKEN_HEADER = b"x-linecad-token"
GUARDED = "/api/"
LARGEST_BODY = 2**20  # bytes; an edit takes some hundred, one of all 4,000 crossings of a photo a quarter of this

HEADERS = {
    "content-security-policy": "; ".join(
        [
            "default-src 'none'",
            "script-src 'self'",
            "style-src 'self'",
            "img-src 'self'",
            "connect-src 'self'",
            "base-uri 'none'",
            "form-action 'none'",
            "frame-ancestors 'none'",
        ]
    ),
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cross-origin-resource-policy": "same-origin",
    "cross-origin-opener-policy": "same-origin",
    "cache-control": "no-store",
}
_HEADERS = [(name.encode(), value.encode()) for name, value in HEADERS.items()]


def new_token() -> str:
    """A token that nobody can guess."""
    return secrets.token_urlsafe(TOKEN_BYTES)


class Guard:
    """ASGI middleware that lets through what the module's first lines allow, and gives every answer the headers."""

    def __init__(self, app: App, token: str, port: int) -> None:
        self.app = app
        self.token = token.encode()
        self.host = f"{HOST}:{port}".encode()
        self.origin = f"http://{HOST}:{port}".encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        if scope["type"] != "http":  # the page uses no web sockets
            raise ValueError(f"a {scope['type']} connection was asked for")
        status, text = self._refusal(scope)
        if status:
            await _answer(send, status, text)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message.get("headers", []), *_HEADERS]
            await send(message)

        await self.app(scope, _Limited(receive), send_with_headers)

    def _refusal(self, scope: Scope) -> tuple[int, str]:
        """Status and reason, or 0 for a request that may pass."""
        headers: list[tuple[bytes, bytes]] = scope["headers"]
        if _values(headers, b"host") != [self.host]:
            return 400, "this server is for its own page alone; open the address that linecad edit printed"
        if any(origin != self.origin for origin in _values(headers, b"origin")):
            return 403, "requests from other pages are refused"
        if any(site not in (b"same-origin", b"none") for site in _values(headers, b"sec-fetch-site")):
            return 403, "requests from other pages are refused"
        if scope["path"].startswith(GUARDED):
            tokens = _values(headers, TOKEN_HEADER)
            if len(tokens) != 1 or not secrets.compare_digest(tokens[0], self.token):
                return 401, "the token is missing or wrong; open the address that linecad edit printed"
            if scope["method"] == "POST" and _media_type(headers) != b"application/json":
                return 415, "only JSON is taken"
        length = _values(headers, b"content-length")
        if length and not (length[0].isdigit() and len(length[0]) < 12 and int(length[0]) <= LARGEST_BODY):
            return 413, f"a request has at most {LARGEST_BODY} bytes"
        return 0, ""


class TooLargeError(Exception):
    """A body without a true length went on beyond LARGEST_BODY."""


class _Limited:
    """A request's body that ends in TooLargeError where it gets too long."""

    def __init__(self, receive: Receive) -> None:
        self.receive = receive
        self.bytes = 0

    async def __call__(self) -> Message:
        message = await self.receive()
        self.bytes += len(message.get("body", b""))
        if self.bytes > LARGEST_BODY:
            raise TooLargeError
        return message


def _values(headers: list[tuple[bytes, bytes]], name: bytes) -> list[bytes]:
    return [value for key, value in headers if key.lower() == name]


def _media_type(headers: list[tuple[bytes, bytes]]) -> bytes:
    found = _values(headers, b"content-type")
    return found[0].split(b";")[0].strip().lower() if len(found) == 1 else b""


async def _answer(send: Send, status: int, text: str) -> None:
    body = text.encode()
    headers = [(b"content-type", b"text/plain; charset=utf-8"), (b"content-length", str(len(body)).encode()), *_HEADERS]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
