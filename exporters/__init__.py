"""A scene as a file: one module a format, chosen by suffix in `exporters.formats`."""
