# Completion for bash: the program says what can come next (bench/cli/completion.h).
_shapebench()
{
    local line=${COMP_LINE:0:COMP_POINT} word ending
    local -a words lines
    read -ra words <<<"$line"
    [[ $line == *[[:space:]] ]] && words+=("")
    mapfile -t lines < <("${words[0]}" complete "${words[@]:1}" 2>/dev/null)
    # bash has --scene=NAME as three words, and completes the last
    local begun=${words[-1]} before=""
    if [[ $begun == --*=* && $COMP_WORDBREAKS == *=* ]]; then before=${begun%%=*}=; fi
    COMPREPLY=()
    for line in "${lines[@]}"; do
        word=${line%%$'\t'*}
        if [ -n "$word" ]; then
            COMPREPLY+=("${word#"$before"}")
            continue
        fi
        ending=${line#$'\t'}
        compopt -o filenames
        while IFS= read -r word; do
            if [ -z "$ending" ] || [[ $word == *"$ending" ]] || [ -d "${word/#\~/$HOME}" ]; then
                COMPREPLY+=("$word")
            fi
        done < <(compgen -f -- "${begun#"$before"}")
    done
}
complete -F _shapebench shapebench
