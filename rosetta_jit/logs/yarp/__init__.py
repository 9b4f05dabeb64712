"""What `yarpdatadumper` writes: folders with `data.log` and `info.log`, and a file an image."""
