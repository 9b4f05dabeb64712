"""The use case: a component on RSB talks to an iCub simulator on YARP. Neither knows of the other; `bridge.toml` lies between them."""
