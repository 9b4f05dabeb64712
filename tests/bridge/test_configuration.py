"""Files of bridges: what they mean, and what is wrong with them, with the place."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.bridge.checking import checked, lines
from rosetta_jit.bridge.configuration import read
from rosetta_jit.bridge.patterns import matching, place_to_list
from rosetta_jit.cli import main

DOCUMENTS = Path(__file__).resolve().parents[2] / "docs"
GOOD = """
[bridge]
metrics = "127.0.0.1:0"

[[route]]
name = "torso"
source = "tcp:9001"
target = "tcp:9002"            # where the others listen
mapping = "yarp/icub/torso_state.mapping"
decode = { encoding = "yarp4" }
rate = 30
full = "newest"

[[route]]
source = "yarp:/icub/*/state:o"
target = "rsb:/icub/{1}?type=bottle"
between = ["yarp3", "yarp4"]

[[rpc]]
serve = "tcp:9003"
call = "tcp:9004"
"""


def write(tmp_path, text):
    (tmp_path / "bridge.toml").write_text(text)
    return str(tmp_path / "bridge.toml")


def test_what_a_file_means(tmp_path, capsys):
    path = write(tmp_path, GOOD)
    first, second = read(path).routes
    assert (first.name, first.rate, first.full, second.name) == (
        "torso",
        30.0,
        "newest",
        "yarp:/icub/*/state:o > rsb:/icub/{1}?type=bottle",
    )
    assert "  by   read yarp/icub/torso_state.mapping (yarp4), write the data-holder as it is" in lines(checked(path))
    assert main(["bridge", path, "--check"]) == 0
    assert "at most 30 a second, 100 wait for the target; when that many do, new ones are dropped" in capsys.readouterr().out
    assert main(["bridge", path, "--check", "--json"]) == 0
    assert [each["by"] for each in json.loads(capsys.readouterr().out)["routes"]][1:] == ["yarp3 to yarp4", "as they are"]


def test_patterns_become_routes():
    route = read_one('source = "yarp:/icub/*/state:o?carrier=fast_tcp"\ntarget = "rsb:/icub/{1}"')
    assert place_to_list(route.source) == "yarp:/icub/?carrier=fast_tcp"
    channels = ["/icub/head/state:o", "/icub/a/b/state:o", "/icub/x?y/state:o", "/other", "/icub/../state:o", "/icub/..\n/state:o"]
    found = [*matching(route, channels)]
    assert [(each.source, each.target) for each in found] == [
        ("yarp:/icub/head/state:o?carrier=fast_tcp", "rsb:/icub/head"),
        ("yarp:/icub/x%3fy/state:o?carrier=fast_tcp", "rsb:/icub/x_y"),
        ("yarp:/icub/../state:o?carrier=fast_tcp", "rsb:/icub/_"),
        ("yarp:/icub/..\n/state:o?carrier=fast_tcp", "rsb:/icub/.._"),
    ]


def read_one(text):
    import tempfile
    from pathlib import Path

    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "a.toml").write_text(f"[[route]]\n{text}\n")
        return read(f"{folder}/a.toml").routes[0]


@pytest.mark.parametrize(
    ("text", "said", "place"),
    [
        ("[[route]\n", "this is not TOML", ":1:8"),
        ("", "there is nothing to do", ":1:1"),
        ('[[route]]\nsuorce = "tcp:1"\n', "did you mean `source`?", ":2:10"),
        ('[[route]]\nsource = "tcp:1"\n', "`target` and `call`", ":1:1"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nrate = -1 # no\n', "`rate` is a number", ":4:8"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nfull = "never"\n', '"oldest", "newest" or "block"', ":4:8"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:1"\n', "come back to it for ever", ":3:10"),
        ('[[route]]\nsource = "tpc:1"\ntarget = "tcp:2"\n', "`tpc:1` is no address", ":2:10"),
        ('[[route]]\nsource = "tcp:1?frames=u32"\ntarget = "tcp:2"\n', "no option", ":2:10"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nmapping = "none.mapping"\n', "none.mapping", ":4:11"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nbetween = ["yarp3", "cdr"]\n', "nothing turns any message", ":4:11"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nfull = "block"\n', "only pipes can wait", ":4:8"),
        ('[[route]]\nsource = "rsb:/a*"\ntarget = "tcp:2"\n', "a route for each channel", ":2:10"),
        (
            '[[route]]\nname="a"\nsource = "tcp:1"\ntarget = "tcp:2"\n[[route]]\nname="a"\nsource = "tcp:1"\ntarget = "tcp:3"\n',
            "two routes `a`",
            ":6:6",
        ),
        ('[[route]]\nsource = "tcp:1"\ntarget = "rsb:/a"\n', "add ?type=…, the wire schema", ":3:10"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "ros1:/a"\n', "add ?type=…, the type's name", ":3:10"),
        ('[[rpc]]\nserve = "tcp:1"\n', "lacks `serve` or `call`", ":1:1"),
        ('[[rpc]]\nserve = "tcp:1"\ncall = "tcp:2"\nrequest = 5\n', "`request` is the mapping", ":4:11"),
        ("route = 5\n", "written as [[route]]", ":1:9"),
        ('[[route]]\nsource = "tcp:99999"\ntarget = "tcp:2"\n', "a host and a port", ":2:10"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "unix:"\n', "a path of at most", ":3:10"),
        ('[[route]]\nsource = "ros1:/a b"\ntarget = "tcp:*"\n', "a host and a port", ":3:10"),
        ('[[rpc]]\nserve = "tcp:1"\ncall = "yarp:a"\n', "a port's name", ":3:8"),
        ('[[rpc]]\nserve = "rsb:a b"\ncall = "tcp:1"\n', "a scope", ":2:9"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nrate = nan\n', "`rate` is a number", ":4:8"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\ntimeout = inf\n', "`timeout` is a number", ":4:11"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nqueue = 9999999999\n', "from 1 to 1000000", ":4:9"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nbetween = ["yarp3", 4]\n', "two encodings", ":4:11"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nbetween = ["yarp3", "yarp4"]\nmapping = "a"\n', "two ways", ":5:11"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nmapping = "a"\ndecode_type = "b"\n', "two ways", ":5:15"),
        ('[[rpc]]\nserve = "tcp:1"\ncall = "tcp:2"\nreply.between = 0\n', "two encodings", ":1:1"),
        ("[bridge]\nsearch_path = 0\n", "a list of folders", ":2:15"),
        ("[bridge]\nsearch_path = [0]\n", "a list of folders", ":2:15"),
        ('[bridge]\nmetrics = "here"\n', "127.0.0.1:9464", ":2:11"),
        ("[bridge]\ninterval = nan\n", "`interval` is a number", ":2:12"),
    ],
)
def test_mistakes_have_a_place(tmp_path, text, said, place):
    path = write(tmp_path, text)
    with pytest.raises(rj.BridgeError) as found:
        checked(path)
    assert said in str(found.value)
    assert f"{path}{place}" in str(found.value)
    assert "^" in str(found.value)


def test_mistakes_as_json(tmp_path, capsys):
    assert main(["bridge", write(tmp_path, "route = 5\n"), "--check", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["diagnostics"][0]["line"] == 1
    assert main(["bridge", str(tmp_path / "none.toml")]) == 1


@pytest.mark.parametrize("name", ["bridges.md", "ros1-to-ros2.md", "rsb.md", "yarp-to-ros2.md"])
def test_the_files_of_the_documents_are_right(tmp_path, name):
    """With the mappings that the document writes beside them."""
    document = DOCUMENTS.joinpath(name).read_text("utf-8")
    for mapping in re.findall(r'MAPPING = """\n(.*?)"""', document, re.DOTALL):
        (tmp_path / "torso.mapping").write_text(mapping)
    for text in re.findall(r"```toml\n(.*?)```", document, re.DOTALL):
        try:
            assert lines(checked(write(tmp_path, text)))
        except rj.BridgeError as error:
            if "takes a package" not in str(error):
                raise


def test_what_two_types_do_not_share_is_said(tmp_path):
    options = 'decode = { encoding = "ros1" }\nencode = { encoding = "cdr" }\n'
    types = 'decode_type = "sensor_msgs/Range"\nencode_type = "sensor_msgs/msg/Range"\n'
    (tmp_path / "b.toml").write_text(f'[[route]]\nsource = "tcp:9001"\ntarget = "tcp:9002"\n{types}{options}')
    found = lines(checked(str(tmp_path / "b.toml")))
    assert [each.strip() for each in found if each.strip().startswith("`")][-1] == "`.variance` is zero or empty"
