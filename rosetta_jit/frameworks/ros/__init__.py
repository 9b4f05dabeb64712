"""What ROS 1 and ROS 2 share: the line-oriented language of `.msg` files, with what differs between them as data (`Dialect`)."""

from rosetta_jit.frameworks.ros.dialect import Dialect, Interface, Rule
from rosetta_jit.frameworks.ros.gather import Gathered
from rosetta_jit.frameworks.ros.schema import definition_of, gathered, schema_of
from rosetta_jit.frameworks.ros.tree import Definition, Field

__all__ = ["Definition", "Dialect", "Field", "Gathered", "Interface", "Rule", "definition_of", "gathered", "schema_of"]
