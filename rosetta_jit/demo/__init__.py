"""The demo: recordings of an iCub, played through compiled kernels. It uses the public API alone, like any user's program."""
