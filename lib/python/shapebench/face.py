"""The library's C face, declared by its own header: shapebench.h lies beside this file, and its enums, structs and
functions are read from there. Nothing is declared twice; a test holds what is read to a C compiler's."""

from __future__ import annotations

import ctypes
import functools
import operator
import os
import re
from pathlib import Path
from typing import Any, Iterable, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

HERE = Path(__file__).resolve().parent
NUMBERS = {"int": ctypes.c_int, "double": ctypes.c_double, "char": ctypes.c_char, "int64_t": ctypes.c_int64,
           "uint8_t": ctypes.c_uint8}


class Error(Exception):
    """What the library refuses or fails at; its text is the library's own line. `code` is one of shapebench.h's."""

    code = 0


class UsageError(Error, ValueError):
    """SB_USAGE: an argument is missing or out of range, or the call is not possible now."""

    code = 2


class InputError(Error):
    """SB_INPUT: a file, a mesh or the parameters of a body cannot be used."""

    code = 3


class Header:
    """What a C header declares that is written as shapebench.h is: typedefs of structs, enums, functions."""

    def __init__(self, text: str) -> None:
        text = re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL)
        self.constant = {name: int(value) for name, value in re.findall(r"^#define (\w+) (\d+)$", text, re.MULTILINE)}
        text = re.sub(r"^#(.*\\\n)*.*$", "", text, flags=re.MULTILINE)
        self.choices: dict[str, dict[str, int]] = {}  # by a member's name, all of its enum, "sum_fast" as "fast"
        for body in re.findall(r"\benum\s*\{(.*?)\}", text, re.DOTALL):
            self._enum(body)
        self.struct: dict[str, Any] = {}
        for body, name in re.findall(r"\btypedef struct\s*\{(.*?)\}\s*(\w+);", text, re.DOTALL):
            self._struct(name, body)
        self.function = {name: (result.strip(), [argument.strip() for argument in arguments.split(",")])
                         for result, name, arguments in
                         re.findall(r"^((?:const )?\w+[ *]+)(\w+)\(([^()]*)\);", text, re.MULTILINE)}

    def _enum(self, body: str) -> None:
        value, number = -1, {}
        for name, given in re.findall(r"(\w+)\s*(?:=\s*(\d+))?\s*(?:,|$)", body):
            number[name] = value = int(given) if given else value + 1
        self.constant |= number
        start = os.path.commonprefix(list(number)).rpartition("_")[0] + "_"
        self.choices |= dict.fromkeys(number, {name.removeprefix(start).lower(): number[name] for name in number})

    def _struct(self, name: str, body: str) -> None:
        fields = []
        for line in body.split(";"):
            kind, _, names = line.strip().removeprefix("const ").partition(" ")
            for star, member, length in re.findall(r"(\*?)(\w+)(?:\[(\w+)\])?", names):
                of: Any = ctypes.c_void_p if star else NUMBERS.get(kind) or self.struct[kind]
                fields.append((member, of * int(self.constant.get(length, length)) if length else of))
        self.struct[name] = type(name, (ctypes.Structure,), {"_fields_": fields})


header = Header((HERE / "shapebench.h").read_text(encoding="utf-8"))
version = ".".join(str(header.constant[f"SHAPEBENCH_VERSION_{part}"]) for part in ("MAJOR", "MINOR", "PATCH"))


def argument_type(text: str) -> Any:
    """Of an argument as the header has it: "const double pose[12]" is a pointer."""
    return ctypes.c_void_p if "*" in text or "[" in text else NUMBERS[text.split()[0]]


def load(path: str) -> Any:
    """A library with the header's functions; ImportError says what is missing, and what helps."""
    try:
        library = ctypes.CDLL(path)  # its calls let go of the interpreter's lock
    except OSError as error:
        needed = re.match(r"(lib[\w+-]+)\.so\.(\d+): cannot open", str(error))
        helps = f": install it (Debian's {needed[1]}{needed[2]})" if needed and needed[1] != "libshapebench" else \
            ": set SHAPEBENCH_LIBRARY to libshapebench.so's place, or install the wheel"
        raise ImportError(f"shapebench's library cannot be loaded: {error}{helps}") from None
    for name, (result, arguments) in header.function.items():
        if not hasattr(library, name):
            raise ImportError(f"{path} is older than this module: it has no {name}()")
        function = getattr(library, name)
        function.restype = {"int": ctypes.c_int, "void": None}.get(result, ctypes.c_char_p)
        function.argtypes = [argument_type(text) for text in arguments if text != "void"]
    if library.sb_version() // 10000 != header.constant["SHAPEBENCH_VERSION_MAJOR"]:
        raise ImportError(f"{path} is version {library.sb_version_text().decode()}, and this module is for {version}")
    return library


@functools.lru_cache(maxsize=None)
def library() -> Any:
    """The library, loaded by the first call: that of SHAPEBENCH_LIBRARY, else the one beside this file, which an
    installation has, else the loader's."""
    own = HERE / "libshapebench.so"
    loaders = f"libshapebench.so.{header.constant['SHAPEBENCH_VERSION_MAJOR']}"
    return load(os.environ.get("SHAPEBENCH_LIBRARY") or (str(own) if own.exists() else loaders))


def call(name: str, *arguments: Any) -> None:
    """A function that can fail, its sb_error apart."""
    error = header.struct["sb_error"]()
    code = getattr(library(), name)(*arguments, ctypes.byref(error))
    if code:
        kind = {UsageError.code: UsageError, InputError.code: InputError}.get(code, Error)
        raise kind(error.text.decode("utf-8", "replace"))


def text(name: str, *arguments: Any) -> Optional[str]:
    """A function that returns a string."""
    found = getattr(library(), name)(*arguments)
    return None if found is None else found.decode()


# ---- what goes in


def chars(value: str, name: str) -> bytes:
    """Text for C, which ends at a 0."""
    made = os.fsencode(value)
    if b"\0" in made:
        raise UsageError(f"'{name}' holds a 0 character")
    return made


def whole(value: Any, name: str, bits: int = 64) -> int:
    """A whole number that C's type holds; ctypes would cut it off."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"'{name}' is {value!r}: a whole number is wanted") from None
    if not -1 << bits - 1 <= number < 1 << bits - 1:
        raise UsageError(f"'{name}' is {number}: it does not fit {bits} bits")
    return number


def array(value: ArrayLike, kind: Any, name: str, *shape: Optional[int]) -> NDArray[Any]:
    """`value` as the flat rows that the library wants: itself where it is so already, else a copy. None in the shape is
    any length, also none at all. (9, 3) and (27,) both fit (None, 3); (3, 9) and (9, 4), which are something else, do
    not."""
    if isinstance(value, np.ma.MaskedArray) and np.any(value.mask):
        raise UsageError(f"'{name}' has masked values: fill or drop them")
    given = np.asarray(value)
    wanted = np.dtype(kind)
    if given.dtype.kind not in ("iu" if wanted.kind in "iu" else "biuf") and given.size:
        raise TypeError(f"'{name}' is of {given.dtype}: {'whole ' if wanted.kind in 'iu' else ''}numbers are wanted")
    if wanted.kind in "iu" and given.size and given.dtype != wanted:
        fits = np.iinfo(wanted)
        if int(given.min()) < fits.min or int(given.max()) > fits.max:
            raise UsageError(f"'{name}' has numbers that do not fit {wanted}")
    flat = np.ascontiguousarray(given, dtype=wanted)
    try:
        if given.ndim == len(shape) and any(length not in (None, size) for length, size in zip(shape, given.shape)):
            raise ValueError
        return flat.reshape([-1 if length is None else length for length in shape])
    except ValueError:
        sizes = " x ".join("n" if length is None else str(length) for length in shape)
        raise UsageError(f"'{name}' has the shape {given.shape}: {sizes} numbers are wanted") from None


def pointer(of: Optional[NDArray[Any]]) -> Optional[int]:
    """Valid while the caller keeps the array."""
    return None if of is None else of.ctypes.data


def room(out: Optional[NDArray[Any]], kind: Any, *shape: int) -> NDArray[Any]:
    """`out`, where it is given and can be filled as it is, else a new array."""
    if out is None:
        return np.empty(shape, kind)
    if not isinstance(out, np.ndarray) or out.dtype != np.dtype(kind) or not out.flags.c_contiguous or \
            not out.flags.writeable or out.shape != shape:
        raise UsageError(f"'out' cannot be filled: a writeable, C-contiguous array of {np.dtype(kind)} and of the shape "
                         f"{shape} is wanted")
    return out


def choice(name: str, member: str, value: Union[str, int]) -> int:
    """The number of "lists", for instance, where `member` is one of its enum's; numbers are the library's to judge."""
    if not isinstance(value, str):
        return whole(value, name, 32)
    known = header.choices[member]
    if value not in known:
        raise UsageError(f"'{name}' is '{value}': it is one of {', '.join(known)}")
    return known[value]


def params(kind: str, given: Iterable[Tuple[str, Any]], choices: dict[str, str]) -> Any:
    """A struct with the library's defaults, and in their place what is given and not None.
    `choices` has a member of the enum of those that are one. Arrays that it points to live as long as it does."""
    made = header.struct[kind]()
    getattr(library(), f"{kind}_init")(ctypes.byref(made))
    made.kept = []
    for name, value in given:
        if value is not None:
            put(made, name, value, choices)
    return made


def put(struct: Any, name: str, value: Any, choices: dict[str, str]) -> None:
    """Sets a member of a struct. Of a pointer, `value` is an array or a struct, which the struct keeps."""
    of = dict(struct._fields_)[name]
    if name in choices:
        setattr(struct, name, choice(name, choices[name], value))
    elif of is ctypes.c_void_p:
        struct.kept.append(value)
        setattr(struct, name, pointer(value) if isinstance(value, np.ndarray) else ctypes.addressof(value))
    elif of is ctypes.c_double:
        setattr(struct, name, float(value))
    elif hasattr(of, "_length_"):
        numbers = array(value, np.dtype(of._type_), name, of._length_)
        getattr(struct, name)[:] = numbers.tolist()
    else:
        setattr(struct, name, whole(value, name, 8 * ctypes.sizeof(of)))


def filled(kind: str, name: str, handle: Any) -> dict[str, Any]:
    """A struct that the library fills, as a dictionary."""
    made = header.struct[kind]()
    call(name, handle, ctypes.byref(made))
    values = ((field, getattr(made, field)) for field, _ in made._fields_)
    return {field: tuple(value) if isinstance(value, ctypes.Array) else value for field, value in values}

