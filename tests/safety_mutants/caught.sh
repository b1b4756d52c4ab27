#!/bin/sh
# Does the law named catch the mutant? It must run, and fail by an assertion: a crash does not count.
#   sh caught.sh PROGRAM LAW
set -u
law=$(printf '%s' "$2" | sed 's/,/\\,/g')  # a comma would mean: or
said=$("$1" "$law" --abort 2>&1)
code=$?
if [ "$code" -eq 0 ]; then
    echo "the mutant lives: no assertion of \"$2\" failed"
    exit 1
fi
if [ "$code" -ge 128 ] || ! echo "$said" | grep -q 'test cases: *1 |.* 1 failed' ||
    echo "$said" | grep -q -e 'unexpected exception' -e 'fatal error'; then
    echo "$said"
    echo "\"$2\" did not fail by an assertion (exit code $code)"
    exit 1
fi
echo "caught by \"$2\""
