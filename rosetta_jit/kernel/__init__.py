"""The kernel IR: its grammar and meaning on one page (`ir`), its printer, and the interpreter that defines what kernels do."""
