# What the tests of scripts/plot_*.py share; test_plot_NAME.sh sources it, and it goes to a folder that
# is removed in the end. exit codes of those: 0 right, 1 wrong, 77 h5py or matplotlib is missing
set -eu
plot=$(cd -- "$(dirname -- "$0")" && pwd)/$(basename -- "$0" .sh | sed s/^test_//).py
program=$(realpath -- "${1:?BUILD-FOLDER missing}")/shapebench
if ! /usr/bin/python3 -c 'import h5py, matplotlib' 2>/dev/null; then
    echo "skipped: /usr/bin/python3 has no h5py or no matplotlib; scripts/setup installs them"
    exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"

wrong() {
    echo "wrong: $*" >&2
    exit 1
}

# draws FILE: as SVG beside it, and as PNG
draws() {
    local stem=${1%.*}
    "$plot" "$1" >said
    grep -qx "wrote $stem.svg" said || wrong "it says $(cat said)"
    grep -q '</svg>' "$stem.svg" || wrong "no SVG"
    "$plot" "$1" -o "$stem.png"
    [ "$(head -c 4 "$stem.png" | tail -c 3)" = PNG ] || wrong "no PNG"
}

# refused CODE ARGUMENTS...: one line on standard error, and that exit code
refused() {
    local code=0 wanted=$1
    shift
    "$plot" "$@" >out 2>err || code=$?
    [ "$code" -eq "$wanted" ] || wrong "exit code $code, not $wanted: $* $(cat err)"
    [ "$(grep -vc 'written to by another program' err)" -eq 1 ] || wrong "more than a line: $(cat err)"
}

# refuses_others FILE: one that is absent, a text, one of another kind; as output a folder, and one in no folder
refuses_others() {
    refused 3 absent.h5
    echo text >text.h5
    refused 3 text.h5
    /usr/bin/python3 -c 'import h5py; h5py.File("other.h5", "w").attrs["kind"] = "else"'
    refused 3 other.h5
    mkdir folder
    refused 4 "$1" -o folder
    [ ! -e folder.png ] || wrong "it wrote beside the folder"
    refused 4 "$1" -o "no/such/$1.png"
}

# interrupted FILE: Ctrl-C while matplotlib is imported, then while it writes; one line, no draft left
interrupted() {
    local when
    mkdir -p early late
    echo 'import os, signal; os.kill(os.getpid(), signal.SIGINT)' >early/matplotlib.py
    cat >late/sitecustomize.py <<'PYTHON'
import os, signal
from matplotlib.figure import Figure

def savefig(self, file, **how):
    file.write(b"half")
    os.kill(os.getpid(), signal.SIGINT)

Figure.savefig = savefig
PYTHON
    for when in early late; do
        PYTHONPATH=$when refused 130 "$1" -o interrupted.svg
        grep -q 'interrupted: nothing was written' err || wrong "it says $(cat err)"
        [ -z "$(compgen -G 'interrupted*')" ] || wrong "left: $(compgen -G 'interrupted*')"
    done
}
