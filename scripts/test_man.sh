#!/usr/bin/env bash
# Every command has a page of the manual; pages are shown without a warning, and have what --help has.
#
# usage: scripts/test_man.sh BUILD_FOLDER     exit codes: 0 passed, 1 failed, 77 no pages: install help2man
set -euo pipefail
build=${1:?BUILD_FOLDER missing}
command -v help2man >/dev/null && command -v man >/dev/null || { echo "no help2man or no man"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
pages=0
for name in shapebench $("$build/shapebench" --help | sed -nE 's/^  ([a-z]+)  .*/shapebench-\1/p'); do
    page=$build/man/$name.1.gz
    [ -s "$page" ] || { echo "no page $name"; exit 1; }
    LC_ALL=C.UTF-8 MANWIDTH=120 man --warnings -l "$page" >"$folder/shown" 2>"$folder/warnings"
    [ ! -s "$folder/warnings" ] || { cat "$folder/warnings"; exit 1; }
    ! command -v mandoc >/dev/null || zcat "$page" | mandoc -T lint -W warning || exit 1
    command=${name#shapebench} command=${command#-}
    grep -qE "^ +$name +- " "$folder/shown" || { echo "$name: no name"; exit 1; }
    "$build/shapebench" help $command | sed -nE 's/^ +(-[a-zV?], )?(--[a-z-]+).*/\2/p' |
        while read -r option; do # hyphens are not broken in options
            grep -qF -- "$option" "$folder/shown" || { echo "$name: no $option"; exit 1; }
        done
    pages=$((pages + 1))
done
[ "$pages" -gt 10 ] || { echo "only $pages pages"; exit 1; }
command -v mandoc >/dev/null || echo "no mandoc: not tested with it"
