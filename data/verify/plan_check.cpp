#include "data/verify/plan_check.hpp"

#include <algorithm>
#include <exception>
#include <optional>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/design/counterbalance.hpp"
#include "protocols/design/friction_blocks.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/design/session_plan.hpp"

namespace palpate::data {
namespace {

using protocols::PlannedTrial;

void check_row(const StoredRow& row,
               const PlannedTrial& planned,
               const protocols::Protocol& protocol,
               Findings& findings) {
    const auto& object = protocol.objects.at(planned.condition.object);
    const auto& friction = protocol.frictions.at(planned.condition.friction);
    const std::string table = fmt::format("plan at position {}", planned.position);
    findings.expect(table, "plan_position", row, static_cast<std::int64_t>(planned.position));
    findings.expect(table, "phase", row, std::string(to_string(planned.phase)));
    findings.expect(table, "planned_object", row, object.name);
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
    const auto rows = rows_of(
        database, "SELECT * FROM adaptive_plan WHERE session_id = ?1 ORDER BY plan_position",
        session);
    std::size_t next = 0;
    for (const PlannedTrial& planned : frame.plan.trials) {
        if (!planned.adaptive) {
            continue;
        }
        if (next < rows.size()) {
            const StoredRow& row = rows[next];
            const protocols::AdaptiveTrial& adaptive = *planned.adaptive;
            const std::string table = fmt::format("adaptive_plan at position {}", planned.position);
            findings.expect(table, "plan_position", row,
                            static_cast<std::int64_t>(planned.position));
            findings.expect(table, "run_number", row, static_cast<std::int64_t>(adaptive.run));
            findings.expect(table, "run_name", row, frame.protocol.runs.at(adaptive.run).name);
            findings.expect(table, "comparison_interval", row,
                            static_cast<std::int64_t>(adaptive.comparison));
            findings.expect(table, "standard_friction", row,
                            frame.protocol.frictions.at(adaptive.standard_friction).name);
        }
        ++next;
    }
    if (rows.size() != next) {
        findings.differs("adaptive_plan", counted(rows.size(), "row"), counted(next, "row"));
    }
}

void check_pictures(const std::vector<StoredRow>& rows,
                    const SessionFrame& frame,
                    Findings& findings) {
    const std::vector<std::size_t>& order = frame.plan.picture_order;
    if (rows.size() != order.size()) {
        findings.differs("picture", counted(rows.size(), "row"), counted(order.size(), "row"));
    }
    for (std::size_t place = 0; place < std::min(rows.size(), order.size()); ++place) {
        const std::string table = fmt::format("picture at place {}", place);
        findings.expect(table, "picture_place", rows[place], static_cast<std::int64_t>(place));
        findings.expect(table, "picture_object", rows[place],
                        frame.protocol.objects.at(order[place]).name);
    }
}

}  // namespace

bool check_plan(Database& database,
                const StoredRow& session,
                SessionFrame& frame,
                Findings& findings) {
    const std::int64_t id = session.integer("session_id");
    const auto rows =
        rows_of(database, "SELECT * FROM plan WHERE session_id = ?1 ORDER BY plan_position", id);
    const auto pictures =
        rows_of(database, "SELECT * FROM picture WHERE session_id = ?1 ORDER BY picture_place", id);
    for (const StoredRow& picture : pictures) {
        frame.pictures.push_back(picture.text("picture_object"));
    }
    try {
        frame.plan = make_plan(frame.protocol, frame.protocol_hash, frame.key, frame.seed,
                               picture_history(frame.protocol, {}, frame.pictures),
                               friction_history(frame.protocol, {}, frictions_of(rows)));
    } catch (const std::exception& e) {
        findings.differs("plan", counted(rows.size(), "row"), e.what());
        return false;
    }
    findings.expect("session", "plan_sha256", session, frame.plan.hash);
    findings.expect("session", "shuffles", session, static_cast<std::int64_t>(frame.plan.attempts));
    if (rows.size() != frame.plan.trials.size()) {
        findings.differs("plan", counted(rows.size(), "row"),
                         counted(frame.plan.trials.size(), "row"));
    }
    for (std::size_t i = 0; i < std::min(rows.size(), frame.plan.trials.size()); ++i) {
        check_row(rows[i], frame.plan.trials[i], frame.protocol, findings);
    }
    check_pictures(pictures, frame, findings);
    check_adaptive_rows(database, id, frame, findings);
    return true;
}

}  // namespace palpate::data
