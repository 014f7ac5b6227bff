#!/usr/bin/env bash
# test_columns.sh: results/README.md lists the columns of measured rows as the program does; with --write it is
# made to.
#
# usage: scripts/test_columns.sh PROGRAM [--write]
set -euo pipefail
readme=$(dirname -- "$0")/../results/README.md
now=$(sed '/^<!-- columns -->$/,/^<!-- end of columns -->$/{//!d}' "$readme" \
  | sed '/^<!-- columns -->$/r '<("$1" tables --columns))
if [ "${2-}" = --write ]; then
  printf '%s\n' "$now" >"$readme"
elif ! diff <(printf '%s\n' "$now") "$readme" >&2; then
  echo "results/README.md lists other columns: scripts/test_columns.sh $1 --write mends it" >&2
  exit 1
fi
