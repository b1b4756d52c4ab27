#include <cctype>
#include <regex>

#include "tests/support/catch.hpp"
#include "tests/support/slurp.hpp"

namespace fs = std::filesystem;

namespace {

const fs::path kHouse = PALPATE_SOURCE_DIR;

/// A C++ file with its string literals in one piece each, as the compiler joins them, and the name
/// of a test case at its bracket.
const std::string& joined(const fs::path& file) {
    static std::map<fs::path, std::string> known;
    const auto [at, first] = known.try_emplace(file);
    if (first) {
        const std::string whole = std::regex_replace(slurp(file), std::regex("\"[ \n]+\""), "");
        at->second = std::regex_replace(whole, std::regex("_CASE\\([ \n]+\""), "_CASE(\"");
    }
    return at->second;
}

Words parts_of(const std::string& text, const std::string& between) {
    return split(all_replaced(text, between, "\n"), '\n');
}

/// The target of the first link in `text`, from the tree's top, and what follows the link; empty
/// without one.
std::pair<std::string, std::string> link_of(const std::string& text) {
    static const std::regex link(R"(\]\(\.\./([^)]*)\)(.*))");
    std::smatch found;
    std::regex_search(text, found, link);
    return {found.str(1), found.str(2)};
}

/// What the page's rule says of a risk, all three from 1.
std::string verdict_on(int severity, int probability, int detectability) {
    const int risk = severity * probability;
    if (risk >= 10) {
        return "no";
    }
    const bool unseen = detectability == 4 && severity >= 2;
    return risk >= 5 || severity == 4 || unseen ? "review" : "yes";
}

/// The verdicts in `text` follow from their estimates. @return how many there are
int verdicts_follow(const std::string& text) {
    static const std::regex estimate("S([1-4]) P([1-5]) D([1-4]): ([a-z]+)");
    int seen = 0;
    for (std::sregex_iterator at(text.begin(), text.end(), estimate), end; at != end; ++at) {
        const std::smatch& found = *at;
        CAPTURE(found.str());
        CHECK(found.str(4) == verdict_on(std::stoi(found.str(1)), std::stoi(found.str(2)),
                                         std::stoi(found.str(3))));
        ++seen;
    }
    return seen;
}

}  // namespace

TEST_CASE("every hazard of docs/safety.md has a measure in the sources and tests that are there",
          "[safety]") {
    int rows = 0;
    int tests = 0;
    std::istringstream page(slurp(kHouse / "docs" / "safety.md"));
    for (std::string line; std::getline(page, line);) {
        verdicts_follow(line);  // of any table
        if (line.size() < 3 || std::isdigit(static_cast<unsigned char>(line[2])) == 0) {
            continue;
        }
        CAPTURE(line);
        const Words cells = parts_of(line, " | ");
        // number, hazard, cause, before, measure, test, after, rest risk
        REQUIRE(cells.size() == 8);
        CHECK(cells[0] == "| " + std::to_string(++rows));
        CHECK(verdicts_follow(cells[3]) == 1);
        CHECK(verdicts_follow(cells[6]) >= 1);
        for (const std::string& measure : parts_of(cells[4], "; ")) {
            const std::string file = link_of(measure).first;
            CAPTURE(measure);
            CHECK_FALSE(file.empty());
            CHECK(fs::is_regular_file(kHouse / file));
            CHECK(file.rfind("tests/", 0) != 0);
        }
        for (const std::string& test : parts_of(cells[5], "<br>")) {
            const auto [file, name] = link_of(test);
            CAPTURE(test);
            CHECK(file.rfind("tests/", 0) == 0);
            REQUIRE(name.rfind(": ", 0) == 0);
            CHECK_THAT(joined(kHouse / file), Has("_CASE(\"" + name.substr(2) + '"'));
            ++tests;
        }
        CHECK(cells[7].size() > 5);
    }
    CHECK(rows >= 54);
    CHECK(tests >= 120);
}
