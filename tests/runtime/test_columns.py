"""Columns of one message, and columns for whoever reads DLPack."""

from __future__ import annotations

import copy
import gc
import pickle
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from rosetta_jit.kernel.state import VALID
from rosetta_jit.runtime.batches.batch import Batch
from rosetta_jit.runtime.batches.nested import Columns, Ragged

sys.path.insert(0, str(Path(__file__).parent))
from schemas import flat, whole
from test_arrow import all_kinds, filled


def test_arrays_of_structs_of_one_message():
    holder = flat()()
    holder.parts = [{"x": index, "name": "n" * index, "values": [index] * index} for index in range(4)]
    columns = holder.column("parts")
    assert columns["x"].tolist() == [0, 1, 2, 3]
    assert columns["name"].to_list() == ["", "n", "nn", "nnn"]
    assert holder.column("parts.values").to_list() == [[], [1], [2, 2], [3, 3, 3]]
    holder.column("parts.x")[1:3] = 7
    assert [part.x for part in holder.parts] == [0, 7, 7, 3]
    assert holder.column("small") == 0
    assert holder.column("part")["values"].tolist() == []
    with pytest.raises(KeyError):
        holder.column("parts.nothing")


def test_columns_of_nested_messages_are_attributes():
    batch = Batch.new(flat(), 3)
    batch[2].parts, batch[1].part.x = [{"x": 5}], 3
    assert batch.part.x.tolist() == [0, 3, 0]
    assert batch.parts.values.x.tolist() == [5]
    assert batch.part["values"].to_list() == [[], [], []]  # `values` is what dictionaries have, too
    assert {"x", "name", "keys"} <= set(dir(batch.part))
    assert pickle.loads(pickle.dumps(batch.part)).x.tolist() == [0, 3, 0]  # noqa: S301 - our own bytes
    assert copy.deepcopy(batch.part).x.tolist() == [0, 3, 0]
    with pytest.raises(AttributeError, match="no column 'nothing' among x, name, values"):
        _ = batch.part.nothing


def test_columns_of_views():
    """A row of a batch, a struct in a list, and a struct that is not there."""
    batch = Batch.new(flat(), 3)
    batch[2].parts = [{"x": 5}]
    assert batch[2].column("parts.x").tolist() == [5]
    assert batch[1].column("parts.x").tolist() == []
    assert batch[2].parts[0].column("x") == 5
    holder = whole()()
    assert holder.child.column("parts.x").tolist() == []
    with pytest.raises(TypeError, match="contain each other"):
        holder.column("children")


def test_columns_of_texts_and_arrays_become_columns_of_pandas():
    pandas = pytest.importorskip("pandas")
    batch = Batch.new(flat(), 3)
    batch[1].parts, batch[2].part.name = [{"x": 5}], "n"
    frame = pandas.DataFrame({"name": batch.part.name, "values": batch.part["values"], "x": batch.parts})
    assert frame["name"].tolist() == ["", "", "n"]
    assert [each.tolist() for each in frame["values"]] == [[], [], []]
    assert frame["x"][1].x.tolist() == [5]
    assert list(batch.part.name) == ["", "", "n"]


def test_arrays_in_arrays_are_one_array():
    batch = Batch.new(all_kinds(), 3)
    batch[1].grid[:] = [[1, 2], [3, 4], [5, 6]]
    grids = batch.grid.to_numpy()
    assert grids.shape == (3, 3, 2)
    assert grids[1].tolist() == [[1, 2], [3, 4], [5, 6]]
    assert np.shares_memory(grids, batch.lanes.buffers[batch._family.tree.root.entries["grid"].node.element.lane])
    batch[0].rows = [[1, 2], [3, 4]]
    with pytest.raises(ValueError, match="lengths"):
        batch.rows.to_numpy()


def test_dlpack():
    batch = Batch.new(flat(), 3)
    batch[1].fixed = [4, 5, 6]
    for column in (batch.small, batch.fixed):
        shown = np.from_dlpack(column)
        assert np.shares_memory(shown, column if isinstance(column, np.ndarray) else column.values)
        assert pa.Tensor.from_dlpack(column).to_numpy().tolist() == shown.tolist()
    assert np.from_dlpack(batch.fixed).tolist() == [[0, 0, 0], [4, 5, 6], [0, 0, 0]]
    assert batch.fixed.__dlpack_device__() == (1, 0)


def test_tensors_of_pytorch_and_jax():
    """They keep the memory that they show, also when the batch grows or is gone."""
    torch, jax = pytest.importorskip("torch"), pytest.importorskip("jax")
    batch = Batch.new(flat(), 3)
    batch[1].fixed, batch[2].small = [4, 5, 6], 7
    shown, numbers = torch.from_dlpack(batch.fixed), torch.from_dlpack(batch.small)
    assert jax.numpy.from_dlpack(batch.fixed).tolist() == shown.tolist()
    assert jax.numpy.from_dlpack(np.ascontiguousarray(batch.small)).tolist() == numbers.tolist() == [0, 0, 7]
    shown[0, 0] = 1
    assert batch[0].fixed[0] == 1
    batch.reset(1000)
    del batch
    gc.collect()
    assert shown[1].tolist() == [4, 5, 6]


def test_names_of_columns():
    """A path goes on in messages alone: never is it the column of another field."""
    batch = Batch.new(all_kinds(), 2)
    for name, words in (
        ("txt", "t.All has no field `txt`; did you mean `text`?"),
        ("part.naem", "t.Part has no field `naem`; did you mean `name`?"),
        ("i8.text", "`i8` is no message, and has no fields"),
        ("text.i8", "`text` is no message, and has no fields"),
        ("nine.text", "`nine` is no message, and has no fields"),
    ):
        for asked in (batch.column, batch.mask, batch[0].column):
            with pytest.raises(KeyError) as caught:
                asked(name)
            assert caught.value.args == (words,)
    with pytest.raises(KeyError, match="`parts` has many elements"):
        batch.mask("parts.x")
    with pytest.raises(KeyError, match="did you mean `text`"):
        batch[0].has("txt")
    assert batch.column("by_name.x").values["value"].tolist() == []


def test_what_a_batch_shows():
    batch = Batch.new(flat(), 6)
    batch[1].parts = [{"x": 5}]
    assert {"small", "parts", "column", "to_arrow", "concatenate"} <= set(dir(batch))
    assert not {"lanes", "room", "_family", "_kept"} & set(dir(batch))
    with pytest.raises(AttributeError, match=r"<Batch of 6 .*> has no field 'smal'") as caught:
        _ = batch.smal
    assert (caught.value.name, caught.value.obj) == ("smal", batch)


def test_a_batch_whose_decode_failed_says_so():
    batch = Batch.new(flat(), 6)
    batch.lanes.words[VALID] = 0
    assert repr(batch) == f"<Batch of {batch._family.struct.name}: the last decode failed>"
    assert "the last decode failed" in batch._repr_html_()
    with batch.lanes:
        batch.lanes.begin_filling()
        assert repr(batch) == f"<Batch of {batch._family.struct.name}: in use>"


def test_rows_of_ragged_columns():
    batch = Batch.new(all_kinds(), 6)
    for row, text in enumerate(("", "é", "b", "c", "d", "e")):
        batch[row].text, batch[row].names = text, [text] * row
    texts, names = batch.column("text"), batch.column("names")
    assert repr(texts) == "<Ragged of 6 texts: '', 'é', 'b', 'c', …>"
    assert repr(names[1:3]) == "<Ragged of 2 arrays: <Ragged of 1 texts: 'é'>, <Ragged of 2 texts: 'b', 'b'>>"
    assert texts[1:3].to_list() == ["é", "b"]
    assert texts[::-2].to_list() == ["e", "c", "é"]
    assert texts[np.array([True, False] * 3)].to_list() == ["", "b", "d"]
    assert texts[[-1, 1]].to_list() == ["e", "é"]
    assert names[2:][0].to_list() == ["b", "b"]
    with pytest.raises(IndexError):
        _ = texts[[6]]


def columns_within(found, path):
    yield path, found
    if isinstance(found, Columns):
        for name, each in found.items():
            yield from columns_within(each, f"{path}.{name}")


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_columns_are_arrays_of_arrow(seed):
    """Of texts, arrays and messages, as the table has them: null where a message lacks them, which the columns themselves do not show."""
    batch = filled(20, seed)
    every = [each for name in batch._family.tree.root.entries for each in columns_within(batch.column(name), name)]
    assert {"part", "part.at", "part.at.label", "rows"} <= {path for path, _ in every}
    for path, found in every:
        if isinstance(found, Ragged | Columns):
            array = pa.array(found)
            array.validate(full=True)
            wanted = batch.to_arrow([path]).column(0).combine_chunks()
            assert array.type == wanted.type
            assert array.to_pylist() == wanted.to_pylist(), path


def test_fields_of_elements_are_arrays_of_arrow():
    batch = filled(20, 4)
    parts, pairs = batch.to_arrow()["parts"].to_pylist(), batch.to_arrow()["pair"].to_pylist()
    for path, wanted in [
        ("parts.at.x", [[each["at"]["x"] for each in row] for row in parts]),
        ("parts.x", [[each["x"] for each in row] for row in parts]),
        ("pair.at", [[each["at"] for each in row] for row in pairs]),
    ]:
        array = pa.array(batch.column(path))
        array.validate(full=True)
        assert array.to_pylist() == wanted, path
    assert not pa.array(batch.column("parts.at.x")).type.value_field.nullable
    assert pa.array(batch.column("parts.x")).type.value_field.nullable


def test_tables_and_frames_of_nested_columns():
    batch = Batch.new(flat(), 3)
    batch[1].part = {"x": 3, "name": "n"}
    assert pa.table({"part": batch.part}).to_pylist() == [{"part": each} for each in batch.to_arrow()["part"].to_pylist()]
    assert pa.table(batch.part).column("name").to_pylist() == ["", "n", ""]
    polars = pytest.importorskip("polars")
    assert polars.Series("part", batch.part).struct.field("x").to_list() == [None, 3, None]
    assert polars.DataFrame(batch.part)["name"].to_list() == ["", "n", ""]


def test_parts_of_columns_are_arrays_of_their_values():
    batch = Batch.new(flat(), 3)
    batch[2].part, batch[1].parts = {"name": "n"}, [{"x": 5}]
    assert pa.array(batch.part.name[1:]).to_pylist() == ["", "n"]
    assert pa.array(copy.copy(batch.part.name)).to_pylist() == ["", "", "n"]
    assert pa.array(batch.parts.values).to_pylist() == [{"x": 5, "name": "", "values": []}]
    assert pa.array(batch.parts[1:]).to_pylist() == [[{"x": 5, "name": "", "values": []}], []]
    batch[0].by_name = {"k": {"x": 7}}
    assert pa.array(batch.by_name[:1]).to_pylist() == [[("k", {"x": 7, "name": "", "values": []})]]
    assert pa.table(batch[1].column("parts")).to_pylist() == [{"x": 5, "name": "", "values": []}]
    with pytest.raises(TypeError, match="fields of one message"):
        pa.array(batch[1].column("part"))


def named():
    """Six messages of which one has all kinds of texts, and one elements."""
    batch = Batch.new(all_kinds(), 4)
    for row, text in enumerate(("base", "arm", "base", "a\0")):
        batch[row].text, batch[row].data = text, text.encode()
    batch[1].names = ["x", "y"]
    return batch


def test_texts_are_compared_one_by_one():
    batch = named()
    assert (batch.text == "base").tolist() == [True, False, True, False]
    assert (batch.text != "base").tolist() == [False, True, False, True]
    assert (batch.text == ["base", "x", "base", "x"]).tolist() == [True, False, True, False]
    assert (batch.data == b"arm").tolist() == [False, True, False, False]
    assert (batch.text == batch.text).all()
    assert len(batch[batch.text == "base"]) == 2
    assert batch.text != None  # noqa: E711 - as of any object
    with pytest.raises(ValueError, match="4 texts are compared with one, or with as many, not with 2"):
        _ = batch.text == ["base", "arm"]
    with pytest.raises(TypeError, match="compared row by row"):
        _ = batch.names == "base"
    with pytest.raises(TypeError, match="compared field by field"):
        _ = batch.part == batch.part


def test_a_truth_value_chooses_no_message():
    """``batch[False]`` was message 0, which a comparison gave that was none."""
    batch = named()
    for index in (True, False, np.bool_(True), (1, 2)):
        with pytest.raises(TypeError, match="messages are chosen by"):
            _ = batch[index]
    for index in (True, False):
        with pytest.raises(TypeError, match="messages are chosen by"):
            _ = batch.text[index]
    with pytest.raises(TypeError, match=r"column\[1\]\[2\]"):
        _ = batch.names[1, 0]
    for name in ("text", ["text", "data"]):
        with pytest.raises(TypeError, match=r"columns by `batch.column\(name\)`"):
            _ = batch[name]


def test_texts_are_arrays_of_numpy_with_the_zeros_at_their_end():
    pandas = pytest.importorskip("pandas")
    batch = named()
    assert np.asarray(batch.text).tolist() == batch.text.to_numpy().tolist() == batch.text.tolist() == ["base", "arm", "base", "a\0"]
    assert np.asarray(batch.data)[3] == b"a\0"
    assert np.asarray(batch.text, dtype="U4")[0] == "base"
    assert np.isin(batch.text, ["arm"]).tolist() == [False, True, False, False]
    assert pandas.Series(batch.data)[3] == b"a\0"
    assert pandas.Series(batch.text)[3] == "a\0"
    assert batch.text[1:].to_numpy().tolist() == ["arm", "base", "a\0"]


def test_fields_of_elements_are_attributes_of_their_column():
    batch = Batch.new(flat(), 3)
    batch[1].parts = [{"x": 5, "name": "a"}, {"x": 6, "name": "b"}]
    batch[2].by_name = {"k": {"x": 7}}
    assert batch.parts.x.to_list() == batch.column("parts.x").to_list() == [[], [5, 6], []]
    assert batch.parts.name[1].to_list() == ["a", "b"]
    assert pa.array(batch.parts.x).type == pa.array(batch.column("parts.x")).type
    assert batch.by_name.key.to_list() == [[], [], ["k"]]
    assert batch.by_name.value.x.to_list() == [[], [], [7]]
    assert pa.array(batch.by_name.key).to_pylist() == [[], [], ["k"]]
    assert {"x", "name"} <= set(dir(batch.parts))
    with pytest.raises(AttributeError, match="a column of arrays has no 'nothing'"):
        _ = batch.parts.nothing


def test_columns_of_messages_are_frames_of_pandas():
    pandas = pytest.importorskip("pandas")
    batch = filled(20, 5)
    whole = pandas.DataFrame(batch)
    part = pandas.DataFrame(batch.part)
    assert [f"part.{name}" for name in part] == [name for name in whole if name.startswith("part.")]
    for name in part:
        assert part[name].isna().tolist() == whole[f"part.{name}"].isna().tolist()
    holder = flat()()
    holder.parts = [{"x": 1, "name": "a", "values": [1.0]}, {"x": 2, "name": "b"}]
    frame = pandas.DataFrame(holder.column("parts"))
    assert (frame["x"].tolist(), frame["name"].tolist()) == ([1, 2], ["a", "b"])
    with pytest.raises(TypeError, match="fields of one message"):
        pandas.DataFrame(holder.column("part"))


def test_tables_of_a_message_that_is_absent():
    """Its numbers were zeros there, and its enums numbers."""
    batch = filled(20, 6)
    wanted = batch.to_arrow(["part"], flatten=True)
    found = pa.table(batch.part)
    for name in found.schema.names:
        if f"part.{name}" in wanted.schema.names:
            assert found[name].to_pylist() == wanted[f"part.{name}"].to_pylist()
            assert found.schema.field(name).type == wanted.schema.field(f"part.{name}").type


def test_columns_are_read_as_a_dictionary():
    batch = Batch.new(flat(), 2)
    columns = batch.part
    assert [*columns] == [*columns.keys()] == [*dict(columns)] == ["x", "name", "values"]
    assert len(columns) == 3
    assert "x" in columns
    assert columns.get("nothing") is None
    assert columns.get("x").tolist() == next(value for name, value in columns.items() if name == "x").tolist() == [0, 0]
    assert repr(columns) == "{'x': [0, 0], 'name': <Ragged of 2 texts: '', ''>, 'values': <Ragged of 2 arrays: [], []>}"
    with pytest.raises(AttributeError, match=r"a column is written into: `.x\[:\] = …`"):
        columns.x = 5
    with pytest.raises(AttributeError, match="no column 'y' among"):
        columns.y = 5


def test_columns_are_changed_in_place():
    """``batch.small += 1`` changes the array, and assigns it to the place where it is."""
    batch = Batch.new(flat(), 3)
    batch[1].small, batch[1].part.x = 5, 7
    batch.small += 1
    batch.part.x *= 2
    batch.column("part").x -= 1
    assert [(each.small, each.part.x) for each in batch] == [(1, -1), (6, 13), (1, -1)]
    with pytest.raises(AttributeError, match=r"a column is written into: `.small\[:\] = …`"):
        batch.small = np.arange(3)
    with pytest.raises(AttributeError, match=r"a column is written into: `.small\[:\] = …`"):
        batch.small = batch.small[:2]
    with pytest.raises(AttributeError, match=r"a column is written into"):
        batch.part.x = batch.part.x.copy()
    with pytest.raises(AttributeError, match="has no field 'smal'"):
        batch.smal = 5
    with pytest.raises(AttributeError, match=r"written into"):
        batch.part = 5
    batch.errors = {}
    assert [each.small for each in pickle.loads(pickle.dumps(batch))] == [1, 6, 1]  # noqa: S301 - our own bytes
