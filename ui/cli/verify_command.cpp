#include <fmt/format.h>

#include "protocols/design/counted.hpp"
#include "data/verify/verify.hpp"
#include "ui/cli/commands.hpp"

namespace palpate::ui {
namespace {

using data::Finding;
using data::FindingKind;
using data::SessionReport;
using protocols::counted;

/// A file can come from anywhere: nothing of its texts reaches the terminal but printable ASCII.
std::string printable(std::string_view text) {
    std::string out;
    for (const char c : text) {
        out += c >= ' ' && c <= '~' ? c : c == '\n' ? ' ' : '?';
    }
    return out;
}

std::string in_quotes(std::string_view text) {
    std::string out = "\"";
    for (const char c : printable(text)) {
        out += c == '"' || c == '\\' ? fmt::format("\\{}", c) : std::string(1, c);
    }
    return out + '"';
}

std::string place_of(const Finding& finding) {
    std::string place;
    if (finding.trial) {
        place += fmt::format("trial {}, ", *finding.trial);
    }
    if (finding.tick) {
        place += fmt::format("tick {}, ", *finding.tick);
    }
    return place + printable(finding.what);
}

void print_findings(const std::vector<Finding>& findings) {
    for (const Finding& finding : findings) {
        if (finding.kind == FindingKind::missing) {
            fmt::print("  missing  {}: {}\n", place_of(finding), printable(finding.recomputed));
            continue;
        }
        fmt::print("  differs  {}: stored {}, recomputed {}", place_of(finding),
                   printable(finding.stored), printable(finding.recomputed));
        fmt::print("{}\n", finding.count > 1
                               ? fmt::format("; {} ticks of the trial differ", finding.count)
                               : "");
    }
}

std::size_t differences(const std::vector<Finding>& findings) {
    std::size_t found = 0;
    for (const Finding& finding : findings) {
        found += finding.kind == FindingKind::differs ? 1 : 0;
    }
    return found;
}

void print_text(const std::string& file, const data::Verification& found) {
    fmt::print("{}: {}\n", printable(file), counted(found.sessions.size(), "session"));
    print_findings(found.file);
    for (const SessionReport& session : found.sessions) {
        const std::size_t different = differences(session.findings);
        fmt::print("{}, participant {}, session {} ({}{}): {}, {} replayed, {}\n",
                   printable(session.study), printable(session.participant), session.number,
                   printable(session.kind), session.finished ? "" : ", not finished",
                   counted(session.trials, "trial"), counted(session.replayed, "tick"),
                   different == 0 ? "nothing differs" : counted(different, "difference"));
        if (!session.head.empty()) {
            fmt::print("  chain    {}\n", printable(session.head));
        }
        print_findings(session.findings);
    }
    const std::size_t all = found.count(FindingKind::differs);
    fmt::print("{}\n", all == 0 ? "Nothing differs."
                                : counted(all, "difference") +
                                      ". Take what differs from a copy made before, or leave "
                                      "it out; verify changes nothing.");
}

std::string json_of(const std::vector<Finding>& findings) {
    std::string text;
    for (const Finding& finding : findings) {
        text += fmt::format(
            "{}{{\"kind\": \"{}\", \"trial\": {}, \"tick\": {}, \"what\": {}, \"stored\": {}, "
            "\"recomputed\": {}, \"count\": {}}}",
            text.empty() ? "" : ", ", finding.kind == FindingKind::differs ? "differs" : "missing",
            finding.trial ? fmt::format("{}", *finding.trial) : "null",
            finding.tick ? fmt::format("{}", *finding.tick) : "null", in_quotes(finding.what),
            in_quotes(finding.stored), in_quotes(finding.recomputed), finding.count);
    }
    return "[" + text + "]";
}

void print_json(const std::string& file, const data::Verification& found) {
    std::string sessions;
    for (const SessionReport& session : found.sessions) {
        sessions += fmt::format(
            "{}{{\"id\": {}, \"study\": {}, \"participant\": {}, \"number\": {}, \"kind\": {}, "
            "\"finished\": {}, \"chain\": {}, \"trials\": {}, \"ticks_replayed\": {}, "
            "\"findings\": {}}}",
            sessions.empty() ? "" : ", ", session.id, in_quotes(session.study),
            in_quotes(session.participant), session.number, in_quotes(session.kind),
            session.finished, in_quotes(session.head), session.trials, session.replayed,
            json_of(session.findings));
    }
    fmt::print(
        "{{\"file\": {}, \"differences\": {}, \"missing\": {}, \"findings\": {}, "
        "\"sessions\": [{}]}}\n",
        in_quotes(file), found.count(FindingKind::differs), found.count(FindingKind::missing),
        json_of(found.file), sessions);
}

}  // namespace

int verify_command(const VerifyOptions& options) {
    data::Database database(options.database, data::Access::read);
    const data::Verification found = data::verify(database);
    if (options.json) {
        print_json(options.database, found);
    } else {
        print_text(options.database, found);
    }
    return found.count(FindingKind::differs) == 0 ? 0 : kExitFailure;
}

}  // namespace palpate::ui
