#include <algorithm>
#include <exception>
#include <optional>

#include <fmt/format.h>

#include "engine/base/sha256.hpp"
#include "engine/base/text.hpp"
#include "protocols/design/counterbalance.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/file/observer_file.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/trial/object_hash.hpp"
#include "data/store/chain.hpp"
#include "data/store/people.hpp"
#include "data/store/session_store.hpp"
#include "data/store/stored_progress.hpp"
#include "data/store/written_rows.hpp"
#include "data/trace/replay.hpp"
#include "data/verify/trial_check.hpp"

namespace palpate::data {
namespace {

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

/// Draws the plan again from protocol, participant, session, seed and the stored row of pictures;
/// the frame's plan becomes the one drawn.
/// @return false if there is no plan to check trials against
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
    findings.expect("plan", plan_rows(frame.protocol, frame.plan), rows, "position");
    findings.expect("picture", picture_rows(frame.protocol, frame.plan), pictures, "place");
    findings.expect(
        "adaptive_plan", adaptive_plan_rows(frame.protocol, frame.plan),
        rows_of(database,
                "SELECT * FROM adaptive_plan WHERE session_id = ?1 ORDER BY plan_position", id),
        "position");
    return true;
}

/// @return false if the text is no protocol, as the chain says: nothing can be checked against it
bool check_protocol(const StoredRow& session, SessionFrame& frame, Findings& findings) {
    try {
        frame.protocol = protocols::stored_protocol(session.text("protocol_toml"));
    } catch (const protocols::ProtocolError&) {
        return false;
    }
    findings.expect("session", "rate_hz", session, frame.protocol.apparatus.rate_hz);
    findings.expect("session", "stiffness_n_per_m", session, frame.protocol.apparatus.stiffness);
    return true;
}

/// @return false if it is no number of 64 bits
bool read_key(const StoredRow& session, SessionFrame& frame, Findings& findings) {
    frame.protocol_hash = session.text("protocol_sha256");
    frame.key = {session.text("run_as"), static_cast<std::size_t>(session.integer("run_as_number")),
                 session.text("secret")};
    frame.simulated = session.text("session_kind") == "simulated";
    frame.replayed = session.text("device").starts_with("replay of ");
    const std::string seed = session.text("seed");
    frame.seed = parsed<decltype(frame.seed)>(seed).value_or(0);
    const bool good = std::to_string(frame.seed) == seed;
    if (!good) {
        findings.differs("session.seed", seed, "a number of at most 64 bits");
    }
    return good;
}

void check_objects(const SessionFrame& frame, const Provenance& provenance, Findings& findings) {
    for (const auto& [key, hash] : protocols::object_hashes(frame.protocol)) {
        const auto stored = provenance.find(key);
        if (stored == provenance.end() || stored->second != hash) {
            findings.differs("session_provenance: " + key,
                             stored == provenance.end() ? "nothing" : stored->second, hash);
        }
    }
}

/// The hash belongs to the text, and the text is the canonical one of a machine.
void check_calibration(const Provenance& provenance, Findings& findings) {
    const auto text = provenance.find(std::string(kCalibrationKey));
    const auto hash = provenance.find(std::string(kCalibrationHashKey));
    if (text == provenance.end() && hash == provenance.end()) {
        return;  // a device without one
    }
    if (text == provenance.end() || hash == provenance.end()) {
        findings.differs(
            "session_provenance: calibration",
            text == provenance.end() ? "a hash without a text" : "a text without a hash", "both");
        return;
    }
    if (sha256_hex(text->second) != hash->second) {
        findings.differs(fmt::format("session_provenance: {}", kCalibrationHashKey), hash->second,
                         sha256_hex(text->second));
    }
    try {
        const auto machines = protocols::parse_calibrations(text->second, "calibration");
        const auto name = provenance.find("calibration name");
        if (name != provenance.end() && machines.size() == 1 &&
            name->second != machines.front().name()) {
            findings.differs("session_provenance: calibration name", name->second,
                             machines.front().name());
        }
    } catch (const protocols::ProtocolError& e) {
        findings.differs("session_provenance: calibration", e.what(), "a calibration");
    }
}

/// Who answered, and whether ticks were kept: a session of people says nothing of either.
void check_simulation(const Provenance& provenance, SessionFrame& frame, Findings& findings) {
    const auto observer = provenance.find(std::string(kObserverKey));
    const auto traces = provenance.find(std::string(kTracesKey));
    for (const auto& there : {observer, traces}) {
        if (there != provenance.end() && !frame.simulated) {
            findings.differs("session_provenance: " + there->first, there->second,
                             "nothing: the session is not simulated");
            return;
        }
    }
    if (traces != provenance.end()) {
        frame.traceless = traces->second == kNoTraces;
        if (!frame.traceless) {
            findings.differs("session_provenance: " + traces->first, traces->second,
                             std::string(kNoTraces));
        }
    }
    if (observer != provenance.end()) {
        try {
            frame.person =
                drawn_person(protocols::parse_observer(observer->second, observer->first),
                             protocols::session_stream(frame.protocol_hash, frame.key, frame.seed));
        } catch (const protocols::ProtocolError& e) {
            findings.differs("session_provenance: " + observer->first, e.what(), "an observer");
        }
    }
}

/// Of a session on three straight axes.
std::optional<engine::Gantry> gantry_of(const std::string& calibration) {
    try {
        const auto machines = protocols::parse_calibrations(calibration, "calibration");
        if (machines.size() == 1 && machines.front().gantry) {
            return engine::Gantry(*machines.front().gantry);
        }
    } catch (const protocols::ProtocolError&) {
        // check_calibration() says it
    }
    return std::nullopt;
}

void check_provenance(Database& database,
                      std::int64_t session,
                      SessionFrame& frame,
                      Findings& findings) {
    const Provenance provenance = first_provenance(database, session);
    check_objects(frame, provenance, findings);
    check_calibration(provenance, findings);
    check_simulation(provenance, frame, findings);
    if (const auto text = provenance.find(std::string(kCalibrationKey)); text != provenance.end()) {
        frame.machine = machine_of(text->second);
        frame.gantry = gantry_of(text->second);
    }
    // What a resumed session went on with.
    for (const StoredEvent& stored : stored_events(database, session)) {
        const protocols::Event& event = stored.event;
        if (event.kind == protocols::EventKind::device) {
            frame.replayed = frame.replayed || event.value.starts_with("replay of ");
        } else if (event.kind == protocols::EventKind::provenance && event.key == kCalibrationKey) {
            frame.gantry.reset();
        }
    }
    if (const Provenance now = next_provenance(database, session); now != provenance) {
        check_calibration(now, findings);
    }
}

void check_end(const StoredRow& session, const TrialCheck& trials, Findings& findings) {
    const bool finished = session.integer("finished") != 0;
    if (finished == session.null("finished_utc")) {
        findings.differs("session.finished", finished ? "1" : "0",
                         finished ? "0: finished_utc is NULL" : "1: finished_utc is there");
    }
    if (finished && !trials.progress().pending().empty()) {
        findings.differs("session.finished", "1",
                         "0: " + counted(trials.progress().pending().order().size(),
                                         "trial is not answered", "trials are not answered"));
    }
}

void check_all(Database& database,
               const StoredRow& session,
               TickRooms& rooms,
               SessionReport& report,
               Findings& findings) {
    const std::int64_t id = session.integer("session_id");
    SessionFrame frame;
    if (!check_protocol(session, frame, findings) || !read_key(session, frame, findings)) {
        return;
    }
    check_provenance(database, id, frame, findings);
    if (!check_plan(database, session, frame, findings)) {
        return;
    }
    TrialCheck trials(database, id, frame, report, rooms);
    for (const StoredRow& trial :
         rows_of(database, "SELECT * FROM trial WHERE session_id = ?1 ORDER BY trial_id", id)) {
        ++report.trials;
        trials.check(trial);
    }
    trials.finish();
    check_end(session, trials, findings);
}

/// Of a session that was destroyed nothing is left but the mark that says so.
void check_destroyed(Database& database, std::int64_t session, Findings& findings) {
    for (const char* table : {"event", "trial", "plan", "picture", "session_provenance"}) {
        const auto rows = rows_of(
            database, fmt::format("SELECT 1 FROM {} WHERE session_id = ?1", table), session);
        const std::size_t wanted = std::string_view(table) == "event" ? 1 : 0;
        if (rows.size() != wanted) {
            findings.differs(table, counted(rows.size(), "row"),
                             fmt::format("{}: a mark says that the session was destroyed", wanted));
        }
    }
}

}  // namespace

SessionReport check_session(Database& database, const StoredRow& session, TickRooms& rooms) {
    SessionReport report{.id = session.integer("session_id"),
                         .study = session.text("study_name"),
                         .participant = session.text("participant_code"),
                         .number = session.integer("session_number"),
                         .kind = session.text("session_kind"),
                         .finished = session.integer("finished") != 0};
    Findings findings(report.findings);
    try {
        if (is_destroyed(database, report.id)) {
            check_destroyed(database, report.id, findings);
        } else {
            check_all(database, session, rooms, report, findings);
        }
        // Also where the rest was not what it should be: the chain needs nothing but rows.
        report.head = chain_head(database, report.id);
        for (const ChainBreak& at : chain_breaks(database, report.id)) {
            findings.look_at(at.trial == 0 ? std::nullopt : std::optional(at.trial));
            findings.differs(at.what, at.stored, at.recomputed);
        }
        findings.look_at({});
    } catch (const std::exception& e) {  // a damaged file: what could be read is in the report
        findings.differs("session", e.what(), "nothing more of this session can be read");
    }
    return report;
}

}  // namespace palpate::data
