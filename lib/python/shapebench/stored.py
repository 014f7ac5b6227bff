"""Files that shapebench stored, opened only when they are whole: the reader of results.py and of every script (which
have it by a link), as bench/store/h5.h's is that of every command. It imports nothing of its folder."""
import contextlib
import functools
import os
import re
import resource
import signal
import zlib

import h5py
import numpy as np

CHECKSUM_LINE = 64  # bytes at the file's end (bench/store/checksum.h)
CHECKSUM_SAYS = "CRC-32, the file's last 64 bytes"  # the attribute of a file that has such a line
CHECKSUM = re.compile(rb"\nshapebench: CRC-32 ([0-9a-f]{8}) of (\d{18}) bytes before\n")
BLOCK = 1 << 24  # bytes read at once
DEEPEST = 8  # groups in groups

# What h5py raises for damaged files, and Python for objects of another kind than expected.
DAMAGE = (LookupError, OSError, ValueError, RuntimeError, TypeError, AttributeError, MemoryError, ArithmeticError)


class Unusable(Exception):
    """A file that cannot be used; says which, why, and what helps."""


def checksum_fits(path):
    """Whether the file is what its last line says; None where it has no such line."""
    with open(path, "rb") as file:
        size = left = os.fstat(file.fileno()).st_size - CHECKSUM_LINE
        if size < 0:
            return None
        file.seek(size)
        line = CHECKSUM.fullmatch(file.read(CHECKSUM_LINE))
        file.seek(0)
        crc = 0
        while line and left > 0:
            block = file.read(min(left, BLOCK))
            crc, left = zlib.crc32(block, crc), left - len(block) if block else -1
        return line and (crc, size) == (int(line[1], 16), int(line[2]))


def with_checksum(content):
    """A file's bytes with the line at its end."""
    return content + b"\nshapebench: CRC-32 %08x of %018d bytes before\n" % (zlib.crc32(content), len(content))


def read_all(group, left, deep=0):
    """Reads everything in a group, and returns how many of the file's `left` bytes it does not account for: what
    was never written, or is linked again and again, could claim any size."""
    for name in group:
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            raise ValueError(f"'{name}' is a link")
        node = group[name]
        dict(node.attrs)
        left -= 1
        if isinstance(node, h5py.Group):
            left = read_all(node, left, deep + 1)
        elif not node.is_virtual:  # the frames of a trajectory are parts of another dataset
            left = read_dataset(node, name, left)
        if left < 0 or deep > DEEPEST:
            raise ValueError(f"'{name}' holds more than the file does")
    return left


def read_dataset(dataset, name, left):
    if dataset.external or dataset.dtype.hasobject:
        raise ValueError(f"'{name}' lies elsewhere")
    size = dataset.size * dataset.dtype.itemsize
    rows = max(1, BLOCK // max(1, size // max(1, len(dataset)))) if dataset.shape else 0
    if size <= left:
        for first in range(0, len(dataset) if rows else 0, rows or 1):
            dataset[first:first + rows]
    return left - size


def try_to_read(path, size):
    """In a child: why the file cannot be read, or nothing."""
    with open("/proc/self/statm", encoding="ascii") as file:
        mapped = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (mapped + (256 << 20) + size,) * 2)
    resource.setrlimit(resource.RLIMIT_CPU, (60 + size // 10**7,) * 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        with h5py.File(path, "r") as file:
            dict(file.attrs)
            read_all(file, size)
        return ""
    except MemoryError:
        return "takes more memory than its size allows"
    except DAMAGE as error:
        return str(error) or type(error).__name__


def why_unreadable(path):
    """Damage can crash the HDF5 library, or have it take any memory or time: a child tries first. It is forked, because
    another interpreter takes 0.2 s to import h5py, and there may be none (in a program that has Python within). Of
    what threads share it needs h5py's lock alone, which this one holds so that it is free there."""
    ends = os.pipe()
    with h5py._objects.phil:
        child = os.fork()
    if not child:
        try:
            for number in signal.valid_signals():
                if callable(signal.getsignal(number)):
                    signal.signal(number, signal.SIG_DFL)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
            os.write(ends[1], try_to_read(path, os.path.getsize(path)).encode()[:2000])
            os._exit(0)
        finally:
            os._exit(1)
    os.close(ends[1])
    with open(ends[0], "rb") as pipe:
        reply = pipe.read()
    if os.waitpid(child, 0)[1]:
        return "so damaged that it cannot be read"
    return " ".join(reply.decode("utf-8", "replace").split())


def check(path):
    """Raises Unusable unless the file is there, ends in its checksum or has none, and can be read to its end."""
    try:
        found = os.stat(path)
    except OSError:
        raise Unusable(f"{path}: no such file") from None
    return check_once(path, found.st_ino, found.st_mtime_ns, found.st_size)


@functools.lru_cache  # a sequence of pictures opens it for each
def check_once(path, *_):
    """check() of the file that is there now."""
    if not os.path.isfile(path):  # a pipe would be waited for
        raise Unusable(f"{path}: it is a {'folder' if os.path.isdir(path) else 'pipe or device'}, not a file")
    try:
        fits = checksum_fits(path)
        if not h5py.is_hdf5(path):
            raise Unusable(f"{path}: not an HDF5 file, or cut off: make it again")
    except OSError as error:
        raise Unusable(f"{path}: cannot be read: {error.strerror}") from None
    if fits is False:
        raise Unusable(f"{path}: damaged: its content is not that of its checksum: make it again")
    why = why_unreadable(path)
    if why:
        cut = "truncated file" in why
        raise Unusable(f"{path}: " + ("not an HDF5 file, or cut off: make it again" if cut else
                                      f"something is missing or damaged ({why}): make it again"))
    return fits


def plain(value):
    """An attribute as Python has it: text, number, or array."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, np.ndarray):
        return value
    return value.item() if hasattr(value, "item") else value


def attributes(node):
    """By number: a signal in h5py's own loop over names, which HDF5 calls back, ends as a SystemError."""
    names = [h5py.h5a.open(node.id, index=n).name.decode() for n in range(h5py.h5a.get_num_attrs(node.id))]
    return {name: plain(node.attrs[name]) for name in names}


@contextlib.contextmanager
def opened(path):
    """The file, for `with`; raises Unusable, also for what the body finds missing or of another kind than expected."""
    fits = check(path)
    try:
        with h5py.File(path, "r") as file:
            if fits is None and "checksum" in file.attrs:
                raise Unusable(f"{path}: its checksum is missing: it was cut off, or something else wrote to it")
            yield file
    except DAMAGE as error:
        why = " ".join(str(error).split()) or type(error).__name__
        raise Unusable(f"{path}: something is missing or damaged ({why}): make it again") from None
