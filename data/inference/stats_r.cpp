#include <algorithm>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "data/inference/stats_report.hpp"

namespace palpate::data {

std::string_view stats_script();  // stats.R

namespace {

/// A string of R, in ASCII: read the same in every locale.
std::string r_string(std::string_view text) {
    std::string out = "\"";
    while (!text.empty()) {
        const Character one = first_character(text);
        const bool plain =
            one.code >= U' ' && one.code < 127 && one.code != U'"' && one.code != U'\\';
        out += plain ? std::string(1, text.front())
             : one.code == U'"' || one.code == U'\\'
                 ? fmt::format("\\{}", text.front())
                 : fmt::format("\\U{{{:x}}}", static_cast<unsigned>(one.code));
        text.remove_prefix(std::max<std::size_t>(one.length, 1));
    }
    return out + '"';
}

std::string list_of(const std::vector<std::string>& all) {
    std::string text = "c(";
    for (const std::string& one : all) {
        text += (&one == all.data() ? "" : ", ") + r_string(one);
    }
    return text + ")";
}

}  // namespace

std::string stats_r(const StatsReport& report, const std::string& trials) {
    const auto& account = report.table.left_out;
    return fmt::format(
        "# The numbers of `palpate stats --json` again, by R, from the trials beside this "
        "script.\n{}# Each line that it prints is a place in that JSON (a JSON pointer), a tab, "
        "and the number.\n"
        "# Base R; the mixed model by Laplace needs lme4 (r-cran-lme4). What palpate draws by "
        "chance\n"
        "# (permutations, the simulated null) is not drawn again.\n"
        "data <- {}\nfrictions <- {}  # differences are from the first\nyes_no <- {}\n"
        "signals <- {}  # of yes/no: for which yes is right\nalternatives <- {}\n"
        "prior_scale <- {}\n\n{}",
        account ? remarked(left_out_text(without_words(*account))) : std::string(),
        r_string(trials), list_of(report.table.frictions), report.yes_no ? "TRUE" : "FALSE",
        list_of(report.options.signals), report.table.alternatives, report.options.prior_scale,
        stats_script());
}

}  // namespace palpate::data
