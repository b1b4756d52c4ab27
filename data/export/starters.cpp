#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <ranges>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "data/analysis/left_out.hpp"
#include "data/csv/json_text.hpp"
#include "data/csv/number_table.hpp"
#include "data/export/export.hpp"

namespace palpate::data {

std::string_view starter_r();       // starter.R
std::string_view starter_python();  // starter.py

namespace {

/// What the scripts set, in the order in which a table should show it.
struct Levels {
    std::vector<std::string> kinds;  ///< of sessions, real before pilot before simulated
    std::vector<std::string> frictions;
    std::vector<std::string> objects;
};

/// Names by the least number that stands beside them; those without one last, by name.
class Ranking {
public:
    void add(std::string_view name, std::string_view number) {
        double value = std::numeric_limits<double>::infinity();
        std::from_chars(number.data(), number.data() + number.size(), value);
        if (!name.empty()) {
            const auto [place, is_new] = least_.try_emplace(std::string(name), value);
            place->second = std::min(place->second, value);
        }
    }
    [[nodiscard]] std::vector<std::string> names() const {
        std::vector<std::string> all;
        for (const auto& [name, value] : least_) {
            all.push_back(name);
        }
        std::ranges::stable_sort(all, {},
                                 [this](const std::string& name) { return least_.at(name); });
        return all;
    }

private:
    std::map<std::string, double> least_;
};

Levels levels_of(const std::filesystem::path& folder) {
    constexpr std::array<std::string_view, 6> kTexts{
        "session_kind", "friction", "mu_s", "planned_object", "curvature_per_m", "chosen_object"};
    const NumberTable trials = read_numbers(folder / "trials.csv", {}, {}, kTexts);
    const auto text = [&](std::size_t row, std::string_view column) {
        return trials.text(row, column).value_or("");
    };
    Ranking kinds;
    Ranking frictions;
    Ranking objects;
    for (std::size_t row = 0; row < trials.rows(); ++row) {
        const std::string_view kind = text(row, "session_kind");
        kinds.add(kind, kind == "real" ? "0" : kind == "pilot" ? "1" : "2");
        frictions.add(text(row, "friction"), text(row, "mu_s"));
        objects.add(text(row, "planned_object"), text(row, "curvature_per_m"));
        objects.add(text(row, "chosen_object"), "");
    }
    Levels levels{kinds.names(), frictions.names(), objects.names()};
    refuse_if(levels.kinds.empty() || levels.frictions.empty(),
              "{}: there is no trial in it, or the columns session_kind and friction are gone",
              (folder / "trials.csv").string());
    return levels;
}

/// The words as a list of the language: "a", "b".
std::string words_text(const std::vector<std::string>& words) {
    return fmt::format("{}", fmt::join(std::views::transform(words, json_string), ", "));
}

/// Who is left out, as the export says it.
std::string account_of(const std::filesystem::path& folder) {
    std::ifstream file(folder / "README.txt");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::size_t begin = text.rfind("\n\nNothing is here of who");
    return begin == std::string::npos ? std::string() : remarked(text.substr(begin + 2));
}

}  // namespace

std::vector<std::filesystem::path> write_starters(const std::filesystem::path& folder) {
    for (const char* name : {"columns.csv", "trials.csv"}) {
        refuse_if(!std::filesystem::exists(folder / name),
                  "{} is no export: it has no {}; make one with palpate export FILE --format csv "
                  "-o FOLDER",
                  folder.string(), name);
    }
    const Levels levels = levels_of(folder);
    const std::string about =
        "# Loads the export beside it, with types and levels set. Written by palpate analysis "
        "init, to be changed.\n" +
        account_of(folder);
    std::vector<std::filesystem::path> written{folder / "analysis.R", folder / "analysis.py"};
    for (const auto& file : written) {
        refuse_if(std::filesystem::exists(file),
                  "{} is there already, and stays as it is: move it away first", file.string());
    }
    const auto write = [&](const std::filesystem::path& file, std::string_view sets,
                           std::string_view c, std::string_view end, std::string_view script) {
        write_new(file, fmt::format("{0}kind {1} {2}  # of sessions; here are {3}\n"
                                    "frictions {1} {6}{4}{7}  # by static friction\n"
                                    "objects {1} {6}{5}{7}  # by curvature\n\n{8}",
                                    about, sets, json_string(levels.kinds[0]),
                                    fmt::join(levels.kinds, ", "), words_text(levels.frictions),
                                    words_text(levels.objects), c, end, script));
    };
    write(written[0], "<-", "c(", ")", starter_r());
    write(written[1], "=", "[", "]", starter_python());
    return written;
}

}  // namespace palpate::data
