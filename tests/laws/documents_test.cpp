#include <cctype>
#include <regex>

#include "engine/base/sha256.hpp"
#include "tests/support/mixed_study.hpp"
#include "tests/support/program.hpp"

namespace fs = std::filesystem;

namespace {

const fs::path kRoot = PALPATE_SOURCE_DIR;

Words lines_of(const fs::path& file) {
    return lines_in(slurp(file));
}

/// A line of a page, and the fence of the block that it stands in, "```sh"; empty outside of any.
struct PageLine {
    std::string text;
    std::string fence;
};

std::vector<PageLine> page_lines(const fs::path& page) {
    std::vector<PageLine> lines;
    std::string fence;
    for (const std::string& line : lines_of(page)) {
        const std::size_t text = line.find_first_not_of(' ');
        if (text != std::string::npos && line.compare(text, 3, "```") == 0) {
            fence = fence.empty() ? line.substr(text) : "";
        } else {
            lines.push_back({line, fence});
        }
    }
    return lines;
}

std::vector<fs::path> pages() {
    std::vector<fs::path> found{kRoot / "README.md", kRoot / "CHANGELOG.md"};
    for (const auto& entry : fs::directory_iterator(kRoot / "docs")) {
        if (entry.path().extension() == ".md") {
            found.push_back(entry.path());
        }
    }
    return found;
}

/// A page's text without its fenced blocks, one line.
std::string prose_of(const fs::path& page) {
    std::string text;
    for (const auto& [line, fence] : page_lines(page)) {
        text += fence.empty() ? line + ' ' : "";
    }
    return text;
}

/// Lines of a page's fenced blocks of shell commands, without comments and prompts.
Words shell_lines(const fs::path& page) {
    Words found;
    for (const auto& [line, fence] : page_lines(page)) {
        if (fence == "```sh") {
            found.push_back(line.substr(0, line.find(" #")));
        }
    }
    return found;
}

/// The anchors of a page's headings, as GitHub and GitLab make them.
std::set<std::string> anchors_of(const fs::path& page) {
    std::set<std::string> found;
    for (const auto& [line, fence] : page_lines(page)) {
        const std::size_t text = line.find_first_not_of('#');
        if (!fence.empty() || text == 0 || text == std::string::npos || line[text] != ' ') {
            continue;
        }
        std::string anchor;
        for (const char c : line.substr(text + 1)) {
            const auto byte = static_cast<unsigned char>(c);
            if (c == ' ') {
                anchor += '-';
            } else if (std::isalnum(byte) != 0 || c == '-' || c == '_') {
                anchor += static_cast<char>(std::tolower(byte));
            }
        }
        found.insert(anchor);
    }
    return found;
}

/// Words and options of a command's help; none where there is no such command.
const std::set<std::string>& help_of(const std::string& command) {
    static std::map<std::string, std::set<std::string>> known;
    if (!known.contains(command)) {
        Finished help = palpate_command({command, "--help"});
        std::ranges::replace_if(
            help.out, [](char c) { return c == ',' || c == '\n'; }, ' ');
        const Words words = help.code == 0 ? split(help.out, ' ') : Words{};
        known[command] = {words.begin(), words.end()};
    }
    return known[command];
}

/// The words behind "palpate" in a command, up to a pipe or a redirection.
Words words_of(const std::string& command) {
    std::istringstream stream(command);
    Words words;
    for (std::string word; stream >> word && word != "|" && word != ">" && word != "&&";) {
        words.push_back(word);
    }
    return words;
}

/// Looks up a command and its options in the program's own help.
void check_command(const Words& words) {
    const std::string& command = words.front();
    const auto& help = help_of(command);
    CHECK_FALSE(help.empty());
    bool quoted = false;
    for (std::size_t i = 1; i < words.size(); ++i) {
        const std::string option = words[i].substr(0, words[i].find('='));
        const bool is_option = !quoted && option.size() > 1 && option[0] == '-' &&
                               std::isalpha(static_cast<unsigned char>(option.back())) != 0;
        quoted = quoted != (std::count(words[i].begin(), words[i].end(), '"') % 2 == 1);
        CAPTURE(option);
        CHECK((!is_option || help.contains(option)));
    }
}

/// Words that the launcher answers by itself.
bool is_the_launchers(const std::string& word) {
    return word == "test" || word == "bench" || word == "--no-install" || word == "--help";
}

}  // namespace

TEST_CASE("every link and anchor of README, CHANGELOG and docs leads somewhere") {
    int links = 0;
    for (const fs::path& page : pages()) {
        for (const std::string& target : between(prose_of(page), "](", ")")) {
            if (target.rfind("http", 0) == 0) {
                continue;
            }
            CAPTURE(page, target);
            const std::size_t hash = target.find('#');
            const fs::path file =
                hash == 0 ? page
                          : fs::weakly_canonical(page.parent_path() / target.substr(0, hash));
            CHECK(fs::exists(file));
            CHECK(fs::relative(file, fs::canonical(kRoot)).string().rfind("..", 0) != 0);
            if (hash != std::string::npos) {
                CHECK(anchors_of(file).contains(target.substr(hash + 1)));
            }
            ++links;
        }
    }
    CHECK(links > 80);
}

TEST_CASE("README fits into 150 lines, and says near its top that nothing was tried on hardware") {
    const auto lines = lines_of(kRoot / "README.md");
    CHECK(lines.size() <= 150);
    const auto line_of_it = std::find_if(lines.begin(), lines.end(), [](const std::string& line) {
        return line.find("Nothing was tried on hardware") != std::string::npos;
    });
    CHECK(line_of_it - lines.begin() < 20);
}

TEST_CASE("every command that a document shows exists, with every option") {
    int commands = 0;
    for (const fs::path& page : pages()) {
        Words shown = shell_lines(page);
        for (const std::string& code : between(prose_of(page), "`", "`")) {
            // `run --durable` says less, and means the same.
            const auto words = words_of(code);
            const bool is_short = words.size() > 1 && words[1].rfind("--", 0) == 0 &&
                                  std::isalpha(static_cast<unsigned char>(code[0])) != 0 &&
                                  !help_of(words[0]).empty();
            shown.push_back(is_short ? "palpate " + code : code);
        }
        for (const std::string& line : shown) {
            for (std::size_t at = line.find("palpate "); at != std::string::npos;
                 at = line.find("palpate ", at + 1)) {
                const std::string before = line.substr(0, at);
                const bool is_command = before.empty() || before == "./" ||
                                        before.ends_with("build/") || before.ends_with("$(./") ||
                                        before.ends_with(" ./");
                const auto words = words_of(line.substr(at + 8));
                if (is_command && !words.empty() && !is_the_launchers(words.front())) {
                    CAPTURE(page, line);
                    check_command(words);
                    ++commands;
                }
            }
        }
    }
    CHECK(commands > 40);
}

TEST_CASE(
    "the study of README goes from registration to export as printed, rehearsed without a rig") {
    const TemporaryFolder folder;
    fs::create_symlink(palpate_program(), folder.path() / "palpate");
    const auto lines = shell_lines(kRoot / "README.md");
    const auto first = std::find_if(lines.begin(), lines.end(), [](const std::string& line) {
        return line.rfind("./palpate new ", 0) == 0;
    });
    REQUIRE(first != lines.end());
    const auto run = [&](std::string line, const std::string& person) {
        for (const auto& [what, by] :
             {std::pair<std::string, std::string>{"P01", person},
              {"shape_friction_haply", "shape_friction_demo"},  // ten trials of it
              {"--device haply:/dev/ttyACM0 --calibration rig.toml", ""}}) {
            line = all_replaced(line, what, by);
        }
        if (line.find("export") != std::string::npos) {
            line += " --kind all";
        }
        for (const char* command : {"palpate stats", "palpate audit", "palpate report"}) {
            line += line.find(command) == std::string::npos ? "" : " --kind simulated";
        }
        CAPTURE(line);
        ended(shell("RIG=--headless && " + line, folder.path()));
    };
    int steps = 0;
    for (auto line = first; line != lines.end(); ++line) {
        const auto has = [&line](const char* word) {
            return line->find(word) != std::string::npos;
        };
        if (!has("./palpate") || has("calibrate") || has("commission") || has("doctor")) {
            continue;
        }
        run(*line, "P01");
        if (has("P01")) {
            run(*line, "P12");
        }
        ++steps;
    }
    CHECK(steps >= 9);
    CHECK(fs::exists(folder.path() / "shared" / "dataset_description.json"));
}

TEST_CASE("docs/devices.md names each limit and maker the group is trusted with") {
    const std::string said = prose_of(kRoot / "docs/devices.md");
    const std::string given = prose_of(kRoot / "cmake/debian/70-palpate.rules") +
                              prose_of(kRoot / "cmake/debian/limits.conf");
    const std::regex what(R"(idVendor\}=="(\w+)\|?(\w*)|@palpate - (\w+ \w+))");
    for (std::sregex_iterator at(given.begin(), given.end(), what), end; at != end; ++at) {
        for (std::size_t part = 1; part < 4; ++part) {
            CHECK_THAT(said, Has(at->str(part)));
        }
    }
}

TEST_CASE("every query that a document shows in a shell answers") {
    const TemporaryFolder folder;
    fs::create_symlink(palpate_program(), folder.path() / "palpate");
    ran({"demo", "--headless", "--db", folder.file("study.sqlite")});
    int queries = 0;
    for (const fs::path& page : pages()) {
        for (const std::string& line : shell_lines(page)) {
            const bool extension = line.rfind("sqlite3 ", 0) == 0;
            const bool query = extension || line.rfind("./palpate sql ", 0) == 0;
            queries += query ? 1 : 0;
            if (query && (!extension || others_load_extension())) {
                CAPTURE(page, line);
                CHECK(ended(shell(line, folder.path())).error.empty());
            }
        }
    }
    CHECK(queries >= 4);
}

TEST_CASE("the scene that docs/protocol.md shows is felt, with the columns that it names") {
    std::string scene;
    std::string head;
    bool over = false;
    for (const auto& [line, fence] : page_lines(kRoot / "docs" / "protocol.md")) {
        over = over || (!scene.empty() && fence != "```toml");
        if (!over && fence == "```toml" && (line == "[renderer]" || !scene.empty())) {
            scene += line + '\n';
        }
        if (line.rfind("./palpate render ", 0) == 0) {
            head = words_of(line.substr(line.find("# ") + 2)).front();
            head = head.substr(0, head.find('['));
        }
    }
    const TemporaryFolder folder;
    std::ofstream(folder.file("scene.toml")) << scene;
    std::ofstream(folder.file("way.csv")) << head << "\n0,0,0.06\n0.001,0,0.03\n0.002,0.01,0.03\n";
    for (const char* command : {"render", "closest"}) {
        CAPTURE(command);
        const Finished felt = ran({command, folder.file("scene.toml"), folder.file("way.csv")});
        CHECK(std::count(felt.out.begin(), felt.out.end(), '\n') == 4);
    }
}

TEST_CASE("the drawing of the house has every folder of every room, in order") {
    // From the top of the drawing down; the lists of CMake go up.
    Words drawn;
    for (const std::string& line : lines_of(kRoot / "docs" / "architecture.md")) {
        for (const std::string& bar : Words{"┌─ ", "├─ ", "│ "}) {
            if (line.rfind(bar, 0) == 0 &&
                std::islower(static_cast<unsigned char>(line[bar.size()])) != 0) {
                drawn.push_back(words_of(line.substr(bar.size())).front());
            }
        }
        if (line.rfind("└", 0) == 0) {
            break;
        }
    }
    Words built;
    for (const char* room : {"engine", "stimuli", "protocols", "data", "ui"}) {
        for (const std::string& line : lines_of(kRoot / room / "CMakeLists.txt")) {
            if (line.rfind("palpate_folder(", 0) == 0) {
                const std::string name = line.substr(15);
                built.push_back(name.substr(0, name.find_first_of(" )")));
            }
        }
        built.push_back(room);
    }
    std::reverse(built.begin(), built.end());
    CHECK(drawn == built);
}

TEST_CASE("docs/protocol.md has every key as the program reads it") {
    const fs::path page = kRoot / "docs" / "protocol.md";
    const std::string text = slurp(page);
    const std::string heading = "## Every key\n";
    REQUIRE_THAT(text, Has(heading));
    const std::string whole =
        text.substr(0, text.find(heading)) + heading +
        "\nMade from the tables by which palpate itself reads, checks and writes these files.\n" +
        palpate_command({"new", "--keys", "--markdown"}).out;
    CHECK_THAT(whole, Has("| `mu_s` |  |", "| `damping_1_mn_m_s` | mN m s |"));
    if (std::getenv("PALPATE_WRITE_DOCS") != nullptr) {
        std::ofstream(page) << whole;
    } else {
        INFO(
            "Keys have changed. To write docs/protocol.md anew, run this test once with "
            "PALPATE_WRITE_DOCS=1 in the environment:\n"
            "PALPATE_WRITE_DOCS=1 ctest --test-dir build -R 'docs/protocol.md has every key'");
        CHECK((text == whole));
    }
}

TEST_CASE("the example queries of docs/data.md run as printed, and answer") {
    const TemporaryFolder folder;
    const std::string file = mixed_study(folder);  // with every kind of question
    const Words queries = between(slurp(kRoot / "docs/data.md"), "\n```sql\n", "```");
    CHECK(queries.size() >= 3);
    for (const std::string& query : queries) {
        CAPTURE(query);
        const Finished answer = ended(Process({"sqlite3", file, query}).wait());
        CHECK_FALSE(answer.out.empty());
    }
}

TEST_CASE("docs/data.md names every table and view of the schema") {
    const TemporaryFile file("d.sqlite");
    ran({"demo", "--headless", "--db", file});
    const Finished names =
        Process({"sqlite3", file, "SELECT name FROM sqlite_master WHERE type IN ('table', 'view')"})
            .wait();
    const std::string text = slurp(kRoot / "docs/data.md");
    for (const std::string& name : lines_in(names.out)) {
        CAPTURE(name);
        CHECK_THAT(text, Has("`" + name + "`"));
    }
}

TEST_CASE("uPlot lies here as its package has it, with its licence") {
    const std::string folder = (kRoot / "data/page/uplot/").string();
    const std::string readme = slurp(folder + "README.md");
    for (const char* name : {"uPlot.iife.min.js", "uPlot.min.css", "LICENSE"}) {
        CAPTURE(name);
        CHECK_THAT(readme,
                   Has(fmt::format("| `{}` | {} |", name, sha256_hex(slurp(folder + name)))));
    }
    CHECK_THAT(slurp(folder + "uPlot.iife.min.js"), Has("(v1.6.32)"));
    CHECK_THAT(slurp(folder + "LICENSE"), Has("The MIT License"));
}
