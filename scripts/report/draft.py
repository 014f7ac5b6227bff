"""A file that appears whole or not at all, by the rules of bench/store/draft.h."""
import contextlib
import os
import stat

import interrupt


class Refused(Exception):
    """What may not be written; says why, and what helps."""


def resolve(path):
    """Where the bytes go: links at the path's end are followed, so that they stay."""
    other = f"{path}: cannot be written: it is there and not a regular file; choose another name"
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise Refused(other)
    except FileNotFoundError:
        pass  # a new file, also behind a link
    except OSError as error:
        raise Refused(f"{path}: cannot be written: {error.strerror}") from None
    while os.path.islink(path):
        folder = os.path.realpath(os.path.dirname(path) or ".")
        if folder == "/dev" or folder.startswith("/proc/"):  # /dev/stdout stands for what is open
            raise Refused(other)
        path = os.path.join(folder, os.readlink(path))
    return path


def check(path, overwrite):
    """The path to write to and, of a file that is there, its mode; raises Refused."""
    target = resolve(path)
    try:
        mode = os.stat(target).st_mode
    except FileNotFoundError:
        return target, None
    if not mode & 0o222 or not os.access(target, os.W_OK):
        raise Refused(f"{path}: cannot be written: it is write-protected; choose another name, or chmod +w")
    if not overwrite:
        raise Refused(f"{path}: cannot be written: it is there; choose another name, or give --overwrite")
    return target, stat.S_IMODE(mode)


def create(target):
    """A file that was not there, under a name of this process; nobody's link."""
    for n in range(100):  # an older process of this number may have left some
        try:
            return open(f"{target}.{os.getpid()}{f'-{n}' if n else ''}.tmp", "xb")
        except FileExistsError as error:
            last = error
    raise last


@contextlib.contextmanager
def begun(path, overwrite):
    """A new file to write bytes to; it takes its place when the body has ended well. Raises Refused and OSError."""
    target, mode = check(path, overwrite)
    with create(target) as file:
        try:
            yield file
            file.flush()
            os.fsync(file.fileno())
            if mode is not None:
                os.fchmod(file.fileno(), mode)
            interrupt.check()
            os.replace(file.name, target)
        except BaseException:
            os.remove(file.name)
            raise
