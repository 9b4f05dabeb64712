"""Classes of Cyclone DDS that contain themselves. It must see the annotations themselves, not their texts."""

from dataclasses import dataclass

from cyclonedds.idl import IdlStruct, annotations, types


@dataclass
@annotations.final
class FinalNode(IdlStruct, typename="FinalNode"):
    tag: types.uint8
    weight: types.float64
    kids: types.sequence["FinalNode"]
    name: str


@dataclass
@annotations.appendable
class AppendableNode(IdlStruct, typename="AppendableNode"):
    tag: types.uint8
    weight: types.float64
    kids: types.sequence["AppendableNode"]
    name: str


@dataclass
@annotations.appendable
class FinalRoot(IdlStruct, typename="FinalRoot"):
    first: types.uint8
    tree: FinalNode
    more: types.sequence[FinalNode]
    last: types.uint8


@dataclass
@annotations.appendable
class AppendableRoot(IdlStruct, typename="AppendableRoot"):
    first: types.uint8
    tree: AppendableNode
    more: types.sequence[AppendableNode]
    last: types.uint8
