# Completion for bash, of what the program's own --help lists.
_shapebench()
{
    local words
    case $COMP_CWORD:$2 in
        1:*) words=$("$1" --help | sed -nE 's/^  ([a-z]+)  .*/\1/p') ;;
        *:-*) words=$("$1" "${COMP_WORDS[1]}" --help | grep -oE -- '--[a-z][a-z-]*') ;;
        *) words=$("$1" scenes | sed -nE 's/^  ([a-z][a-z-]*)  .*/\1/p') ;;
    esac 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$2")
}
complete -o default -F _shapebench shapebench # files where nothing else begins so
