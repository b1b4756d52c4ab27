#!/bin/sh
# The guard, guarded: each rule must catch its breach at the right line, and pass what is allowed.
#   sh guard_test.sh
# shellcheck disable=SC2016
set -u
guard=$(cd -- "$(dirname -- "$0")" && pwd -P)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failed=0

# A small tree that keeps every rule: made once, in the current folder.
make_tree() {
    put engine/math/sine.hpp '#pragma once' '#include <glm/vec2.hpp>' 'double sine(double x);'
    put engine/contact/foot.cpp '#include "engine/math/sine.hpp"' '#include <cmath>' \
        '// std::sin would differ between machines; see also "rand()".' \
        '/* std::exp(1)' '   std::pow(2, 3) */' \
        'double f(double x) { return std::sqrt(x) + std::floor(sine(x)) + angle.sin; }' \
        "const char* kText = R\"(std::cos(x) \"quoted\" // no comment)\"; const int kMany = 1'000;" \
        "const char kQuote = '\"'; const char* kSin = \"std::sin(x)\"; int atan_unit(int);"
    put engine/friction/friction_law.cpp '#include <cmath>' 'double c = std::exp(-1.0);'
    put engine/realtime/servo.cpp '#include "engine/contact/foot.hpp"' '#include <sys/mman.h>'
    put engine/base/text.cpp '#include <fmt/core.h>' '#include <nettle/sha2.h>'
    put engine/CMakeLists.txt 'palpate_room_uses(glm::glm # never -ffast-math' '    Threads::Threads)' \
        'palpate_folder(base LINK PkgConfig::NETTLE SOURCES text.cpp)' 'palpate_folder(math)' \
        'palpate_folder(contact PACED' '    SEES math' '    SOURCES foot.cpp)' \
        'palpate_folder(friction SEES math contact SOURCES friction_law.cpp)' \
        'palpate_folder(device)' 'palpate_folder(device/drivers SEES device LINK PkgConfig::COMEDI)' \
        'palpate_folder(realtime SEES contact SOURCES servo.cpp)'
    put protocols/CMakeLists.txt 'palpate_folder(file SOURCES parse.cpp)' 'palpate_folder(session SEES file)'
    put data/CMakeLists.txt 'palpate_folder(statistics SOURCES solve.cpp)' \
        'palpate_folder(store SOURCES database.cpp)' 'palpate_folder(verify SEES store)'
    put ui/CMakeLists.txt 'palpate_folder(sdl)' 'palpate_folder(subject SEES sdl SOURCES window.cpp)'
    put protocols/file/parse.cpp '#include "engine/math/sine.hpp"' '#include <toml++/toml.h>' '#include <fmt/core.h>'
    put data/store/database.cpp '#include <sqlite3.h>' '#include "protocols/file/parse.hpp"'
    put ui/subject/window.cpp '#include "ui/sdl/sdl.hpp"' '#include "data/store/database.hpp"'
    put ui/sdl/sdl.hpp '#include <SDL2/SDL.h>'
    put tests/data/store_test.cpp '#include <sqlite3.h>' '#include "ui/subject/window.hpp"' '#include <random>' \
        'std::uniform_real_distribution<double> newtons;'
    put CMakeLists.txt 'add_compile_options(-ffp-contract=off -fno-fast-math)'
    put README.md 'See https://example.org/home/page and engine/home/.'
    put build/engine/generated.hpp '#include "ui/anything.hpp"'
}

# The scratch tree is as it was made.
clean_tree() {
    cd "$scratch" || exit 2
    rm -rf tree
    cp -R clean tree
    cd tree || exit 2
}

put() { # put FILE LINE...
    case $1 in
        */*) [ -d "${1%/*}" ] || mkdir -p "${1%/*}" ;;
    esac
    file=$1
    shift
    printf '%s\n' "$@" >"$file"
}

check() { found=$(sh "$guard/check.sh" "$scratch/tree" 2>/dev/null); }

# catches PLACE WORDS: the guard finds one breach, there, for that reason. The file was put just before.
catches() {
    check && found='nothing'
    case $found in
        *"
"*) ;;
        "$1: "*"$2"*) clean_tree; return ;;
    esac
    failed=$((failed + 1))
    printf '%s\n' "NOT CAUGHT  $1 ($2)" "  found: $found"
    clean_tree
}

# breach PLACE WORDS LINE...: in a file of these lines, and nowhere else, the guard finds one breach, for that reason.
breach() {
    place=$1
    words=$2
    shift 2
    put "${place%:*}" "$@"
    catches "$place" "$words"
}

passes() { # passes WHAT
    check || { failed=$((failed + 1)); printf '%s\n' "WRONGLY CAUGHT  $1" "$found"; }
    clean_tree
}

mkdir "$scratch/clean"
cd "$scratch/clean" || exit 2
make_tree
clean_tree
passes 'a clean tree'

# The order of the rooms, and of the folders of each.
breach engine/math/a.hpp:3 'may not see stimuli' '#pragma once' '' '#include "stimuli/object.hpp"'
breach stimuli/a.hpp:1 'may not see protocols' '#include "protocols/a.hpp"'
breach protocols/file/a.cpp:2 'may not see data' '' '#  include "data/a.hpp"'
breach data/store/a.cpp:1 'may not see ui' '#include "ui/a.hpp" // once'
breach ui/subject/a.cpp:1 'may not see tests' '#include "tests/support/catch.hpp"'
breach engine/math/a.cpp:1 'engine/math may not see engine/contact' '#include "engine/contact/foot.hpp"'
breach engine/realtime/a.cpp:1 'engine/realtime may not see engine/math' '#include "engine/math/sine.hpp"'
breach engine/device/a.cpp:1 'engine/device may not see engine/device/drivers' \
    '#include "engine/device/drivers/port.hpp"'
breach protocols/file/a.cpp:1 'protocols/file may not see protocols/session' '#include "protocols/session/run.hpp"'
breach data/store/a.cpp:2 'data/store may not see data/verify' '' '#include "data/verify/finding.hpp"'
put engine/device/drivers/a.hpp '#include "engine/device/port.hpp"' '#include "engine/device/drivers/b.hpp"'
passes 'a folder inside another sees that and itself'
breach engine/magic/a.cpp:1 'engine/magic has no place' '#include <cmath>'
put data/a.cpp '#include "protocols/file/parse.hpp"'
passes 'a room sees every folder to the left'
breach data/CMakeLists.txt:2 'not above it' \
    'palpate_folder(store' '    SEES verify)' 'palpate_folder(verify SEES store)'

# Chains of headers, and rings of files.
chain_of() { # chain_of COUNT: h1 needs h2, which needs h3 ...
    for i in $(seq 1 $(($1 - 1))); do
        put "engine/math/h$i.hpp" '' "#include \"engine/math/h$((i + 1)).hpp\""
    done
    put "engine/math/h$1.hpp" '#pragma once'
}
chain_of 13
catches engine/math/h1.hpp:2 'a chain of 13 headers'
chain_of 12
put engine/math/h0.cpp '#include "engine/math/h1.hpp"'
passes 'a chain of 12 headers and a source'
put engine/math/a.hpp '#include "engine/math/b.hpp"'
put engine/math/b.hpp '#pragma once'
put engine/math/b.cpp '#include "engine/math/b.hpp"' '#include "engine/math/a.hpp"'
catches engine/math/a.hpp:1 'a ring of files'
put engine/math/a.hpp '#include "engine/math/b.hpp"'
put engine/math/b.hpp '#include "engine/math/c.hpp"'
put engine/math/c.hpp '#include "engine/math/a.hpp"'
catches engine/math/a.hpp:1 'a ring of files'
put tests/data/a.hpp '#include "tests/data/a.hpp"'
passes 'a file of the tests that needs itself'

# How an include is written.
breach data/store/a.cpp:1 'does not name its room' '#include "database.hpp"'
breach data/store/a.cpp:1 'does not name its room' '#include "store/database.hpp"'
breach data/store/a.cpp:3 'without dots' '' '' '#include "../store/database.hpp"'
breach data/store/a.cpp:1 'without dots' '#include "data/../ui/window.hpp"'
breach tests/data/a.cpp:1 'without dots' '#include "./store_test.hpp"'
breach data/store/a.cpp:1 'with quotes' '#include <ui/window.hpp>'
breach data/store/a.cpp:1 'cannot read' '#include A_MACRO'

# Libraries.
breach data/a.cpp:1 'SDL2 belongs to ui' '#include <SDL.h>'
breach engine/device/a.cpp:1 'SDL2 belongs to ui' '#include <SDL2/SDL_events.h>'
breach ui/subject/a.cpp:1 'SDL2 belongs to ui/sdl' '#include <SDL2/SDL.h>'
breach ui/sdl/a.hpp:1 'enters by ui/sdl/sdl.hpp' '#include <SDL2/SDL.h>'
breach ui/a.cpp:1 'SQLite belongs to data' '#include <sqlite3.h>'
breach data/a.hpp:2 'stays out of headers' '#pragma once' '#include <sqlite3.h>'
breach data/a.cpp:1 'toml++ belongs to protocols' '#include <toml++/toml.h>'
breach protocols/a.cpp:1 'CLI11 belongs to ui' '#include <CLI/CLI.hpp>'
breach protocols/a.cpp:1 'zlib belongs to data' '#include <zlib.h>'
breach stimuli/a.cpp:1 'nettle belongs to engine/base data' '#include <nettle/sha2.h>'
breach engine/contact/a.cpp:1 'fmt belongs to' '#include <fmt/core.h>'
breach engine/contact/a.cpp:1 'comedilib belongs to engine/device/drivers' '#include <comedilib.h>'
breach data/a.cpp:1 'no library that the guard knows' '#include <rapidjson/document.h>'
breach data/store/a.cpp:1 'nlohmann belongs to' '#include <nlohmann/json.hpp>'
breach data/store/a.cpp:1 'Boost belongs to data/statistics' '#include <boost/math/distributions/normal.hpp>'
breach data/statistics/a.cpp:1 'Eigen enters by data/statistics/solve.cpp' '#include <Eigen/Cholesky>'
put data/statistics/solve.cpp '#include <Eigen/Cholesky>'
passes 'Eigen by its own door'
put data/a.hpp '#include <fmt/core.h>' '#include <glm/vec2.hpp>'
passes 'glm and fmt in a header'

# What keeps a result the same to the bit.
breach engine/contact/a.cpp:1 'libm' 'double a = std::sin(1.0);'
breach engine/contact/a.cpp:2 'libm' '/* one' 'two */ double a = glm::atan(1.0);'
breach engine/contact/a.cpp:1 'libm' 'double a = pow (2.0, 0.5);  // a comment'
breach engine/contact/a.cpp:1 'libm' 'auto f = &std::hypot;'
breach engine/contact/a.cpp:1 'libm' 'auto f = "\"" + ::log10f(2.0F);'
breach engine/contact/a.cpp:3 'libm' 'auto t = R"x(' 'std::sin(' ')x"; auto b = std::atan2(1.0, 2.0);'
breach stimuli/a.cpp:1 'one order everywhere' 'std::shuffle(a.begin(), a.end(), rng);'
breach protocols/a.cpp:2 'one order everywhere' '' 'std::normal_distribution<> d;'
breach engine/device/a.cpp:1 'one order everywhere' 'int a = rand();'
put stimuli/a.cpp 'double a = std::sin(1.0) + operand(2);'
passes 'libm outside engine, and a name that ends in rand'
breach CMakeLists.txt:2 'to the bit' 'target_compile_options(palpate_engine PRIVATE' '    -ffast-math)'
breach CMakePresets.json:2 'to the bit' '{' '"CMAKE_CXX_FLAGS": "-Ofast"' '}'

# What links what.
breach data/CMakeLists.txt:2 'data may not link SDL2::SDL2' \
    'palpate_folder(store SOURCES a.cpp LINK SQLite::SQLite3' '    SDL2::SDL2)' 'palpate_folder(verify SEES store)'
breach stimuli/CMakeLists.txt:1 'stimuli may not link palpate::data' 'palpate_room_uses(palpate::engine palpate::data)'
breach stimuli/CMakeLists.txt:1 'stimuli may not link SDL2::SDL2' \
    'target_link_libraries(palpate_stimuli PUBLIC palpate::engine SDL2::SDL2)'
breach data/store/CMakeLists.txt:2 'data may not link palpate::engine' \
    '' 'target_link_libraries(palpate_data PUBLIC palpate::engine)'
breach ui/subject/CMakeLists.txt:1 'ui may not link SQLite::SQLite3' \
    'target_link_libraries(palpate PRIVATE palpate::ui SQLite::SQLite3)'
breach ui/subject/CMakeLists.txt:1 'link_libraries' 'link_libraries(m)'
breach data/store/CMakeLists.txt:1 'by hand' 'file(GLOB sources *.cpp)'

# Files.
breach data/long.cpp:401 'longer than 400' "$(yes 'int x;' | head -n 401)"
put data/long.cpp "$(yes 'int x;' | head -n 400)"
passes 'a file of 400 lines'
breach data/long.cpp:61 'a function of 61 lines' 'int f(int a,' '      int b) {' "$(yes '    ++a;' | head -n 58)" '}'
breach data/long.cpp:63 'a function of 61 lines' \
    'class C {' 'public:' '    int f() {' "$(yes '        ++a;' | head -n 59)" '    }' '};'
put data/long.cpp 'class C {' 'public:' '    int f() {' "$(yes '        ++a;' | head -n 58)" '    }' '};' \
    'constexpr int kMany[]{' "$(yes '    1,' | head -n 70)" '};' 'int f() {' "$(yes '    ++a;' | head -n 58)" '}'
passes 'functions of 60 lines, and a table'
put data/a.cpp 'int a;' && printf 'int b;' >>data/a.cpp
catches data/a.cpp:2 'does not end'
breach README.md:1 'one machine' 'Look into /ho''me/ann/data.'
breach data/a.cpp:2 'one machine' '' '// see /ro''ot/notes'
breach tests/data/a.cpp:1 'one machine' "const char* k = \"$scratch/tree/data\";"

# Several breaches in several files are all listed.
put data/a.cpp '#include "ui/a.hpp"' '#include <SDL.h>'
put stimuli/a.cpp '#include "ui/a.hpp"'
check
listed=$(printf "%s\n" "$found" | grep -c "^[a-z/.]*:[12]: ")
[ "$listed" = 3 ] || { failed=$((failed + 1)); echo "not all listed: $found"; }

echo "$failed rules of the guard broken"
[ "$failed" = 0 ]
