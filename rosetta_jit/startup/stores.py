"""The code of `__init__` for so many fields that are all given, compiled with this module: no class has to wait for its own."""
# ruff: noqa: D103, E501, E702, F821 - a line for each number of fields; the names are those that each class gives

from __future__ import annotations

from types import CodeType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    STORES: tuple[CodeType, ...]
    """For one field, for two, and so on."""
else:
    # fmt: off
    def of_1(self, a0): set0(self, a0)
    def of_2(self, a0, a1): set0(self, a0); set1(self, a1)
    def of_3(self, a0, a1, a2): set0(self, a0); set1(self, a1); set2(self, a2)
    def of_4(self, a0, a1, a2, a3): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3)
    def of_5(self, a0, a1, a2, a3, a4): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4)
    def of_6(self, a0, a1, a2, a3, a4, a5): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5)
    def of_7(self, a0, a1, a2, a3, a4, a5, a6): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6)
    def of_8(self, a0, a1, a2, a3, a4, a5, a6, a7): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7)
    def of_9(self, a0, a1, a2, a3, a4, a5, a6, a7, a8): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8)
    def of_10(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9)
    def of_11(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10)
    def of_12(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11)
    def of_13(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12)
    def of_14(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13)
    def of_15(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13); set14(self, a14)
    def of_16(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13); set14(self, a14); set15(self, a15)
    # fmt: on

    _ALL = of_1, of_2, of_3, of_4, of_5, of_6, of_7, of_8, of_9, of_10, of_11, of_12, of_13, of_14, of_15, of_16
    STORES = tuple(each.__code__ for each in _ALL)
