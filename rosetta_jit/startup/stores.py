"""The code of `__init__` for so many fields that are all given, compiled with this module: no class has to wait for its own."""
# ruff: noqa: D103, E501, E702, F821 - a line for each number of fields; the names are those that each class gives

from __future__ import annotations

from types import CodeType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    STORES: tuple[CodeType, ...]
    """For no field, for one, and so on."""
else:
    # fmt: off
    def of_0(self): pass
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
    def of_17(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13); set14(self, a14); set15(self, a15); set16(self, a16)
    def of_18(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13); set14(self, a14); set15(self, a15); set16(self, a16); set17(self, a17)
    def of_19(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17, a18): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13); set14(self, a14); set15(self, a15); set16(self, a16); set17(self, a17); set18(self, a18)
    def of_20(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17, a18, a19): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13); set14(self, a14); set15(self, a15); set16(self, a16); set17(self, a17); set18(self, a18); set19(self, a19)
    def of_21(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17, a18, a19, a20): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13); set14(self, a14); set15(self, a15); set16(self, a16); set17(self, a17); set18(self, a18); set19(self, a19); set20(self, a20)
    def of_22(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17, a18, a19, a20, a21): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13); set14(self, a14); set15(self, a15); set16(self, a16); set17(self, a17); set18(self, a18); set19(self, a19); set20(self, a20); set21(self, a21)
    def of_23(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13); set14(self, a14); set15(self, a15); set16(self, a16); set17(self, a17); set18(self, a18); set19(self, a19); set20(self, a20); set21(self, a21); set22(self, a22)
    def of_24(self, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23): set0(self, a0); set1(self, a1); set2(self, a2); set3(self, a3); set4(self, a4); set5(self, a5); set6(self, a6); set7(self, a7); set8(self, a8); set9(self, a9); set10(self, a10); set11(self, a11); set12(self, a12); set13(self, a13); set14(self, a14); set15(self, a15); set16(self, a16); set17(self, a17); set18(self, a18); set19(self, a19); set20(self, a20); set21(self, a21); set22(self, a22); set23(self, a23)
    _ALL = (
        of_0, of_1, of_2, of_3, of_4, of_5, of_6, of_7, of_8, of_9, of_10, of_11, of_12,
        of_13, of_14, of_15, of_16, of_17, of_18, of_19, of_20, of_21, of_22, of_23, of_24,
    )
    # fmt: on

    STORES = tuple(each.__code__ for each in _ALL)
