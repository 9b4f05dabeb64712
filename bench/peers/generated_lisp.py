"""Generated Lisp in a process of SBCL, which times its own loops."""

from __future__ import annotations

import subprocess
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rosetta_jit.api.options import request_of
from rosetta_jit.generate.build import generated

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from pathlib import Path

    import numpy as np

TIMING = """
(require :asdf)
(let ((*standard-output* (make-broadcast-stream)))
  (asdf:load-asd (truename "joints.asd"))
  (asdf:load-system "joints"))
(in-package #:joints)
(defvar *octets* (coerce '({octets}) 'octets))
(defvar *message* (decode *octets*))
(defvar *codec* (make-codec))
(defun nanoseconds ()
  (multiple-value-bind (seconds microseconds) (sb-ext:get-time-of-day)
    (* 1000 (+ (* 1000000 seconds) microseconds))))
(defun nanoseconds-of-one (octets message codec iterations)
  (let ((start (nanoseconds)))
    (with-floats
      (dotimes (number iterations)
        (decode octets :codec codec :before message)))
    (/ (- (nanoseconds) start) iterations 1d0)))
(format t "~{{~F~^ ~}}~%" (coerce (joint-angles-angles *message*) 'list))
(loop (finish-output)
      (format t "~F~%" (nanoseconds-of-one *octets* *message* *codec* (read))))
"""


@contextmanager
def generated_lisp(mapping: Path, folder: Path, message: bytes, angles: np.ndarray) -> Generator[Callable[[int], float]]:
    """The decoder of a mapping of joints: a function from iterations to nanoseconds a message. Fills the angles."""
    for name, text in generated(request_of("decode", {"encoding": "yarp3"}, mapping=str(mapping)), "lisp", ("decode",), "joints").items():
        (folder / name).write_text(text)
    (folder / "timing.lisp").write_text(TIMING.format(octets=" ".join(map(str, message))))
    process = subprocess.Popen(["sbcl", "--script", "timing.lisp"], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    given, said = process.stdin, process.stdout
    assert given is not None
    assert said is not None

    def timed(iterations: int) -> float:
        given.write(f"{iterations}\n")
        given.flush()
        return float(said.readline())

    try:
        angles[:] = [float(each) for each in said.readline().split()]
        yield timed
    finally:
        process.kill()
        process.communicate()
