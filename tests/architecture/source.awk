# C++: what a file may include and call, and how long it may be. Input: paths from the tree's top, and with
# -v folders=FILE what cmake.awk wrote.
# Portable awk (mawk too): no gensub, no intervals in patterns.

BEGIN {
    order = "engine <- stimuli <- protocols <- data <- ui"
    rooms = split("engine stimuli protocols data ui tests", name, " ")
    for (i = 1; i <= rooms; i++) rank[name[i]] = i

    # The folders of a room, and which of its others each may include: as cmake.awk read them.
    while ((getline line <folders) > 0) {
        count = split(line, word, " ")
        sees[word[1]] = " "
        for (i = 2; i <= count; i++) sees[word[1]] = sees[word[1]] word[i] " "
    }

    # Where a library's headers may be included: a room, or a folder of one. In .cpp files only, but
    # for glm, fmt, Boost's whole numbers and JSON's forward declarations: values of our own interfaces.
    library("glm", "^glm/", "engine stimuli protocols data ui")
    library("fmt", "^fmt/", "engine/base protocols data ui")
    library("toml++", "^(toml\\+\\+|tomlplusplus)/|^toml\\.hpp$", "protocols")
    library("nettle", "^nettle/", "engine/base data")
    library("SQLite", "^sqlite3(ext)?\\.h$", "data")
    library("zlib", "^(zlib|zconf)\\.h$", "data")
    library("Boost", "^boost/math/", "data/statistics")
    library("Boost.Multiprecision", "^boost/multiprecision/", "protocols/order")
    library("xxHash", "^xxh(ash|3)\\.h$", "data")
    library("SDL_syswm", "^SDL2/SDL_syswm\\.h$", "ui/subject")
    library("SDL2", "^SDL", "ui/sdl")
    library("libpng", "^png\\.h$", "ui/subject ui/session")
    library("CLI11", "^CLI/", "ui")
    library("libmicrohttpd", "^microhttpd\\.h$", "ui/console")
    library("nlohmann", "^nlohmann/", "protocols/file data/csv data/export data/analysis data/fit data/inference" \
        " data/choice data/page data/tables ui")
    library("Eigen", "^Eigen/", "engine/deformation data/statistics")  # curves that yield; nothing that a tick computes
    library("comedilib", "^comedi(lib)?\\.h$", "engine/device/drivers")
    # Of a library that is slow to compile, or is loaded late: which file of a folder includes it.
    door["data/statistics", "Boost"] = "data/statistics/distributions.cpp"
    door["data/statistics", "Eigen"] = "data/statistics/solve.cpp"
    door["ui/sdl", "SDL2"] = "ui/sdl/sdl.hpp"

    posix = " unistd.h fcntl.h poll.h pthread.h sched.h signal.h termios.h time.h errno.h dlfcn.h" \
            " stdint.h stdbool.h pty.h dirent.h link.h netdb.h syscall.h spawn.h glob.h pwd.h stdlib.h stdio.h string.h"

    # libm differs between C libraries in the last bit, and one bit breaks a replay.
    inexact = "(a?sinh?|a?cosh?|a?tanh?|atan2|exp2?|expm1|log(2|10|1p)?|pow|cbrt|hypot|erfc?" \
              "|[tl]gamma|sincos)[fl]?"
    # Computed once a scene and kept with the session, so that a replay need not compute them again.
    exempt["engine/friction/friction_law.cpp"] = 1

    longest = 400
    longest_function = 60
}

FNR == 1 { start_file(FILENAME) }

{
    if (FNR == longest + 1) breach("longer than " longest " lines: one idea a file")
    if (!in_comment && raw_end == "" && match($0, /^[ \t]*#[ \t]*include[ \t]*/))
        check_include(substr($0, RSTART + RLENGTH))
    inside = in_comment || raw_end != ""
    line = code($0)
    if (room != "tests" && !inside) check_length($0)
    if (room == "engine" && !(file in exempt)) check_exactness(line)
    if (room == "engine" || room == "stimuli" || room == "protocols") check_random(line)
}

function start_file(path,   part) {
    file = path
    split(path, part, "/")
    room = part[1]
    folder = folder_of(path, room)
    if (room != "tests" && folder != "" && !(room "/" folder in sees))
        breach(room "/" folder " has no place in " room "/CMakeLists.txt: palpate_folder(" folder " ...)")
    header = path ~ /\.(hpp|h)$/
    in_comment = 0
    raw_end = ""
}

function breach(reason) { print file ":" FNR ": " reason }

function listed(word, words) { return index(" " words " ", " " word " ") > 0 }

# `text`: what follows #include.
function check_include(text,   path, part) {
    if (text ~ /^"/) {
        path = substr(text, 2)
        sub(/".*/, "", path)
        split(path, part, "/")
        if (path ~ /(^|\/)\.\.?\//) breach("\"" path "\": write the path from the room on, without dots")
        else if (!(part[1] in rank) || path !~ /\//) breach("\"" path "\" does not name its room")
        else check_order(path, part[1])
    } else if (text ~ /^</) {
        path = substr(text, 2)
        sub(/>.*/, "", path)
        split(path, part, "/")
        if (part[1] in rank && part[1] != path) breach("<" path ">: rooms are included with quotes")
        else if (room != "tests") check_library(path)
    } else breach("the guard cannot read this include")
}

function folder_of(path, of,   at) {
    path = substr(path, length(of) + 2)
    for (at = length(path); at > 0 && substr(path, at, 1) != "/"; at--) {}
    return substr(path, 1, at - 1)
}

function check_order(path, to,   to_folder) {
    if (room == "tests") return
    to_folder = folder_of(path, to)
    if (rank[to] > rank[room]) {
        if (to == "tests") breach("\"" path "\": " room " may not see tests")
        else breach("\"" path "\": " room " may not see " to "; the order is " order)
    } else if (room == to && folder != to_folder && index(sees[room "/" folder], " " to_folder " ") == 0)
        breach("\"" path "\": " room "/" folder " may not see " to "/" to_folder \
               ": its SEES in " room "/CMakeLists.txt does not name it")
}

function library(called, headers, rooms) {
    known[++libraries] = called
    pattern[libraries] = headers
    where[called] = rooms
}

# Of several the first.
function library_of(path,   i) {
    for (i = 1; i <= libraries; i++) if (path ~ pattern[i]) return known[i]
    return ""
}

function check_library(path,   of) {
    if (path ~ /^[a-z0-9_]+$/ || path ~ /^(sys|linux|gnu|netinet|arpa)\// || listed(path, posix)) return
    if (path ~ /^[a-z0-9]*intrin\.h$/) return
    of = library_of(path)
    if (of == "") breach("<" path "> is of no library that the guard knows")
    else if (!listed(room, where[of]) && !listed(room "/" folder, where[of]))
        breach("<" path ">: " of " belongs to " where[of])
    else if ((room "/" folder, of) in door) {
        if (file != door[room "/" folder, of])
            breach("<" path ">: " of " enters by " door[room "/" folder, of])
    }
    else if (header && of != "glm" && of != "fmt" && of != "Boost.Multiprecision" &&
             path != "nlohmann/json_fwd.hpp")
        breach("<" path ">: " of " stays out of headers")
}

function check_exactness(line) {
    if (line ~ "(^|[^A-Za-z0-9_])(std|glm) *:: *" inexact "([^A-Za-z0-9_]|$)" ||
        line ~ "(^|[^A-Za-z0-9_.>:])(::)?" inexact " *\\(" ||
        line ~ /glm *:: *(rotate|angle|orientedAngle|slerp|fastPow|fastSin|fastCos)[^A-Za-z0-9_]/)
        breach("libm is not the same to the bit everywhere: engine/math has elementary functions that are")
}

# From the line with its name to its brace, as clang-format sets them: at the margin, and in a class one step in.
# Tables, types and namespaces end in another way.
function check_length(text,   step) {
    if (text ~ /^[^ }#]/) {
        begin[0] = FNR
        if (text !~ /^(public|protected|private):/) in_class = text ~ /^(class|struct)/
    } else if (in_class && text ~ /^    [^ }]/) begin[4] = FNR
    if (text ~ /^}$/) step = 0
    else if (in_class && text ~ /^    }$/) step = 4
    else return
    if (FNR - begin[step] + 1 > longest_function)
        breach("a function of " (FNR - begin[step] + 1) " lines: " longest_function " at most, an idea each")
}

function check_random(line) {
    if (line ~ /std *:: *(shuffle|random_shuffle|sample|generate_canonical|[a-z_]+_distribution)/ ||
        line ~ /(^|[^A-Za-z0-9_])s?rand *\(/)
        breach("every C++ library draws this in its own way: a seed must give one order everywhere")
}

# The line without comments, and with its literals emptied.
function code(s,   out, mark, at) {
    out = ""
    while (s != "") {
        if (in_comment || raw_end != "") {
            mark = in_comment ? "*/" : raw_end
            at = index(s, mark)
            if (!at) return out
            s = substr(s, at + length(mark))
            in_comment = 0
            raw_end = ""
            continue
        }
        if (!match(s, /\/\/|\/\*|"|'/)) return out s
        mark = substr(s, RSTART, RLENGTH)
        out = out substr(s, 1, RSTART - 1)
        s = substr(s, RSTART + RLENGTH)
        if (mark == "//") return out
        if (mark == "/*") {
            in_comment = 1
            out = out " "
        } else if (mark == "\"" && out ~ /(^|[^A-Za-z0-9_])(u8|u|U|L)?R$/) {
            at = index(s, "(")
            raw_end = ")" substr(s, 1, at - 1) "\""
            s = substr(s, at + 1)
        } else if (mark == "'" && out ~ /[0-9a-fA-F]$/ && s ~ /^[0-9a-fA-F]/ &&
                   out !~ /(^|[^A-Za-z0-9_])(u8|u|U|L)$/) {
            continue  # 1'000
        } else {
            if (mark == "\"") match(s, /^([^"\\]|\\.)*"/)
            else match(s, /^([^'\\]|\\.)*'/)
            s = RSTART ? substr(s, RLENGTH + 1) : ""
            out = out mark mark
        }
    }
    return out
}
