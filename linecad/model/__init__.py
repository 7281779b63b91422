"""From decided crossings to a model: lines in space, planes, faces, scale, the scene."""
