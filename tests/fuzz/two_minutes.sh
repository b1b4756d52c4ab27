#!/bin/bash
# Two minutes of each fuzzer, four at a time. What they find stays in build/found and is printed: it belongs to corpus/.
#   cmake --preset fuzz && cmake --build --preset fuzz && bash tests/fuzz/two_minutes.sh [SECONDS [SEED]]
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
export seconds=${1:-120} seed=${2:-0}

fuzz() {
    local name=${1#build/fuzz/fuzz_}
    local found=build/found/$name
    mkdir -p "$found/new"
    if "$1" -seed="$seed" -max_total_time="$seconds" -max_len=4096 -timeout=20 -rss_limit_mb=4096 -print_final_stats=1 \
        -artifact_prefix="$found/" "$found/new" "tests/fuzz/corpus/$name" >"$found/log" 2>&1; then
        echo "$name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$found/log") inputs"
        return
    fi
    tail -n 40 "$found/log"
    find "$found" -maxdepth 1 -type f ! -name log -printf '%f\n' -exec base64 {} \;
    return 1
}
export -f fuzz
printf '%s\n' build/fuzz/fuzz_* | xargs -P 4 -I{} bash -c 'fuzz {}'
