"""What a person corrects about a photo: the edits, their file, their application to the lines that were found."""
