#!/bin/sh
# ctest with these words; and where all that failed waits for a clock (boards, windows, sessions that run), that once
# more, alone: where a machine gives a program no turn for some milliseconds, a fault is what must happen. What computes
# has one try. Exit code: ctest's.
code=0
ctest "$@" || code=$?
[ "$code" = 8 ] || exit "$code"
names() { ctest "$@" -N | sed -n 's/^ *Test *#[0-9]*: //p'; }
waits=$(names "$@" -L clock)
failed=$(names "$@" --rerun-failed)
if [ -z "$failed" ] || printf '%s\n' "$failed" | grep -qvxF "$waits"; then
    exit 8
fi
printf 'All that failed waits for a clock. Once more, alone:\n%s\n' "$failed"
exec ctest "$@" --rerun-failed -j1
