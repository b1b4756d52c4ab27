#!/bin/sh
# The guard of the house: prints every breach as file:line: reason, and fails if there is one.
#   sh check.sh TREE
#
# cmake.awk    the folders of a room and their order, what targets link, and with which flags
# source.awk   what C++ files include and call, and how long they are
# chains.awk   how long a chain of headers is, and that no files need one another in a ring
# this file    text ends with a newline and names no folder of anybody's machine
set -u
LC_ALL=C
export LC_ALL
guard=$(cd -- "$(dirname -- "$0")" && pwd -P)
cd -- "$1" || exit 2
tree=$(pwd -P)
breaches=$(mktemp)
folders=$(mktemp)
trap 'rm -f "$breaches" "$folders"' EXIT

# The tree's own files; $@ selects and acts, as find's arguments. Built trees and git's are not ours.
own_files() {
    # shellcheck disable=SC2046  # no name at the top has a space
    find $(ls -d -- * .ci 2>/dev/null) -path build -prune -o -type f "$@"
}

# Silence must mean that everything was read.
broken() {
    echo "the guard itself failed: $1" >&2
    exit 2
}

own_files \( -name CMakeLists.txt -o -name '*.cmake' -o -name CMakePresets.json \) \
    -exec awk -v folders="$folders" -f "$guard/cmake.awk" {} + >>"$breaches" || broken cmake.awk
own_files \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' \) \
    -exec awk -v folders="$folders" -f "$guard/source.awk" {} + >>"$breaches" || broken source.awk

own_files \( -name '*.hpp' -o -name '*.cpp' \) -print | grep -v '^tests/' |
    awk -f "$guard/chains.awk" >>"$breaches" || broken chains.awk

printf 'a\n' | grep -qPz '\n\z' || broken 'grep -Pz'
own_files \( -name '*.[hc]pp' -o -name '*.txt' -o -name '*.cmake' -o -name '*.sh' -o -name '*.awk' \
    -o -name '*.md' -o -name '*.toml' -o -name '*.json' -o -name '*.sql' -o -name '*.R' -o -name '*.py' \
    -o -path palpate -o -path .ci/run \) \
    -size +0 -exec grep -LPz '\n\z' {} + |
    while IFS= read -r file; do
        echo "$file:$(($(wc -l <"$file") + 1)): the last line does not end"
    done >>"$breaches"

# Home folders, and the very folder that this checkout lies in.
checkout=$(printf '%s' "$tree" | sed 's/[][\\.*^$+?(){}|]/\\&/g')
case $tree in
    /*/*) ;;
    *) checkout='/(home|Users)/[[:alnum:]]' ;;  # a folder at the top may share its name with anything
esac
own_files -exec grep -HInE \
    -e '(^|[^[:alnum:]_.:/-])/(home|Users)/[[:alnum:]_]' -e '(^|[^[:alnum:]_.:/-])/[r]oot/' \
    -e "(^|[^[:alnum:]_.:/-])$checkout" {} + |
    sed 's/^\([^:]*:[0-9]*\):.*/\1: names a folder of one machine/' >>"$breaches"

sort -t : -k 1,1 -k 2,2n "$breaches"
count=$(wc -l <"$breaches")
echo "$((count)) breaches of the house's order" >&2
[ "$count" -eq 0 ]
