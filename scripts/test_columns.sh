#!/usr/bin/env bash
# test_columns.sh: results/README.md lists the columns of measured rows, sweeps, calibrations and claims as the
# program does; with --write it is made to.
#
# usage: scripts/test_columns.sh PROGRAM [--write]
set -euo pipefail
readme=$(dirname -- "$0")/../results/README.md
now=$(cat "$readme")
while read -r command mark; do # the lists, and where each is
  now=$(sed "/^<!-- $mark -->\$/,/^<!-- end of columns -->\$/{//!d}" <<<"$now" \
    | sed "/^<!-- $mark -->\$/r "<("$1" "$command" --columns))
done <<'END'
tables columns
sweep columns of sweep
calibrate columns of calibrate
claims columns of claims
END
if [ "${2-}" = --write ]; then
  printf '%s\n' "$now" >"$readme"
elif ! diff <(printf '%s\n' "$now") "$readme" >&2; then
  echo "results/README.md lists other columns: scripts/test_columns.sh $1 --write mends it" >&2
  exit 1
fi
