"""How the server of the page starts and ends: on 127.0.0.1 alone, by Uvicorn."""

import os
import socket
from collections.abc import Callable

import uvicorn

from linecad.editing.guard import HOST, Guard
from linecad.errors import EditorError

STOP_S = 3  # that open requests get when the server ends


def listen(port: int) -> socket.socket:
    """A socket on 127.0.0.1 alone; port 0 takes a free one. EditorError when the port is taken."""
    listener = socket.socket()
    try:
        if os.name == "posix":  # else a port is taken for a minute after its last connection; elsewhere it means more
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((HOST, port))
        listener.listen()
    except OSError as error:
        listener.close()
        raise EditorError(
            f"port {port} cannot be used: {error.strerror}; leave out --port to take a free one"
        ) from None
    return listener


def serve(app: Guard, listener: socket.socket, on_ready: Callable[[], None]) -> None:
    """Serve until Ctrl-C or a request to end; `on_ready` is called when the first request can come."""
    config = uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        ws="none",
        lifespan="off",
        timeout_graceful_shutdown=STOP_S,
    )
    _Server(config, on_ready).run(sockets=[listener])


class _Server(uvicorn.Server):
    def __init__(self, config: uvicorn.Config, on_ready: Callable[[], None]) -> None:
        super().__init__(config)
        self.on_ready = on_ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Tell when the server listens."""
        await super().startup(sockets)
        self.on_ready()
