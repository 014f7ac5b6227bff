#!/usr/bin/env bash
# Shells complete commands, options and their values as a user types them: bash by its function, zsh on a
# terminal.
#
# usage: scripts/test_completions.sh BUILD_FOLDER     exit codes: 0 passed, 1 failed
set -euo pipefail
here=$(cd -- "$(dirname -- "$0")" && pwd)
build=$(cd -- "${1:?BUILD_FOLDER missing}" && pwd)
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
PATH=$build:$PATH
cd "$folder"
mkdir saved
touch saved.h5 saved.txt

# shellcheck source=scripts/completions/shapebench.bash
. "$here/completions/shapebench.bash"
# in_bash LINE WORD...: typing LINE and a tab offers these words, and no others.
in_bash() {
    read -ra COMP_WORDS <<<"$1"
    COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
    _shapebench shapebench "${COMP_WORDS[-1]}"
    diff <(printf '%s\n' "${@:2}" | sort) <(printf '%s\n' "${COMPREPLY[@]}" | sort -u) ||
        { echo "bash: < wanted, > offered for '$1'"; exit 1; }
}
[ "$(complete -p shapebench)" = "complete -o default -F _shapebench shapebench" ]
in_bash "shapebench re" regress report
in_bash "shapebench run --gra" --gravity
in_bash "shapebench tables --scene pengu" penguin penguins penguins-collide penguins-free
in_bash "shapebench sweep sa" santa
in_bash "shapebench frobnicate x"

command -v zsh >/dev/null || { echo "no zsh: not tested"; exit 0; }
# What is on the line of a zsh that was typed LINE and a tab.
cat >typed.zsh <<'SCRIPT'
zmodload zsh/zpty
typed=$1
zpty shell zsh -f -i
zpty -w shell "fpath=($2 \$fpath) PS1= ; autoload -Uz compinit; compinit -u -d $PWD/dump; show() { print -r -- \"<\$BUFFER>\" >>$PWD/shown; BUFFER=; }; zle -N show; bindkey '^G' show; bindkey '^I' complete-word; print ready"
zpty -r shell seen $'*ready[\r\n]*'
zpty -w -n shell "$typed"$'\t\a'
for wait in {1..200}; do
    [[ -s shown ]] && break
    sleep 0.05
    while zpty -r -t shell seen; do :; done
done
zpty -d shell
cat shown 2>/dev/null
SCRIPT
# in_zsh TYPED LINE: what stands there after the tab.
in_zsh() {
    local said
    rm -f shown
    said=$(zsh -f typed.zsh "$1" "$here/completions" </dev/null)
    [ "$said" = "<$2>" ] || { echo "zsh: '$1' and a tab make $said"; exit 1; }
}
in_zsh "shapebench tab" "shapebench tables "
in_zsh "shapebench run --gra" "shapebench run --gravity "
in_zsh "shapebench run penguins-c" "shapebench run penguins-collide "
in_zsh "shapebench sweep saved.h" "shapebench sweep saved.h5 "
