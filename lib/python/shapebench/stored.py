"""Files that shapebench stored, opened only when they are whole: the reader of results.py and of every script (which
have it by a link), as bench/store/h5.h's is that of every command. It imports nothing of its folder."""
import contextlib
import functools
import os
import sys
import warnings
import zlib

import h5py
import numpy as np

USER_BLOCK = 512  # bytes before HDF5, which have the checksum (bench/store/checksum.h)
FORMAT = {"libver": ("v110", "v110"), "userblock_size": USER_BLOCK}  # of h5py.File() that is to write such a file
OLD = (b"\x89HDF\r\n\x1a\n\0", b"\x89HDF\r\n\x1a\n\1")  # HDF5's superblocks of versions without checksums
PART = 1 << 24  # bytes read at once
DEEPEST = 8  # groups in groups
VIEWS = {"frames", "fields", "topologies"}  # parts of a trajectory's datasets; HDF5 crashes where they are damaged

# What h5py raises for damaged files, and Python for objects of another kind than expected.
DAMAGE = (LookupError, OSError, ValueError, RuntimeError, TypeError, AttributeError, MemoryError, ArithmeticError)


class Unusable(Exception):
    """A file that cannot be used; says which, why, and what helps."""


def user_block(file):
    """The user block that belongs to the rest of an open file."""
    crc = 0
    for part in iter(lambda: file.read(PART), b""):
        crc = zlib.crc32(part, crc)
    text = f"shapebench: CRC-32 {crc:08x} of {file.tell() - USER_BLOCK} bytes of HDF5 after this block\n"
    return text.encode().ljust(USER_BLOCK, b"\0")


def write_checksum(file):
    """Fills the user block of a file that is open for reading and writing, and that HDF5 has closed."""
    file.seek(USER_BLOCK)
    block = user_block(file)
    file.seek(0)
    file.write(block)


@functools.lru_cache  # a sequence of pictures opens it for each
def checksum_holds(path, *_):
    """Whether the file that is there now is as it was stored; raises Unusable where it is none of the format."""
    if not os.path.isfile(path):  # a pipe would be waited for
        raise Unusable(f"{path}: is a {'directory' if os.path.isdir(path) else 'pipe or device, not a file'}")
    try:
        with open(path, "rb") as file:
            head = file.read(USER_BLOCK)
            holds = head == user_block(file)
    except OSError as error:
        raise Unusable(f"{path}: cannot be read: {error.strerror}") from None
    if head.startswith(OLD):
        raise Unusable(f"{path}: HDF5 without checksums, as shapebench stored it until November 2026: make it again, "
                       f"or convert it: h5repack -m 1 -L -f FLET {path} NEW.h5")
    return holds


def bytes_held(group, unchecked, deep=0):
    """How large the datasets in a group are. One that was never written can claim any size. Those without checksums
    are added to `unchecked`."""
    if deep > DEEPEST:
        raise ValueError("groups lie in groups without an end")
    held = 0
    for name in group:
        if name in VIEWS:
            continue
        node = group[name]
        if isinstance(node, h5py.Group):
            held += bytes_held(node, unchecked, deep + 1)
        elif node.size:
            held += node.size * node.dtype.itemsize
            unchecked += [] if node.fletcher32 else [name]
    return held


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


def print_remark(text):
    """How scripts take the remarks of opened()."""
    print(text, file=sys.stderr)


@contextlib.contextmanager
def opened(path, remark=warnings.warn):
    """The file, for `with`; raises Unusable, also for what the body finds missing or of another kind than expected. HDF5
    compares its own checksums as the body reads; a file that another program has written to is used, with a remark."""
    try:
        found = os.stat(path)
    except OSError:
        raise Unusable(f"{path}: no such file") from None
    holds = checksum_holds(path, found.st_ino, found.st_mtime_ns, found.st_size)
    unchecked = []
    try:
        with h5py.File(path, "r") as file:
            if bytes_held(file, unchecked) > found.st_size:
                raise ValueError("it holds more than its size")
            yield file
    except DAMAGE as error:
        why = " ".join(str(error).split()) or type(error).__name__
        if "lock file" in why or "already open" in why:
            raise Unusable(f"{path}: another program has it open, or ended while it had: close it there, or type "
                           f"h5clear -s {path}") from None
        raise Unusable(f"{path}: not an HDF5 file, or cut off ({why})" if "truncated" in why or "signature" in why else
                       f"{path}: something is missing or damaged ({why}): make it again") from None
    if not holds:
        remark(f"{path}: written to by another program; "
               + ("some of its data have no checksums" if unchecked else "HDF5's own checksums hold"))
