# A machine made of fakes, in $machine: bin/ is its whole PATH, `calls` lists what was run there,
# `installed` and `known` what its dpkg has and its apt could get.
# Sourced by launcher_test.sh, which owns $scratch and $launcher.
# shellcheck shell=sh disable=SC2034,SC2086,SC2154

everything='cmake g++ ninja-build pkg-config libglm-dev libeigen3-dev libfmt-dev libtomlplusplus-dev nettle-dev
libsqlite3-dev zlib1g-dev libxxhash-dev libboost-dev libpq5 libcli11-dev nlohmann-json3-dev libsdl2-dev
libsdl2-ttf-dev libpng-dev libmicrohttpd-dev fonts-dejavu-core sqlite3 catch2 xvfb libx11-dev libxtst-dev python3 python3-jsonschema r-base-core r-cran-rsqlite
gcc-avr avr-libc binutils-avr libsimavr-dev libelf-dev
libsisl-dev libocct-modeling-algorithms-dev libocct-modeling-data-dev libcgal-dev libhdf5-dev'

# fake NAME: an executable of the machine; its text is standard input.
fake() {
    { echo '#!/bin/sh'; cat; } >"$machine/bin/$1"
    chmod +x "$machine/bin/$1"
}

# A machine for user ID $1 that has every package but those named behind it; its apt lists know all. Its tree has a
# space in its path.
new_machine() {
    machine=$scratch/machine$((count += 1))
    tree="$machine/my tree"
    mkdir -p "$machine/bin" "$tree"
    cp "$launcher" "$tree/palpate"
    mkdir -p "$tree/tests/support"
    cp "$(dirname "$launcher")/tests/support/once_more.sh" "$tree/tests/support"
    export machine
    : >"$machine/calls"
    printf '%s\n' $everything >"$machine/known"
    printf '%s\n' "$@" | grep -vxFf - "$machine/known" >"$machine/installed"
    for tool in nproc sh cat sed tr dirname readlink tail mkdir flock grep touch cp chmod rm sleep; do
        ln -s "$(command -v $tool)" "$machine/bin/$tool"
    done

    fake id <<FAKE
echo $1
FAKE
    fake sudo <<'FAKE'
if [ "$1" = -n ]; then # whether it would ask for a password
    [ ! -e "$machine/sudo-asks" ]
    exit
fi
echo "sudo $*" >>"$machine/calls"
[ ! -e "$machine/sudo-refuses" ] || exit 1
exec "$@"
FAKE
    fake dpkg-query <<'FAKE'
echo "dpkg-query" >>"$machine/calls"
sed 's/.*/installed & /' "$machine/installed"
case $* in
    *Provides*) echo 'installed libnewer-dev liboffered-dev (= 2), liboffered2-dev' ;;
esac
echo 'config-files libremoved-dev '
FAKE
    fake apt-get <<'FAKE'
options=
while :; do
    case $1 in
        -q) shift ;;
        -o) shift 2 ;;
        *) break ;;
    esac
done
echo "apt-get $*" >>"$machine/calls"
if [ "$1" = update ]; then
    [ ! -e "$machine/mirror" ] || cp "$machine/mirror" "$machine/known"
    exit 0
fi
[ "$1" = install ] || exit 100
echo 'Reading package lists...'
for word in "$@"; do
    case $word in
        install | -*) continue ;;
    esac
    grep -qxF "$word" "$machine/known" || { echo "E: Unable to locate package $word"; exit 100; }
    case " $* " in
        *' -s '*) ;;
        *) echo "$word" >>"$machine/installed" ;;
    esac
done
FAKE
    fake ninja </dev/null
    fake pkg-config </dev/null
    fake cmake <<'FAKE'
echo "cmake $*" >>"$machine/calls"
cat >/dev/null # a builder that eats what it can read
if [ "$1" = --build ]; then
    if [ -e "$machine/broken-source" ]; then
        echo '[1/2] Building CXX object engine.o'
        echo 'engine.cpp:3: error: this is broken'
        exit 2
    fi
    made=palpate
    case $* in *'--target palpate_bench') made=palpate_bench ;; esac
    if [ -x "$2/$made" ]; then
        echo 'ninja: no work to do.'
    else
        echo "[1/1] Linking CXX executable $made"
        cp "$machine/program" "$2/$made"
    fi
    exit 0
fi
[ ! -e "$machine/cannot-configure" ] || { echo 'CMake Error: no fmt'; exit 1; }
tests=OFF
case $* in *PALPATE_TESTS=ON*) tests=ON ;; esac
case $* in *--fresh*) rm -f build/palpate ;; esac
tree=build
case $* in *' -B build/peers'*) tree=build/peers ;; esac
printf '%s\n' "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" 'CMAKE_GENERATOR:INTERNAL=Ninja' \
    'CMAKE_BUILD_TYPE:STRING=Release' "PALPATE_TESTS:BOOL=$tests" >$tree/CMakeCache.txt
touch $tree/build.ninja
FAKE
    fake ctest <<'FAKE'
case $* in
*'-L clock -N') echo '  Test  #2: a window' ;;
*'--rerun-failed -N') cat "$machine/failed" ;;
*) echo "ctest $*" >>"$machine/calls" ;;
esac
case $* in *' -N') exit ;; *--rerun-failed*) exit "$(cat "$machine/fails-alone")" ;; esac
exit 8
FAKE
    # The program of the fake tree: prints what it was given, one argument a line, and leaves with 42.
    fake program <<'FAKE'
for argument in "$@"; do printf '<%s>\n' "$argument"; done
printf '%s\n' "locale ${LC_ALL-unset}" "here $PWD" "process $$" "name $0" >"$machine/program-saw"
flock -n "$machine/my tree/build/palpate-lock" sh -c 'echo lock free' >>"$machine/program-saw"
[ "${1-}" != read-input ] || cat
exit 42
FAKE
    mv "$machine/bin/program" "$machine/program"
}

# Runs the machine's launcher from $here (the tree, unless set) as $as: $code, $out, $err.
launch() {
    (cd "${here:-$tree}" && PATH=$machine/bin "${as:-$tree/palpate}" "$@") \
        >"$machine/out" 2>"$machine/err" </dev/null
    code=$?
    out=$(cat "$machine/out")
    err=$(cat "$machine/err")
    calls=$(cat "$machine/calls")
}

# The same with the list of calls begun anew.
launch_anew() {
    : >"$machine/calls"
    launch "$@"
}
