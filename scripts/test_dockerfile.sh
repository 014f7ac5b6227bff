#!/usr/bin/env bash
# The Dockerfile runs README.md's commands that pack and install, in their order, and no others; the package
# that it installs is called as cpack calls it.
#
# usage: scripts/test_dockerfile.sh     exit codes: 0 passed, 1 failed
set -euo pipefail
cd -- "$(dirname -- "$0")/.."
said=$(sed -n '/^<!-- commands of the Dockerfile -->/,/^<!-- end of commands -->/s/^    //p' README.md | sed 's/ *#.*//')
run=$(sed -n 's/^RUN //p' Dockerfile)
[ "$(grep -c . <<<"$said")" -ge 5 ] || { echo "README.md: its commands are not found"; exit 1; }
diff <(echo "$said") <(echo "$run") || { echo "< README.md, > Dockerfile: other commands"; exit 1; }
grep -q 'CPACK_DEBIAN_FILE_NAME DEB-DEFAULT' scripts/package.cmake # shapebench_VERSION_ARCHITECTURE.deb
