"""Object code: from the compiler, into files, into the process."""
