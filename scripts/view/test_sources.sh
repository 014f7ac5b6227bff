#!/usr/bin/env bash
# Where scripts/view/view looks for a library's sources: in every list of apt, made one of sources; and that it is
# quiet where there are none. apt-get is a stand-in here. And a page that is there opens with another mesh.
#
# usage: scripts/view/test_sources.sh     exit codes: 0 passed, 1 failed
set -eu
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
mkdir -p "$folder/bin" "$folder/apt/sources.list.d" "$folder/clone" "$folder/lib-1/lib"
echo 'deb [trusted=yes] http://one.example a main' >"$folder/apt/sources.list"
printf '%s\n' 'Types: deb' 'URIs: http://two.example' >"$folder/apt/sources.list.d/ubuntu.sources"
touch "$folder/lib-1/lib/"{a.c,a.txt}
tar -czf "$folder/lib_1.orig.tar.gz" -C "$folder" lib-1
cat >"$folder/bin/apt-get" <<APT
#!/bin/sh
cat parts/* >>"$folder/lists"
case \$* in *update) exit 100 ;; *tar-only\ lib) cp "$folder/lib_1.orig.tar.gz" . ;; *) exit 100 ;; esac
APT
chmod +x "$folder/bin/apt-get"
{
    echo "root=$folder/clone; say() { echo \"\$*\"; }"
    sed -n '/^fetch_sources()/,/^}/p' "$(dirname -- "$0")/view" | sed "s#/etc/apt#$folder/apt#g"
    echo 'fetch_sources "$@"'
} >"$folder/fetch"
export PATH=$folder/bin:$PATH

bash "$folder/fetch" lib lib/a.c 'lib/*.[ch]' >"$folder/said" 2>&1 || { cat "$folder/said"; exit 1; }
[ "$(ls "$folder/clone/build-view/lib/lib")" = a.c ] || { echo "not the sources alone"; exit 1; }
for line in 'deb-src [trusted=yes] http://one.example a main' 'Types: deb-src' 'URIs: http://two.example'; do
    grep -qxF -- "$line" "$folder/lists" || { echo "apt-get was not given: $line"; exit 1; }
done
if bash "$folder/fetch" other lib/a.c 'lib/*.[ch]' >"$folder/said" 2>&1; then echo "there are no sources"; exit 1; fi
[ "$(cat "$folder/said")" = 'fetching the sources of other' ] || { cat "$folder/said"; exit 1; }

here=$(cd -- "$(dirname -- "$0")" && pwd)
echo 'v 0 0 0' >"$folder/own.obj"
python3 "$here/build.py" "$here/../../results/page.html" "$folder/own.html" '' "$folder/own.obj"
python3 - "$folder/own.html" "$here/../../results/page.html" <<'PY' || { echo "more than the mesh is another"; exit 1; }
import json, re, sys
parts = re.compile('(.*"data"[^>]*>)(.*?)(</script>.*)', re.DOTALL)
own, page = (parts.fullmatch(open(path).read()).groups() for path in sys.argv[1:])
data = json.loads(own[1])
sys.exit(data["mesh"][0]["name"] != "own.obj" or data["scene"] != "" or own[::2] != page[::2] or "bodies" not in data)
PY
