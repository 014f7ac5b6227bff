#!/usr/bin/env bash
# Follows README.md word for word in a fresh root of each Debian release: runs its commands in their order on a mesh written
# here, installs the package in a second root, makes and uses the wheel as lib/python/README.md says, stores measurements,
# and lets every release read the files of every other. Prints each step to standard error, and README.md's table.
#
# usage: scripts/check_systems.sh [--quick] [RELEASE...]     default: bookworm trixie; --quick leaves out scripts/test
#        TMPDIR holds the roots while this runs, 8 GB each; MIRROR is the archive (http://deb.debian.org/debian), and
#        COMPONENTS what of it (main): of Ubuntu's main,universe
# exit codes: 0 all passed, 1 a step failed, 2 usage, 3 not root, or a program is missing
set -um # -m: steps, and what they test, can be interrupted, though they run in the background
# shellcheck source=scripts/setup
. "$(dirname -- "${BASH_SOURCE[0]}")/setup"
columns=(scripts/run view scripts/test package wheel "stored files")
declare -A cells # "RELEASE COLUMN": ok or FAILED
count=0 status=0 running='' left_out='' logs=$root/build-systems
export mirror=${MIRROR:-http://deb.debian.org/debian} components=${COMPONENTS:-main}
unset COMPONENTS # debootstrap has one of its own
sweep='scripts/run sweep --scene penguin --engine fastlsm --w 1:4 --frames 5 --block 100 -o stored/sweep.h5'

# make_root RELEASE FOLDER: makes a minimal root that knows localhost, and a copy of it for the package; puts the clone,
# and the mesh that README.md calls MESH.obj, into the first.
# shellcheck disable=SC2317 # step() calls it
make_root() {
    debootstrap --variant=minbase --components="$components" "$1" "$2" "$mirror" && echo 127.0.0.1 localhost >"$2/etc/hosts" &&
        echo 'Acquire::Check-Valid-Until "false";' >"$2/etc/apt/apt.conf.d/mirror" && # it may be as of some day
        cp -a -- "$2" "$2-package" &&
        mkdir -p -- "$2-package/shapebench/build" && cp -a -- "$folder/clone" "$2/shapebench" &&
        PYTHONPATH=$2/shapebench/scripts python3 -Bc 'import small_inputs; print(small_inputs.BOX)' >"$2/shapebench/MESH.obj"
}

# inside FOLDER COMMAND: runs a line of shell in the clone of a root.
# shellcheck disable=SC2317 # step() calls it
inside() {
    mount -t proc proc "$1/proc" && mount --rbind /dev "$1/dev" &&
        chroot "$1" /usr/bin/env -i HOME=/root "PATH=$PATH" "http_proxy=${http_proxy-}" bash -c "cd /shapebench && $2"
}
export -f make_root inside

# step RELEASE COLUMN TITLE COMMAND...: runs a command in namespaces of its own, so that its mounts and processes end with
# it; says and notes how it ended.
step() {
    local from=$SECONDS log
    count=$((count + 1))
    log=$(printf '%s/%s-%02d.log' "$logs" "$1" "$count")
    printf '%-9s %-70.70s ' "$1" "${3%%$'\n'*}" >&2
    unshare --mount --pid --fork --mount-proc bash -c '"$@"; exit' - "${@:4}" </dev/null >"$log" 2>&1 &
    running=$!
    if wait "$running"; then
        printf 'ok  %d s\n' $((SECONDS - from)) >&2
        cells[$1 $2]=${cells[$1 $2]-ok}
    else
        printf 'FAILED, log: %s\n' "$log" >&2
        cells[$1 $2]=FAILED status=1
    fi
    running=''
}

# line RELEASE COLUMN COMMAND: one step, a line of shell in the release's clone.
line() { step "$1" "$2" "$3" inside "$folder/$1" "$3"; }

# commands DOCUMENT: prints its indented lines outside of code blocks, without comments.
commands() { sed -n "/^\`\`\`/,/^\`\`\`$/d; s/ *#.*//; s/^    //p" "$folder/clone/$1"; }

# follow_readme RELEASE: runs README.md's commands, from apt-get on in the package's root, and the program installed there.
follow_readme() {
    local command place=$folder/$1 column=package
    while read -r command <&3; do
        case $command in
        "scripts/run view"*) column=view ;;
        scripts/run | scripts/test) column=$command ;;
        "apt-get update")
            place+=-package
            cp -- "$folder/$1/shapebench/build/"shapebench_*.deb "$place/shapebench/build" 2>/dev/null
            ;;
        *) column=package ;;
        esac
        step "$1" "$column" "$command" inside "$place" "$command"
    done 3< <(commands README.md | grep -vxE "$left_out" &&
        printf 'shapebench %s\n' --version "tables --scene penguin --repeats 2" view)
}

# make_wheel RELEASE: makes and installs the wheel by lib/python/README.md's first commands; runs its first example.
make_wheel() {
    local command
    line "$1" wheel "apt-get install -y --no-install-recommends python3-venv"
    while read -r command <&3; do line "$1" wheel "$command"; done 3< <(commands lib/python/README.md | head -n 3)
    line "$1" wheel "sed -n '/^\`\`\`python/,/^\`\`\`\$/{//!p;/^\`\`\`\$/q}' lib/python/README.md |
        MPLBACKEND=agg venv/bin/python - && test -s sag.png"
}

# store RELEASE: stores a table and a sweep; stops the sweep after a point and resumes it.
store() {
    line "$1" "stored files" "mkdir stored && scripts/run tables --scene penguin --repeats 201 -o stored/x.h5"
    line "$1" "stored files" "set -m; $sweep & until [ -e stored/sweep.h5 ] || ! kill -0 %1; do sleep 0.1; done
        kill -TERM %1; wait %1; [ \$? -eq 143 ]" # not INT, which what runs in the background may ignore
    line "$1" "stored files" "$sweep --resume"
}

# read_files RELEASE FOLDER: reads stored files in every way; regress returns 7 where other programs disturbed the times.
read_files() {
    line "$1" "stored files" "scripts/run report $2/x.h5 $2/sweep.h5 -o $2.html"
    line "$1" "stored files" "scripts/run regress $2/x.h5 $2/x.h5 || [ \$? -eq 7 ]"
    line "$1" "stored files" "scripts/run sweep $2/sweep.h5"
    line "$1" "stored files" "PYTHONPATH=lib/python python3 -c 'import shapebench.results as r
assert len(r.read(\"$2/x.h5\")[\"rows\"]) == 1 and len(r.read(\"$2/sweep.h5\")[\"points\"]) == 4'"
}

# table RELEASE...: README.md's table.
table() {
    local release name column
    printf 'The commands of this page in fresh roots: %s, %s.\n\n| system | CMake, gcc, HDF5 |' "$(date -u +%F)" \
        "$(git -C "$folder/clone" describe --always)"
    printf ' %s |' "${columns[@]}"
    printf '\n|'
    printf ' --- |%.0s' - - "${columns[@]}"
    for release; do
        name=$(sed -n 's/^PRETTY_NAME="\(.*\)"/\1/p' "$folder/$release/etc/os-release")
        printf '\n| %s | %s |' "${name:-$release}" \
            "$(chroot "$folder/$release" dpkg-query -W -f "\${Version}\n" gcc libhdf5-dev cmake |
                sed -E 's/^[0-9]+://; s/[-+~].*//; $!s/$/,/' | paste -sd ' ')"
        for column in "${columns[@]}"; do printf ' %s |' "${cells[$release $column]--}"; done
    done
    printf '\n'
}

if [ "${1-}" = --quick ]; then
    left_out=scripts/test columns=(scripts/run view package wheel "stored files")
    shift
fi
[[ ${1-} != -* ]] || { say "usage: scripts/check_systems.sh [--quick] [RELEASE...]" && exit 2; }
[ $# -gt 0 ] || set -- bookworm trixie
if [ "$(id -u)" -ne 0 ] || ! type debootstrap git unshare python3 >/dev/null; then
    say "start this as root, with debootstrap, git, python3 and util-linux installed" && exit 3
fi
export folder && folder=$(mktemp -d) || exit 3
trap '[ -z "$running" ] || { kill -KILL $(</proc/$running/task/$running/children); wait; }; rm -rf -- "$folder"' EXIT
trap 'exit 130' INT TERM
mkdir -p -- "$logs" && rm -f -- "$logs"/*.log && git clone -q --no-hardlinks "$root" "$folder/clone" || exit 1
for release; do
    step "$release" root "fresh root with a clone" make_root "$release" "$folder/$release"
    [ "${cells[$release root]}" = ok ] || continue
    follow_readme "$release"
    rm -rf -- "$folder/$release-package"
    make_wheel "$release"
    store "$release"
    read_files "$release" stored
done
for writer; do
    for release; do
        [ "$release" != "$writer" ] || continue
        cp -R -- "$folder/$writer/shapebench/stored" "$folder/$release/shapebench/of-$writer" 2>/dev/null
        read_files "$release" "of-$writer"
    done
done
table "$@" 2>/dev/null
exit "$status"
