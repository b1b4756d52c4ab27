# CMake: the folders of a room and what each sees of it, what they link, how sources are listed, and which flags
# nobody may set. With -v folders=FILE it writes a line "room/folder seen seen ..." a folder, for source.awk.
# Input: CMakeLists.txt, *.cmake and CMakePresets.json, as paths from the tree's top.

BEGIN {
    links["engine"] = "glm::glm fmt::fmt Threads::Threads PkgConfig::NETTLE PkgConfig::COMEDI" \
                    " Eigen3::Eigen"
    links["stimuli"] = "palpate::engine"
    links["protocols"] = "palpate::stimuli tomlplusplus::tomlplusplus Boost::headers" \
                         " nlohmann_json::nlohmann_json"
    links["data"] = "palpate::protocols SQLite::SQLite3 ZLIB::ZLIB PkgConfig::NETTLE PkgConfig::PQ Boost::headers" \
                    " PostgreSQL::PostgreSQL palpate::xxhash Eigen3::Eigen" \
                    " nlohmann_json::nlohmann_json"
    links["ui"] = "palpate::data CLI11::CLI11 PNG::PNG palpate::thesis"
    scopes = "PUBLIC PRIVATE INTERFACE palpate::warnings"
}

FNR == 1 {
    split(FILENAME, part, "/")
    room = part[1]
    command = ""
}

{
    if (FILENAME !~ /\.json$/) sub(/#.*/, "")
    if (/-ffast-math|-Ofast|-funsafe-math|-fassociative-math|-freciprocal-math|-ffp-contract=(fast|on)/)
        breach("this flag lets the compiler change results: a recorded trace must replay to the bit")
    if (FILENAME !~ /\.json$/) read_commands($0)
}

function breach(reason) { print FILENAME ":" FNR ": " reason }

# One argument after another; a command may go on for many lines.
function read_commands(s,   word) {
    while (s != "") {
        if (command == "") {
            if (!match(s, /[A-Za-z_][A-Za-z0-9_]*[ \t]*\(/)) return
            command = tolower(substr(s, RSTART, RLENGTH - 1))
            sub(/[ \t]+$/, "", command)
            s = substr(s, RSTART + RLENGTH)
            argument = 0
            depth = 1
            if (command == "link_libraries" && room in links)
                breach("link_libraries links what nobody asked for: use target_link_libraries")
            continue
        }
        if (!match(s, /[^ \t()"]+|[()]/)) return
        word = substr(s, RSTART, RLENGTH)
        s = substr(s, RSTART + RLENGTH)
        if (word == "(") depth++
        else if (word == ")") { if (--depth == 0) command = "" }
        else check_argument(++argument, word)
    }
}

function check_argument(number, word) {
    if (command == "file" && word ~ /^GLOB/) breach("sources are listed by hand")
    if (!(room in links)) return
    if (command == "palpate_folder") check_folder(number, word)
    else if (command == "palpate_room_uses" || (command == "target_link_libraries" && number > 1)) check_link(word)
}

# palpate_folder(name SEES folders LINK libraries SOURCES files): what is seen stands above.
function check_folder(number, word) {
    if (number == 1) {
        folder = word
        placed[room "/" folder] = 1
        printf "%s%s/%s", line_end, room, folder >folders
        line_end = "\n"
        keyword = ""
    } else if (word ~ /^[A-Z]+$/) keyword = word
    else if (keyword == "LINK") check_link(word)
    else if (keyword == "SEES") {
        printf " %s", word >folders
        if (!(room "/" word in placed))
            breach(room "/" folder " sees " word ", which is not above it: the folders stand in their order")
    }
}

function check_link(word) {
    if (index(" " scopes " palpate::" room " " links[room] " ", " " word " ") == 0)
        breach(room " may not link " word "; it may: " links[room])
}

END { if (line_end != "") print "" >folders }
