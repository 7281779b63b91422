"""Pictures of an exported model from where the camera was not, drawn from the file itself."""
