#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "data/csv/json_text.hpp"
#include "data/verify/verify.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct VerifyOptions {
    std::string database;
    bool json = false;
};

using data::Finding;
using data::FindingKind;
using data::Json;
using data::SessionReport;

std::string place_of(const Finding& finding) {
    std::string place;
    if (finding.trial) {
        place += fmt::format("trial {}, ", *finding.trial);
    }
    if (finding.tick) {
        place += fmt::format("tick {}, ", *finding.tick);
    }
    return place + plain(finding.what);
}

void print_findings(const std::vector<Finding>& findings) {
    for (const Finding& finding : findings) {
        if (finding.kind == FindingKind::missing) {
            say("  missing  {}: {}\n", place_of(finding), plain(finding.recomputed));
            continue;
        }
        say("  differs  {}: stored {}, recomputed {}", place_of(finding), plain(finding.stored),
            plain(finding.recomputed));
        say("{}\n",
            finding.count > 1 ? fmt::format("; {} ticks of the trial differ", finding.count) : "");
    }
}

void print_text(const std::string& file, const data::Verification& found) {
    say("{}: {}\n", plain(file), counted(found.sessions.size(), "session"));
    print_findings(found.file);
    for (const SessionReport& session : found.sessions) {
        const auto different = static_cast<std::size_t>(
            std::ranges::count(session.findings, FindingKind::differs, &Finding::kind));
        say("{}, participant {}, session {} ({}{}): {}, {} replayed, {}\n", plain(session.study),
            plain(session.participant), session.number, plain(session.kind),
            session.finished ? "" : ", not finished", counted(session.trials, "trial"),
            counted(session.replayed, "tick"),
            different == 0 ? "nothing differs" : counted(different, "difference"));
        if (!session.head.empty()) {
            say("  seal     {}\n", plain(session.head));
        }
        print_findings(session.findings);
    }
    const std::size_t all = found.count(FindingKind::differs);
    say("{}\n", all == 0 ? "Nothing differs."
                         : counted(all, "difference") +
                               ". Take what differs from a copy made before, or leave "
                               "it out; verify changes nothing.");
    say("Not checked, since nothing else in the file says it:\n");
    for (const std::string_view what : data::kNotChecked) {
        say("  {}\n", what);
    }
}

Json json_of(const std::vector<Finding>& findings) {
    Json all = Json::array();
    for (const Finding& finding : findings) {
        all.push_back({{"kind", finding.kind == FindingKind::differs ? "differs" : "missing"},
                       {"trial", json_or_null(finding.trial)},
                       {"tick", json_or_null(finding.tick)},
                       {"what", finding.what},
                       {"stored", finding.stored},
                       {"recomputed", finding.recomputed},
                       {"count", finding.count}});
    }
    return all;
}

void print_json(const std::string& file, const data::Verification& found) {
    Json sessions = Json::array();
    for (const SessionReport& session : found.sessions) {
        sessions.push_back({{"id", session.id},
                            {"study", session.study},
                            {"participant", session.participant},
                            {"number", session.number},
                            {"kind", session.kind},
                            {"finished", session.finished},
                            {"seal", session.head},
                            {"trials", session.trials},
                            {"ticks_replayed", session.replayed},
                            {"findings", json_of(session.findings)}});
    }
    say("{}\n", data::json_text({{"file", file},
                                 {"differences", found.count(FindingKind::differs)},
                                 {"missing", found.count(FindingKind::missing)},
                                 {"findings", json_of(found.file)},
                                 {"not_checked", data::kNotChecked},
                                 {"sessions", sessions}}));
}

void declare(CommandWords& words, VerifyOptions& options) {
    words.add("FILE", options.database, "A palpate database; nothing in it is changed").required();
    words.add("--json", options.json, "One JSON object instead of lines");
}

int run(const VerifyOptions& options) {
    data::Database database(options.database, data::Access::inspect);
    const data::Verification found = data::verify(database);
    if (options.json) {
        print_json(options.database, found);
    } else {
        print_text(options.database, found);
    }
    return found.count(FindingKind::differs) == 0 ? 0 : kExitFailure;
}

}  // namespace

Command verify_command() {
    return make_command<VerifyOptions>(
        "verify", "Recompute what a database says, replay every trial, say what differs", declare,
        run);
}

}  // namespace palpate::ui
