#!/bin/sh
# What the launcher promises, each on a fresh fake machine.   sh launcher_test.sh PATH/TO/palpate
# shellcheck disable=SC1091,SC2016,SC2034,SC2154
set -u
launcher=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
count=0
failed=0
unset LC_ALL
. "$(dirname "$0")/fake_machine.sh"

holds() { # holds LAW COMMAND...
    law=$1
    shift
    if "$@"; then
        echo "ok      $law"
    else
        failed=$((failed + 1))
        printf '%s\n' "NOT OK  $law" "  code: $code" "  calls: $calls" "  out: $out" "  err: $err"
    fi
}
has() { case $1 in *"$2"*) return 0 ;; esac; return 1; }
lacks() { ! has "$@"; }
install='apt-get install -y --no-install-recommends'

sh -n "$launcher" || exit 1

new_machine 0
launch demo
holds 'the first call configures without the tests' has "$calls" 'cmake -DPALPATE_TESTS=OFF --preset release'
holds 'and builds only the program' has "$calls" '--target palpate'
holds 'the exit code is the program'\''s' [ "$code" = 42 ]
holds 'standard output is the program'\''s alone' [ "$out" = '<demo>' ]
holds 'nothing is installed when nothing is missing' lacks "$calls" apt-get
holds 'the program keeps the locale of its user' grep -q 'locale unset' "$machine/program-saw"
holds 'and does not keep others from starting' grep -q 'lock free' "$machine/program-saw"
launch_anew demo
holds 'the second call configures nothing' lacks "$calls" preset
holds 'the second call says nothing' [ -z "$err" ]
holds 'the second call asks dpkg once' [ "$(grep -c dpkg-query "$machine/calls")" = 1 ]
: >"$machine/calls"
printf '  Test  #%s\n' '1: a sum' '2: a window' >"$machine/failed"
echo 0 >"$machine/fails-alone"
launch test -R 'a law'
holds 'test configures with the tests' has "$calls" 'cmake -DPALPATE_TESTS=ON --preset release'
holds 'test builds everything' has "$calls" '--target all'
holds 'test hands its arguments to ctest' has "$calls" \
    "ctest --test-dir $tree/build --output-on-failure -j$((8 + $(nproc))) --no-tests=error -R a law"
holds 'the exit code of test is ctest'\''s' [ "$code" = 8 ]
holds 'where something failed that computes, nothing has a second try' lacks "$calls" --rerun-failed
echo '  Test  #2: a window' >"$machine/failed"
launch test
holds 'what waits for a clock is tried once more, alone' has "$calls" '--no-tests=error --rerun-failed -j1'
holds 'and may pass then' [ "$code" = 0 ]
echo 8 >"$machine/fails-alone"
launch test
holds 'or fails' [ "$code" = 8 ]
launch_anew figures -o pictures
holds 'figures builds their program beside palpate' has "$calls" '--target palpate palpate_figures'
holds 'and hands palpate the whole line' [ "$out" = '<figures>
<-o>
<pictures>' ]
launch_anew demo
launch test
holds 'once asked for, the tests stay on' lacks "$calls" preset

new_machine 0
launch bench contact --csv 'a b.csv'
holds 'bench builds the benchmark alone' has "$calls" '--target palpate_bench'
holds 'in the tree of the program' has "$calls" 'cmake -DPALPATE_TESTS=OFF --preset release
'
holds 'asks for no test package and no peer' lacks "$calls" apt-get
holds 'and runs it' grep -qx "name $tree/build/palpate_bench" "$machine/program-saw"
holds 'with its arguments' [ "$out" = '<contact>
<--csv>
<a b.csv>' ]
holds 'the exit code is the benchmark'\''s' [ "$code" = 42 ]
launch_anew demo
holds 'the program then needs no other configuration' lacks "$calls" preset

new_machine 0 libsisl-dev libcgal-dev catch2
launch bench scaling
holds 'the benchmark by itself needs no peer' lacks "$err" 'not installed'
launch bench contact --peers
holds 'peers are installed when they are asked for' has "$calls" "$install libsisl-dev libcgal-dev"
holds 'peers have a tree of their own' has "$calls" \
    'cmake -DPALPATE_TESTS=OFF -DPALPATE_BENCH_PEERS=ON -B build/peers --preset release'
holds 'and a program of their own' grep -qx "name $tree/build/peers/palpate_bench" "$machine/program-saw"
holds 'which is said' has "$out" '<--peers>'
launch_anew bench contact --peers
holds 'once configured, it stays so' lacks "$calls" preset
launch demo
holds 'the tree of the program knows nothing of peers' lacks "$calls" PEERS
launch bench no-such-thing
holds 'what the benchmark does not know, it says itself' has "$out" '<no-such-thing>'
launch demo --peers
holds 'a program'\''s word --peers is the program'\''s' grep -qx "name $tree/build/palpate" "$machine/program-saw"

new_machine 1000 libsisl-dev
launch --no-install bench contact --peers
holds '--no-install bench --peers: leaves with 3' [ "$code" = 3 ]
holds 'and names the peer' has "$err" 'not installed: libsisl-dev'

new_machine 0
launch '' 'two words' "a 'single' and a \"double\"" '*' '$HOME' '--no-install' '\n'
expected="<>
<two words>
<a 'single' and a \"double\">
<*>
<\$HOME>
<--no-install>
<\\n>"
holds 'arguments arrive as they were given' [ "$out" = "$expected" ]
launch
holds 'no arguments stay no arguments' [ -z "$out" ]
launch -- test
holds 'only the first word can be the launcher'\''s' has "$out" '<test>'

new_machine 0 libfmt-dev g++
launch demo
holds 'what is missing is named' has "$err" 'not installed: g++ libfmt-dev'
holds 'root installs it, without sudo' has "$calls" "
$install g++ libfmt-dev"
holds 'what apt says is not on standard output' [ "$out" = '<demo>' ]
holds 'nobody calls sudo for root' lacks "$calls" sudo
holds 'and goes on to the program' [ "$code" = 42 ]
holds 'lists that know the packages are not fetched again' lacks "$calls" 'apt-get update'
holds 'a plain command asks for no test package' lacks "$err" catch2

at_terminal() { # at_terminal ANSWER
    printf '%s\n' "$1" | script -qec "PATH='$machine/bin' '$tree/palpate' demo" /dev/null >"$machine/out" 2>&1
    code=$?
    out=$(cat "$machine/out")
    calls=$(cat "$machine/calls")
}
for case in 0: 0:n 1000: 1000:n; do
    new_machine "${case%:*}" libfmt-dev
    at_terminal "${case#*:}"
    holds 'root, or whose sudo asks nothing, is asked at a terminal' has "$out" 'install them now, as root? [Y/n]'
    if [ "${case#*:}" = n ]; then
        holds 'who says no has nothing installed' lacks "$calls" apt-get
        holds 'and leaves with 3' [ "$code" = 3 ]
    else
        holds 'who says yes, has it' has "$calls" "$install libfmt-dev"
        holds 'and goes on, asked once' [ "$(grep -c 'Y/n' "$machine/out")$code" = 142 ]
    fi
done
new_machine 1000 libfmt-dev
touch "$machine/sudo-asks"
at_terminal ''
holds 'whom sudo asks for a password is asked by nobody else' lacks "$out" 'Y/n'
holds 'and has it installed' has "$calls" "sudo apt-get -q"

new_machine 0 libfmt-dev
cp "$machine/known" "$machine/mirror"
: >"$machine/known"
launch demo
holds 'empty lists are fetched first' has "$calls" "apt-get update
$install libfmt-dev"
holds 'before anybody is alarmed' lacks "$err" 'Unable to locate'
holds 'and then it goes on' [ "$code" = 42 ]

new_machine 1000 catch2 xvfb
launch test
holds 'others install through sudo' has "$calls" "sudo apt-get -q"
holds 'test asks for the packages of the tests' has "$calls" "$install catch2 xvfb"
holds 'and ctest runs' has "$calls" 'ctest --test-dir'

new_machine 1000 libfmt-dev
rm "$machine/bin/sudo"
launch demo
holds 'neither root nor sudo: leaves with 3' [ "$code" = 3 ]
holds 'and says what to run' has "$err" "$install libfmt-dev"
holds 'and builds nothing' lacks "$calls" cmake

new_machine 1000 libfmt-dev
touch "$machine/sudo-refuses"
launch demo
holds 'sudo refuses: leaves with 3' [ "$code" = 3 ]
holds 'and says what to run by hand' has "$err" 'cmake --preset release'

new_machine 1000 libfmt-dev sqlite3
launch --no-install demo
holds '--no-install: leaves with 3' [ "$code" = 3 ]
holds 'and names what is missing' has "$err" 'not installed: libfmt-dev sqlite3'
holds 'and gives the command' has "$err" "sudo apt-get update && sudo $install libfmt-dev sqlite3"
holds 'and runs nothing but dpkg-query' [ "$calls" = dpkg-query ]
new_machine 1000
launch --no-install demo
holds '--no-install goes on when nothing is missing' [ "$out" = '<demo>' ]

new_machine 0 libsdl2-dev
sed -i 's/liboffered-dev/libsdl2-dev/' "$machine/bin/dpkg-query"
launch demo
holds 'a package that another one provides is not missing' lacks "$err" 'not installed'

new_machine 0 libglm-dev
grep -vx libglm-dev "$machine/known" >"$machine/less" && mv "$machine/less" "$machine/known"
launch demo
holds 'a system whose apt does not know a package: leaves with 3' [ "$code" = 3 ]
holds 'after fetching the lists once' [ "$(grep -c 'apt-get update' "$machine/calls")" = 1 ]
holds 'and names the systems that do' has "$err" 'Ubuntu 24.04'

new_machine 0
rm "$machine/bin/dpkg-query" "$machine/bin/apt-get" "$machine/bin/ninja"
launch demo
holds 'no apt, no tools: leaves with 3' [ "$code" = 3 ]
holds 'with the list of packages' has "$err" 'libtomlplusplus-dev'
holds 'and the plain CMake way' has "$err" 'cmake --build --preset release'
fake ninja </dev/null
launch demo
holds 'no apt, but the tools are there: goes on' [ "$out" = '<demo>' ]
new_machine 0
rm "$machine/bin/dpkg-query"
touch "$machine/cannot-configure"
launch demo
holds 'no apt, and a library is missing: leaves with 3' [ "$code" = 3 ]
holds 'with CMake'\''s reason' has "$err" 'CMake Error: no fmt'

new_machine 0
touch "$machine/broken-source"
launch demo
holds 'a build that fails leaves with 1' [ "$code" = 1 ]
holds 'shows the end of the log' has "$err" 'engine.cpp:3: error: this is broken'
holds 'and where the log is' has "$err" "$tree/build/palpate-build.log"
holds 'and nothing on standard output' [ -z "$out" ]

new_machine 0
mkdir "$machine/elsewhere"
ln -s '../my tree/palpate' "$machine/elsewhere/link"
here=$machine/elsewhere as=./link
launch demo
holds 'runs through a symbolic link' [ "$out" = '<demo>' ]
holds 'in the folder of its caller' grep -q "here $machine/elsewhere" "$machine/program-saw"
here=$machine/elsewhere as='../my tree/palpate'
holds 'and builds in its own tree' [ ! -e "$machine/elsewhere/build" ]
launch demo
holds 'runs from any folder' [ "$out" = '<demo>' ]
unset here as

new_machine 0
launch demo
rm "$tree/build/build.ninja"
launch_anew demo
holds 'a configuration that was cut short is made again' has "$calls" preset

new_machine 0
launch demo
cp -R "$tree" "$machine/copy"
: >"$machine/calls"
as=$machine/copy/palpate
launch demo
holds 'a copied checkout is configured anew' has "$calls" 'cmake --fresh'
unset as

new_machine 0
answer=$(cd "$tree" && echo typed | PATH=$machine/bin ./palpate read-input 2>/dev/null)
holds 'standard input is the program'\''s' has "$answer" typed

new_machine 0
launch demo
(cd "$tree" && PATH=$machine/bin exec ./palpate demo >"$machine/out" 2>&1) &
wait $!
holds 'signals reach the program: it is the launcher'\''s own process' grep -qx "process $!" "$machine/program-saw"

new_machine 0
(cd "$tree" && PATH=$machine/bin ./palpate one >"$machine/one" 2>/dev/null) &
launch two
wait
holds 'two at once both run' [ "$(cat "$machine/one") $out" = '<one> <two>' ]
calls=$(cat "$machine/calls")
holds 'and configure once' [ "$(grep -c preset "$machine/calls")" = 1 ]

echo "$failed of the launcher's laws broken"
[ $failed = 0 ]
