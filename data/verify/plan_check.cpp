#include "data/verify/plan_check.hpp"

#include <algorithm>
#include <exception>
#include <optional>

#include <fmt/format.h>

#include "protocols/design/counted.hpp"
#include "protocols/design/counterbalance.hpp"
#include "protocols/design/friction_blocks.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/design/session_plan.hpp"

namespace palpate::data {
namespace {

using protocols::PlannedTrial;

template <class List>
std::optional<std::size_t> index_of(const List& list, const std::string& name) {
    const auto found =
        std::find_if(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
    return found == list.end() ? std::nullopt
                               : std::optional(static_cast<std::size_t>(found - list.begin()));
}

void check_row(const StoredRow& row,
               const PlannedTrial& planned,
               const protocols::Protocol& protocol,
               Findings& findings) {
    const auto& object = protocol.objects.at(planned.condition.object);
    const auto& friction = protocol.frictions.at(planned.condition.friction);
    const std::string table = fmt::format("plan at position {}", planned.position);
    findings.expect(table, "position", row, static_cast<std::int64_t>(planned.position));
    findings.expect(table, "phase", row, std::string(to_string(planned.phase)));
    findings.expect(table, "object", row, object.name);
    const auto curvature = curvature_of(object);
    findings.expect(table, "curvature_per_m", row, curvature ? Value(*curvature) : Value());
    findings.expect(table, "friction", row, friction.name);
    findings.expect(table, "mu_s", row, friction.mu_s);
    findings.expect(table, "mu_d", row, friction.mu_d);
    findings.expect(table, "break_before", row, std::int64_t{planned.break_before ? 1 : 0});
    findings.expect(table, "block", row, static_cast<std::int64_t>(planned.block));
}

/// Frictions of the main trials in the order in which they come.
std::vector<std::string> frictions_of(const std::vector<StoredRow>& rows) {
    std::vector<std::string> names;
    for (const StoredRow& row : rows) {
        const std::string name = row.text("friction");
        if (row.text("phase") == "main" &&
            std::find(names.begin(), names.end(), name) == names.end()) {
            names.push_back(name);
        }
    }
    return names;
}

/// What is planned of trials whose stimulus a rule chooses.
void check_adaptive_rows(Database& database,
                         std::int64_t session,
                         const SessionFrame& frame,
                         Findings& findings) {
    if (database.schema() < 5) {
        return;
    }
    const auto rows = rows_of(
        database, "SELECT * FROM adaptive_plan WHERE session = ?1 ORDER BY position", session);
    std::size_t next = 0;
    for (const PlannedTrial& planned : frame.plan.trials) {
        if (!planned.adaptive) {
            continue;
        }
        if (next < rows.size()) {
            const StoredRow& row = rows[next];
            const protocols::AdaptiveTrial& adaptive = *planned.adaptive;
            const std::string table = fmt::format("adaptive_plan at position {}", planned.position);
            findings.expect(table, "position", row, static_cast<std::int64_t>(planned.position));
            findings.expect(table, "run", row, static_cast<std::int64_t>(adaptive.run));
            findings.expect(table, "run_name", row, frame.protocol.runs.at(adaptive.run).name);
            findings.expect(table, "comparison", row,
                            static_cast<std::int64_t>(adaptive.comparison));
            findings.expect(table, "standard_friction", row,
                            frame.protocol.frictions.at(adaptive.standard_friction).name);
        }
        ++next;
    }
    if (rows.size() != next) {
        findings.differs("adaptive_plan", protocols::counted(rows.size(), "row"),
                         protocols::counted(next, "row"));
    }
}

/// The plan as its rows say it: enough to replay trials.
std::optional<protocols::Plan> stored_plan(const std::vector<StoredRow>& rows,
                                           const SessionFrame& frame) {
    protocols::Plan plan;
    for (const StoredRow& row : rows) {
        const auto object = index_of(frame.protocol.objects, row.text("object"));
        const auto friction = index_of(frame.protocol.frictions, row.text("friction"));
        if (!object || !friction) {
            return std::nullopt;
        }
        const std::string phase = row.text("phase");
        plan.trials.push_back({.position = plan.trials.size(),
                               .phase = phase == "practice" ? protocols::Phase::practice
                                      : phase == "main"     ? protocols::Phase::main
                                                            : protocols::Phase::catch_trial,
                               .condition = {*object, *friction},
                               .break_before = row.integer("break_before") != 0,
                               .block = static_cast<std::size_t>(row.integer("block"))});
    }
    for (const std::string& name : frame.pictures) {
        const auto object = index_of(frame.protocol.objects, name);
        if (!object) {
            return std::nullopt;
        }
        plan.picture_order.push_back(*object);
    }
    return plan;
}

void check_pictures(const std::vector<StoredRow>& rows,
                    const SessionFrame& frame,
                    Findings& findings) {
    const std::vector<std::size_t>& order = frame.plan.picture_order;
    if (rows.size() != order.size()) {
        findings.differs("picture", protocols::counted(rows.size(), "row"),
                         protocols::counted(order.size(), "row"));
    }
    for (std::size_t place = 0; place < std::min(rows.size(), order.size()); ++place) {
        const std::string table = fmt::format("picture at place {}", place);
        findings.expect(table, "place", rows[place], static_cast<std::int64_t>(place));
        findings.expect(table, "object", rows[place], frame.protocol.objects.at(order[place]).name);
    }
}

}  // namespace

bool check_plan(Database& database,
                const StoredRow& session,
                SessionFrame& frame,
                Findings& findings) {
    const std::int64_t id = session.integer("id");
    const auto rows =
        rows_of(database, "SELECT * FROM plan WHERE session = ?1 ORDER BY position", id);
    const auto pictures =
        rows_of(database, "SELECT * FROM picture WHERE session = ?1 ORDER BY place", id);
    for (const StoredRow& picture : pictures) {
        frame.pictures.push_back(picture.text("object"));
    }
    try {
        frame.plan = make_plan(frame.protocol, frame.protocol_hash, frame.key, frame.seed,
                               picture_history(frame.protocol, {}, frame.pictures),
                               friction_history(frame.protocol, {}, frictions_of(rows)));
    } catch (const std::exception& e) {
        findings.differs("plan", protocols::counted(rows.size(), "row"), e.what());
        return false;
    }
    if (frame.old && frame.plan.hash != session.text("plan_sha256")) {
        findings.missing("session.plan_sha256",
                         "an older palpate drew this order in another way: its rows are believed");
        const auto stored = stored_plan(rows, frame);
        if (!stored) {
            findings.differs("plan", "names", "names of the protocol's objects and frictions");
            return false;
        }
        frame.plan = *stored;
    } else {
        findings.expect("session", "plan_sha256", session, frame.plan.hash);
        findings.expect("session", "shuffles", session,
                        static_cast<std::int64_t>(frame.plan.attempts));
    }
    if (rows.size() != frame.plan.trials.size()) {
        findings.differs("plan", protocols::counted(rows.size(), "row"),
                         protocols::counted(frame.plan.trials.size(), "row"));
    }
    for (std::size_t i = 0; i < std::min(rows.size(), frame.plan.trials.size()); ++i) {
        check_row(rows[i], frame.plan.trials[i], frame.protocol, findings);
    }
    check_pictures(pictures, frame, findings);
    check_adaptive_rows(database, id, frame, findings);
    return true;
}

}  // namespace palpate::data
