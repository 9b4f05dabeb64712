"""How holders of a class are made: the first few in Python, the others by compiled code, which has a recipe for each plan."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Protocol

from rosetta_jit.runtime.attributes.code import functions, is_compiled, library
from rosetta_jit.runtime.attributes.makers import set_recipe
from rosetta_jit.runtime.holder.message import Access, recipe
from rosetta_jit.runtime.limits import FEW_HOLDERS, MAX_RECIPES
from rosetta_jit.runtime.memory_plan import Plan
from rosetta_jit.runtime.row_counts import begun_as


class MadeFamily(Protocol):
    """A family as `Making` knows it."""

    plan: Plan
    array_type: type[Any]

    @property
    def holder(self) -> Any: ...
    @property
    def root(self) -> Access: ...


class Making:
    """What makes the holders of one family.

    Attributes
    ----------
    is_alike : bool
        Whether all that the class makes without arguments are the same at first.
    latest : tuple
        The plan that the class has made the last one of by compiled code, its recipe, and the function for it.
    """

    def __init__(self, family: MadeFamily) -> None:
        self._family = family
        self.is_alike = False
        self.latest: tuple[Any, Any, Any] = None, None, None
        self._made_in_python = 0
        self._recipes: dict[int, tuple[Any, ...]] = {}
        self._offered: Any = None
        self._fresh: tuple[Plan | None, Callable[[], Any]] = None, object

    def is_worth_compiling(self) -> bool:
        """Whether code for what makes holders is to be compiled, if there is none: the first few are made sooner in Python."""
        if library() is None or is_compiled("equip"):
            return True
        self._made_in_python += 1
        return self._made_in_python > FEW_HOLDERS

    def recipe(self, plan: Plan) -> tuple[Any, ...] | None:
        """What compiled code needs to make a holder of a plan; None where there is no such code."""
        found = self._recipes.get(id(plan))
        if found is not None and found[1] is plan:
            return found
        if library() is None:
            return None
        if len(self._recipes) >= MAX_RECIPES:
            self._recipes.clear()
        found = self._recipes[id(plan)] = recipe(plan, self._family.array_type, self._family.root)
        return found

    def new(self, plan: Plan) -> Any:
        """A holder of a plan, of which nobody's constructor runs."""
        found = self.recipe(plan)
        if found is not None:
            return functions()["spawn"](self._family.holder, found)
        holder = self._family.holder.__new__(self._family.holder)
        holder.lay_out_(plan)
        return holder

    def fresh(self) -> Any:
        """A holder with the room that new ones have, of which nobody's constructor runs."""
        plan, make = self._fresh
        if plan is not self._family.plan:
            plan = self._family.plan
            recipe = self.recipe(plan)
            make = partial(self.new, plan) if recipe is None else partial(functions()["spawn"], self._family.holder, recipe)
            self._fresh = plan, make
        return make()

    def offer(self) -> None:
        """Let compiled code make the holders that the class makes without arguments, if they are all alike: as this first one."""
        if not self.is_alike:
            return
        family = self._family
        prototype = type.__call__(family.holder)
        first = begun_as(prototype.lanes_)
        if first is not None and prototype.lanes_.plan is family.plan:
            self._offered = recipe(family.plan, family.array_type, family.root, first)
            set_recipe(family.holder, self._offered)

    def offer_soon(self) -> None:
        """The same for who makes holders in other ways than by calling the class, whose first calls make the offer."""
        if self.is_alike and self.latest[0] is not self._family.plan:
            type.__call__(self._family.holder)
