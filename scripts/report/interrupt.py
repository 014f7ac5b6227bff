"""Signals end a script with one line and 128 + the signal, as they end shapebench, also while it imports."""
import os
import signal
import sys

NUMBERS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGALRM, signal.SIGUSR1,
           signal.SIGUSR2, signal.SIGXCPU)


caught = []  # the signal


def stop(number, _):
    caught.append(number)
    for other in NUMBERS:
        signal.signal(other, signal.SIG_IGN)  # drafts are being removed
    print(f"{os.path.basename(sys.argv[0])}: interrupted: nothing was written", file=sys.stderr)
    sys.exit(128 + number)


def check():
    """Ends the script once more: Python drops what a handler raises while it frees things."""
    if caught:
        sys.exit(128 + caught[0])


def said(dropped):
    """Not the end itself, of which Python otherwise says that it was dropped."""
    if not caught:
        sys.__unraisablehook__(dropped)


def watch():
    sys.unraisablehook = said
    for number in NUMBERS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, stop)
