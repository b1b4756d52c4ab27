#include <cmath>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "protocols/file/document.hpp"
#include "protocols/file/procedure_file.hpp"
#include "data/csv/number_table.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct ProcedureOptions {
    std::string config;
    std::string responses;
    std::string output;   ///< empty: standard output
    bool hashes = false;  ///< a column with the hash of the state after every trial
    bool keys = false;    ///< only print what a configuration may say
};

using protocols::Estimate;
using protocols::Procedure;

/// The column that says which of several interleaved staircases showed a stimulus.
constexpr std::string_view kStaircase = "staircase";

/// Columns of the stimulus: "stimulus", and "stimulus_covariate" for a further dimension of that
/// name.
std::vector<std::string> stimulus_columns(const Procedure& procedure) {
    std::vector<std::string> columns;
    for (const std::string& name : procedure.stimulus_names()) {
        columns.push_back(columns.empty() ? "stimulus" : "stimulus_" + name);
    }
    return columns;
}

std::string head(const Procedure& procedure, bool tracks, bool hashes) {
    const std::vector<std::string> stimulus = stimulus_columns(procedure);
    std::string text = fmt::format("trial,{},response", fmt::join(stimulus, ","));
    if (tracks) {
        text += fmt::format(",{}", kStaircase);
    }
    const std::vector<Estimate> estimates = procedure.estimates();
    if (estimates.size() < 2) {
        text += ",estimate_mean,estimate_mode";
    } else {
        for (const Estimate& estimate : estimates) {
            text += fmt::format(",estimate_mean_{0},estimate_mode_{0}", estimate.name);
        }
    }
    text += ",entropy_bits";
    for (const std::string& column : stimulus) {
        text += ",next_" + column;
    }
    return text + (hashes ? ",state_sha256\n" : "\n");
}

void add(std::string& line, std::optional<double> value) {
    line += ',';
    if (value && std::isfinite(*value)) {
        fmt::format_to(std::back_inserter(line), "{}", *value == 0.0 ? 0.0 : *value);
    }
}

/// What the procedure says after a trial: estimates, entropy, and what it would show next.
void add_state(std::string& line, const Procedure& procedure) {
    const std::vector<Estimate> estimates = procedure.estimates();
    for (const Estimate& estimate : estimates) {
        add(line, estimate.mean);
        add(line, estimate.mode);
    }
    if (estimates.empty()) {
        line += ",,";
    }
    add(line, procedure.entropy());
    if (procedure.finished()) {
        line += std::string(procedure.stimulus_names().size(), ',');
    } else {
        for (const double x : procedure.next()) {
            add(line, x);
        }
    }
}

/// The response of a row as an outcome.
std::size_t outcome_of(const Procedure& procedure,
                       const data::NumberTable& table,
                       std::size_t row,
                       const std::string& file) {
    const double response = table.at(row, 0);
    const auto last = static_cast<double>(procedure.outcomes() - 1);
    refuse_if<data::CsvError>(
        !(response >= 0.0 && response <= last) || response != std::floor(response),
        "{}:{}: response is {}: give a whole number from 0 to {}", file, table.lines[row], response,
        last);
    return static_cast<std::size_t>(response);
}

/// The stimulus of a row, or what the procedure recommends if the file has no such columns.
std::vector<double> shown_in(const Procedure& procedure,
                             const data::NumberTable& table,
                             std::size_t row) {
    if (table.columns.size() == 1) {
        return procedure.next();
    }
    std::vector<double> shown;
    for (std::size_t k = 1; k < table.columns.size(); ++k) {
        shown.push_back(table.at(row, k));
    }
    return shown;
}

std::string line_of(std::size_t row,
                    const std::vector<double>& shown,
                    std::size_t outcome,
                    std::string_view staircase) {
    std::string line = fmt::format("{}", row + 1);
    for (const double x : shown) {
        add(line, x);
    }
    line += fmt::format(",{}", outcome);
    if (!staircase.empty()) {
        line += fmt::format(",{}", staircase);
    }
    return line;
}

std::string replayed(Procedure procedure,
                     const data::NumberTable& table,
                     const std::string& file,
                     bool hashes) {
    const bool tracks = !procedure.track().empty();
    std::string text = head(procedure, tracks, hashes);
    for (std::size_t row = 0; row < table.rows(); ++row) {
        refuse_if<data::CsvError>(procedure.finished(),
                                  "{}:{}: response {} comes after the end: the procedure ends with "
                                  "trial {}; delete the rows beyond, or let it go on longer",
                                  file, table.lines[row], row + 1, row);
        const std::vector<double> shown = shown_in(procedure, table, row);
        const std::size_t outcome = outcome_of(procedure, table, row, file);
        const std::string_view given = table.text(row, kStaircase).value_or("");
        const std::string_view staircase = !tracks || given.empty() ? procedure.track() : given;
        std::string line = line_of(row, shown, outcome, staircase);
        try {
            procedure.update(shown, outcome, staircase);
        } catch (const std::invalid_argument& e) {
            throw data::CsvError(fmt::format("{}:{}: {}", file, table.lines[row], e.what()));
        }
        add_state(line, procedure);
        text += line;
        if (hashes) {
            text += ',' + procedure.state_hash();
        }
        text += '\n';
    }
    return text;
}

void declare(CommandWords& words, ProcedureOptions& options) {
    words.add("CONFIG", options.config, "A procedure file (TOML)").required_unless("--keys");
    words
        .add("RESPONSES", options.responses,
             "A CSV file with a column response (and stimulus, and staircase)")
        .required_unless("--keys");
    words.add("-o,--output", options.output, "Where to write; standard output without it");
    words.add("--hashes", options.hashes, "Add the SHA-256 of the state after every trial");
    words.add("--keys", options.keys, "Print what a procedure file may say");
}

int run(const ProcedureOptions& options) {
    if (options.keys) {
        say("{}", protocols::procedure_key_reference());
        return 0;
    }
    const protocols::Procedure procedure = protocols::parse_procedure(
        protocols::read_text(options.config, protocols::kMaxDocument), options.config);
    const std::vector<std::string> shown = stimulus_columns(procedure);
    const std::vector<std::string_view> optional(shown.begin(), shown.end());
    const std::vector<std::string_view> wanted{"response"};
    const data::NumberTable table =
        data::read_numbers(options.responses, wanted, optional, std::span(&kStaircase, 1));
    write_whole(options.output, replayed(procedure, table, options.responses, options.hashes));
    return 0;
}

}  // namespace

Command procedure_command() {
    return make_command<ProcedureOptions>(
        "procedure", "Replay an adaptive procedure: stimuli, estimates and entropy trial by trial",
        declare, run);
}

}  // namespace palpate::ui
