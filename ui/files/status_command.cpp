#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/store/database.hpp"
#include "data/store/session_lock.hpp"
#include "data/store/session_store.hpp"
#include "ui/command/command.hpp"
#include "ui/live/live_segment.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

using data::Json;

struct StatusOptions {
    std::string database;
    bool follow = false;
    bool json = false;
};

void declare(CommandWords& words, StatusOptions& options) {
    words.add("FILE", options.database, "A palpate database; it is only read").required();
    words.add("--follow", options.follow,
              "Goes on with a line for each change of what runs, until nothing runs on it");
    words.add("--json", options.json, "For programs: one JSON object a line");
}

/// How many orders are taken, and by how many people the one that most have.
Json rows_of(const data::LevelOrders& orders) {
    std::map<std::vector<std::string>, std::size_t> people;
    std::size_t most = 0;
    for (const auto& order : orders.others) {
        if (!order.empty()) {
            most = std::max(most, ++people[order]);
        }
    }
    return {{"used", people.size()}, {"max_people", most}};
}

/// One JSON text that the file itself makes of its rows.
Json made_of(data::Database& database, const char* sql, const std::string& study) {
    return Json::parse(database.first(sql, study).text(0));
}

constexpr const char* kSessions =
    "SELECT json_group_array(json_object('participant', participant_code, 'number', "
    "session_number, 'kind', session_kind, 'answered', answered - invalid_answers, 'planned', "
    "planned, 'finished', json(iif(finished, 'true', 'false')), 'withdrawn', "
    "json(iif(withdrawn_reason IS NOT NULL, 'true', 'false')), 'refused', json(iif((SELECT consent "
    "IS 0 FROM participant WHERE participant_code = health.participant_code), 'true', 'false')), "
    "'version', (SELECT study_name || '@' || substr(protocol_sha256, 1, 8) FROM study JOIN session "
    "USING (study_id) WHERE session_id = health.session_id))) FROM (SELECT * FROM session_health "
    "WHERE study_name = ?1 ORDER BY session_id) AS health";

/// Who really ran, and of these whose consent nobody noted; withdrawn sessions and who does not
/// consent left out, and the latter named.
constexpr const char* kPeople =
    "SELECT json_object('ran', count(*) FILTER (WHERE consent IS NOT 0), 'unfinished', "
    "json(json_group_array(code) FILTER (WHERE consent IS NOT 0 AND done = 0)), 'consent_missing', "
    "json(json_group_array(code) FILTER (WHERE consent IS NULL)), 'refused', "
    "json(json_group_array(code) FILTER (WHERE consent IS 0))) FROM (SELECT participant_code AS "
    "code, consent, max(finished) AS done FROM session JOIN study USING (study_id) JOIN "
    "participant USING (participant_id) WHERE study_name = ?1 AND session_kind = 'real' AND "
    "withdrawn_reason IS NULL GROUP BY participant_id ORDER BY min(session_id))";

Json studies_of(data::Database& database) {
    data::Statement row = database.prepare(
        "SELECT study_name, study_title, protocol_toml, max(study_id) FROM study GROUP BY "
        "study_name ORDER BY study_id");
    Json all = Json::array();
    while (row.step()) {
        const std::string study = row.text(0);
        const std::size_t planned = protocols::stored_protocol(row.text(2)).participants;
        Json people = made_of(database, kPeople, study);
        const std::size_t ran = people["ran"];
        all.push_back(
            {{"protocol", study},
             {"title", row.text(1)},
             {"planned", planned},
             {"remaining", planned > ran ? planned - ran : 0},
             {"people", std::move(people)},
             {"picture_orders", rows_of(orders_of(database, data::Balanced::pictures, study, {}))},
             {"friction_orders",
              rows_of(orders_of(database, data::Balanced::frictions, study, {}))},
             {"sessions", made_of(database, kSessions, study)}});
    }
    return all;
}

std::string listed(const Json& names) {
    return names.empty()
             ? "nobody"
             : fmt::format("{}", fmt::join(names.get<std::vector<std::string>>(), ", "));
}

std::string orders_text(const char* of, const Json& rows) {
    return rows["used"] == 0
             ? std::string()
             : fmt::format("  orders of {}: {} taken, one by up to {}\n", of,
                           rows["used"].get<std::size_t>(),
                           counted(rows["max_people"].get<std::size_t>(), "person", "people"));
}

std::string study_text(const Json& study) {
    const Json& people = study["people"];
    std::string text = fmt::format(
        "{}: {} of {} planned ran, {} to go\n  not finished: {}\n  consent missing: {}\n",
        study["protocol"].get<std::string>(), people["ran"].get<std::size_t>(),
        counted(study["planned"].get<std::size_t>(), "person", "people"),
        study["remaining"].get<std::size_t>(), listed(people["unfinished"]),
        listed(people["consent_missing"]));
    if (!people["refused"].empty()) {
        text += fmt::format("  do not consent: {}\n", listed(people["refused"]));
    }
    text += orders_text("pictures", study["picture_orders"]) +
            orders_text("friction blocks", study["friction_orders"]);
    const Json& sessions = study["sessions"];
    const bool several = std::ranges::any_of(sessions, [&](const Json& session) {
        return session["version"] != sessions.front()["version"];
    });
    for (const Json& session : sessions) {
        text += fmt::format("  {:<12} session {}  {:<9}  {} of {} answered{}{}{}{}\n",
                            session["participant"].get<std::string>(), session["number"].get<int>(),
                            session["kind"].get<std::string>(), session["answered"].get<int>(),
                            session["planned"].get<int>(),
                            session["finished"].get<bool>() ? ", finished" : "",
                            session["withdrawn"].get<bool>() ? ", withdrawn" : "",
                            session["refused"].get<bool>() ? ", no consent" : "",
                            several ? ", of " + session["version"].get<std::string>() : "");
    }
    return text;
}

std::string running_text(const Json& state) {
    if (!state.value("answers", true)) {
        return fmt::format(
            "running: {}, {}, session {}: it does not answer. It hangs or is stopped, runs in "
            "another container, or is another user's or another palpate's; if somebody feels it, "
            "use the switch of its motors\n",
            state.value("participant", ""), state.value("kind", ""), state.value("number", 0));
    }
    const auto minutes = state.find("remaining_min");
    return fmt::format(
        "running: {}, {}, session {}: {}{}; {} left{}{}\n", state.value("participant", ""),
        state.value("kind", ""), state.value("number", 0), state.value("sentence", ""),
        state.value("solved", false) ? " (solved: it can go on)" : "", state.value("remaining", 0),
        minutes != state.end() && minutes->is_number()
            ? fmt::format(", about {:.0f} min", minutes->get<double>())
            : "",
        state.value("alarm", false) ? "; ATTENTION: many trials do not count" : "");
}

/// Those that some program runs, and that none of `running` is.
Json silent_of(data::Database& database, const std::vector<RunningSession>& running) {
    data::Statement row = database.prepare(
        "SELECT session_id, uuid, participant_code, session_number, session_kind FROM session JOIN "
        "participant USING (participant_id) ORDER BY session_id");
    Json all = Json::array();
    while (row.step()) {
        const std::string uuid = row.text(1);
        if (std::ranges::find(running, uuid, &RunningSession::uuid) == running.end() &&
            data::SessionLock::held(database, row.integer(0))) {
            all.push_back({{"session", uuid},
                           {"participant", row.text(2)},
                           {"number", row.integer(3)},
                           {"kind", row.text(4)},
                           {"answers", false}});
        }
    }
    return all;
}

/// What some program runs on a file: those that show themselves, and those that do not answer.
struct Running {
    std::vector<RunningSession> sessions;
    Json silent;

    explicit Running(data::Database& database)
        : sessions(running_sessions(database.file())), silent(silent_of(database, sessions)) {
        if (!silent.empty()) {  // one that begins answers a moment later
            std::this_thread::sleep_for(std::chrono::milliseconds(200));
            sessions = running_sessions(database.file());
            silent = silent_of(database, sessions);
        }
    }
    [[nodiscard]] bool all_live() const {
        return std::ranges::all_of(sessions, &RunningSession::alive);
    }
    /// As they stand; of those whose program has ended, none that did not say how.
    [[nodiscard]] Json states() const {
        Json all = silent;
        for (const RunningSession& session : sessions) {
            const bool alive = session.alive();
            const auto state = session.reader->state();
            Json shown = object_in(state ? state->json : "");
            if (!shown.empty() && (alive || has_ended(shown))) {
                all.push_back(std::move(shown));
            }
        }
        return all;
    }
    [[nodiscard]] static bool has_ended(const Json& state) {
        return state.value("ended", Json()).is_string();
    }
};

/// A line for each change, until all have ended. Once a second all are asked whether they answer.
void follow(data::Database& database, Running running, bool json) {
    std::map<std::string, std::string> said;
    bool any = true;
    for (int turn = 1; any && !interrupted(); ++turn) {
        any = false;
        const bool last_words = !running.all_live();
        for (const Json& state : running.states()) {
            any = any || !Running::has_ended(state);
            const std::string text = json ? one_line(state) + '\n' : running_text(state);
            if (std::exchange(said[state.value("session", "")], text) != text) {
                say("{}", text);
            }
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        if (any && (last_words || (turn % 5 == 0 && running.all_live()))) {
            running = Running(database);
        }
    }
}

int run(const StatusOptions& options) {
    catch_signals();
    data::Database database(options.database, data::Access::read);
    Running running(database);
    Json status{{"file", options.database}, {"studies", nullptr}, {"running", running.states()}};
    {
        const data::Snapshot snapshot(database);
        status["studies"] = studies_of(database);
    }
    if (options.json) {
        say("{}\n", one_line(status));
    } else {
        for (const Json& study : status["studies"]) {
            say("{}", study_text(study));
        }
        for (const Json& state : status["running"]) {
            say("{}", running_text(state));
        }
        say("{}", status["running"].empty() ? "Nothing runs on it now.\n" : "");
    }
    if (options.follow) {
        follow(database, std::move(running), options.json);
        return 0;
    }
    return running.silent.empty() ? 0 : 1;
}

}  // namespace

Command status_command() {
    return make_command<StatusOptions>(
        "status", "Who ran, what remains, and what runs now, also while it runs", declare, run);
}

}  // namespace palpate::ui
