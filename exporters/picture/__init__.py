"""PNG: pictures of a scene and of a camera, and the canvas they are drawn on."""
