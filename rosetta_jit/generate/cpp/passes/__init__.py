"""What kernels become for C++ before they are printed: fewer checks, numbers and lists by themselves."""
